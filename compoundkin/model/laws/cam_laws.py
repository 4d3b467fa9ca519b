"""The standard cam laws over a span of 1, their pieces, and the rest-to-rest motion of least time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import comb, cos, factorial, inf, isinf, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number

# Terms that cancel leave no more than this part of their sizes: a few units in the last place.
ROUNDING = 1e-15
# Jumps of a derivative below this part of its scale in the program are rounding.
JUMP = 1e-9


@dataclass(frozen=True)
class AccelerationPiece:
    """A piece of a law: its span, the acceleration ``sum a[k] u**k + A sin(w u + phase)``, u from its start.

    `wave` is (A, w, phase); `leap` a jump of the velocity at the start.
    """

    span: float
    acceleration: tuple[float, ...] = (0.0,)
    wave: tuple[float, float, float] = (0.0, 1.0, 0.0)
    leap: float = 0.0


# The accelerations; their scale follows from the rise. The waves of the modified curves take an eighth of the span.
LAWS: dict[str, tuple[AccelerationPiece, ...]] = {
    "dwell": (AccelerationPiece(1.0),),
    "constant-velocity": (AccelerationPiece(1.0, leap=1.0),),
    "parabolic": (AccelerationPiece(0.5, (1.0,)), AccelerationPiece(0.5, (-1.0,))),
    "harmonic": (AccelerationPiece(1.0, wave=(1.0, pi, pi / 2)),),
    "cycloidal": (AccelerationPiece(1.0, wave=(1.0, 2 * pi, 0.0)),),
    "3-4-5": (AccelerationPiece(1.0, (0.0, 60.0, -180.0, 120.0)),),
    "4-5-6-7": (AccelerationPiece(1.0, (0.0, 0.0, 420.0, -1680.0, 2100.0, -840.0)),),
    "modified-trapezoid": (
        AccelerationPiece(0.125, wave=(1.0, 4 * pi, 0.0)),
        AccelerationPiece(0.25, (1.0,)),
        AccelerationPiece(0.25, wave=(1.0, 4 * pi, pi / 2)),
        AccelerationPiece(0.25, (-1.0,)),
        AccelerationPiece(0.125, wave=(1.0, 4 * pi, -pi / 2)),
    ),
    "modified-sine": (
        AccelerationPiece(0.125, wave=(1.0, 4 * pi, 0.0)),
        AccelerationPiece(0.75, wave=(1.0, 4 * pi / 3, pi / 2)),
        AccelerationPiece(0.125, wave=(1.0, 4 * pi, -pi / 2)),
    ),
}


@dataclass(frozen=True)
class PositionPiece:
    """A position ``sum p[k] u**k + A sin(w u + phase)``; `wave` is (A, w, phase)."""

    start: float
    polynomial: tuple[float, ...]
    wave: tuple[float, float, float]

    def derivative(self, k: int, u: float) -> float:
        """Return the k-th derivative at a distance from the start.

        >>> PositionPiece(0.0, (1.0, 2.0, 3.0), (0.0, 1.0, 0.0)).derivative(1, 2.0)
        14.0
        """
        amplitude, frequency, phase = self.wave
        smooth = sum(
            c * factorial(j) / factorial(j - k) * u ** (j - k) for j, c in enumerate(self.polynomial) if j >= k
        )
        return smooth + amplitude * frequency**k * sin(frequency * u + phase + k * pi / 2)

    def scaled(self, start: float, over: float, place: float, rise: float) -> PositionPiece:
        """Return the piece scaled to a span and a rise, beginning at a place."""
        amplitude, frequency, phase = self.wave
        polynomial = [c * rise / over**k for k, c in enumerate(self.polynomial)]
        polynomial[0] += place
        return PositionPiece(start + self.start * over, tuple(polynomial), (amplitude * rise, frequency / over, phase))


@cache
def unit_pieces(law: str) -> tuple[PositionPiece, ...]:
    """Return a law with a rise of 1 over a span of 1. Raises KeyError for an unknown one.

    >>> [piece.start for piece in unit_pieces("modified-sine")]
    [0.0, 0.125, 0.875]
    """
    return integrate_acceleration(LAWS[law])


def integrate_acceleration(parts: Sequence[AccelerationPiece]) -> tuple[PositionPiece, ...]:
    """Return the positions that accelerations make, from rest, with a rise of 1.

    >>> parabolic = AccelerationPiece(0.5, (1.0,)), AccelerationPiece(0.5, (-1.0,))
    >>> [piece.start for piece in integrate_acceleration(parabolic)]
    [0.0, 0.5]
    """
    start = place = speed = 0.0
    pieces = []
    for part in parts:
        piece = _integrate_piece(part, start, place, speed + part.leap)
        start, place, speed = start + part.span, piece.derivative(0, part.span), piece.derivative(1, part.span)
        pieces.append(piece)
    return tuple(piece.scaled(0.0, 1.0, 0.0, 1.0 / place if place else 1.0) for piece in pieces)


def _integrate_piece(part: AccelerationPiece, start: float, place: float, speed: float) -> PositionPiece:
    """Return the position of a piece that begins at a place with a speed."""
    amplitude, frequency, phase = part.wave
    wave = -amplitude / frequency**2
    fixed = (place - wave * sin(phase), speed - wave * frequency * cos(phase))
    return PositionPiece(start, (*fixed, *(a / ((k + 1) * (k + 2)) for k, a in enumerate(part.acceleration))),
               (wave, frequency, phase))  # fmt: skip


@dataclass(frozen=True)
class Discontinuity:
    """A place of a program where a derivative jumps: order 1 is the velocity, 2 the acceleration."""

    place: float
    order: int
    jump: float


def jumps(
    pieces: Sequence[PositionPiece], end: float, natural: Sequence[float], goes_on: bool
) -> tuple[Discontinuity, ...]:
    """Return where derivatives of order 1, 2 ... jump, from piece to piece and at both ends.

    `natural` is the scale of each order. If it `goes_on`, the end is joined to the beginning.
    """
    ends = [*(piece.start for piece in pieces[1:]), end]
    found = []
    for order, size in enumerate(natural, 1):
        last = [piece.derivative(order, at - piece.start) for piece, at in zip(pieces, ends, strict=True)]
        first = [piece.derivative(order, 0.0) for piece in pieces]
        before, after = [last[-1] if goes_on else 0.0, *last], [*first, first[0] if goes_on else 0.0]
        for place, a, b in zip([0.0, *ends], before, after, strict=True):
            if abs(b - a) > JUMP * size:
                found.append(Discontinuity(place, order, b - a))
    return tuple(sorted(found, key=lambda one: (one.place, one.order)))


class Spots(NamedTuple):
    """Places in a program: the index of their pieces, and which are outside."""

    index: Number
    before: Number
    after: Number


class PieceTable:
    """The pieces of a program as arrays."""

    def __init__(self, pieces: Sequence[PositionPiece], end: float) -> None:
        self.starts = np.array([piece.start for piece in pieces])
        self.end = end
        longest = max(len(piece.polynomial) for piece in pieces)
        # one row for every power
        self.powers = np.array(
            [[*piece.polynomial, *[0.0] * (longest - len(piece.polynomial))] for piece in pieces]
        ).T.copy()
        self.waves = np.array([piece.wave for piece in pieces]).T.copy()

    def spots(self, x: Number) -> Spots:
        """Return the pieces of places x."""
        index = np.clip(np.searchsorted(self.starts, x, side="right") - 1, 0, len(self.starts) - 1)
        return Spots(index, x < 0.0, x > self.end)

    def taylor(self, x: Number, spots: Spots, order: int, stops: bool) -> list[Number]:
        """Return the Taylor coefficients at places x; constant outside, if it `stops`."""
        index, before, after = spots
        place = np.where(before, 0.0, np.where(after, self.end, x)) if stops else x
        u = place - self.starts[index]
        out = self._smooth(index, u, order)
        if self.waves[0].any():
            out = [a + b for a, b in zip(out, self._waves(index, u, order), strict=True)]
        if stops and order:
            # NaN stays NaN
            out[1:] = [np.where(before | after, 0.0, c) for c in out[1:]]
        return [out[0], *(np.where(np.abs(c) <= self._rounding(k)[index], 0.0, c) for k, c in enumerate(out[1:], 1))]

    def _rounding(self, k: int) -> Number:
        """Return the sizes below which coefficients are rounding of terms that cancel."""
        spans = np.diff([*self.starts, self.end])
        smooth = sum(comb(j, k) * np.abs(p) * spans ** (j - k) for j, p in enumerate(self.powers) if j >= k)
        return ROUNDING * (smooth + np.abs(self.waves[0]) * self.waves[1] ** k / factorial(k))

    def _smooth(self, index: Number, u: Number, order: int) -> list[Number]:
        """Horner's scheme for a polynomial and its derivatives at once."""
        out: list[Number] = [self.powers[-1][index]] + [np.zeros_like(u)] * order
        for power in self.powers[-2::-1]:
            for k in range(order, 0, -1):
                out[k] = out[k] * u + out[k - 1]
            out[0] = out[0] * u + power[index]
        return out

    def _waves(self, index: Number, u: Number, order: int) -> list[Number]:
        amplitude, frequency, phase = (row[index] for row in self.waves)
        angle = frequency * u + phase
        turns = amplitude * np.sin(angle), amplitude * np.cos(angle)
        # sine, cosine, -sine, -cosine ...
        signs = (1.0, 1.0, -1.0, -1.0)
        return [turns[k % 2] * (signs[k % 4] / factorial(k)) * frequency**k for k in range(order + 1)]


