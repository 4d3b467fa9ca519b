"""The NumPy tape: a flat program computed operation by operation, in rows that stay in cache."""
