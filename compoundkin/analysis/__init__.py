"""Findings about a solved motion: instant centres, coupler curves, loop equations, checks, cams, equivalents."""
