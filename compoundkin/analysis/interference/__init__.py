"""Interference: which outlines of links touch along a motion, and how near the others come."""
