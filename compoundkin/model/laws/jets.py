"""A series that NumPy's functions accept: Python functions of time are then differentiated exactly."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from compoundkin.base.composition import composed
from compoundkin.base.series import Number, Series, constant


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
        return composed(outer, x)

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
    return composed(outer, x)


def _where(condition: Any, yes: Any, no: Any) -> Series:
    chosen, (a, b) = _leading(condition), (_series(yes), _series(no))
    pairs = ((s.c[k] if k < len(s.c) else 0.0 for s in (a, b)) for k in range(max(len(a.c), len(b.c))))
    return Series(tuple([np.where(chosen, *pair) for pair in pairs]))


def _constant(function: Any) -> Callable[..., Any]:
    """Return the rule of a function that only looks at values."""
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
