"""The values of a compiled path: its outputs by name, and which poses are assembled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arguments import check_design, checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import Description
from compoundkin.programs.call_numbers import COMPLEX, FLOAT, PLAIN_FLAGS, CallNumbers, numbers_of_designs
from compoundkin.programs.limit_screening import ScreenedDesigns


class PathValues(Mapping[str, Any]):
    """Outputs over designs and poses by name.

    They are arrays of the call's `shape`, the last axis the motion. Points are complex, angles unwrapped along the
    motion. `failed` (designs, poses) is the index of the first group that does not close plus one, else 0; None where
    all close. `screened` are the designs near limits, None where none came near one.

    >>> import compoundkin as ck
    >>> found = ck.compile(ck.load("slider-crank"), ["B", "B.x"])([0.0, 1.0])
    >>> found, list(found), found["B.x"].shape
    (PathValues(B, B.x at (2,) poses), ['B', 'B.x'], (2,))
    """

    __slots__ = ("_numbers", "_solving", "failed", "found", "screened", "shape")

    def __init__(
        self,
        numbers: CallNumbers | Callable[[], CallNumbers],
        found: Mapping[str, Number],
        failed: Number | None,
        solving: Callable[[CallNumbers], Description],
        shape: tuple[int, ...] | None = None,
        screened: ScreenedDesigns | None = None,
    ) -> None:
        self._numbers, self.found, self.failed, self._solving = numbers, found, failed, solving
        self.screened = screened
        self.shape = self.numbers.shape if shape is None else shape

    @property
    def numbers(self) -> CallNumbers:
        """The inputs of the call."""
        if not isinstance(self._numbers, CallNumbers):
            self._numbers = self._numbers()
        return self._numbers

    def __getitem__(self, name: str) -> Any:
        """Return an output by its name; raises UnknownName."""
        found = self.found.get(name) if isinstance(name, str) else None
        if found is None:
            raise UnknownName(Problem(str(name), "there is no such output", suggestion(str(name), list(self.found))))
        if found.size != prod(self.shape):
            found = np.broadcast_to(found, (prod(self.shape[:-1]), self.shape[-1] if self.shape else 1))
        return found.reshape(self.shape)

    def arrays_for(self, vectors: Mapping[str, bool], shape: tuple[int, ...]) -> dict[str, Number] | None:
        """Return its arrays (designs, poses) for the results of another call; None where they cannot hold them.

        `vectors` are the outputs of that call, and which are vectors; `shape` is that of its arrays.
        """
        if self.shape != shape or not shape:
            return None
        size = prod(shape)
        for name, array in self.found.items():
            kind = vectors.get(name)
            if kind is None or array.dtype is not (COMPLEX if kind else FLOAT) or array.size != size:
                return None
            if array.flags.num & PLAIN_FLAGS != PLAIN_FLAGS:
                return None
        return dict(self.found)

    def __iter__(self) -> Iterator[str]:
        return iter(self.found)

    def __len__(self) -> int:
        return len(self.found)

    __eq__, __hash__ = object.__eq__, object.__hash__

    @property
    def assembled(self) -> Any:
        """Which poses are assembled, a bool array of the call's shape."""
        if self.failed is None:
            return np.broadcast_to(np.True_, self.shape)
        return (self.failed == 0).reshape(self.shape)

    @checked
    def motion(self, design: int = 0) -> Motion:
        """Return one design solved by `solve`, which reports failures with their reasons.

        `design` counts along all axes but the last. Raises InvalidInput for an index out of range, NotAssembled
        for a design without an assembled pose.

        >>> import compoundkin as ck
        >>> found = ck.compile(ck.load("slider-crank"), "B")()
        >>> ck.gaps(found.motion())
        ()
        """
        check_design(design, self.numbers.extent[0])
        with np.errstate(all="ignore"):
            return self._solving(numbers_of_designs(self.numbers, np.array([design]))).motion

    def __reduce__(self) -> tuple[Any, ...]:
        # the numbers may not be read yet
        return PathValues, (self.numbers, self.found, self.failed, self._solving, self.shape, self.screened)

    def __repr__(self) -> str:
        return f"PathValues({', '.join(self.found)} at {self.shape} poses)"
