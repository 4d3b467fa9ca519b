"""Numbers that record: real, complex or true-or-false, taken by every kernel for ordinary coefficients.

NumPy's functions are answered by the protocols `__array_ufunc__` and `__array_function__`, so that kernels know nothing
of recording; a function without an entry in a table here cannot be recorded. Questions about all poses at once
(`np.any`, `np.all`) are answered yes: of two branches the general one is recorded. A recorded number has no truth
value, no length and no shape but ().
"""

from __future__ import annotations

import operator
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np

from compoundkin.programs.graph.operation_graph import CONSTANT, OperationGraph


class NumpyOperand(ABC):
    """What a recorded number answers besides arithmetic. Comparisons are truths, recorded too."""

    __slots__ = ()
    x: int

    @abstractmethod
    def like(self, value: Any) -> Any:
        """Return a number as one recorded in the same graph."""

    @abstractmethod
    def of(self, operation: str, *operands: int) -> Any:
        """Return the number that an operation on nodes gives."""

    @abstractmethod
    def part(self, index: int) -> int:
        """Return the node of the real (0) or imaginary (1) part."""

    def _ordered(self, operation: str, one: Any, other: Any) -> Any:
        if one.y is not None or other.y is not None:
            raise TypeError("vectors have no order: compare lengths or coordinates")
        return self.of(operation, one.x, other.x)

    def __ge__(self, other: Any) -> Any:
        return self._ordered("ge", self, self.like(other))

    def __gt__(self, other: Any) -> Any:
        return self._ordered("gt", self, self.like(other))

    def __le__(self, other: Any) -> Any:
        return self._ordered("ge", self.like(other), self)

    def __lt__(self, other: Any) -> Any:
        return self._ordered("gt", self.like(other), self)

    def __eq__(self, other: Any) -> Any:
        b = self.like(other)
        same = self.of("eq", self.x, b.x)
        return same & self.of("eq", self.part(1), b.part(1))

    def __ne__(self, other: Any) -> Any:
        return ~(self == other)

    def __and__(self, other: Any) -> Any:
        return self.of("and", self.x, self.like(other).x)

    def __or__(self, other: Any) -> Any:
        return self.of("or", self.x, self.like(other).x)

    __rand__, __ror__ = __and__, __or__

    def __invert__(self) -> Any:
        return self.of("not", self.x)

    def __bool__(self) -> bool:
        raise TypeError("a recorded number has no truth value: kernels are straight-line arithmetic")

    def __float__(self) -> float:
        raise TypeError("a recorded number is no float: kernels are straight-line arithmetic")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        pass  # joined

        found = UFUNCS.get(ufunc)
        if method != "__call__" or options or found is None:
            return NotImplemented
        return found(*(self.like(value) for value in inputs))

    def __array_function__(self, function: Callable[..., Any], types: Any, args: Any, options: Any) -> Any:
        pass  # joined

        found = FUNCTIONS.get(function)
        return NotImplemented if found is None else found(self, *args, **options)


