"""linkage_sim: its JSON of bodies with coordinates of their own, read."""
