"""Runs of studies: what they compute, in pieces, here or on other machines, kept in memory or in a folder, and found."""
