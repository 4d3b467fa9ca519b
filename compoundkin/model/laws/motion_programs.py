"""Motion programs: dwells, rises and falls by standard cam laws or in the least time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import degrees, inf
from typing import Any, ClassVar, TypeAlias

import numpy as np

from compoundkin.base.arguments import as_python_number, checked, is_finite_real
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidMechanism, Problem, suggestion
from compoundkin.base.series import Series, compose_series
from compoundkin.model.fields import Key
from compoundkin.model.laws.cam_laws import (
    JUMP,
    LAWS,
    Discontinuity,
    LeastTime,
    PieceTable,
    PositionPiece,
    jumps,
    unit_pieces,
)

Array: TypeAlias = np.ndarray[Any, Any]
_WORDS = "write laws.rise(...), laws.fall(...), laws.dwell(...)"


@dataclass(frozen=True)
class Program:
    """Segments one after another, from place 0 and value `start`, repeated after each period with `repeat`.

    It maps a coordinate (the rotation of a cam, or time in seconds) to another one, both in the user's units.
    Raises InvalidMechanism for anything but segments.

    >>> from compoundkin.model.laws.motion_programs import dwell, fall, rise
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
        """The distance between its greatest and its least value; all laws are monotonic."""
        return float(np.ptp(self.values))

    @cached_property
    def repeats(self) -> bool:
        """Whether it ends where it began, as for a cam, or repeats."""
        return self.repeat or abs(self._advance) <= JUMP * self.lift

    @property
    def _advance(self) -> float:
        """The advance over a period."""
        return float(self.values[-1] - self.values[0])

    def at(self, x: Series, repeat: bool | None = None, like: Program | None = None) -> Series:
        """Return its value and all derivatives along a coordinate, a real series of any shape.

        Before its beginning and after its end it stands still, or goes on periodically if `repeat` (None: if it
        `repeats`); a period that does not end where it began goes on from there. At a jump the derivatives are those
        behind it, at the very end those before it. `like`, a program of as many pieces, determines each place's piece.

        >>> from compoundkin.model.laws.motion_programs import rise
        >>> program(rise(1.0, 2.0, "harmonic")).at(Series((np.array([-1.0, 1.0, 3.0]),))).c[0].round(9).tolist()
        [0.0, 0.5, 1.0]
        """
        goes_on = self.repeats if repeat is None else repeat
        value = x.c[0] if isinstance(x.c[0], np.ndarray) else float(x.c[0])
        placing = like or self
        turns = np.floor(value / placing.period) if goes_on else 0.0
        spots = placing._table.spots(value - turns * placing.period)
        outer = self._table.taylor(value - turns * self.period, spots, x.order, not goes_on)
        if goes_on and abs(self._advance) > JUMP * self.lift:
            outer[0] = outer[0] + turns * self._advance
        return compose_series(outer if isinstance(value, np.ndarray) else [float(c) for c in outer], x)

    def coordinate(self, t: Number, order: int, like: Program | None = None) -> Series:
        """Evaluate it as a law at times t (seconds). It goes on after its end if `repeat`."""
        return self.at(Series((t, 1.0, *[0.0] * (order - 1))[: order + 1]), self.repeat, like)

    @cached_property
    def pieces(self) -> tuple[PositionPiece, ...]:
        """Its pieces, from the first to the last."""
        places = zip(self.breaks[:-1].tolist(), self.values[:-1].tolist(), self.segments, strict=True)
        return tuple(piece.scaled(at, s.over, value, s.rise) for at, value, s in places for piece in s.shape)

    @cached_property
    def _table(self) -> PieceTable:
        return PieceTable(self.pieces, self.period)

    def discontinuities(self, repeat: bool | None = None) -> tuple[Discontinuity, ...]:
        """Return the places where velocity or acceleration jump, both ends included.

        >>> from compoundkin.model.laws.motion_programs import rise
        >>> [(d.place, d.order) for d in program(rise(1.0, over=2.0, law="parabolic")).discontinuities()]
        [(0.0, 2), (1.0, 2), (2.0, 2)]
        """
        goes_on = self.repeats if repeat is None else repeat
        return jumps(self.pieces, self.period, [self._natural(order) for order in (1, 2)], goes_on)

    def _natural(self, order: int) -> float:
        """The scale of a derivative: that of the mean speed, or its values where pieces begin."""
        mean = max(abs(s.rise) / s.over**order for s in self.segments)
        return max(mean, *(abs(piece.derivative(order, 0.0)) for piece in self.pieces))


@checked
def program(*segments: ProgramSegment, start: float = 0.0, repeat: bool = False) -> Program:
    """Return a program of dwells, rises and falls.

    >>> from compoundkin.model.laws.motion_programs import dwell, rise
    >>> program(dwell(1.0), rise(2.0, over=1.0), start=3.0).values.tolist()
    [3.0, 3.0, 5.0]
    """
    return Program(segments, start, repeat)


