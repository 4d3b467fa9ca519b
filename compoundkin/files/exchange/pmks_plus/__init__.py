"""PMKS+: its share links and its files, which hold the same string, read and written."""
