"""Counterweights: which exist, and what they do."""
