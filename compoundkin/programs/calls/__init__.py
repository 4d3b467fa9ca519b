"""Calls: the numbers that a program is given, and the arrays that it writes."""
