"""Numbers that trace how they are computed while a sketch is painted: a value, and the node of a graph for it.

Painters compute with them as with any other numbers, and every branch is taken by the values. The node of a vertex
says how it is computed from the mechanism's dimensions, so that a page can draw it anew. A function that takes no
nodes gives the plain value: what is drawn of it is carried by its link as it is.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import Number

if TYPE_CHECKING:
    from compoundkin.programs.recording.recorded_number import RecordedNumber

# The kind of inputs that are the least of a course.
LEAST = "least"
# Functions that give an array along the poses as it is.
SAME = (np.ravel, np.atleast_1d)


class Traced:
    """A number with its node; NumPy's functions of it are traced too."""

    node: RecordedNumber

    def conjugate(self) -> Any:
        """Return the complex conjugate."""
        return traced(untraced(self).conjugate(), self.node.conjugate())

    @property
    def real(self) -> Any:
        """The real part."""
        return traced(untraced(self).real, self.node.real)

    @property
    def imag(self) -> Any:
        """The imaginary part."""
        return traced(untraced(self).imag, self.node.imag)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        from compoundkin.programs.recording.recorded_number import UFUNCS

        values = [untraced(one) for one in inputs]
        found = getattr(ufunc, method)(*values, **{key: untraced(one) for key, one in options.items()})
        recorded = UFUNCS.get(ufunc) if method == "__call__" and not options else None
        return _traced_result(found, inputs, lambda nodes: recorded(*nodes)) if recorded else found

    def __array_function__(self, function: Callable[..., Any], types: Any, args: Any, options: Any) -> Any:
        from compoundkin.programs.recording.recorded_number import FUNCTIONS

        found = function(*untraced(args), **{key: untraced(one) for key, one in options.items()})
        recorded = FUNCTIONS.get(function)
        if function in SAME:
            return traced(found, self.node)
        if recorded is None or options:
            return found
        return _traced_result(found, args, lambda nodes: recorded(self.node, *nodes))


def _traced_result(value: Any, operands: Any, recorded: Callable[[list[Any]], Any]) -> Any:
    """A value with its node; the value alone of truth values, and where an operand has no node."""
    if isinstance(value, tuple | bool | np.bool_) or np.asarray(value).dtype.kind == "b":
        return value
    own = next(one.node for one in operands if isinstance(one, Traced))
    if any(_is_array(one) and not isinstance(one, Traced) for one in operands):
        return value
    try:
        node = recorded([one.node if isinstance(one, Traced) else own.like(one) for one in operands])
    except TypeError:
        return value
    return traced(value, node) if isinstance(node, type(own)) else value


def _binary(name: str, swapped: bool = False) -> Callable[[Any, Any], Any]:
    operation = getattr(operator, name)

    def method(self: Any, other: Any) -> Any:
        if not isinstance(other, int | float | complex | np.number | TracedLength):
            return NotImplemented
        one, two = (other, self) if swapped else (self, other)
        value = operation(untraced(one), untraced(two))
        # numbers that cannot change are not worked out again
        fixed = self.node.is_constant and (not isinstance(other, Traced) or other.node.is_constant)
        return traced(value, self.node.like(value) if fixed else operation(_node(one), _node(two)))

    return method


def _compared(name: str) -> Callable[[Any, Any], bool]:
    operation = getattr(operator, name)
    return lambda self, other: bool(operation(untraced(self), untraced(other)))


def _of_value(function: Callable[[float], Any]) -> Callable[[Any], Any]:
    return lambda self: function(self.value)


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _node(value: Any) -> Any:
    return value.node if isinstance(value, Traced) else value


class TracedCourse(Traced, np.ndarray):  # type: ignore[override]
    """An array along the poses of a motion. Its node is that of one pose."""

    def __array_finalize__(self, of: Any) -> None:
        self.node = getattr(of, "node", None)  # type: ignore[assignment]

    def min(self, *args: Any, **options: Any) -> Any:
        """Return the least of real numbers, over the poses."""
        return traced(untraced(self).min(*args, **options), _least(self.node))

    def max(self, *args: Any, **options: Any) -> Any:
        """Return the greatest of real numbers, over the poses."""
        return traced(untraced(self).max(*args, **options), -_least(-self.node))


def traced(value: Number, node: RecordedNumber) -> Any:
    """Return a number, or an array along the poses, with a node."""
    if _is_array(value):
        found: Any = np.asarray(value).view(TracedCourse)
    else:
        single = value.item() if isinstance(value, np.ndarray) else value
        found = TracedPlace(single) if isinstance(single, complex) else TracedLength(single)
    found.node = node
    return found


def untraced(value: Any) -> Any:
    """Return numbers without their nodes."""
    if isinstance(value, tuple | list):
        return type(value)(untraced(one) for one in value)
    if not isinstance(value, Traced):
        return value
    if isinstance(value, np.ndarray):
        return np.asarray(value)
    return complex(value) if isinstance(value, complex) else float(value)  # type: ignore[arg-type]


class _Scalar(Traced):
    """The arithmetic of single numbers."""

    ndim = 0

    __add__, __radd__ = _binary("add"), _binary("add", True)
    __sub__, __rsub__ = _binary("sub"), _binary("sub", True)
    __mul__, __rmul__ = _binary("mul"), _binary("mul", True)
    __truediv__, __rtruediv__ = _binary("truediv"), _binary("truediv", True)

    def __neg__(self) -> Any:
        return traced(-untraced(self), -self.node)

    def __abs__(self) -> Any:
        return traced(abs(untraced(self)), abs(self.node))

    def __pow__(self, exponent: float) -> Any:
        return traced(untraced(self) ** exponent, self.node**exponent)

    def item(self) -> Any:
        """Return itself."""
        return self


class TracedPlace(_Scalar, complex):  # type: ignore[misc]
    """A place or direction with its node. It equals no other, not even zero: at other dimensions it is elsewhere."""

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


class TracedLength(_Scalar):
    """A real number with its node. It is no `float`, of which Python's complex numbers would take the value alone."""

    def __init__(self, value: float) -> None:
        self.value = float(value)

    def __array__(self, *args: Any, **options: Any) -> Number:
        return np.array(self.value)

    def __eq__(self, other: object) -> bool:
        return bool(self.value == untraced(other))

    __lt__, __le__, __gt__, __ge__ = (_compared(name) for name in ("lt", "le", "gt", "ge"))
    __float__, __int__, __bool__, __hash__ = (_of_value(function) for function in (float, int, bool, hash))

    def __round__(self, digits: int | None = None) -> Any:
        return round(self.value, digits)

    def __format__(self, form: str) -> str:
        return format(self.value, form)


def _least(node: RecordedNumber) -> RecordedNumber:
    """The least of a number over the poses: an input, found by the node of that number."""
    from compoundkin.programs.graph.operation_graph import InputNumber

    return type(node).given(node.graph, InputNumber(LEAST, str(node.x)))


def as_place(value: Number) -> complex:
    """Return a place as a complex number. Its node stays with it, where it has one."""
    return value if isinstance(value, TracedPlace) else complex(value)


def as_length(value: Number) -> Any:
    """Return a real number as a plain one. Its node stays with it, where it has one."""
    return value if isinstance(value, TracedLength) else float(value)
