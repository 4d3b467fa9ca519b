"""Runs of studies: rows computed in pieces, here or on other machines, kept in memory or in a folder."""
