"""Near limits: what is assembled, what needs a look, what only solving can tell."""
