"""Arithmetic on truncated Taylor series in time: one position formula gives every derivative.

A `Series` holds coefficients ``c[0..order]`` of ``x(t) = c[0] + c[1] t + c[2] t**2 + ...``, each a
number or an array, so that the k-th time derivative is ``k! c[k]``. A series of one coefficient is a
constant of any order; this is what keeps link lengths and the frame free of cost. Otherwise two series
that meet have the same length. Adding the number 0 or multiplying by the number 1 gives the same object back;
it costs nothing, and two links of one orientation are known to share it.

Source: A. Griewank and A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, section 13.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import factorial, inf
from operator import mul
from typing import Any, TypeAlias

import numpy as np

# A number or an array of numbers; NumPy's stubs cannot say "the same array library as the operand".
Number: TypeAlias = Any


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
            return self if _is(b[0], 0) else Series((a[0] + b[0], *a[1:]))
        return Series((a[0] + b[0], *b[1:]))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series(tuple([_negative(x) for x in self.c]))

    def __sub__(self, other: Series | Number) -> Series:
        a, b = self.c, _coefficients(other)
        if len(a) == len(b):
            return Series(tuple([x - y for x, y in zip(a, b, strict=True)]))
        if len(b) == 1:
            return self if _is(b[0], 0) else Series((a[0] - b[0], *a[1:]))
        return Series((a[0] - b[0], *[_negative(y) for y in b[1:]]))

    def __rsub__(self, other: Number) -> Series:
        return (-self).__add__(other)

    def __mul__(self, other: Series | Number) -> Series:
        b = _coefficients(other)
        if len(b) == 1:
            return self._scaled(b[0])
        if len(self.c) == 1:
            return Series(b)._scaled(self.c[0])
        if other is self:
            return Series(tuple([_folded(b, b, k, mul) for k in range(len(b))]))
        return self._bilinear(other, mul)

    __rmul__ = __mul__

    def __truediv__(self, other: Series | Number) -> Series:
        a, b = self.c, _coefficients(other)
        inverse = _reciprocal(b[0])
        if len(b) == 1:
            return self._scaled(inverse)
        q = [a[0] * inverse]
        for k in range(1, len(b)):
            carried = _convolved(b[1 : k + 1], q, mul)
            q.append((a[k] - carried) * inverse if k < len(a) else carried * -inverse)
        return Series(tuple(q))

    def __rtruediv__(self, other: Number) -> Series:
        b = self.c
        q = [_reciprocal(b[0])]
        minus = _negative(q[0])
        for k in range(1, len(b)):
            q.append(_convolved(b[1 : k + 1], q, mul) * minus)
        return Series(tuple(q))._scaled(other)

    def conj(self) -> Series:
        """The complex conjugate."""
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
        """The scalar product of two planar vectors, ``Re(conj(a) b)``."""
        return self._bilinear(other, dot)

    def cross(self, other: Series | Number) -> Series:
        """The third component of the vector product of two planar vectors, ``Im(conj(a) b)``."""
        return self._bilinear(other, cross)

    def abs2(self) -> Series:
        """The squared length of a planar vector."""
        back = [x.conjugate() for x in self.c[: (len(self.c) + 1) // 2]]
        return Series(tuple([_folded(back, self.c, k, _real_product) for k in range(len(self.c))]))

    def sqrt(self) -> Series:
        """The positive square root; NaN where the leading coefficient is negative."""
        a = self.c
        root = [np.sqrt(a[0])]
        if len(a) > 1:
            half = 0.5 / root[0]
            for k in range(1, len(a)):
                root.append((a[k] - _convolved(root[1:], root[1:], mul) if k > 1 else a[k]) * half)
        return Series(tuple(root))

    def unit(self) -> Series:
        """The unit vector of a planar vector."""
        return self / self.abs2().sqrt()

    def turn(self) -> Series:
        """The unit vector ``exp(i a)`` at the angle this (real) series gives.

        >>> Series((0.0, 2.0, 0.0)).turn().c
        ((1+0j), 2j, (-2+0j))
        """
        out = [joined(np.cos(self.c[0]), np.sin(self.c[0]))]
        rates = self.c
        for k in range(1, len(rates)):
            terms = [(1j * j / k * rates[j]) * out[k - j] for j in range(1, k + 1) if not _is(rates[j], 0)]
            out.append(sum(terms[1:], terms[0]) if terms else 0j)
        return Series(tuple([x if isinstance(x, np.ndarray) else complex(x) for x in out]))

    def angle(self) -> Series:
        """The angle of a unit vector, its leading coefficient between -pi and pi."""
        rates = self.turning().c if len(self.c) > 1 else ()
        return Series((np.angle(self.c[0]), *[rate / k for k, rate in enumerate(rates, 1)]))

    def turning(self) -> Series:
        """The rate at which a unit vector turns, ``Im(conj(u) u')``, one order lower than the vector itself."""
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
        """The k-th time derivative, an array; zero beyond the order of a constant."""
        if k < len(self.c):
            return self.c[k] * factorial(k) if k > 1 else self.c[k]
        return np.zeros_like(self.c[0])

    def _scaled(self, factor: Number) -> Series:
        return self if _is(factor, 1) else Series(tuple([x * factor for x in self.c]))

    def _bilinear(self, other: Series | Number, product: Callable[[Number, Number], Number]) -> Series:
        a, b = self.c, _coefficients(other)
        if len(b) == 1:
            return Series(tuple([product(x, b[0]) for x in a]))
        if len(a) == 1:
            return Series(tuple([product(a[0], y) for y in b]))
        return Series(tuple([_convolved(a[: k + 1], b[: k + 1], product) for k in range(len(a))]))

    def __repr__(self) -> str:
        return f"Series({self.c!r})"


def constant(value: Number) -> Series:
    """The series of a value that does not change."""
    return Series((value,))


def as_series(value: Series | Number) -> Series:
    """A number as a constant; a series as it is."""
    return value if isinstance(value, Series) else Series((value,))


def planar(x: Series, y: Series) -> Series:
    """The planar vector with the (real) components x and y.

    >>> planar(Series((1.0, 2.0)), Series((3.0, 4.0))).c
    ((1+3j), (2+4j))
    """
    if len(x.c) == len(y.c):
        return Series(tuple([joined(a, b) for a, b in zip(x.c, y.c, strict=True)]))
    return x + y * 1j


def _coefficients(value: Series | Number) -> tuple[Number, ...]:
    return value.c if isinstance(value, Series) else (value,)


def _is(value: Number, number: int) -> bool:
    """Whether a coefficient is a Python number of this value; an array never is, whatever its entries."""
    return isinstance(value, (float, complex, int)) and value == number


def joined(x: Number, y: Number) -> Number:
    """The complex number or array with these parts; twice as fast as ``x + 1j * y``, which converts both.

    >>> joined(1.0, 2.0)
    (1+2j)
    """
    if not (isinstance(x, np.ndarray) or isinstance(y, np.ndarray)):
        return complex(x, y)
    out = np.empty(np.broadcast(x, y).shape, dtype=complex)
    out.real, out.imag = x, y
    return out


def _negative(a: Number) -> Number:
    # NumPy's negation of complex arrays is not vectorised, its subtraction is: three times as fast
    return 0.0 - a


def _reciprocal(a: Number) -> Number:
    # Python's numbers raise an error where arrays give infinity
    return inf if _is(a, 0) else 1.0 / a


def _convolved(a: Sequence[Number], b: Sequence[Number], product: Callable[[Number, Number], Number]) -> Number:
    """The sum of a[0] b[-1], a[1] b[-2] ... a[-1] b[0]."""
    # products are not given names, so that NumPy may add to a large one in place
    if len(a) == 1:
        return product(a[0], b[0])
    return product(a[0], b[-1]) + _convolved(a[1:], b[:-1], product)


def _folded(a: Sequence[Number], b: Sequence[Number], k: int, product: Callable[[Number, Number], Number]) -> Number:
    """The k-th coefficient of a product in which a[i] b[j] and a[j] b[i] are the same."""
    half = (k + 1) // 2
    if k == 0:
        return product(a[0], b[0])
    if k % 2:
        return _convolved(a[:half], b[half : k + 1], product) * 2.0
    return _convolved(a[:half], b[half + 1 : k + 1], product) * 2.0 + product(a[half], b[half])


def _real_product(a: Number, b: Number) -> Number:
    return (a * b).real


def dot(a: Number, b: Number) -> Number:
    """The scalar product of planar vectors that are numbers or arrays.

    >>> dot(1 + 2j, 3 + 4j)
    11.0
    """
    # one complex product takes less time than the four passes over strided parts
    return (a.conjugate() * b).real


def cross(a: Number, b: Number) -> Number:
    """The third component of the vector product of planar vectors that are numbers or arrays.

    >>> cross(1 + 2j, 3 + 4j)
    -2.0
    """
    # written out, so that the cross product of a vector with itself is exactly zero
    return a.real * b.imag - a.imag * b.real
