"""All configurations of a mechanism, the circuits they lie on, their branches and limit positions."""
