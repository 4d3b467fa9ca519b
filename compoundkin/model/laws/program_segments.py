"""Segments of motion programs: dwells, and rises and falls by the standard cam laws or in the least time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import degrees, inf
from typing import ClassVar

from compoundkin.base.argument_forms import is_finite_real
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN
from compoundkin.base.display import short
from compoundkin.base.errors import InvalidMechanism, Problem, nearest
from compoundkin.base.given_numbers import plain
from compoundkin.model.fields import Key
from compoundkin.model.laws.cam_laws import LAWS, PositionPiece, unit_pieces
from compoundkin.model.laws.least_time import LeastTime

# The law whose limits say how long it takes.
LEAST_TIME = "least-time"
LIMITS = ("speed", "acceleration", "jerk")
NAMES = (*LAWS, LEAST_TIME)
# A span below the least time by no more than this part of it is the least time: rounding of what was written down.
ROUNDING = 1e-9
# Beyond these powers of distances and limits are no numbers any more.
LEAST, MOST = 1e-60, 1e60


@dataclass(frozen=True)
class ProgramSegment:
    """A part of a program. A law, the span it takes, and how far it rises (negative: falls; a dwell 0).

    The law "least-time" has its greatest speed, acceleration and jerk, any of which may be left out but the last two
    together. Without a span it takes the least; with a longer one it is stretched, all its rates the lower.
    Raises InvalidMechanism for a law that there is not, a span that is not positive or shorter than the least, a dwell
    that rises, limits that are not positive or of another law.

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
            object.__setattr__(self, name, plain(getattr(self, name)))
        problems = list(self._problems())
        if problems:
            raise InvalidMechanism(problems)
        if not self.over:
            object.__setattr__(self, "over", self._fastest.duration)

    def _problems(self) -> Iterator[Problem]:
        law = self.law if isinstance(self.law, str) else ""
        if law not in NAMES:
            yield Problem("segment.law", f"there is no law {self.law!r}", nearest(str(self.law), list(NAMES)))
        wrong = list(self._number_problems(law))
        wrong += self._limit_problems() if law == LEAST_TIME else self._misplaced(law)
        yield from wrong
        if law == LEAST_TIME and not wrong:
            yield from self._span_problems()

    def _number_problems(self, law: str) -> Iterator[Problem]:
        if not is_finite_real(self.over) or self.over < 0.0:
            yield Problem("segment.over", f"{self.over!r} is not a span", "give a positive number")
        elif law != LEAST_TIME and not self.over:
            yield Problem("segment.over", "there is no span", "give a positive number")
        if not is_finite_real(self.rise):
            yield Problem("segment.rise", f"{short(self.rise)} is not a finite number")
        elif law == "dwell" and self.rise != 0.0:
            yield Problem("segment.rise", "a dwell rises by 0", "choose another law, or leave the rise out")

    def _misplaced(self, law: str) -> Iterator[Problem]:
        for name in LIMITS:
            if getattr(self, name) is not None and law:
                remedy = f"leave it out, or choose the law {LEAST_TIME!r}"
                yield Problem(f"segment.{name}", f"the law {law!r} has no such limit", remedy)

    def _limit_problems(self) -> Iterator[Problem]:
        for name in LIMITS:
            value = getattr(self, name)
            if value is not None and (not is_finite_real(value) or value <= 0.0):
                what = f"{short(value)} is not a limit"
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
        # nor beside a time that is as much longer
        if not all(LEAST < value < MOST for value in sizes) or self._fastest.growth < LEAST * self._fastest.duration:
            yield Problem("segment.over", f"{min(sizes):g} and {max(sizes):g} are too far from 1", "take other units")
        elif 0.0 < self.over < self._fastest.duration * (1.0 - ROUNDING):
            what = f"{self.over:g} is too short: within these limits it takes {self._fastest.duration:.6g}"
            yield Problem("segment.over", what, "give that or more, leave it out, or raise the limits")

    @property
    def is_fastest(self) -> bool:
        """Whether it takes the least time, so that the span need not be written."""
        return self.law == LEAST_TIME and self.rise != 0.0 and self.over == self._fastest.duration

    @property
    def followed(self) -> str:
        """The number that follows from others: the least span, a dwell's rise."""
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
    """Find that spans do not add up to a turn of a cam."""
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

    The law "least-time" takes its greatest speed, acceleration and jerk instead of a span, or one longer than needed.

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
