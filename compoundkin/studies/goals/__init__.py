"""Goals and constraints of better dimensions: one file for each kind, by what people ask for.

What is asked along a motion, or at driver values of its own, is a `Term`.
"""
