"""Quantiles of distributions at numbers between 0 and 1, without those at 0 and 1, which may be infinite."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number

# Sobol's numbers are multiples of 2^-30; 0 stands for all below the first of them, the half of which is taken.
LEAST_UNIT = 2.0**-31


def inner_units(units: Number) -> Number:
    """Return the numbers, which are moved off 0 and 1."""
    return np.clip(units, LEAST_UNIT, 1.0 - LEAST_UNIT)


def normal_quantiles(units: Number) -> Number:
    """Return the quantiles of the standard normal distribution."""
    from scipy.special import ndtri

    return np.asarray(ndtri(inner_units(units)))
