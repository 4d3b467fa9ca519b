"""Numbers as texts of other programs: all their digits, the shortest way."""

from __future__ import annotations


def shortest(value: float) -> str:
    """Return a number with all its digits, a whole one without a point.

    >>> shortest(10.0), shortest(-0.0), shortest(0.1), shortest(1e-7)
    ('10', '0', '0.1', '1e-07')
    """
    return repr(float(value) + 0.0).removesuffix(".0")
