"""The numbers of laws by name, laws with others in their place, and how a law changes with one of its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.series import Number
from compoundkin.model.field_numbers import numbers_of
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.program_segments import ProgramSegment

SEGMENTS = "segments"
# Differences are taken over this part of a number, or of the shortest piece where pieces move; each level of
# extrapolation halves it. Four levels leave the eighth power of it, some 1e-13 of the slope, and as much of rounding.
STEP, LEVELS = 0.02, 4
# Where a law has other pieces, or is none, so near to a number, it is not smooth there.
NEAREST = 1e-6


def law_numbers(law: Any) -> dict[str, Number]:
    """Return the numbers that a law states: "speed", or "segments.0.rise". Tables and functions state none.

    What follows from other numbers is none: the rise of a dwell, the span of a rise in the least time.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.program_segments import dwell, rise
    >>> law_numbers(program(rise(10.0, over=2.0), dwell(1.0)))
    {'start': 0.0, 'segments.0.over': 2.0, 'segments.0.rise': 10.0, 'segments.1.over': 1.0}
    """
    # a table has its numbers all along the motion
    found = {name: value for name, value in numbers_of(law).items() if np.shape(value)[-1:] <= (1,)}
    for index, segment in enumerate(getattr(law, SEGMENTS, ())):
        own = {name: value for name, value in numbers_of(segment).items() if name != segment.followed}
        found |= {f"{SEGMENTS}.{index}.{name}": value for name, value in own.items()}
    return found


def law_with(law: Any, numbers: Mapping[str, Any]) -> Any:
    """Return a law with other numbers, named as `law_numbers` does. Raises InvalidMechanism.

    >>> from compoundkin.model.laws.motion_programs import program
    >>> from compoundkin.model.laws.program_segments import rise
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
    """Return how value, speed ... at times change with a number of the law.

    Where pieces meet they are those of the piece behind. NaN where the law is not smooth in the number. Source of the
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
    """Return central differences. Times are in the pieces in which the law itself has them."""
    number = law_numbers(law)[name]
    ends = (law_with(law, {name: number + way * step}).coordinate(times, order, law) for way in (1.0, -1.0))
    ahead, behind = ends
    return [(ahead.derivative(k) - behind.derivative(k)) / (2.0 * step) for k in range(order + 1)]


def _smooth_step(law: Program, name: str, times: Number) -> tuple[float, int]:
    """Return the step of differences and its levels, none where the law is not smooth."""
    number = float(law_numbers(law)[name])
    step = STEP * (abs(number) or 1.0)
    periods = 1.0 + float(np.max(np.abs(times))) / law.period if law.repeat else 1.0
    own = _places(law)
    while step >= NEAREST * STEP * abs(number):
        try:
            ends = [_places(law_with(law, {name: number + way * step})) for way in (1.0, -1.0)]
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


def _places(law: Program) -> Number:
    """Return where its pieces begin, and the end."""
    return np.array([*(piece.start for piece in law.pieces), law.period])
