"""NumPy's functions on recorded numbers, by the function; what is not listed cannot be recorded."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from compoundkin.programs.graph.operations import CONSTANT
from compoundkin.programs.recording.numpy_answers import answer_for_all
from compoundkin.programs.recording.recorded_number import RecordedNumber


def _named(operation: str) -> Callable[..., Any]:
    """Return the function that records one operation on real numbers."""

    def recorded(*operands: RecordedNumber) -> RecordedNumber:
        graph = operands[0].graph
        if any(each.y is not None for each in operands):
            raise TypeError(f"{operation} is recorded of real numbers only")
        return RecordedNumber(graph, graph.apply(operation, *(each.x for each in operands)))

    return recorded


def _tan(angle: RecordedNumber) -> Any:
    return _named("sin")(angle) / _named("cos")(angle)


def _exp(x: RecordedNumber) -> Any:
    size = _named("exp")(x.real)
    return size if x.y is None else size * (_named("cos")(x.imag) + 1j * _named("sin")(x.imag))


def _tanh(x: RecordedNumber) -> Any:
    """Of the exponential of what is below zero: it stays finite."""
    small = _exp(-2.0 * abs(x))
    return _sign(x) * ((1.0 - small) / (1.0 + small))


def _sign(x: RecordedNumber) -> RecordedNumber:
    return chosen(x > 0.0, 1.0, chosen(x < 0.0, -1.0, x))


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
    np.fabs: _named("abs"),
    np.square: _square,
    np.reciprocal: RecordedNumber.reciprocal,
    np.sqrt: _named("sqrt"),
    np.hypot: lambda x, y: _named("sqrt")(x * x + y * y),
    np.sin: _named("sin"),
    np.cos: _named("cos"),
    np.tan: _tan,
    np.arctan2: _named("atan2"),
    np.arctan: lambda x: _named("atan2")(x, x.like(1.0)),
    np.arcsin: lambda x: _named("atan2")(x, _named("sqrt")(1.0 - x * x)),
    np.arccos: lambda x: _named("atan2")(_named("sqrt")(1.0 - x * x), x),
    np.deg2rad: lambda x: x * (np.pi / 180.0),
    np.rad2deg: lambda x: x * (180.0 / np.pi),
    np.radians: lambda x: x * (np.pi / 180.0),
    np.degrees: lambda x: x * (180.0 / np.pi),
    np.exp: _exp,
    np.log: _named("log"),
    np.log10: lambda x: _named("log")(x) * (1.0 / np.log(10.0)),
    np.tanh: _tanh,
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
    node = value.graph.nodes[value.x]
    if node.operation != CONSTANT or value.y is not None:
        raise TypeError("only whole powers, and square roots of real numbers, can be recorded")
    return node.value


def chosen(truth: RecordedNumber, one: Any, other: Any) -> RecordedNumber:
    """Return one number where a truth is, and another where it is not."""
    graph, a, b = truth.graph, truth.like(one), truth.like(other)
    if not graph.is_truth(truth.x) and graph.nodes[truth.x].operation != CONSTANT:
        raise TypeError("numpy.where is recorded of truths only: write a comparison")
    x = graph.apply("select", truth.x, a.x, b.x)
    if a.y is None and b.y is None:
        return RecordedNumber(graph, x)
    return RecordedNumber(graph, x, graph.apply("select", truth.x, a.imag.x, b.imag.x))


def _filled(value: float) -> Callable[..., RecordedNumber]:
    return lambda like, *args, **options: like.like(value)


def _same(like: RecordedNumber, value: Any, *args: Any, **options: Any) -> Any:
    return value


def _angle(like: RecordedNumber, z: RecordedNumber, deg: bool = False) -> Any:
    angle = _named("atan2")(z.imag, z.real)
    return angle * (180.0 / np.pi) if deg else angle


def _round(like: RecordedNumber, value: RecordedNumber, decimals: int = 0) -> Any:
    if decimals:
        raise TypeError("only rounding to whole numbers is recorded")
    return _named("rint")(value)


def _clipped(like: RecordedNumber, value: Any, low: Any = None, high: Any = None) -> Any:
    above = like.like(value) if low is None else _named("max")(like.like(value), like.like(low))
    return above if high is None else _named("min")(above, like.like(high))


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: lambda like, truth, one, other: chosen(like.like(truth), one, other),
    np.any: lambda like, *args, **options: answer_for_all(),
    np.all: lambda like, *args, **options: answer_for_all(),
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
    np.clip: _clipped,
    np.iscomplexobj: lambda like, value: value.y is not None,
}
