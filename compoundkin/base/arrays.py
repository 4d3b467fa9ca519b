"""Numbers and arrays of them alike: plane vectors, coefficients, angles, and values at one design and pose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, TypeAlias

import numpy as np

# A number or an array of numbers; NumPy's stubs cannot say "the same array library as the operand".
Number: TypeAlias = Any
TURN = 2.0 * np.pi
# Numbers that Python itself makes complex.
PLAIN = (float, int, np.number)
# Lengths that can be computed with: the fourth power of one, as in the discriminant of a dyad, is a number still.
LONGEST, SHORTEST = 1e50, 1e-50


# --- plane vectors ---


def complex_of(x: Number, y: Number) -> Number:
    """Join two parts to a complex number or array. This is twice as fast as ``x + 1j * y``, which converts both.

    >>> complex_of(1.0, 2.0)
    (1+2j)
    """
    if not (isinstance(x, np.ndarray) or isinstance(y, np.ndarray)):
        # a number of another kind, one that records, is joined by its own arithmetic
        return complex(x, y) if isinstance(x, PLAIN) and isinstance(y, PLAIN) else x + 1j * y
    out = np.empty(np.broadcast(x, y).shape, dtype=complex)
    out.real, out.imag = x, y
    return out


def dot(a: Number, b: Number) -> Number:
    """Return the scalar product of plane vectors that are numbers or arrays.

    >>> dot(1 + 2j, 3 + 4j)
    11.0
    """
    # one complex product takes less time than the four passes over strided parts
    return (a.conjugate() * b).real


def cross(a: Number, b: Number) -> Number:
    """Return the third component of the vector product of plane vectors, numbers or arrays.

    >>> cross(1 + 2j, 3 + 4j)
    -2.0
    """
    # written out, so that the cross product of a vector with itself is exactly zero
    return a.real * b.imag - a.imag * b.real


# --- coefficients of series ---


def is_number(value: Number, number: int) -> bool:
    """Return whether a coefficient is a Python number of this value; an array never is."""
    return isinstance(value, (float, complex, int)) and value == number


def negative(a: Number) -> Number:
    """Return the negative of a coefficient."""
    # NumPy's negation of complex arrays is not vectorised, its subtraction is: three times as fast
    return 0.0 - a


def reciprocal(a: Number) -> Number:
    """Return one divided by a coefficient, infinite for a zero."""
    # Python's numbers raise an error where arrays give infinity
    return inf if is_number(a, 0) else 1.0 / a


def real_product(a: Number, b: Number) -> Number:
    """Return the real part of a product."""
    return (a * b).real


def convolution(a: Sequence[Number], b: Sequence[Number], product: Callable[[Number, Number], Number]) -> Number:
    """Return the sum of the products of a[0] b[-1], a[1] b[-2] ... a[-1] b[0]."""
    # products are not given names, so that NumPy may add to a large one in place
    if len(a) == 1:
        return product(a[0], b[0])
    return product(a[0], b[-1]) + convolution(a[1:], b[:-1], product)


def symmetric_convolution(
    a: Sequence[Number], b: Sequence[Number], k: int, product: Callable[[Number, Number], Number]
) -> Number:
    """Return the k-th coefficient of a product where a[i] b[j] equals a[j] b[i]."""
    half = (k + 1) // 2
    if k == 0:
        return product(a[0], b[0])
    if k % 2:
        return convolution(a[:half], b[half : k + 1], product) * 2.0
    return convolution(a[:half], b[half + 1 : k + 1], product) * 2.0 + product(a[half], b[half])


# --- values in order ---


def ascending(*arrays: Any) -> Number:
    """Return the distinct values of some arrays in order; no value may be NaN.

    NumPy's functions of sets load masked arrays when they are first called, which takes as long as to solve a motion.

    >>> ascending([2.0, 1.0], [1.0]).tolist()
    [1.0, 2.0]
    """
    found = np.sort(np.concatenate([np.ravel(one) for one in arrays]))
    return found[np.append(True, found[1:] != found[:-1])] if len(found) else found


# --- angles ---


def wrapped(angle: Number) -> Number:
    """Return the same angle above -pi and up to pi.

    >>> [round(float(wrapped(x)), 6) for x in (-np.pi, 1.0, 4.0)]
    [3.141593, 1.0, -2.283185]
    """
    return angle - TURN * np.ceil((angle - np.pi) / TURN)


def whole_turns(angle: Number, turn: Number = TURN) -> Number:
    """Return the multiple of a turn that is nearest to an angle.

    >>> whole_turns(700.0, 360.0)
    np.float64(720.0)
    """
    return turn * np.round(angle / turn)


def turns_above(angle: Number, low: Number, turn: Number = TURN) -> Number:
    """Return the turns of an angle above the one that begins at `low`.

    >>> turns_above(np.array([-10.0, 350.0, 370.0]), 0.0, 360.0).tolist()
    [-360.0, 0.0, 360.0]
    """
    return turn * np.floor((angle - low) / turn)


# Less than half a turn, by more than rounding.
HALF_TURN = 3.14


def unwrapped(angle: Number) -> Number:
    """Make an angle continuous along the last axis, over gaps of NaN too.

    >>> unwrapped(np.array([3.0, np.nan, -3.0])).round(3).tolist()
    [3.0, nan, 3.283]
    """
    if np.ndim(angle) == 0 or np.shape(angle)[-1] < 2:
        return angle
    spread = np.max(angle) - np.min(angle) if np.size(angle) else np.nan
    if spread < HALF_TURN:
        return angle  # no step is of half a turn, as of most links
    if np.size(angle) == np.shape(angle)[-1] and np.isfinite(spread):
        row = np.ravel(angle)
        # the sums of turns below decide on the sign of a negative zero
        if not np.signbit(row[row == 0.0]).any():
            return _unwrapped_row(row).reshape(np.shape(angle))
    turns = np.rint((angle[..., 1:] - angle[..., :-1]) * (0.5 / np.pi))
    if not turns.any():
        return angle
    if not np.isnan(turns).any():
        return np.concatenate([angle[..., :1], angle[..., 1:] - 2.0 * np.pi * np.cumsum(turns, axis=-1)], axis=-1)
    rows = np.array(angle).reshape(-1, np.shape(angle)[-1])
    for row in rows:
        known = ~np.isnan(row)
        row[known] = np.unwrap(row[known])
    return rows.reshape(np.shape(angle))


def _unwrapped_row(angle: Number) -> Number:
    """Make one row of finite angles continuous, piece by piece between its jumps."""
    steps = angle[1:] - angle[:-1]
    jumps = np.flatnonzero(np.abs(steps) > HALF_TURN)
    turns = np.cumsum(np.rint(steps[jumps] * (0.5 / np.pi)))
    if not turns.any():
        return angle
    found = np.array(angle)
    for first, end, turn in zip(jumps + 1, np.append(jumps[1:] + 1, len(angle)), turns, strict=True):
        found[first:end] -= 2.0 * np.pi * turn
    return found


# --- values at one design and pose ---


def trapezoid(values: Number, places: Number) -> Number:
    """Integrate values over their places, along the last axis, by the trapezoidal rule.

    >>> float(trapezoid(np.array([0.0, 1.0, 4.0]), np.array([0.0, 1.0, 2.0])))
    3.0
    """
    return np.sum((values[..., 1:] + values[..., :-1]) * np.diff(places), axis=-1) / 2


def degrees(angle: Any) -> Any:
    """Convert radians to degrees; a short decimal missed by rounding alone is that decimal.

    >>> float(np.rad2deg(np.deg2rad(30.0))), float(degrees(np.deg2rad(30.0)))
    (29.999999999999996, 30.0)
    """
    exact = np.rad2deg(angle)
    short = np.round(exact, 9)
    return np.where(np.abs(short - exact) <= 2.0 * np.spacing(np.abs(exact)), short, exact)


def entry(value: Number, at: tuple[int, ...]) -> Number:
    """Return the entry at an index of whatever shape the value broadcasts with.

    An axis of length 1, or one that is not there, stands for every place along it.

    >>> entry(np.array([[1.0, 2.0]]), (3, 1)), entry(5.0, (3, 1))
    (np.float64(2.0), np.float64(5.0))
    """
    array = np.asarray(value)
    own = at[len(at) - array.ndim :]
    return array[tuple([k if n > 1 else 0 for k, n in zip(own, array.shape, strict=True)])]


def first_entry(value: Number) -> Number:
    """Return a number as it is, of an array its first entry.

    >>> first_entry(np.array([[1.0, 2.0]])), first_entry(3.0)
    (np.float64(1.0), 3.0)
    """
    return value if np.ndim(value) == 0 else np.ravel(value)[0]


def column(value: Number, designs: int) -> Number:
    """Return one number per design, at one pose. The value broadcasts with them.

    >>> column(2.0, 3).tolist()
    [2.0, 2.0, 2.0]
    """
    return np.broadcast_to(value, (designs, 1))[:, 0]


def row(value: Number, poses: int) -> Number:
    """Return one number per pose, of one design. The value broadcasts with them.

    >>> row(np.array([[1.0]]), 2).tolist()
    [1.0, 1.0]
    """
    return np.broadcast_to(value, (1, poses))[0]


class Vectors(np.ndarray[Any, np.dtype[np.complex128]]):
    """A complex array of planar vectors; `xy` splits it.

    >>> np.array([1 + 2j]).view(Vectors).xy.tolist()
    [[1.0, 2.0]]
    """

    @property
    def xy(self) -> Number:
        """The components, in a last axis of length 2."""
        plain = np.asarray(self)
        return np.stack([plain.real, plain.imag], axis=-1)


def as_number(value: Number) -> Number:
    """Return a number as Python's, an array as it is."""
    return value if isinstance(value, np.ndarray) and value.ndim else float(value)
