"""Tolerances: what errors of dimensions and loose pins do to a motion, at worst and by chance."""
