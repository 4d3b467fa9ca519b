"""Coulomb friction coupled to the true reactions: its sizes at every pose, wedging, self-locking, efficiency."""
