"""Tables of operations: the program of a live page, and the dimensions that it may change one by one."""
