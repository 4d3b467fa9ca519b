"""What a timing chart shows: how each driver or follower moves, and when it rises, falls and dwells."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.bracketing import bisected
from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.series import Number, Series
from compoundkin.files.document import is_angle
from compoundkin.model.attributes import DEGREES, TIME
from compoundkin.model.laws import Law, as_law
from compoundkin.model.laws.law_corners import corners
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.program_segments import turn_problems
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.profile_contact import as_profiled
from compoundkin.model.profiles import Synthesised
from compoundkin.view.plot.marked_places import CONSTANT

# Places looked at in every phase of a program, and all along any other law.
IN_PHASE, IN_LAW = 60, 1500
# Halvings that find where a law begins to dwell, to the last digit that is shown.
HALVINGS = 40
ROTATION = "rotation"


@dataclass(frozen=True)
class Phase:
    """A part of a row. In it the value rises (`sense` 1), falls (-1) or dwells (0)."""

    begin: float
    end: float
    sense: int

    @property
    def word(self) -> str:
        """What it does."""
        return ("dwell", "rise", "fall")[self.sense]


@dataclass(frozen=True, eq=False)
class TimingRow:
    """One row: its name, what its values and their places are, and the range.

    `moved` returns the value and its rate at places; `breaks` are where phases may begin, none where that is not known.
    """

    name: str
    unit: str
    between: tuple[float, float]
    moved: Callable[[Number], tuple[Number, Number]]
    breaks: tuple[float, ...] = ()

    @property
    def scale(self) -> float:
        """By what values are multiplied to be read: angles are in degrees."""
        return float(np.rad2deg(1.0)) if self.unit == DEGREES else 1.0

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """Its phases, one after another. Neighbours of one sense are one."""
        joints = self._joints
        senses = self._senses(0.5 * (joints[:-1] + joints[1:]))
        first = [0, *(np.flatnonzero(np.diff(senses)) + 1)]
        ends = [self._refined(k, senses, joints) for k in first[1:]]
        bounds = zip([joints[0], *ends], [*ends, joints[-1]], senses[first], strict=True)
        return tuple(Phase(float(a), float(b), int(sense)) for a, b, sense in bounds)

    @cached_property
    def curve(self) -> tuple[Number, Number]:
        """Places and values, close enough to be drawn."""
        each = [
            np.linspace(a, b, IN_PHASE, endpoint=False) for a, b in zip(self._joints, self._joints[1:], strict=False)
        ]
        x = np.append(np.concatenate(each), self._joints[-1]) if self.breaks else self._joints
        return x, self.moved(x)[0] * self.scale

    @cached_property
    def _joints(self) -> Number:
        low, high = self.between
        if not self.breaks:
            return np.linspace(low, high, IN_LAW + 1)
        return np.array([low, *(x for x in sorted(set(self.breaks)) if low < x < high), high])

    @cached_property
    def still(self) -> float:
        """The rate that is none: rounding of the greatest, or of the values."""
        values, rates = self.moved(self._joints)
        return CONSTANT * max(float(np.max(np.abs(rates))), float(np.ptp(values)) / (self.between[1] - self.between[0]))

    def _senses(self, x: Number) -> Number:
        rates = self.moved(x)[1]
        return np.where(np.abs(rates) <= self.still, 0, np.sign(rates)).astype(int)

    def _refined(self, k: int, senses: Number, joints: Number) -> float:
        """Where the sense changes: at a break, else between two places looked at."""
        if self.breaks:
            return float(joints[k])
        before = senses[k - 1]
        low, high = 0.5 * (joints[k - 1] + joints[k]), 0.5 * (joints[k] + joints[k + 1])
        return float(bisected(lambda x: self._senses(x) == before, low, high, HALVINGS)[0])


def rows(what: Mechanism | Mapping[str, Any], over: str | None) -> tuple[str, tuple[TimingRow, ...]]:
    """Return what the rows are drawn over, "time" or "rotation", and the rows.

    Raises InvalidInput where there is nothing to draw.
    """
    if over not in (None, TIME, ROTATION):
        raise InvalidInput(Problem("over", f"{over!r} is nothing to draw over", nearest(str(over), [TIME, ROTATION])))
    if not isinstance(what, Mechanism):
        laws = {str(name): law for name, law in what.items()}
        return (ROTATION, tuple(_of_programs(laws))) if over == ROTATION else (TIME, tuple(_of_laws(laws)))
    if over in (None, TIME):
        laws = {drive.name: drive.law for drive in what.drives if drive.law is not None}
        if laws:
            units = {d.name: DEGREES if is_angle(what, d) else what.unit for d in what.drives}
            return TIME, tuple(_of_laws(laws, units, what.time))
    if over in (None, ROTATION):
        found = tuple(_of_cams(what))
        if found:
            return ROTATION, found
    wanted = {TIME: "no driver has a law", ROTATION: "no cam is made for a motion program"}
    told = wanted[over] if over else " and ".join(wanted.values())
    raise InvalidInput(
        Problem("timing chart", told, "write drive(..., law=laws.program(...)), or give the laws by name")
    )


def _of_laws(
    laws: Mapping[str, Any], units: Mapping[str, str] | None = None, times: Number | None = None
) -> Iterator[TimingRow]:
    known = {name: _law(name, law) for name, law in laws.items()}
    first, last = _range(known, times)
    for name, law in known.items():
        # a table tells nothing outside of its range
        ends = law.span if law.span and not isinstance(law, Program) and not getattr(law, "repeat", False) else None
        low, high = (max(first, ends[0]), min(last, ends[1])) if ends else (first, last)
        breaks = tuple(map(float, corners(law, low, high))) if isinstance(law, Program) else ()
        yield TimingRow(name, (units or {}).get(name, ""), (low, high), _moved(law), breaks)


def _law(name: str, given: Any) -> Law:
    law = as_law(f"laws.{name}", given)
    if law is None:
        raise InvalidInput(Problem(f"laws.{name}", "None is not a law", "write laws.program(...), or leave it out"))
    return law


def _range(laws: Mapping[str, Law], times: Number | None) -> tuple[float, float]:
    """From the first to the last time of a mechanism, else of all laws."""
    spans = [law.span for law in laws.values() if law.span] if times is None else [(np.min(times), np.max(times))]
    low, high = min((a for a, _ in spans), default=0.0), max((b for _, b in spans), default=0.0)
    if not high > low:
        what = "nothing tells for how long the drivers move" if laws else "there is no law"
        raise InvalidInput(Problem("timing chart", what, "give Mechanism(..., time=...), or a law with a span"))
    return float(low), float(high)


def _moved(law: Law) -> Callable[[Number], tuple[Number, Number]]:
    def moved(x: Number) -> tuple[Number, Number]:
        value, rate = (np.broadcast_arrays(part, np.atleast_1d(x))[0] for part in law.coordinate(x, 1).c)
        if value.size != np.size(x) or rate.size != np.size(x):
            raise InvalidInput(Problem("timing chart", "a law has several designs", "give one for a single design"))
        return value.reshape(np.shape(x)), rate.reshape(np.shape(x))

    return moved


def _of_programs(programs: Mapping[str, Any]) -> Iterator[TimingRow]:
    for name, program in programs.items():
        if not isinstance(program, Program):
            what = f"{program!r} is not a motion program"
            raise InvalidInput(Problem(f"laws.{name}", what, "write laws.program(...), or draw laws over time"))
        wrong = list(turn_problems(program.period, f"laws.{name}"))
        if wrong:
            raise InvalidInput(wrong)
        yield _laid_round(name, "", program, 0.0)


def _of_cams(mechanism: Mechanism) -> Iterator[TimingRow]:
    for pair in filter(None, map(as_profiled, mechanism.written_pairs)):
        made = pair.profile
        if isinstance(made, Synthesised):
            unit = DEGREES if made.oscillates else mechanism.unit
            start = -made.start if made.clockwise else made.start
            yield _laid_round(pair.name, unit, made.program, start)


def _laid_round(name: str, unit: str, program: Program, start: float) -> TimingRow:
    """Return the row of a program that begins at an angle of the cam, over a turn in degrees."""
    degree = TURN / 360.0

    def moved(x: Number) -> tuple[Number, Number]:
        q = np.asarray(x, dtype=float) * degree - start
        value, rate = program.at(Series((q, degree)), repeat=True).c
        return value, np.broadcast_to(rate, np.shape(x))

    begins = np.mod(np.rad2deg(program.breaks + start), 360.0)
    return TimingRow(name, unit, (0.0, 360.0), moved, tuple(float(x) for x in begins.round(9)))
