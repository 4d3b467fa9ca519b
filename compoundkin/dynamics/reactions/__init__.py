"""Reactions: the reverse pass over the groups, and what equilibrium leaves open."""
