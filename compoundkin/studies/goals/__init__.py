"""Goals and constraints of an optimisation, with values and slopes along a motion or at driver values of their own."""
