"""The driving law of a Python function with its derivatives, by series arithmetic or by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from compoundkin.base.arrays import Number, as_number
from compoundkin.base.copies import CopiesFunction
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Series, compose_series, constant, from_derivatives
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import ComparedByValue

Array: TypeAlias = np.ndarray[Any, Any]
MOST_DERIVATIVES = 4
# Nine points: the error of a third derivative is of the sixth power of the step.
NODES = np.arange(-4.0, 5.0)
# The steps tried, as parts of the range of times; the best is about a fiftieth of the function's own time scale.
# Their ratio is no simple fraction: else steps of whole periods of the function agree with each other.
STEPS = 0.0625 * 0.618 ** np.arange(18.0)
# If differences of neighbouring steps disagree by more than this part of the derivative, there is none.
AGREEMENT = 1e-2
# Two ways to the same value differ by rounding only.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class FunctionLaw(CopiesFunction, ComparedByValue):
    """A Python function of times that returns the coordinate, or (value, speed, ...).

    The latter is a tuple.
    A tuple may go to the jerk. Derivatives that it does not return are exact where the function is written with
    NumPy's ordinary functions; otherwise they are differences (see `differentiate_function`). Raises InvalidInput where
    it fails, or returns something of another shape or not finite.

    >>> FunctionLaw(lambda t: np.sin(2.0 * t)).coordinate(np.array([0.0]), order=3).derivative(3).tolist()
    [-8.0]
    """

    f: Callable[[Any], Any]

    function_field: ClassVar[str] = "f"
    kind: ClassVar[str] = "function"
    keys: ClassVar[tuple[Key, ...]] = ()
    span: ClassVar[None] = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FunctionLaw) and self.f is other.f

    def __hash__(self) -> int:
        return hash(self.f)

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds)."""
        times = np.asarray(t, dtype=float)
        given = self._called(times)[: order + 1]
        if len(given) <= order:
            last = len(given) - 1
            given += differentiate_function(lambda x: self._component(x, last), times, order - last)[1:]
        return from_derivatives([as_number(values) for values in given])

    def _component(self, times: Any, k: int) -> Any:
        """Return one component of the result, unchecked."""
        made = self.f(times)
        return made[k] if isinstance(made, tuple) else made

    def _called(self, times: Array) -> list[Array]:
        """Return the checked result of the function."""
        try:
            made = self.f(times.copy())
        except Exception as error:
            what = f"the function fails: {type(error).__name__}: {error}"
            raise InvalidInput(Problem("law", what, "it is called with an array of times")) from error
        parts = list(made) if isinstance(made, tuple) else [made]
        if not 1 <= len(parts) <= MOST_DERIVATIVES:
            what = f"the function returns {len(parts)} arrays"
            raise InvalidInput(Problem("law", what, "return the coordinate, or (value, speed, acceleration, jerk)"))
        return [_checked(part, times) for part in parts]


def _checked(part: Any, times: Array) -> Array:
    try:
        if np.iscomplexobj(part):  # its real part is not what its author meant
            raise TypeError
        values = np.asarray(part, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("law", "the function does not return numbers", "return an array of reals")) from None
    if values.shape != times.shape:
        what = f"the function returns shape {values.shape} for times of shape {times.shape}"
        raise InvalidInput(Problem("law", what, "return one value for each time, such as c + 0 * t for a constant"))
    bad = times[~np.isfinite(values)]
    if bad.size:
        raise InvalidInput(Problem("law", f"the function is not finite at {bad.flat[0]:g} s"))
    return values


def differentiate_function(f: Callable[[Any], Any], times: Array, order: int) -> list[Array]:
    """Return a function and its derivatives up to `order` (3 at most) at times. Arrays of the shape of `times`.

    Exact where the function is written with NumPy functions that `Jet` knows. Otherwise central differences over
    nine points, with the step at each time at which a smaller one changes least; for a function whose own time scale
    T is between a two-hundredth of the range of times and the range itself, derivatives 1, 2 and 3 are good to about
    1e-11, 1e-10 and 1e-8 of its size over T, T**2 and T**3.

    Raises InvalidInput where the function is not defined around a time, or has no derivatives there.

    Source: W. H. Press et al., Numerical Recipes, 3rd ed., Cambridge 2007, section 5.7 (choice of the step);
    M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, section 25.3.

    >>> [found.tolist() for found in differentiate_function(lambda t: t**3, np.array([2.0]), 3)]
    [[8.0], [12.0], [12.0], [6.0]]
    """
    exact = _by_series(f, times, order)
    if exact is not None:
        return exact
    return [np.asarray(f(times.copy()), dtype=float), *_by_differences(f, times, order)]


