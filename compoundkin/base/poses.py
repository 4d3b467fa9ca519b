"""Where a link is: its origin and its orientation, both as series in time."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import NamedTuple

from compoundkin.base.arrays import Number, entry, whole_turns
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import Series, constant


class End(NamedTuple):
    """One link's side of a pair: a point. It has a direction for a guide or its block; a number that belongs to it.

    In a link's own frame point and direction are constants; in a driven composite link or in the world they are
    series. The `measure` is a radius, a number of teeth or a phase: the same in every frame.
    """

    point: Series | Number
    direction: Series | Number | None = None
    measure: Number = None

    @property
    def along(self) -> Series:
        """The direction as a series; only the ends of guides and blocks have one.

        >>> End(0j, 1j).along.c
        (1j,)
        """
        return self.direction if isinstance(self.direction, Series) else constant(self.direction)


class Pose(ShortRepr):
    """A link's pose: origin `z` and orientation `u`, a unit vector. A point p of the link is at ``z + u p``.

    `theta` is the angle of `u` where full turns are counted, None where only the orientation is known.

    >>> Pose(constant(1 + 0j), constant(1j)).at(2.0).c
    ((1+2j),)
    """

    __slots__ = ("theta", "u", "z")

    def __init__(self, z: Series, u: Series, theta: Series | None = None) -> None:
        self.z = z
        self.u = u
        self.theta = theta

    @classmethod
    def of(cls, z: Number, u: Number) -> Pose:
        """Make a pose of order 0."""
        return cls(constant(z), constant(u))

    def at(self, p: Series | Number) -> Series:
        """Return the place in the world of the link's point `p`. The point is given in the link's frame."""
        if isinstance(p, (complex, float, int)) and p == 0:
            return self.z
        if self is FIXED:
            return p if isinstance(p, Series) else constant(p)
        return self.z + self.u * p

    def place(self, p: Number) -> Number:
        """Return where the link's point `p` is, without its rates.

        >>> Pose(constant(1 + 0j), constant(1j)).place(2.0)
        (1+2j)
        """
        if isinstance(p, (complex, float, int)) and p == 0:
            return self.z.c[0]
        return p if self is FIXED else self.z.c[0] + self.u.c[0] * p

    @property
    def angle(self) -> Series:
        """The angle of its orientation. It has full turns where they are counted, else is between -pi and pi.

        >>> FIXED.angle.c
        (0.0,)
        """
        return self.u.angle() if self.theta is None else self.theta

    def mapped(self, change: Callable[[Series], Series]) -> Pose:
        """Change all series of the pose alike, that of a counted angle too.

        >>> Pose.of(1j, 1 + 0j).mapped(lambda series: series * 2.0).z.c
        (2j,)
        """
        return Pose(change(self.z), change(self.u), None if self.theta is None else change(self.theta))

    def counted(self, near: Number) -> Pose:
        """Return the pose with full turns counted. Its angle is the one nearest to `near`.

        >>> Pose.of(0j, 1j).counted(8.0).angle.c[0].round(6)
        np.float64(7.853982)
        """
        theta = self.u.angle()
        return Pose(self.z, self.u, theta + whole_turns(near - theta.c[0]))

    def entry(self, at: tuple[int, ...]) -> Pose:
        """Return one pose of an array of them, at an index it broadcasts with.

        >>> Pose.of(constant(1j).c[0], 1 + 0j).entry((3, 1)).z.c
        (1j,)
        """
        z, u = (Series(tuple([complex(entry(c, at)) for c in part.c])) for part in (self.z, self.u))
        theta = None if self.theta is None else Series(tuple([float(entry(c, at)) for c in self.theta.c]))
        return Pose(z, u, theta)

    def derivative(self, p: Number, k: int) -> Number:
        """Return the k-th time derivative of where the point `p` of the link is.

        >>> Pose(constant(1 + 0j), constant(1j)).derivative(2.0, 0)
        (1+2j)
        """
        z, u = self.z.c, self.u.c
        found = u[k] * p if k < len(u) else 0j
        if k < len(z):
            found = found + z[k]
        return found * factorial(k) if k > 1 else found

    def carry(self, end: End) -> End:
        """Return the link's side of a pair, in the world."""
        if self is FIXED:
            return End(self.at(end.point), end.direction, end.measure)
        return End(self.at(end.point), None if end.direction is None else self.u * end.direction, end.measure)

    def compose(self, inner: Pose) -> Pose:
        """Return the pose of what has pose `inner` in this link's frame."""
        if self is FIXED:
            return inner
        known = self.theta is not None and inner.theta is not None
        return Pose(self.at(inner.z), self.u * inner.u, self.angle + inner.angle if known else None)

    def trimmed(self, order: int) -> Pose:
        """Cut the pose to an order at most."""
        if self.z.order <= order and self.u.order <= order:
            return self
        return self.mapped(lambda series: Series(series.c[: order + 1]))

    def inverse(self) -> Pose:
        """Return the pose of the world as seen from the link."""
        back = self.u.conj()
        return Pose(-(back * self.z), back, None if self.theta is None else -self.theta)


FIXED = Pose(constant(0j), constant(1 + 0j), constant(0.0))
