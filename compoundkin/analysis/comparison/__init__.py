"""Comparison: two mechanisms side by side, their structure, their dimensions, and how far apart they move."""