# Parts that take less than this of the whole time are rounding: a limit is then just reached.
NOTHING = 1e-13


@dataclass(frozen=True)
class LeastTime:
    """Motion over a distance in the least time; an infinite limit has no effect.

    The speed grows over `ramp` (the jerk is greatest), `hold` (the acceleration is) and a ramp again; then `cruise`;
    then the same backwards.

    >>> LeastTime(10.0, speed=5.0, acceleration=2.0).duration  # 10 / 5 + 5 / 2, beyond the triangle's 2 sqrt(10 / 2)
    4.47213595499958
    >>> round(LeastTime(2.0, jerk=1.0).duration, 12)  # the cube root of 32 d / j
    4.0
    """

    distance: float
    speed: float = inf
    acceleration: float = inf
    jerk: float = inf

    @cached_property
    def ramp(self) -> float:
        """The time in which the acceleration grows, until it meets a limit."""
        unlimited: float = (self.distance / self.jerk / 2.0) ** (1.0 / 3.0)
        return min(self.acceleration / self.jerk if not isinf(self.acceleration) else inf,
                   sqrt(self.speed / self.jerk) if not isinf(self.speed) else inf, unlimited)  # fmt: skip

    @cached_property
    def peak(self) -> float:
        """The greatest acceleration reached."""
        return self.acceleration if isinf(self.jerk) else min(self.acceleration, self.jerk * self.ramp)

    @cached_property
    def hold(self) -> float:
        """The time at the greatest acceleration."""
        half = self.ramp / 2.0
        until_half_way = sqrt(half * half + self.distance / self.peak) - half
        return self._time(min(self.speed / self.peak, until_half_way) - self.ramp)

    @cached_property
    def growth(self) -> float:
        """The time in which the acceleration grows and holds."""
        return self.ramp + self.hold

    @cached_property
    def cruise(self) -> float:
        """The time at the greatest speed."""
        return self._time(self.distance / (self.peak * self.growth) - self.growth - self.ramp)

    @property
    def duration(self) -> float:
        """The whole time."""
        return 2.0 * (2.0 * self.ramp + self.hold) + self.cruise

    @property
    def _least(self) -> float:
        """A lower bound of the whole time: that of the greatest acceleration alone."""
        return 2.0 * sqrt(self.distance / self.peak)

    def _time(self, found: float) -> float:
        return found if found > NOTHING * self._least else 0.0

    @cached_property
    def unit_pieces(self) -> tuple[PositionPiece, ...]:
        """Its pieces with a rise of 1 over a span of 1."""
        ramp, hold, cruise = (part / self.duration for part in (self.ramp, self.hold, self.cruise))
        slope = 1.0 / ramp if ramp else 0.0
        parts = (
            AccelerationPiece(ramp, (0.0, slope)),
            AccelerationPiece(hold, (1.0,)),
            AccelerationPiece(ramp, (1.0, -slope)),
            AccelerationPiece(cruise),
            AccelerationPiece(ramp, (0.0, -slope)),
            AccelerationPiece(hold, (-1.0,)),
            AccelerationPiece(ramp, (-1.0, slope)),
        )
        return integrate_acceleration([part for part in parts if part.span])
