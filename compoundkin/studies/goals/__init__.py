"""Goals and constraints of an optimisation, which have values and slopes along a motion or at driver values of their own."""