class RecordedNumber(NumpyOperand):
    """A real number, a complex one, or a truth, as nodes of a graph.

    A real number has no `y`.

    >>> from compoundkin.programs.graph.operation_graph import InputNumber
    >>> x = RecordedNumber.given(OperationGraph(), InputNumber("drive", "crank", "0"))
    >>> (np.cos(x) + 1j * np.sin(x)).conjugate()
    RecordedNumber(complex)
    """

    __slots__ = ("graph", "x", "y")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, graph: OperationGraph, x: int, y: int | None = None) -> None:
        self.graph, self.x, self.y = graph, x, y

    @classmethod
    def given(cls, graph: OperationGraph, *parts: Any) -> RecordedNumber:
        """Return an input; of two inputs a complex one."""
        return cls(graph, *(graph.input(part) for part in parts))

    def like(self, value: Any) -> RecordedNumber:
        """Return a number as one recorded in the same graph."""
        if isinstance(value, RecordedNumber):
            return value
        if np.ndim(value):
            raise TypeError("an array of several numbers met a recorded one")
        if isinstance(value, np.ndarray):
            value = value.item()
        if isinstance(value, (bool, np.bool_)):
            return RecordedNumber(self.graph, self.graph.constant(float(value)))
        if isinstance(value, complex | np.complexfloating):
            return RecordedNumber(
                self.graph, self.graph.constant(float(value.real)), self.graph.constant(float(value.imag))
            )
        return RecordedNumber(self.graph, self.graph.constant(float(value)))

    def of(self, operation: str, *operands: int) -> RecordedNumber:
        """Return the number that an operation on nodes gives."""
        return RecordedNumber(self.graph, self.graph.apply(operation, *operands))

    def part(self, index: int) -> int:
        """Return the node of the real (0) or imaginary (1) part."""
        return (self.x, self.graph.constant(0.0) if self.y is None else self.y)[index]

    @property
    def is_constant(self) -> bool:
        """Whether it is a number that nothing changes."""
        return all(node is None or self.graph.nodes[node].operation == CONSTANT for node in (self.x, self.y))

    # --- arithmetic ---

    def _each(self, operation: str, other: Any) -> RecordedNumber:
        b = self.like(other)
        x = self.graph.apply(operation, self.x, b.x)
        return RecordedNumber(
            self.graph,
            x,
            None if self.y is None and b.y is None else self.graph.apply(operation, self.part(1), b.part(1)),
        )

    def __add__(self, other: Any) -> Any:
        return self._each("add", other) if _is_scalar(other) else NotImplemented

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self._each("sub", other) if _is_scalar(other) else NotImplemented

    def __rsub__(self, other: Any) -> Any:
        return self.like(other)._each("sub", self) if _is_scalar(other) else NotImplemented

    def __mul__(self, other: Any) -> Any:
        if not _is_scalar(other):
            return NotImplemented
        b, put = self.like(other), self.graph.apply
        if self.y is None or b.y is None:
            real, whole = (self, b) if self.y is None else (b, self)
            return whole._times(real.x)
        x = put("sub", put("mul", self.x, b.x), put("mul", self.y, b.y))
        return RecordedNumber(self.graph, x, put("add", put("mul", self.x, b.y), put("mul", self.y, b.x)))

    __rmul__ = __mul__

    def _times(self, factor: int) -> RecordedNumber:
        put = self.graph.apply
        return RecordedNumber(
            self.graph, put("mul", self.x, factor), None if self.y is None else put("mul", self.y, factor)
        )

    def reciprocal(self) -> RecordedNumber:
        """Return one divided by it, shared by all quotients."""
        put = self.graph.apply
        if self.y is None:
            return self.of("inv", self.x)
        length2 = put("inv", put("add", put("mul", self.x, self.x), put("mul", self.y, self.y)))
        return RecordedNumber(self.graph, put("mul", self.x, length2), put("neg", put("mul", self.y, length2)))

    def __truediv__(self, other: Any) -> Any:
        return self * self.like(other).reciprocal() if _is_scalar(other) else NotImplemented

    def __rtruediv__(self, other: Any) -> Any:
        return self.reciprocal() * other if _is_scalar(other) else NotImplemented

    def __neg__(self) -> RecordedNumber:
        return RecordedNumber(
            self.graph, self.graph.apply("neg", self.x), None if self.y is None else self.graph.apply("neg", self.y)
        )

    def __pos__(self) -> RecordedNumber:
        return self

    def __abs__(self) -> RecordedNumber:
        if self.y is None:
            return self.of("abs", self.x)
        put = self.graph.apply
        return self.of("sqrt", put("add", put("mul", self.x, self.x), put("mul", self.y, self.y)))

    def __pow__(self, exponent: Any) -> RecordedNumber:
        whole = int(exponent)
        root = exponent - whole
        if abs(root) not in (0.0, 0.5) or (root and self.y is not None):
            raise TypeError("only whole powers, and square roots of real numbers, can be recorded")
        found = self.of("sqrt", self.x) if root else self.like(1.0)
        square, left = self, abs(whole)
        while left:
            found = found * square if left % 2 else found
            square, left = square * square, left // 2
        return found.reciprocal() if exponent < 0 else found

    # --- parts ---

    @property
    def real(self) -> RecordedNumber:
        """The real part."""
        return RecordedNumber(self.graph, self.x)

    @property
    def imag(self) -> RecordedNumber:
        """The imaginary part."""
        return RecordedNumber(self.graph, self.part(1))

    def conjugate(self) -> RecordedNumber:
        """Return the complex conjugate."""
        return self if self.y is None else RecordedNumber(self.graph, self.x, self.graph.apply("neg", self.y))

    def __getitem__(self, index: Any) -> RecordedNumber:
        """Return the whole of it, as an array without axes does."""
        if index != ():
            raise TypeError("a recorded number has no entries")
        return self

    def reshape(self, *shape: Any) -> RecordedNumber:
        """Return itself: one number has one shape."""
        return self

    @property
    def shape(self) -> tuple[int, ...]:
        """That of a number."""
        return ()

    ndim = 0

    @property
    def dtype(self) -> Any:
        """What arrays of such numbers hold."""
        return np.dtype(bool if self.graph.is_truth(self.x) else float if self.y is None else complex)

    def __repr__(self) -> str:
        kind = "truth" if self.graph.is_truth(self.x) else "real" if self.y is None else "complex"
        return f"RecordedNumber({kind})"


