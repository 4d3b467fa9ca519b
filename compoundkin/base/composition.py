"""Series made of others: a function of one, one given by an equation only, a vector by its components.

Source: A. Griewank and A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, sections 13.2 and 13.3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from compoundkin.base.arrays import PLAIN, Number, joined
from compoundkin.base.series import Series


def composed(coefficients: Sequence[Number], s: Series) -> Series:
    """Return the series C(s(t)) by Horner's rule.

    `coefficients` are those of C at the leading coefficient of s; as many as `s` has are used.

    >>> composed((4.0, 4.0, 1.0), Series((2.0, 1.0, 0.0))).c  # the square of 2 + t
    (4.0, 4.0, 1.0)
    """
    order = s.order
    result: tuple[Number, ...] = (coefficients[order],)
    for k in range(order - 1, -1, -1):
        # s - s(0) is t times a series, so that every step inwards needs one order less
        result = (coefficients[k], *(Series(s.c[1 : order - k + 1]) * Series(result)).c)
    return Series(result)


def implicit(start: Number, order: int, slope: Number, residual: Callable[[Series], Series]) -> Series:
    """Return the series with this leading coefficient that makes `residual` zero, order by order.

    `slope` is the derivative of the residual by s at `start`; the coefficients are not finite where it is zero.

    >>> implicit(2.0, 2, 4.0, lambda s: s * s - Series((4.0, 4.0, 2.0)[: s.order + 1])).c  # root of 4 + 4 t + 2 t^2
    (2.0, 1.0, 0.25)
    """
    found = [start]
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(1, order + 1):
            found.append(residual(Series((*found, 0.0))).c[k] * -np.divide(1.0, slope))
    return Series(tuple([float(x) if isinstance(x, PLAIN) else x for x in found]))


def differentiated(coefficients: tuple[Number, ...]) -> tuple[Number, ...]:
    """Return the Taylor coefficients of the derivative.

    >>> differentiated((4.0, 4.0, 1.0))
    (4.0, 2.0)
    """
    return tuple([c * k for k, c in enumerate(coefficients)])[1:]


def planar(x: Series, y: Series) -> Series:
    """Return the planar vector with the (real) components x and y.

    >>> planar(Series((1.0, 2.0)), Series((3.0, 4.0))).c
    ((1+3j), (2+4j))
    """
    if len(x.c) == len(y.c):
        return Series(tuple([joined(a, b) for a, b in zip(x.c, y.c, strict=True)]))
    return x + y * 1j
