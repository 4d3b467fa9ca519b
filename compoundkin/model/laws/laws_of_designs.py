"""Laws of several designs: those whose numbers are arrays, and programs side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number, Series
from compoundkin.model.laws.law_numbers import law_slopes, law_with
from compoundkin.model.laws.motion_programs import Program


@dataclass(frozen=True, repr=False)
class LawsOfDesigns(PrintsShort):
    """Programs side by side. `shape` is that of the designs, in whose order they are."""

    laws: tuple[Program, ...]
    shape: tuple[int, ...]

    @property
    def span(self) -> tuple[float, float] | None:
        """From when to when they are defined, None where they differ."""
        spans = {law.span for law in self.laws}
        return spans.pop() if len(spans) == 1 else None

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds)."""
        return Series(tuple(self._rows(t, lambda law, row: law.coordinate(row, order).c)))

    def slopes(self, name: str, times: Number, order: int) -> list[Number]:
        """Return the slopes by one of their numbers, as `law_slopes` does."""
        return self._rows(times, lambda law, row: law_slopes(law, name, row, order))

    def _rows(self, t: Number, of: Callable[[Program, Number], Sequence[Number]]) -> list[Number]:
        """Return what is found of each law at its times, design by design."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        designs = np.broadcast_shapes(self.shape, times.shape[:-1])
        shape = (*designs, times.shape[-1])
        rows = np.broadcast_to(times, shape).reshape(-1, shape[-1])
        index = np.broadcast_to(np.arange(len(self.laws)).reshape(self.shape), designs).ravel()
        found = [of(self.laws[i], row) for i, row in zip(index, rows, strict=True)]
        return [np.stack(column).reshape(shape) for column in zip(*found, strict=True)]


def moved_law(law: Any, numbers: Mapping[str, Number]) -> Any:
    """Return a law with other numbers, or arrays of them for designs. Raises InvalidMechanism.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.program_segments import rise
    >>> lifts = moved_law(program(rise(1.0, over=2.0)), {"segments.0.rise": np.array([[10.0], [20.0]])})
    >>> lifts.coordinate(1.0, 0).c[0].tolist()
    [[5.0], [10.0]]
    """
    shape = np.broadcast_shapes(*(np.shape(value)[:-1] for value in numbers.values()))
    single = all(np.ndim(value) == 0 for value in numbers.values())
    if single or not isinstance(law, Program):
        return law_with(law, numbers)
    columns = {name: np.broadcast_to(np.asarray(v)[..., 0] if np.ndim(v) else v, shape) for name, v in numbers.items()}
    rows = zip(*(column.ravel().tolist() for column in columns.values()), strict=True)
    return LawsOfDesigns(tuple(law_with(law, dict(zip(numbers, row, strict=True))) for row in rows), shape)


def slopes_of(law: Any, name: str, times: Number, order: int) -> list[Number]:
    """Return what `law_slopes` does, of a law or of laws of designs."""
    return law.slopes(name, times, order) if isinstance(law, LawsOfDesigns) else law_slopes(law, name, times, order)
