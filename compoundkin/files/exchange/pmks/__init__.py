"""PMKS: joints as records of link names, a kind and a place, in text, in addresses, in its files, in tables."""
