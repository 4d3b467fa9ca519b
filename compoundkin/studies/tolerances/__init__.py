"""Tolerance analysis: the effect of errors of dimensions and of clearances, worst case and statistical."""
