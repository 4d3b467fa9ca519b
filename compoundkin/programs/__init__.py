"""Compiled programs: a bound mechanism recorded as straight-line arithmetic, its back ends, derivatives, sources."""
