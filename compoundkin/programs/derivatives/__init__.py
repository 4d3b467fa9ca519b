"""Derivatives of recorded programs: new nodes of the same graph, by tangents or by adjoints."""