def _by_series(f: Callable[[Any], Any], times: Array, order: int) -> list[Array] | None:
    """Differentiate by series arithmetic; None where the function uses an unknown operation."""
    plain = np.asarray(f(times.copy()), dtype=float)
    try:
        with np.errstate(all="ignore"):
            made = f(Jet(Series((times, 1.0, *[0.0] * (order - 1))[: order + 1])))
    except Exception:
        # whatever it does to an object that is not an array
        return None
    if not isinstance(made, Jet):
        return None
    found = [np.broadcast_to(made.series.derivative(k), times.shape).astype(float) for k in range(order + 1)]
    near = np.abs(found[0] - plain) <= SAME * np.max(np.abs(plain), initial=1.0)
    return found if near.all() and all(np.isfinite(one).all() for one in found) else None


def _by_differences(f: Callable[[Any], Any], times: Array, order: int) -> list[Array]:
    spread = float(np.ptp(times)) or 1.0
    steps = spread * STEPS
    tried = [_sampled(f, times[..., None] + NODES * step) for step in steps]
    found = []
    for k, weights in enumerate(_weights(order), 1):
        differences = np.stack([s @ weights / h**k for s, h in zip(tried, steps, strict=True)])
        found.append(_best_difference(differences, tried, steps, times, k))
    return found


def _sampled(f: Callable[[Any], Any], places: Array) -> Array:
    """Return the function at places, not a number where it has no value."""
    try:
        with np.errstate(all="ignore"):
            found = np.asarray(f(places.reshape(-1)), dtype=float)
    except Exception:
        return np.full(places.shape, np.nan)
    return found.reshape(places.shape) if found.size == places.size else np.full(places.shape, np.nan)


def _weights(order: int) -> list[Array]:
    """Return the weights of the nodes for derivatives 1 to `order` at step 1."""
    powers = NODES[None, :] ** np.arange(len(NODES))[:, None]
    right = np.zeros((len(NODES), order))
    factor = 1.0
    for k in range(1, order + 1):
        factor *= k
        right[k, k - 1] = factor
    return list(np.linalg.solve(powers, right).T)


def _best_difference(found: Array, tried: list[Array], steps: Array, times: Array, k: int) -> Array:
    """Return the difference that changes least with the next two smaller steps."""
    change = np.abs(np.diff(found, axis=0))
    change = np.maximum(change[:-1], change[1:])
    index = np.argmin(np.where(np.isnan(change), np.inf, change), axis=0)[None]
    best = np.take_along_axis(found[1:-1], index, axis=0)[0]
    left = np.take_along_axis(change, index, axis=0)[0]
    size = np.nanmax([np.nanmax(np.abs(s), initial=0.0) for s in tried])
    natural = np.abs(best) + size / float(np.max(steps)) ** k
    wrong = ~(left <= AGREEMENT * natural)
    if wrong.any():
        what = f"the function has no derivative {k} at {times[wrong].flat[0]:g} s that differences could find"
        remedy = "let it return (value, speed, acceleration, jerk)"
        raise InvalidInput(Problem("law", what, remedy))
    return np.asarray(best)


