"""How recorded numbers compare, and answer NumPy's functions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_ONE_POSE = ContextVar("one pose is recorded", default=False)


@contextmanager
def one_pose() -> Iterator[None]:
    """Record what sees one pose: nothing can be asked of all poses at once."""
    token = _ONE_POSE.set(True)
    try:
        yield
    finally:
        _ONE_POSE.reset(token)


def answer_for_all() -> bool:
    """Answer yes where all poses are asked: the general branch is recorded."""
    if _ONE_POSE.get():
        raise TypeError("numpy.any and numpy.all ask of all poses, of which there is one here")
    return True


class NumpyAnswers(ABC):
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
        from compoundkin.programs.recording.recorded_functions import UFUNCS

        found = UFUNCS.get(ufunc)
        if method != "__call__" or options or found is None:
            return NotImplemented
        return found(*(self.like(value) for value in inputs))

    def __array_function__(self, function: Callable[..., Any], types: Any, args: Any, options: Any) -> Any:
        from compoundkin.programs.recording.recorded_functions import FUNCTIONS

        found = FUNCTIONS.get(function)
        return NotImplemented if found is None else found(self, *args, **options)
