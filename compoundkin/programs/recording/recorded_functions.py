"""NumPy's functions on recorded numbers, by the function; what is not listed cannot be recorded."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from compoundkin.programs.recording.recorded_number import RecordedNumber


def _named(operation: str) -> Callable[..., Any]:
    """Return the function that records one operation on real numbers."""

    def recorded(*operands: RecordedNumber) -> RecordedNumber:
        graph = operands[0].graph
        return RecordedNumber(graph, graph.apply(operation, *(each.x for each in operands)))

    return recorded


def _tan(angle: RecordedNumber) -> Any:
    return _named("sin")(angle) / _named("cos")(angle)


def _exp(x: RecordedNumber) -> Any:
    size = _named("exp")(x.real)
    return size if x.y is None else size * (_named("cos")(x.imag) + 1j * _named("sin")(x.imag))


def _sign(x: RecordedNumber) -> RecordedNumber:
    return _where(x, x > 0.0, 1.0, _where(x, x < 0.0, -1.0, x))


def _finite(x: RecordedNumber) -> Any:
    return abs(x) < np.inf


def _square(x: RecordedNumber) -> Any:
    return x * x


def _remainder(x: RecordedNumber, period: RecordedNumber) -> Any:
    return x - period * _named("floor")(x / period)


UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.divide: operator.truediv,
    np.negative: operator.neg,
    np.positive: operator.pos,
    np.absolute: abs,
    np.conjugate: RecordedNumber.conjugate,
    np.square: _square,
    np.sqrt: _named("sqrt"),
    np.hypot: lambda x, y: _named("sqrt")(x * x + y * y),
    np.sin: _named("sin"),
    np.cos: _named("cos"),
    np.tan: _tan,
    np.arctan2: _named("atan2"),
    np.arctan: lambda x: _named("atan2")(x, x.like(1.0)),
    np.arcsin: lambda x: _named("atan2")(x, _named("sqrt")(1.0 - x * x)),
    np.arccos: lambda x: _named("atan2")(_named("sqrt")(1.0 - x * x), x),
    np.exp: _exp,
    np.log: _named("log"),
    np.sign: _sign,
    np.maximum: _named("max"),
    np.minimum: _named("min"),
    np.fmax: _named("fmax"),
    np.fmin: _named("fmin"),
    np.floor: _named("floor"),
    np.ceil: _named("ceil"),
    np.rint: _named("rint"),
    np.remainder: _remainder,
    np.power: lambda x, n: x ** _number(n),
    np.greater_equal: operator.ge,
    np.greater: operator.gt,
    np.less_equal: operator.le,
    np.less: operator.lt,
    np.equal: operator.eq,
    np.not_equal: operator.ne,
    np.logical_and: operator.and_,
    np.logical_or: operator.or_,
    np.logical_not: operator.invert,
    np.bitwise_and: operator.and_,
    np.bitwise_or: operator.or_,
    np.invert: operator.invert,
    np.isfinite: _finite,
    np.isnan: lambda x: ~(x == x),
}


def _number(value: RecordedNumber) -> float:
    """Return the number that a recorded one is known to be."""
    return value.graph.nodes[value.x].value


def _where(like: RecordedNumber, truth: Any, one: Any, other: Any) -> RecordedNumber:
    chosen, a, b = like.like(truth), like.like(one), like.like(other)
    graph = like.graph
    x = graph.apply("select", chosen.x, a.x, b.x)
    if a.y is None and b.y is None:
        return RecordedNumber(graph, x)
    return RecordedNumber(graph, x, graph.apply("select", chosen.x, a.imag.x, b.imag.x))


def _general(like: RecordedNumber, *args: Any, **options: Any) -> bool:
    """Answer what is asked of all poses at once: yes, so that the general branch is recorded."""
    return True


def _filled(value: float) -> Callable[..., RecordedNumber]:
    return lambda like, *args, **options: like.like(value)


def _same(like: RecordedNumber, value: Any, *args: Any, **options: Any) -> Any:
    return value


def _angle(like: RecordedNumber, z: RecordedNumber, deg: bool = False) -> Any:
    return _named("atan2")(z.imag, z.real)


def _round(like: RecordedNumber, value: RecordedNumber, decimals: int = 0) -> Any:
    return _named("rint")(value)


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.any: _general,
    np.all: _general,
    np.shape: lambda like, value: (),
    np.ndim: lambda like, value: 0,
    np.zeros_like: _filled(0.0),
    np.ones_like: _filled(1.0),
    np.broadcast_to: _same,
    np.ravel: _same,
    np.real: lambda like, value: value.real,
    np.imag: lambda like, value: value.imag,
    np.angle: _angle,
    np.round: _round,
    np.iscomplexobj: lambda like, value: value.y is not None,
}