class Jet(NDArrayOperatorsMixin):
    """A Taylor series (to order 3) in the guise of an array. What NumPy does to it, it does to all derivatives.

    A function it does not know raises TypeError. At jumps and kinks the derivatives are those of one side.

    >>> t = Jet(Series((2.0, 1.0, 0.0, 0.0)))
    >>> [float(c) for c in (np.sqrt(2.0 * t) + t**2).series.c]
    [6.0, 4.5, 0.9375, 0.015625]
    """

    def __init__(self, series: Series) -> None:
        self.series = series

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the array it stands for."""
        return np.shape(self.series.c[0])

    def __array_ufunc__(self, function: Any, method: str, *operands: Any, **options: Any) -> Any:
        return self._applied(UFUNCS, function, operands, method != "__call__" or bool(options))

    def __array_function__(self, function: Any, types: Any, operands: Any, options: Any) -> Any:
        return self._applied(FUNCTIONS, function, operands, bool(options))

    def _applied(self, table: dict[Any, Callable[..., Any]], function: Any, operands: Any, special: bool) -> Any:
        if special or function not in table:
            return NotImplemented
        made = table[function](*operands)
        return Jet(made) if isinstance(made, Series) else made


def _series(operand: Any) -> Series:
    return operand.series if isinstance(operand, Jet) else constant(np.asarray(operand, dtype=float))


def _leading(operand: Any) -> Any:
    return operand.series.c[0] if isinstance(operand, Jet) else operand


def _function(*derivatives: Callable[[Any], Any]) -> Callable[[Any], Series]:
    """Return the rule of a function, from itself and its derivatives."""

    def rule(operand: Any) -> Series:
        x = _series(operand)
        outer = [derivative(x.c[0]) / factorial(k) for k, derivative in enumerate(derivatives[: len(x.c)])]
        return compose_series(outer, x)

    return rule


def _power(base: Any, exponent: Any) -> Series:
    if isinstance(exponent, Jet) or np.ndim(exponent):
        raise TypeError
    x, p = _series(base), float(exponent)
    outer: list[Number] = []
    factor = 1.0
    for k in range(len(x.c)):
        # a derivative that vanishes must not become 0 times infinity at 0
        outer.append(factor * x.c[0] ** (p - k) if factor else 0.0 * x.c[0])
        factor *= (p - k) / (k + 1)
    return compose_series(outer, x)


def _where(condition: Any, yes: Any, no: Any) -> Series:
    chosen, (a, b) = _leading(condition), (_series(yes), _series(no))
    pairs = ((s.c[k] if k < len(s.c) else 0.0 for s in (a, b)) for k in range(max(len(a.c), len(b.c))))
    return Series(tuple([np.where(chosen, *pair) for pair in pairs]))


def _constant(function: Any) -> Callable[..., Any]:
    """Return the rule of a function that depends on values only."""
    return lambda *operands: function(*map(_leading, operands))


def _remainder(a: Any, b: Any) -> Series:
    carried: Series = _series(b) * np.floor(_leading(a) / _leading(b))
    return _series(a) - carried


_sin = _function(np.sin, np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x))
_cos = _function(np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x), np.sin)
_sinh = _function(np.sinh, np.cosh, np.sinh, np.cosh)
_cosh = _function(np.cosh, np.sinh, np.cosh, np.sinh)
UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: lambda a, b: _series(a) + _series(b),
    np.subtract: lambda a, b: _series(a) - _series(b),
    np.multiply: lambda a, b: _series(a) * _series(b),
    np.true_divide: lambda a, b: _series(a) / _series(b),
    np.negative: lambda a: -_series(a),
    np.positive: _series,
    np.square: lambda a: _series(a) * _series(a),
    np.power: _power,
    np.float_power: _power,
    np.sqrt: lambda a: _power(a, 0.5),
    np.reciprocal: lambda a: 1.0 / _series(a),
    np.remainder: _remainder,
    np.absolute: lambda a: _where(_leading(a) < 0.0, Jet(-_series(a)), a),
    np.maximum: lambda a, b: _where(np.greater_equal(_leading(a), _leading(b)), a, b),
    np.minimum: lambda a, b: _where(np.less_equal(_leading(a), _leading(b)), a, b),
    np.sin: _sin,
    np.cos: _cos,
    np.tan: lambda a: _sin(a) / _cos(a),
    np.sinh: _sinh,
    np.cosh: _cosh,
    np.tanh: lambda a: _sinh(a) / _cosh(a),
    np.exp: _function(np.exp, np.exp, np.exp, np.exp),
    np.log: _function(np.log, lambda x: 1.0 / x, lambda x: -1.0 / x**2, lambda x: 2.0 / x**3),
    np.arctan: _function(
        np.arctan,
        lambda x: 1.0 / (1.0 + x**2),
        lambda x: -2.0 * x / (1.0 + x**2) ** 2,
        lambda x: (6.0 * x**2 - 2.0) / (1.0 + x**2) ** 3,
    ),
    np.deg2rad: lambda a: _series(a) * (np.pi / 180.0),
    np.radians: lambda a: _series(a) * (np.pi / 180.0),
    np.rad2deg: lambda a: _series(a) * (180.0 / np.pi),
    np.degrees: lambda a: _series(a) * (180.0 / np.pi),
}


UFUNCS |= {f: _constant(f) for f in (np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal,
                                     np.floor, np.ceil, np.sign)}  # fmt: skip


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.zeros_like: _constant(np.zeros_like),
    np.ones_like: _constant(np.ones_like),
}
