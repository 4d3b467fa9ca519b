"""Arithmetic on truncated Taylor series in time: one position formula gives every derivative.

A `Series` holds coefficients ``c[0..order]`` of ``x(t) = c[0] + c[1] t + c[2] t**2 + ...``, each a
number or an array, so that the k-th time derivative is ``k! c[k]``. A series of one coefficient is a
constant of any order; this is what keeps link lengths and the frame free of cost. Otherwise two series
that meet have the same length. Adding the number 0 or multiplying by the number 1 gives the same object back;
it costs nothing, and two links of one orientation are known to share it.

Source: A. Griewank and A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, sections 13.2 and 13.3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import factorial
from operator import mul

import numpy as np

from compoundkin.base.arrays import (
    PLAIN,
    Number,
    as_number,
    complex_of,
    convolution,
    cross,
    dot,
    first_entry,
    is_number,
    negative,
    real_product,
    reciprocal,
    symmetric_convolution,
)

__all__ = ["Number", "Series", "as_series", "constant"]


class Series:
    """A truncated Taylor series; `c` is the tuple of its coefficients.

    >>> t = Series((2.0, 1.0, 0.0))          # 2 + t
    >>> (t * t).c
    (4.0, 4.0, 1.0)
    >>> (1.0 / t).c
    (0.5, -0.25, 0.125)
    """

    __slots__ = ("c",)
    # NumPy arrays on the left hand must leave the operation to us.
    __array_ufunc__ = None

    def __init__(self, c: tuple[Number, ...]) -> None:
        self.c = c

    @property
    def order(self) -> int:
        """The order of the highest derivative held; 0 for a constant."""
        return len(self.c) - 1

    def __add__(self, other: Series | Number) -> Series:
        a, b = self.c, _coefficients(other)
        if len(a) == len(b):
            return Series(tuple([x + y for x, y in zip(a, b, strict=True)]))
        if len(b) == 1:
            return self if is_number(b[0], 0) else Series((a[0] + b[0], *a[1:]))
        return Series((a[0] + b[0], *b[1:]))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series(tuple([negative(x) for x in self.c]))

    def __sub__(self, other: Series | Number) -> Series:
        a, b = self.c, _coefficients(other)
        if len(a) == len(b):
            return Series(tuple([x - y for x, y in zip(a, b, strict=True)]))
        if len(b) == 1:
            return self if is_number(b[0], 0) else Series((a[0] - b[0], *a[1:]))
        return Series((a[0] - b[0], *[negative(y) for y in b[1:]]))

    def __rsub__(self, other: Number) -> Series:
        return (-self).__add__(other)

    def __mul__(self, other: Series | Number) -> Series:
        b = _coefficients(other)
        if len(b) == 1:
            return self._scaled(b[0])
        if len(self.c) == 1:
            return Series(b)._scaled(self.c[0])
        if other is self:
            return Series(tuple([symmetric_convolution(b, b, k, mul) for k in range(len(b))]))
        return self._bilinear(other, mul)

    __rmul__ = __mul__

    def __truediv__(self, other: Series | Number) -> Series:
        a, b = self.c, _coefficients(other)
        inverse = reciprocal(b[0])
        if len(b) == 1:
            return self._scaled(inverse)
        q = [a[0] * inverse]
        for k in range(1, len(b)):
            carried = convolution(b[1 : k + 1], q, mul)
            q.append((a[k] - carried) * inverse if k < len(a) else carried * -inverse)
        return Series(tuple(q))

    def __rtruediv__(self, other: Number) -> Series:
        b = self.c
        q = [reciprocal(b[0])]
        minus = negative(q[0])
        for k in range(1, len(b)):
            q.append(convolution(b[1 : k + 1], q, mul) * minus)
        return Series(tuple(q))._scaled(other)

    def conj(self) -> Series:
        """Return the complex conjugate."""
        return Series(tuple([x.conjugate() for x in self.c]))

    @property
    def real(self) -> Series:
        """The real part."""
        return Series(tuple([x.real for x in self.c]))

    @property
    def imag(self) -> Series:
        """The imaginary part."""
        return Series(tuple([x.imag for x in self.c]))

    def dot(self, other: Series | Number) -> Series:
        """Return the scalar product of two planar vectors, ``Re(conj(a) b)``."""
        return self._bilinear(other, dot)

    def cross(self, other: Series | Number) -> Series:
        """Return the third component of the vector product of planar vectors, ``Im(conj(a) b)``."""
        return self._bilinear(other, cross)

    def abs2(self) -> Series:
        """Return the squared length of a planar vector."""
        back = [x.conjugate() for x in self.c[: (len(self.c) + 1) // 2]]
        return Series(tuple([symmetric_convolution(back, self.c, k, real_product) for k in range(len(self.c))]))

    def sqrt(self) -> Series:
        """Return the positive square root; NaN where the leading coefficient is negative."""
        a = self.c
        root = [np.sqrt(a[0])]
        if len(a) > 1:
            half = 0.5 / root[0]
            for k in range(1, len(a)):
                root.append((a[k] - convolution(root[1:], root[1:], mul) if k > 1 else a[k]) * half)
        return Series(tuple(root))

    def unit(self) -> Series:
        """Return the unit vector of a planar vector."""
        return self / self.abs2().sqrt()

    def turn(self) -> Series:
        """Return the unit vector ``exp(i a)`` at the angle this (real) series gives.

        >>> Series((0.0, 2.0, 0.0)).turn().c
        ((1+0j), 2j, (-2+0j))
        """
        out = [complex_of(np.cos(self.c[0]), np.sin(self.c[0]))]
        rates = self.c
        for k in range(1, len(rates)):
            terms = [(1j * j / k * rates[j]) * out[k - j] for j in range(1, k + 1) if not is_number(rates[j], 0)]
            out.append(sum(terms[1:], terms[0]) if terms else 0j)
        return Series(tuple([complex(x) if isinstance(x, (float, int)) else x for x in out]))

    def angle(self) -> Series:
        """Return the angle of a unit vector, its leading coefficient between -pi and pi."""
        rates = self.turning().c if len(self.c) > 1 else ()
        return Series((np.angle(self.c[0]), *[rate / k for k, rate in enumerate(rates, 1)]))

    def turning(self) -> Series:
        """Return the rate at which a unit vector turns. It is ``Im(conj(u) u')``, one order lower than the vector."""
        u = self.c
        back = [x.conjugate() for x in u[: len(u) // 2]]
        out = []
        for k in range(1, len(u)):
            total = (back[0] * u[k]).imag * float(k)
            for j in range(k // 2 + 1, k):  # two by two: Im(conj(b) a) = -Im(conj(a) b)
                total = total + (back[k - j] * u[j]).imag * float(2 * j - k)
            out.append(total)
        return Series(tuple(out) or (0.0,))

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative, an array; zero beyond the order of a constant."""
        if k < len(self.c):
            return self.c[k] * factorial(k) if k > 1 else self.c[k]
        return np.zeros_like(self.c[0])

    def _scaled(self, factor: Number) -> Series:
        return self if is_number(factor, 1) else Series(tuple([x * factor for x in self.c]))

    def _bilinear(self, other: Series | Number, product: Callable[[Number, Number], Number]) -> Series:
        a, b = self.c, _coefficients(other)
        if len(b) == 1:
            return Series(tuple([product(x, b[0]) for x in a]))
        if len(a) == 1:
            return Series(tuple([product(a[0], y) for y in b]))
        return Series(tuple([convolution(a[: k + 1], b[: k + 1], product) for k in range(len(a))]))

    def __repr__(self) -> str:
        return f"Series({self.c!r})"


def constant(value: Number) -> Series:
    """Return the series of a value that does not change."""
    return Series((value,))


def as_series(value: Series | Number) -> Series:
    """Return a number as a constant, a series as it is."""
    return value if isinstance(value, Series) else Series((value,))


def first_number(value: Series | Number | None) -> Number:
    """Return the first entry of a number, an array, or a constant series; None where there is none.

    >>> first_number(Series((np.array([[1.0], [2.0]]),))), first_number(None)
    (np.float64(1.0), None)
    """
    return None if value is None else first_entry(value.c[0] if isinstance(value, Series) else value)


def _coefficients(value: Series | Number) -> tuple[Number, ...]:
    return value.c if isinstance(value, Series) else (value,)


def compose_series(coefficients: Sequence[Number], s: Series) -> Series:
    """Return the series C(s(t)) by Horner's rule.

    `coefficients` are those of C at the leading coefficient of s; as many as `s` has are used.

    >>> compose_series((4.0, 4.0, 1.0), Series((2.0, 1.0, 0.0))).c  # the square of 2 + t
    (4.0, 4.0, 1.0)
    """
    order = s.order
    result: tuple[Number, ...] = (coefficients[order],)
    for k in range(order - 1, -1, -1):
        # s - s(0) is t times a series, so that every step inwards needs one order less
        result = (coefficients[k], *(Series(s.c[1 : order - k + 1]) * Series(result)).c)
    return Series(result)


def implicit_series(start: Number, order: int, slope: Number, residual: Callable[[Series], Series]) -> Series:
    """Return the series with this leading coefficient that makes `residual` zero, order by order.

    `slope` is the derivative of the residual by s at `start`; the coefficients are not finite where it is zero.

    The root of 4 + 4 t + 2 t^2 that begins with 2:

    >>> implicit_series(2.0, 2, 4.0, lambda s: s * s - Series((4.0, 4.0, 2.0)[: s.order + 1])).c
    (2.0, 1.0, 0.25)
    """
    found = [start]
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(1, order + 1):
            found.append(residual(Series((*found, 0.0))).c[k] * -np.divide(1.0, slope))
    return Series(tuple([float(x) if isinstance(x, PLAIN) else x for x in found]))


def derivative_coefficients(coefficients: tuple[Number, ...]) -> tuple[Number, ...]:
    """Return the Taylor coefficients of the derivative.

    >>> derivative_coefficients((4.0, 4.0, 1.0))
    (4.0, 2.0)
    """
    return tuple([c * k for k, c in enumerate(coefficients)])[1:]


def planar_series(x: Series, y: Series) -> Series:
    """Return the planar vector with the (real) components x and y.

    >>> planar_series(Series((1.0, 2.0)), Series((3.0, 4.0))).c
    ((1+3j), (2+4j))
    """
    if len(x.c) == len(y.c):
        return Series(tuple([complex_of(a, b) for a, b in zip(x.c, y.c, strict=True)]))
    return x + y * 1j


def taylor(values: tuple[Number, ...], t: Number, order: int) -> Series:
    """Return a coordinate at times t with its derivatives, from its value, speed, acceleration ... at time 0.

    >>> taylor((1.0, 2.0, 6.0), 2.0, order=2).c
    (17.0, 14.0, 3.0)
    """
    found = []
    for k in range(order + 1):
        total = values[-1] if k < len(values) else 0.0
        for j in range(len(values) - 2, k - 1, -1):
            if type(total) is float and total == 0.0 and type(values[j]) is float:
                total = 0.0 + values[j]  # at all times
            else:
                total = (total * t / (j - k + 1) if j > k else total * t) + values[j]
        if k < len(values) - 1 and type(total) is float and isinstance(t, np.ndarray):
            everywhere = np.empty(t.shape)
            everywhere.fill(total)
            total = everywhere
        found.append(as_number(total))
    return from_derivatives(found)


def from_derivatives(derivatives: list[Number]) -> Series:
    """Return the series of a value and its derivatives.

    >>> from_derivatives([1.0, 2.0, 3.0, 6.0]).c
    (1.0, 2.0, 1.5, 1.0)
    """
    factor, out = 1.0, []
    for k, derivative in enumerate(derivatives):
        factor *= max(k, 1)
        out.append(derivative / factor if k > 1 else derivative)
    return Series(tuple(out))
