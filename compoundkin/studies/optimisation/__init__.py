"""Optimisation of dimensions: from many starts at once to verified mechanisms."""
