"""Where a link is: its origin and its orientation, both as series in time."""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

from compoundkin.series import Number, Series, constant


class End(NamedTuple):
    """One link's side of a pair: a point, and for a guide or its block also the direction of the guide.

    In a link's own frame both are constants; in a driven composite link or in the world they are series.
    """

    point: Series | Number
    direction: Series | Number | None = None

    @property
    def along(self) -> Series:
        """The direction as a series; only the ends of guides and blocks have one.

        >>> End(0j, 1j).along.c
        (1j,)
        """
        return self.direction if isinstance(self.direction, Series) else constant(self.direction)


class Pose:
    """A link's pose: origin `z` and orientation `u`, a unit vector; a point p of the link is at ``z + u p``.

    >>> Pose(constant(1 + 0j), constant(1j)).at(2.0).c
    ((1+2j),)
    """

    __slots__ = ("u", "z")

    def __init__(self, z: Series, u: Series) -> None:
        self.z = z
        self.u = u

    @classmethod
    def of(cls, z: Number, u: Number) -> Pose:
        """A pose of order 0."""
        return cls(constant(z), constant(u))

    def at(self, p: Series | Number) -> Series:
        """Where the point that is `p` in the link's frame is in the world."""
        if isinstance(p, (complex, float, int)) and p == 0:
            return self.z
        if self is FIXED:
            return p if isinstance(p, Series) else constant(p)
        return self.z + self.u * p

    def derivative(self, p: Number, k: int) -> Number:
        """The k-th time derivative of where the point `p` of the link is.

        >>> Pose(constant(1 + 0j), constant(1j)).derivative(2.0, 0)
        (1+2j)
        """
        z, u = self.z.c, self.u.c
        found = u[k] * p if k < len(u) else 0j
        if k < len(z):
            found = found + z[k]
        return found * factorial(k) if k > 1 else found

    def carry(self, end: End) -> End:
        """The link's side of a pair, in the world."""
        if self is FIXED:
            return End(self.at(end.point), end.direction)
        return End(self.at(end.point), None if end.direction is None else self.u * end.direction)

    def compose(self, inner: Pose) -> Pose:
        """The pose of what has pose `inner` in this link's frame."""
        return inner if self is FIXED else Pose(self.at(inner.z), self.u * inner.u)

    def inverse(self) -> Pose:
        """The pose of the world as seen from the link."""
        back = self.u.conj()
        return Pose(-(back * self.z), back)


FIXED = Pose(constant(0j), constant(1 + 0j))
