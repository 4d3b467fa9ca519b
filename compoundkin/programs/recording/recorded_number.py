"""Numbers that record: real, complex or true-or-false, taken by every kernel for ordinary coefficients.

NumPy's functions are answered by the protocols `__array_ufunc__` and `__array_function__`, so that kernels know nothing
of recording. What is asked of all poses at once (`np.any`, `np.all`) is answered yes: of two branches the general one
is recorded. A recorded number has no truth value, no length and no shape but ().
"""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT
from compoundkin.programs.recording.numpy_answers import NumpyAnswers


class RecordedNumber(NumpyAnswers):
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
