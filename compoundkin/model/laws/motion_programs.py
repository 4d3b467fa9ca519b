"""Motion programs: dwells, rises and falls by the standard cam laws, one after another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

import numpy as np

from compoundkin.base.argument_forms import is_finite_real
from compoundkin.base.arguments import checked
from compoundkin.base.composition import composed
from compoundkin.base.errors import InvalidMechanism, Problem, nearest
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.cam_laws import JUMP, LAWS, Discontinuity, PieceTable, PositionPiece, jumps, unit_pieces

Array: TypeAlias = np.ndarray[Any, Any]

_WORDS = "write laws.rise(...), laws.fall(...), laws.dwell(...)"


@dataclass(frozen=True)
class ProgramSegment:
    """A part of a program. A law, the span it takes, and how far it rises (negative: falls; a dwell 0).

    Raises InvalidMechanism for a law that there is not, a span that is not positive, a dwell that rises.

    >>> ProgramSegment("cycloidal", over=2.0, rise=10.0).rise
    10.0
    """

    law: str
    over: float
    rise: float = 0.0

    keys: ClassVar[tuple[Key, ...]] = (
        Key("law", "name", f"One of {', '.join(LAWS)}.", required=True),
        Key("over", "span", "The span it takes: seconds, or of a cam's rotation.", required=True),
        Key("rise", "coordinate", "How far it rises; negative for a fall.", default=0.0),
    )

    def __post_init__(self) -> None:
        problems = list(self._problems())
        if problems:
            raise InvalidMechanism(problems)

    def _problems(self) -> Iterator[Problem]:
        if not isinstance(self.law, str) or self.law not in LAWS:
            yield Problem("segment.law", f"there is no law {self.law!r}", nearest(str(self.law), list(LAWS)))
        if not is_finite_real(self.over) or self.over <= 0.0:
            yield Problem("segment.over", f"{self.over!r} is not a span", "give a positive number")
        if not is_finite_real(self.rise):
            yield Problem("segment.rise", f"{self.rise!r} is not a finite number")
        elif isinstance(self.law, str) and self.law == "dwell" and self.rise != 0.0:
            yield Problem("segment.rise", "a dwell rises by 0", "choose another law, or leave the rise out")


@dataclass(frozen=True)
class Program:
    """Segments one after another, from place 0 and value `start`. `repeat`: begun anew after each period.

    It maps a coordinate (the rotation of a cam, or time in seconds) to another one, both in the user's units.
    Raises InvalidMechanism for what is not a segment.

    >>> lift = program(rise(10.0, over=1.0), dwell(0.5), fall(10.0, over=1.0), dwell(0.5))
    >>> [round(c, 9) for c in lift.at(Series((0.5, 1.0))).c]
    [5.0, 20.0]
    >>> lift.period, lift.lift, lift.repeats
    (3.0, 10.0, True)
    """

    segments: tuple[ProgramSegment, ...]
    start: float = 0.0
    repeat: bool = False

    kind: ClassVar[str] = "program"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("segments", "segments", "Its dwells, rises and falls, one after another.", required=True),
        Key("start", "coordinate", "The value at its beginning.", default=0.0),
        Key("repeat", "flag", "Whether it begins anew after its end, from the value reached.", default=False),
    )

    def __post_init__(self) -> None:
        problems = list(self._problems())
        if problems:
            raise InvalidMechanism(problems)

    def _problems(self) -> Iterator[Problem]:
        if not isinstance(self.segments, tuple) or not self.segments:
            yield Problem("program.segments", "there is no segment", _WORDS)
            return
        for index, segment in enumerate(self.segments):
            if not isinstance(segment, ProgramSegment):
                yield Problem(f"program.segments[{index}]", f"{segment!r} is not a segment", _WORDS)
        if not isinstance(self.repeat, bool):
            yield Problem("program.repeat", f"{self.repeat!r} is not True or False")
        if not is_finite_real(self.start):
            yield Problem("program.start", f"{self.start!r} is not a finite number")

    @cached_property
    def breaks(self) -> Array:
        """Where its segments begin, and the end: one number more than segments."""
        return np.cumsum([0.0, *(segment.over for segment in self.segments)])

    @cached_property
    def values(self) -> Array:
        """Its values at the breaks."""
        return np.asarray(self.start + np.cumsum([0.0, *(segment.rise for segment in self.segments)]))

    @property
    def period(self) -> float:
        """The sum of the spans."""
        return float(self.breaks[-1])

    @property
    def span(self) -> tuple[float, float]:
        """From where to where it is defined by its segments."""
        return 0.0, self.period

    @property
    def lift(self) -> float:
        """The distance between its greatest and its least value. Every law rises or falls all the way."""
        return float(np.ptp(self.values))

    @cached_property
    def repeats(self) -> bool:
        """Whether it ends where it began, so that a cam may carry it round. One that repeats begins anew."""
        return self.repeat or abs(self._advance) <= JUMP * self.lift

    @property
    def _advance(self) -> float:
        """How far a period brings it."""
        return float(self.values[-1] - self.values[0])

    def at(self, x: Series, repeat: bool | None = None) -> Series:
        """Return its value and all derivatives along a coordinate. A real series of any shape.

        Before its beginning and after its end it stands still, or goes on periodically if `repeat`
        (None: if it `repeats`); a period that does not end where it began goes on from there. At a jump
        the derivatives are those behind it, at the very end those before it.

        >>> program(rise(1.0, 2.0, "harmonic")).at(Series((np.array([-1.0, 1.0, 3.0]),))).c[0].round(9).tolist()
        [0.0, 0.5, 1.0]
        """
        goes_on = self.repeats if repeat is None else repeat
        value = x.c[0] if isinstance(x.c[0], np.ndarray) else float(x.c[0])
        turns = np.floor(value / self.period) if goes_on else 0.0
        outer = self._table.taylor(value - turns * self.period if goes_on else value, x.order, not goes_on)
        if goes_on and abs(self._advance) > JUMP * self.lift:
            outer[0] = outer[0] + turns * self._advance
        return composed(outer if isinstance(value, np.ndarray) else [float(c) for c in outer], x)

    def coordinate(self, t: Number, order: int) -> Series:
        """Evaluate it as a law at times t (seconds). It goes on after its end if `repeat`."""
        return self.at(Series((t, 1.0, *[0.0] * (order - 1))[: order + 1]), self.repeat)

    @cached_property
    def pieces(self) -> tuple[PositionPiece, ...]:
        """Its pieces, from the first to the last."""
        places = zip(self.breaks[:-1].tolist(), self.values[:-1].tolist(), self.segments, strict=True)
        return tuple(piece.scaled(at, s.over, value, s.rise) for at, value, s in places for piece in unit_pieces(s.law))

    @cached_property
    def _table(self) -> PieceTable:
        return PieceTable(self.pieces, self.period)

    def discontinuities(self, repeat: bool | None = None) -> tuple[Discontinuity, ...]:
        """Return the places where velocity or acceleration jump, both ends included.

        >>> [(d.place, d.order) for d in program(rise(1.0, over=2.0, law="parabolic")).discontinuities()]
        [(0.0, 2), (1.0, 2), (2.0, 2)]
        """
        goes_on = self.repeats if repeat is None else repeat
        natural = [max(abs(s.rise) / s.over**order for s in self.segments) for order in (1, 2)]
        return jumps(self.pieces, self.period, natural, goes_on)


@checked
def program(*segments: ProgramSegment, start: float = 0.0, repeat: bool = False) -> Program:
    """Return a program of dwells, rises and falls.

    >>> program(dwell(1.0), rise(2.0, over=1.0), start=3.0).values.tolist()
    [3.0, 3.0, 5.0]
    """
    return Program(segments, start, repeat)


@checked
def rise(amount: float, over: float, law: str = "cycloidal") -> ProgramSegment:
    """Return a rise by an amount over a span.

    >>> rise(10.0, over=2.0, law="3-4-5").law
    '3-4-5'
    """
    return ProgramSegment(law, over, amount)


@checked
def fall(amount: float, over: float, law: str = "cycloidal") -> ProgramSegment:
    """Return a fall by an amount over a span: a rise by its opposite.

    >>> fall(10.0, over=2.0).rise
    -10.0
    """
    return ProgramSegment(law, over, -amount)


@checked
def dwell(over: float) -> ProgramSegment:
    """Return a dwell over a span.

    >>> dwell(2.0).law
    'dwell'
    """
    return ProgramSegment("dwell", over)
