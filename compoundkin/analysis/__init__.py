"""Findings about a solved motion: instant centres, coupler curves, loop equations, checks, cams, equivalents.

The derivation of the instant centres (which two lines give which centre, in which order) depends on links and pairs
only. It is made once and evaluated at all poses in homogeneous coordinates, so that centres at infinity are ordinary.
It starts from the relaxed structure: at random geometry an overconstrained one does not move.

`verify` uses none of the formulas that solved the motion: residuals of the pairs' equations, velocities from instant
centres, the collinearity of every three centres, derivatives against differences of positions at neighbouring driver
values, each pose as the continuation of the one before it, gaps as places to which no continuation leads, drawn
configurations and written modes. `Motion.error` bounds the rounding: the motion solved again with dimensions changed by
rounding.

Loop equations are data: every vector has a length and an angle, sums of unknowns. After substitution of plain ties two
rows a loop remain; velocities, accelerations and Newton's iterations share one matrix of symbolic derivatives.

Outlines are points, lines or polygons with a radius in the links' frames. The distance of two cores less both radii is
the clearance, which changes no faster than bodies move: the search is limited to where that allows a touch or a new
least clearance.
"""
