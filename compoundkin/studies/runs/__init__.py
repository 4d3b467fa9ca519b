"""Runs of studies: what they compute, in pieces, here or elsewhere, kept in memory or a folder, and what is found."""
