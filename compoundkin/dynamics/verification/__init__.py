"""The independent verification of forces."""
