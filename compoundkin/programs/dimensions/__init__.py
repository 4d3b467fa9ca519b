"""Free dimensions: what every call of a program may change of a mechanism, and the mechanism that has it changed."""
