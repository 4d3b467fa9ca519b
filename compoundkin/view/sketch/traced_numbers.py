"""Numbers that trace how they are computed while a sketch is painted: a value, and the node of a graph for it.

Painters compute with them as with any other numbers, and every branch is taken by the values. The trace of a vertex
says how it is computed from the mechanism's dimensions, so that a page can draw it anew. A function that takes no
traces gives the plain value: what is drawn of it is carried by its link as it is.
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
    """What noted numbers have in common: their note, and how NumPy's functions are answered."""

    note: RecordedNumber

    def conjugate(self) -> Any:
        """Return the complex conjugate."""
        return traced(untraced(self).conjugate(), self.note.conjugate())

    @property
    def real(self) -> Any:
        """The real part."""
        return traced(untraced(self).real, self.note.real)

    @property
    def imag(self) -> Any:
        """The imaginary part."""
        return traced(untraced(self).imag, self.note.imag)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        from compoundkin.programs.recording.recorded_number import UFUNCS

        values = [untraced(one) for one in inputs]
        found = getattr(ufunc, method)(*values, **{key: untraced(one) for key, one in options.items()})
        recorded = UFUNCS.get(ufunc) if method == "__call__" and not options else None
        return _answered(found, inputs, lambda notes: recorded(*notes)) if recorded else found

    def __array_function__(self, function: Callable[..., Any], types: Any, args: Any, options: Any) -> Any:
        from compoundkin.programs.recording.recorded_number import FUNCTIONS

        found = function(*untraced(args), **{key: untraced(one) for key, one in options.items()})
        recorded = FUNCTIONS.get(function)
        if function in SAME:
            return traced(found, self.note)
        if recorded is None or options:
            return found
        return _answered(found, args, lambda notes: recorded(self.note, *notes))


def _answered(value: Any, operands: Any, recorded: Callable[[list[Any]], Any]) -> Any:
    """A value with its note; the value alone where truth values are needed or an operand has no note."""
    if isinstance(value, tuple | bool | np.bool_) or np.asarray(value).dtype.kind == "b":
        return value
    own = next(one.note for one in operands if isinstance(one, Traced))
    if any(_is_array(one) and not isinstance(one, Traced) for one in operands):
        return value
    try:
        note = recorded([one.note if isinstance(one, Traced) else own.like(one) for one in operands])
    except TypeError:
        return value
    return traced(value, note) if isinstance(note, type(own)) else value


def _binary(name: str, swapped: bool = False) -> Callable[[Any, Any], Any]:
    operation = getattr(operator, name)

    def method(self: Any, other: Any) -> Any:
        if not isinstance(other, int | float | complex | np.number | TracedLength):
            return NotImplemented
        one, two = (other, self) if swapped else (self, other)
        value = operation(untraced(one), untraced(two))
        # numbers that cannot change are not worked out again
        fixed = self.note.is_constant and (not isinstance(other, Traced) or other.note.is_constant)
        return traced(value, self.note.like(value) if fixed else operation(_note(one), _note(two)))

    return method


def _compared(name: str) -> Callable[[Any, Any], bool]:
    operation = getattr(operator, name)
    return lambda self, other: bool(operation(untraced(self), untraced(other)))


def _of_value(function: Callable[[float], Any]) -> Callable[[Any], Any]:
    return lambda self: function(self.value)


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _note(value: Any) -> Any:
    return value.note if isinstance(value, Traced) else value


class TracedCourse(Traced, np.ndarray):  # type: ignore[override]
    """An array along the poses of a motion. Its note is that of one pose."""

    def __array_finalize__(self, of: Any) -> None:
        self.note = getattr(of, "note", None)  # type: ignore[assignment]

    def min(self, *args: Any, **options: Any) -> Any:
        """Return the least of real numbers, over the poses."""
        return traced(untraced(self).min(*args, **options), _least(self.note))

    def max(self, *args: Any, **options: Any) -> Any:
        """Return the greatest of real numbers, over the poses."""
        return traced(untraced(self).max(*args, **options), -_least(-self.note))


def traced(value: Number, note: RecordedNumber) -> Any:
    """Return a number, or an array along the poses, with a note."""
    if _is_array(value):
        found: Any = np.asarray(value).view(TracedCourse)
    else:
        single = value.item() if isinstance(value, np.ndarray) else value
        found = TracedPlace(single) if isinstance(single, complex) else TracedLength(single)
    found.note = note
    return found


def untraced(value: Any) -> Any:
    """Return numbers without their notes."""
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
        return traced(-untraced(self), -self.note)

    def __abs__(self) -> Any:
        return traced(abs(untraced(self)), abs(self.note))

    def __pow__(self, exponent: float) -> Any:
        return traced(untraced(self) ** exponent, self.note**exponent)

    def item(self) -> Any:
        """Return itself."""
        return self


class TracedPlace(_Scalar, complex):  # type: ignore[misc]
    """A place or direction with its note. It equals no other, not even zero: at other dimensions it is elsewhere."""

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


class TracedLength(_Scalar):
    """A real number with its note. It is no `float`, of which Python's complex numbers would take the value alone."""

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


def _least(note: RecordedNumber) -> RecordedNumber:
    """The least of a number over the poses: an input, found by the node of that number."""
    from compoundkin.programs.graph.operation_graph import InputNumber

    return type(note).given(note.graph, InputNumber(LEAST, str(note.x)))


def as_place(value: Number) -> complex:
    """Return a place as a complex number. Its note stays with it, where it has one."""
    return value if isinstance(value, TracedPlace) else complex(value)


def as_length(value: Number) -> Any:
    """Return a real number as a plain one. Its note stays with it, where it has one."""
    return value if isinstance(value, TracedLength) else float(value)
