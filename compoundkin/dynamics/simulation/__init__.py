"""Forward dynamics: mechanisms that move under their masses and loads."""
