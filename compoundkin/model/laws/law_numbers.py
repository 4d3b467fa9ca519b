"""Numbers of driving laws by name: laws with other numbers or of several designs, and their sensitivities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.series import Series
from compoundkin.model.fields import stated_numbers
from compoundkin.model.laws.motion_programs import Program, ProgramSegment
from compoundkin.model.laws.path_coordinate import PathCoordinate
from compoundkin.model.laws.table_laws import MotionTable, TimeTable

SEGMENTS = "segments"
# Differences are taken over this part of a number, or of the shortest piece where pieces move; each level of
# extrapolation halves it. Four levels leave the eighth power of it, some 1e-13 of the slope, and as much of rounding.
STEP, LEVELS = 0.02, 4
# Where a law has other pieces, or is invalid, so near to a number, it is not smooth there.
NEAREST = 1e-6


def law_numbers(law: Any) -> dict[str, Number]:
    """Return the numbers of a law by name: "speed", or "segments.0.rise". Tables and functions have none.

    Numbers that follow from others are left out: the rise of a dwell, the span of a rise in the least time.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.motion_programs import dwell, rise
    >>> law_numbers(program(rise(10.0, over=2.0), dwell(1.0)))
    {'start': 0.0, 'segments.0.over': 2.0, 'segments.0.rise': 10.0, 'segments.1.over': 1.0}
    """
    # a table has its numbers all along the motion
    found = {name: value for name, value in stated_numbers(law).items() if np.shape(value)[-1:] <= (1,)}
    for index, segment in enumerate(getattr(law, SEGMENTS, ())):
        own = {name: value for name, value in stated_numbers(segment).items() if name != segment.followed}
        found |= {f"{SEGMENTS}.{index}.{name}": value for name, value in own.items()}
    return found


def law_with(law: Any, numbers: Mapping[str, Any]) -> Any:
    """Return a law with other numbers, named as by `law_numbers`. Raises InvalidMechanism.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.motion_programs import rise
    >>> law_with(program(rise(10.0, over=2.0)), {"segments.0.rise": 20.0}).lift
    20.0
    """
    fields: dict[str, Any] = {}
    for name, value in numbers.items():
        word, _, rest = name.partition(".")
        if rest:
            index, _, own = rest.partition(".")
            fields.setdefault(word, {}).setdefault(int(index), {})[own] = value
        else:
            fields[word] = value
    if SEGMENTS in fields:
        changes = fields[SEGMENTS]
        fields[SEGMENTS] = tuple(
            _segment_with(one, changes[k]) if k in changes else one for k, one in enumerate(law.segments)
        )
    return replace(law, **fields)


def _segment_with(segment: ProgramSegment, numbers: Mapping[str, Any]) -> ProgramSegment:
    # the least span is found anew
    anew: dict[str, Any] = {"over": 0.0} if segment.is_fastest else {}
    return replace(segment, **anew, **numbers)


def law_slopes(law: Any, name: str, times: Number, order: int) -> list[Number]:
    """Return the derivatives of value, speed ... at times by a number of the law.

    Between two pieces they are those of the later one. NaN where the law is not smooth in the number. Source of the
    extrapolation: L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911), 307-357.

    >>> from compoundkin.model.laws.constant_laws import ConstantSpeed
    >>> [float(slope) for slope in law_slopes(ConstantSpeed(3.0), "speed", 2.0, 1)]
    [2.0, 1.0]
    """
    if not isinstance(law, Program):
        # linear in its numbers
        moved = law_with(law, {**dict.fromkeys(law_numbers(law), 0.0), name: 1.0}).coordinate(times, order)
        return [moved.derivative(k) for k in range(order + 1)]
    step, levels = _smooth_step(law, name, times)
    if not levels:
        return [np.full(np.shape(times), np.nan)] * (order + 1)
    rows = [_differences(law, name, step / 2**level, times, order) for level in range(levels)]
    for power in range(1, levels):
        rows = [
            [(4**power * b - a) / (4**power - 1) for a, b in zip(wide, narrow, strict=True)]
            for wide, narrow in pairwise(rows)
        ]
    return rows[0]


def _differences(law: Program, name: str, step: float, times: Number, order: int) -> list[Number]:
    """Return central differences, with times in the pieces of the law itself."""
    number = law_numbers(law)[name]
    ends = (law_with(law, {name: number + way * step}).coordinate(times, order, law) for way in (1.0, -1.0))
    ahead, behind = ends
    return [(ahead.derivative(k) - behind.derivative(k)) / (2.0 * step) for k in range(order + 1)]


def _smooth_step(law: Program, name: str, times: Number) -> tuple[float, int]:
    """Return the step of differences and its levels, no levels where the law is not smooth."""
    number = float(law_numbers(law)[name])
    step = STEP * (abs(number) or 1.0)
    periods = 1.0 + float(np.max(np.abs(times))) / law.period if law.repeat else 1.0
    own = _piece_boundaries(law)
    while step >= NEAREST * STEP * abs(number):
        try:
            ends = [_piece_boundaries(law_with(law, {name: number + way * step})) for way in (1.0, -1.0)]
        except InvalidMechanism:
            ends = []
        if ends and all(len(end) == len(own) for end in ends):
            farthest = periods * max(float(np.max(np.abs(end - own))) for end in ends)
            nearest = STEP * float(np.min(np.diff(own)))
            if farthest == 0.0:
                return step, 1  # where pieces stay, the law is linear in the number
            return step * min(1.0, nearest / farthest), LEVELS
        step /= 10.0
    return step, 0


def _piece_boundaries(law: Program) -> Number:
    """Return the places where its pieces begin, and its end."""
    return np.array([*(piece.start for piece in law.pieces), law.period])


@dataclass(frozen=True, repr=False)
class DesignLaws(ShortRepr):
    """Programs of several designs, in the order of an array of this `shape`."""

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
        """Return the derivatives by one of their numbers, as `law_slopes`."""
        return self._rows(times, lambda law, row: law_slopes(law, name, row, order))

    def _rows(self, t: Number, of: Callable[[Program, Number], Sequence[Number]]) -> list[Number]:
        """Return a function of each law and its times, design by design."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        designs = np.broadcast_shapes(self.shape, times.shape[:-1])
        shape = (*designs, times.shape[-1])
        rows = np.broadcast_to(times, shape).reshape(-1, shape[-1])
        index = np.broadcast_to(np.arange(len(self.laws)).reshape(self.shape), designs).ravel()
        found = [of(self.laws[i], row) for i, row in zip(index, rows, strict=True)]
        return [np.stack(column).reshape(shape) for column in zip(*found, strict=True)]