def _is_scalar(value: Any) -> bool:
    return isinstance(value, (RecordedNumber, float, complex, int, np.number)) or (
        isinstance(value, np.ndarray) and value.ndim == 0
    )


_ONE_POSE = ContextVar("one pose is recorded", default=False)


@contextmanager
def one_pose() -> Iterator[None]:
    """Record what sees one pose: nothing can be asked of all poses at once."""
    token = _ONE_POSE.set(True)
    try:
        yield
    finally:
        _ONE_POSE.reset(token)


def true_for_all() -> bool:
    """Answer yes where all poses are asked: the general branch is recorded."""
    if _ONE_POSE.get():
        raise TypeError("numpy.any and numpy.all ask of all poses, of which there is one here")
    return True


def _operation(operation: str) -> Callable[..., Any]:
    """Return the function that records one operation on real numbers."""

    def recorded(*operands: RecordedNumber) -> RecordedNumber:
        graph = operands[0].graph
        if any(each.y is not None for each in operands):
            raise TypeError(f"{operation} is recorded of real numbers only")
        return RecordedNumber(graph, graph.apply(operation, *(each.x for each in operands)))

    return recorded


def _tan(angle: RecordedNumber) -> Any:
    return _operation("sin")(angle) / _operation("cos")(angle)


def _exp(x: RecordedNumber) -> Any:
    size = _operation("exp")(x.real)
    return size if x.y is None else size * (_operation("cos")(x.imag) + 1j * _operation("sin")(x.imag))


def _tanh(x: RecordedNumber) -> Any:
    """Of the exponential of what is below zero: it stays finite."""
    small = _exp(-2.0 * abs(x))
    return _sign(x) * ((1.0 - small) / (1.0 + small))


def _sign(x: RecordedNumber) -> RecordedNumber:
    return selected(x > 0.0, 1.0, selected(x < 0.0, -1.0, x))


def _is_finite(x: RecordedNumber) -> Any:
    return abs(x) < np.inf


def _square(x: RecordedNumber) -> Any:
    return x * x


def _remainder(x: RecordedNumber, period: RecordedNumber) -> Any:
    return x - period * _operation("floor")(x / period)


def selected(truth: RecordedNumber, one: Any, other: Any) -> RecordedNumber:
    """Return one number where a truth is, and another where it is not."""
    graph, a, b = truth.graph, truth.like(one), truth.like(other)
    if not graph.is_truth(truth.x) and graph.nodes[truth.x].operation != CONSTANT:
        raise TypeError("numpy.where is recorded of truths only: write a comparison")
    x = graph.apply("select", truth.x, a.x, b.x)
    if a.y is None and b.y is None:
        return RecordedNumber(graph, x)
    return RecordedNumber(graph, x, graph.apply("select", truth.x, a.imag.x, b.imag.x))


UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.divide: operator.truediv,
    np.negative: operator.neg,
    np.positive: operator.pos,
    np.absolute: abs,
    np.conjugate: RecordedNumber.conjugate,
    np.fabs: _operation("abs"),
    np.square: _square,
    np.reciprocal: RecordedNumber.reciprocal,
    np.sqrt: _operation("sqrt"),
    np.hypot: lambda x, y: _operation("sqrt")(x * x + y * y),
    np.sin: _operation("sin"),
    np.cos: _operation("cos"),
    np.tan: _tan,
    np.arctan2: _operation("atan2"),
    np.arctan: lambda x: _operation("atan2")(x, x.like(1.0)),
    np.arcsin: lambda x: _operation("atan2")(x, _operation("sqrt")(1.0 - x * x)),
    np.arccos: lambda x: _operation("atan2")(_operation("sqrt")(1.0 - x * x), x),
    np.deg2rad: lambda x: x * (np.pi / 180.0),
    np.rad2deg: lambda x: x * (180.0 / np.pi),
    np.radians: lambda x: x * (np.pi / 180.0),
    np.degrees: lambda x: x * (180.0 / np.pi),
    np.exp: _exp,
    np.log: _operation("log"),
    np.log10: lambda x: _operation("log")(x) * (1.0 / np.log(10.0)),
    np.tanh: _tanh,
    np.sign: _sign,
    np.maximum: _operation("max"),
    np.minimum: _operation("min"),
    np.fmax: _operation("fmax"),
    np.fmin: _operation("fmin"),
    np.floor: _operation("floor"),
    np.ceil: _operation("ceil"),
    np.rint: _operation("rint"),
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
    np.isfinite: _is_finite,
    np.isnan: lambda x: ~(x == x),
}


def _number(value: RecordedNumber) -> float:
    """Return the number that a recorded one is known to be."""
    node = value.graph.nodes[value.x]
    if node.operation != CONSTANT or value.y is not None:
        raise TypeError("only whole powers, and square roots of real numbers, can be recorded")
    return node.value


def _constant(value: float) -> Callable[..., RecordedNumber]:
    return lambda like, *args, **options: like.like(value)


def _unchanged(like: RecordedNumber, value: Any, *args: Any, **options: Any) -> Any:
    return value


def _angle(like: RecordedNumber, z: RecordedNumber, deg: bool = False) -> Any:
    angle = _operation("atan2")(z.imag, z.real)
    return angle * (180.0 / np.pi) if deg else angle


def _round(like: RecordedNumber, value: RecordedNumber, decimals: int = 0) -> Any:
    if decimals:
        raise TypeError("only rounding to whole numbers is recorded")
    return _operation("rint")(value)


def _clip(like: RecordedNumber, value: Any, low: Any = None, high: Any = None) -> Any:
    above = like.like(value) if low is None else _operation("max")(like.like(value), like.like(low))
    return above if high is None else _operation("min")(above, like.like(high))


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: lambda like, truth, one, other: selected(like.like(truth), one, other),
    np.any: lambda like, *args, **options: true_for_all(),
    np.all: lambda like, *args, **options: true_for_all(),
    np.shape: lambda like, value: (),
    np.ndim: lambda like, value: 0,
    np.zeros_like: _constant(0.0),
    np.ones_like: _constant(1.0),
    np.broadcast_to: _unchanged,
    np.broadcast_arrays: lambda like, *values: [like.like(value) for value in values],
    np.ravel: _unchanged,
    np.real: lambda like, value: value.real,
    np.imag: lambda like, value: value.imag,
    np.angle: _angle,
    np.round: _round,
    np.clip: _clip,
    np.iscomplexobj: lambda like, value: value.y is not None,
}