@checked
def least_time(
    distance: float,
    *,
    speed: float | None = None,
    acceleration: float | None = None,
    jerk: float | None = None,
    over: float | None = None,
    start: float = 0.0,
) -> Program:
    """Return the law that goes a distance in the least time.

    From rest to rest; the distance may be negative. Speed, acceleration and jerk (rad/s or length/s, and so on) are the
    limits; one left out is not limited, but acceleration and jerk cannot both be left out. Without `jerk` the speed
    over time is a trapezoid or triangle, with it the acceleration is continuous: the s-curve of up to seven parts. A
    time `over` that is longer than the least stretches it.

    Raises InvalidMechanism for limits that are not positive, a distance of 0, a time too short.

    Source: L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, ch. 3.

    >>> least_time(10.0, speed=5.0, acceleration=10.0).period  # 10 / 5 + 5 / 10
    2.5
    >>> least_time(10.0, speed=5.0, acceleration=10.0, jerk=40.0).period  # and 10 / 40
    2.75
    """
    return Program((ProgramSegment(LEAST_TIME, over or 0.0, distance, speed, acceleration, jerk),), start)


@checked
def synchronised(*programs: Program) -> tuple[Program, ...]:
    """Stretch programs in time, so that all take as long as the slowest.

    Several axes then begin and end together. None gets faster, so that limits are kept. Raises InvalidMechanism
    where there is none.

    >>> slow, fast = synchronised(least_time(8.0, acceleration=2.0), least_time(1.0, acceleration=2.0))
    >>> slow.period, fast.period
    (4.0, 4.0)
    """
    if not programs:
        raise InvalidMechanism(Problem("programs", "there are none to stretch", "give two or more"))
    longest = max(one.period for one in programs)
    return tuple(_stretched(one, longest) for one in programs)


def _stretched(one: Program, period: float) -> Program:
    """Return a program that takes a given time."""
    if one.period == period:
        return one
    spans = np.array([segment.over for segment in one.segments]) * (period / one.period)
    # what rounding leaves goes to the longest, of which it is the least part
    spans[np.argmax(spans)] += period - np.cumsum(spans)[-1]
    changed = (replace(s, over=over) for s, over in zip(one.segments, spans.tolist(), strict=True))
    return replace(one, segments=tuple(changed))


# The law whose span follows from its limits.
LEAST_TIME = "least-time"
LIMITS = ("speed", "acceleration", "jerk")
NAMES = (*LAWS, LEAST_TIME)
# A span below the least time by no more than this part of it is the least time: rounding of what was written down.
ROUNDING = 1e-9
# Beyond these, powers of distances and limits overflow.
LEAST, MOST = 1e-60, 1e60


