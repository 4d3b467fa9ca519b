"""All configurations of a mechanism, the circuits they lie on, their branches and limit positions; workspaces.

The configuration curve is lifted over one group after another, from the driver's range upward. A segment is an interval
of the driver's value on which each group keeps its mode. Over a group with a closed form segments are cut at the zeros
of the group's margin and doubled; over any other group the configurations at slices are joined by arcs of continuation
and cut at turning points. Ends of segments are glued as they are cut, so that circuits are chains of segments, and no
continuation jumps to another circuit unnoticed: every arc must arrive at a known configuration, through a port that no
other arc uses. Along a segment everything is smooth in the angle of a half circle.

A workspace is solved with the inverse mechanism: the drivers are released, the motion of the point is prescribed. The
margin of a place is the least of its groups, guide ends and drivers' ranges, in the best configuration; it is
continuous, so that false position on the lines of a lattice finds the boundary. Modes are those of the driven
mechanism.
"""
