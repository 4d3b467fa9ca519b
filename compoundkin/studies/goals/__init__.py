"""Goals and constraints of better dimensions: one file for each kind, by what people ask for."""