def law_of_designs(law: Any, numbers: Mapping[str, Number]) -> Any:
    """Return a law with other numbers, or arrays of them for designs. Raises InvalidMechanism.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.motion_programs import rise
    >>> lifts = law_of_designs(program(rise(1.0, over=2.0)), {"segments.0.rise": np.array([[10.0], [20.0]])})
    >>> lifts.coordinate(1.0, 0).c[0].tolist()
    [[5.0], [10.0]]
    """
    shape = np.broadcast_shapes(*(np.shape(value)[:-1] for value in numbers.values()))
    single = all(np.ndim(value) == 0 for value in numbers.values())
    if single or not isinstance(law, Program):
        return law_with(law, numbers)
    columns = {name: np.broadcast_to(np.asarray(v)[..., 0] if np.ndim(v) else v, shape) for name, v in numbers.items()}
    rows = zip(*(column.ravel().tolist() for column in columns.values()), strict=True)
    return DesignLaws(tuple(law_with(law, dict(zip(numbers, row, strict=True))) for row in rows), shape)


def law_sensitivities(law: Any, name: str, times: Number, order: int) -> list[Number]:
    """Return `law_slopes` of a law or of laws of designs."""
    return law.slopes(name, times, order) if isinstance(law, DesignLaws) else law_slopes(law, name, times, order)


def derivative_jumps(law: Any, first: float, last: float) -> Number:
    """Return the times from `first` to `last` at which some derivative of a law may jump; none for a Python function.

    >>> from compoundkin.model.laws import dwell, program, rise
    >>> derivative_jumps(program(rise(1.0, over=2.0, law="parabolic"), dwell(1.0), repeat=True), 0.5, 5.0).tolist()
    [1.0, 2.0, 3.0, 4.0, 5.0]
    >>> derivative_jumps(MotionTable([0, 1, 2], *np.ones((3, 3))), 0.5, 5.0).tolist()
    [1.0, 2.0]
    """
    if isinstance(law, Program):
        own = np.append([piece.start for piece in law.pieces], law.period)
        return _over_periods(own, law.period, law.repeat, first, last)
    if isinstance(law, TimeTable | MotionTable):
        low, high = law.span
        return _over_periods(np.asarray(law.times), high - low, isinstance(law, TimeTable) and law.repeat, first, last)
    if isinstance(law, PathCoordinate):
        return np.unique(np.concatenate([np.empty(0), *(derivative_jumps(own, first, last) for own in law.path.laws)]))
    return np.empty(0)


def _over_periods(own: Number, period: float, repeat: bool, first: float, last: float) -> Number:
    """Return the jumps of a law in a range of times, in all its periods if it repeats."""
    if repeat:
        turns = np.arange(np.floor((first - own[0]) / period), np.ceil((last - own[0]) / period) + 1.0)
        own = np.unique((own[:-1] + turns[:, None] * period).ravel())
    return own[(own >= first) & (own <= last)]