@dataclass(frozen=True)
class ProgramSegment:
    """A part of a program: a law, its span, and its rise (negative for a fall, 0 for a dwell).

    The law "least-time" has its greatest speed, acceleration and jerk, any of which may be left out but the last two
    together. Without a span it takes the least; with a longer one it is stretched, with lower rates.
    Raises InvalidMechanism for an unknown law, a span that is not positive or shorter than the least, a dwell that
    rises, limits that are not positive or of another law.

    >>> ProgramSegment("cycloidal", over=2.0, rise=10.0).rise
    10.0
    >>> ProgramSegment("least-time", rise=-10.0, speed=5.0, acceleration=10.0).over
    2.5
    """

    law: str
    over: float = 0.0
    rise: float = 0.0
    speed: float | None = None
    acceleration: float | None = None
    jerk: float | None = None

    keys: ClassVar[tuple[Key, ...]] = (
        Key("law", "name", f"One of {', '.join(NAMES)}.", required=True),
        Key("over", "span", "The span it takes: seconds, or of a cam's rotation; the least-time law has its own."),
        Key("rise", "coordinate", "How far it rises; negative for a fall.", default=0.0),
        Key("speed", "rate", "The greatest speed of the least-time law."),
        Key("acceleration", "length", "The greatest acceleration of the least-time law, rad/s^2 or length/s^2."),
        Key("jerk", "length", "The greatest jerk of the least-time law, rad/s^3 or length/s^3."),
    )

    def __post_init__(self) -> None:
        for name in ("over", "rise", *LIMITS):
            object.__setattr__(self, name, as_python_number(getattr(self, name)))
        problems = list(self._problems())
        if problems:
            raise InvalidMechanism(problems)
        if not self.over:
            object.__setattr__(self, "over", self._fastest.duration)

    def _problems(self) -> Iterator[Problem]:
        law = self.law if isinstance(self.law, str) else ""
        if law not in NAMES:
            yield Problem("segment.law", f"there is no law {self.law!r}", suggestion(str(self.law), list(NAMES)))
        wrong = list(self._number_problems(law))
        wrong += self._limit_problems() if law == LEAST_TIME else self._misplaced_limits(law)
        yield from wrong
        if law == LEAST_TIME and not wrong:
            yield from self._span_problems()

    def _number_problems(self, law: str) -> Iterator[Problem]:
        if not is_finite_real(self.over) or self.over < 0.0:
            yield Problem("segment.over", f"{self.over!r} is not a span", "give a positive number")
        elif law != LEAST_TIME and not self.over:
            yield Problem("segment.over", "there is no span", "give a positive number")
        if not is_finite_real(self.rise):
            yield Problem("segment.rise", f"{short_repr(self.rise)} is not a finite number")
        elif law == "dwell" and self.rise != 0.0:
            yield Problem("segment.rise", "a dwell rises by 0", "choose another law, or leave the rise out")

    def _misplaced_limits(self, law: str) -> Iterator[Problem]:
        for name in LIMITS:
            if getattr(self, name) is not None and law:
                remedy = f"leave it out, or choose the law {LEAST_TIME!r}"
                yield Problem(f"segment.{name}", f"the law {law!r} has no such limit", remedy)

    def _limit_problems(self) -> Iterator[Problem]:
        for name in LIMITS:
            value = getattr(self, name)
            if value is not None and (not is_finite_real(value) or value <= 0.0):
                what = f"{short_repr(value)} is not a limit"
                yield Problem(f"segment.{name}", what, "give a positive number, or leave it out")
        if self.acceleration is None and self.jerk is None:
            what = "nothing limits the acceleration: it would take no time to gain speed"
            yield Problem("segment.acceleration", what, "give the greatest acceleration, the greatest jerk or both")

    def _span_problems(self) -> Iterator[Problem]:
        if self.rise == 0.0:
            if not self.over:
                yield Problem("segment.rise", "a rise of 0 takes no time", "give a distance, or write a dwell")
            return
        sizes = [abs(self.rise), *(value for value in (self.speed, self.acceleration, self.jerk) if value is not None)]
        # also not beside a time that is as much longer
        if not all(LEAST < value < MOST for value in sizes) or self._fastest.growth < LEAST * self._fastest.duration:
            yield Problem("segment.over", f"{min(sizes):g} and {max(sizes):g} are too far from 1", "take other units")
        elif 0.0 < self.over < self._fastest.duration * (1.0 - ROUNDING):
            what = f"{self.over:g} is too short: within these limits it takes {self._fastest.duration:.6g}"
            yield Problem("segment.over", what, "give that or more, leave it out, or raise the limits")

    @property
    def is_fastest(self) -> bool:
        """Whether it takes the least time, so that its span can be left out."""
        return self.law == LEAST_TIME and self.rise != 0.0 and self.over == self._fastest.duration

    @property
    def followed(self) -> str:
        """The name of the number that follows from others: the least span, a dwell's rise."""
        return "over" if self.is_fastest else "rise" if self.law == "dwell" else ""

    @cached_property
    def _fastest(self) -> LeastTime:
        limits = (self.speed, self.acceleration, self.jerk)
        return LeastTime(abs(float(self.rise)), *(inf if value is None else float(value) for value in limits))

    @property
    def shape(self) -> tuple[PositionPiece, ...]:
        """Its pieces with a rise of 1 over a span of 1."""
        if self.law == LEAST_TIME:
            return self._fastest.unit_pieces if self.rise else unit_pieces("dwell")
        return unit_pieces(self.law)


def turn_problems(period: float, where: str) -> Iterator[Problem]:
    """Find spans that do not add up to a turn of a cam."""
    if abs(period - TURN) > ROUNDING:
        what = f"the spans add up to {degrees(period):.6g} degrees, not to a turn of 360"
        remedy = "change a dwell; spans are degrees in a file, radians in Python: laws.rise(10, over=deg(90))"
        yield Problem(where, what, remedy)


@checked
def rise(
    amount: float,
    over: float = 0.0,
    law: str = "cycloidal",
    *,
    speed: float | None = None,
    acceleration: float | None = None,
    jerk: float | None = None,
) -> ProgramSegment:
    """Return a rise by an amount over a span.

    The law "least-time" takes its greatest speed, acceleration and jerk instead of a span, or with a longer one.

    >>> rise(10.0, over=2.0, law="3-4-5").law
    '3-4-5'
    >>> rise(9.0, law="least-time", acceleration=4.0).over  # 2 sqrt(9 / 4)
    3.0
    """
    return ProgramSegment(law, over, amount, speed, acceleration, jerk)


@checked
def fall(
    amount: float,
    over: float = 0.0,
    law: str = "cycloidal",
    *,
    speed: float | None = None,
    acceleration: float | None = None,
    jerk: float | None = None,
) -> ProgramSegment:
    """Return a fall by an amount over a span: a rise by its opposite.

    >>> fall(10.0, over=2.0).rise
    -10.0
    """
    return ProgramSegment(law, over, -amount, speed, acceleration, jerk)


@checked
def dwell(over: float) -> ProgramSegment:
    """Return a dwell over a span.

    >>> dwell(2.0).law
    'dwell'
    """
    return ProgramSegment("dwell", over)
