"""Goals and constraints of better dimensions: one file for each kind, by what people ask for.

What is asked along a motion, or at driver values of its own, is a `Term`. Interference of outlines comes as one more
constraint, in a file of its own, as soon as links have outlines.
"""
