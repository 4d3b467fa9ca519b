"""The motion of least time within greatest speed, acceleration and jerk, from rest to rest.

At every moment one of the limits is reached, which makes it the shortest: without a limit of the jerk the speed over
time is a trapezoid or triangle; with one it has up to seven parts of constant jerk.

Source: L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, sections 3.2
and 3.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, isinf, sqrt

from compoundkin.model.laws.cam_laws import AccelerationPiece, PositionPiece, integrated

# Parts that take less than this of the whole time are rounding: a limit is then just reached.
NOTHING = 1e-13


@dataclass(frozen=True)
class LeastTime:
    """How a distance is gone in the least time. A limit that is infinite does not count.

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
        """A time that the whole one is not below: that of the greatest acceleration alone."""
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
        return integrated([part for part in parts if part.span])
