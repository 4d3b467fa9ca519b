"""Graphs of real operations: what is recorded, folded, cut into strata, and read by every back end."""
