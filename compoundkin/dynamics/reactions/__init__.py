"""Reactions: the reverse pass over the groups, and undetermined forces."""
