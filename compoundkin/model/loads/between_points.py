"""What springs and dampers between points of two links share: the line between them, and the pull along it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import dot
from compoundkin.base.errors import InvalidMechanism, LikelySlip, Problem, warn
from compoundkin.base.series import Number, Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import link_key, spot_key
from compoundkin.model.geometry import FRAME, vector
from compoundkin.model.loads.contract import Load, LoadedPoses


class EndGap(NamedTuple):
    """The way from the first end to the second.

    It has its length, and the velocity of the second end relative to the first.
    """

    vector: Number
    length: Number
    velocity: Number

    @property
    def rate(self) -> Number:
        """How fast it grows. Ends that meet move apart with their whole speed."""
        with np.errstate(all="ignore"):
            along = dot(self.vector, self.velocity) / self.length
        return np.where(np.asarray(self.length) == 0.0, np.abs(self.velocity), along)

    def along(self, pull: Number, where: str) -> Number:
        """Return a pull as a vector. Warns, naming `where`, where ends that meet give it no direction."""
        length, vector = np.asarray(self.length), np.asarray(self.vector)
        meeting = (length == 0.0) & (np.asarray(pull) != 0.0)
        if np.any(meeting):
            warn(f"{where}: its ends meet, where its force has no direction", LikelySlip)
        with np.errstate(all="ignore"):
            return np.where(length == 0.0, np.where(meeting, np.nan, 0.0), pull * vector / length)


@dataclass(frozen=True, eq=False, repr=False)
class BetweenPoints(Load):
    """A load along the line between points of two links.

    Its ends are the point `point` of `link` and the point `at` of the link `to`.
    """

    link: str = field(metadata=link_key("The link that one end is fixed to."))
    point: Any = field(metadata=spot_key("link", "Its end there: a point, or a place in the link's frame."))
    to: str = field(default=FRAME, kw_only=True, metadata=link_key("The link that the other end is fixed to."))
    at: Any = field(
        default="", kw_only=True, metadata=spot_key("to", "Its end there: a point, or a place in the link's frame.")
    )

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"{self.title} on {self.link}"

    def gap(self, at: LoadedPoses) -> EndGap:
        """Return the line between its ends."""
        between = at.place(self.to, self.at) - at.place(self.link, self.point)
        return EndGap(between.c[0], abs(between.c[0]), velocity_of(between))

    def attack(self, link: str) -> str | Number:
        """Return its end on a link."""
        return self.point if link == self.link else self.at

    @abstractmethod
    def pull(self, gap: EndGap, at: LoadedPoses) -> Number:
        """Return the force on its first end, a vector."""

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the force on both links."""
        gap = self.gap(at)
        pull = self.pull(gap, at)
        pulled = Wrench.at(at.place(self.link, self.point).c[0], pull)
        yield self.link, pulled
        yield self.to, -pulled


def velocity_of(series: Series) -> Number:
    """Return the velocity of a place; none of a motion without velocities."""
    return series.c[1] if len(series.c) > 1 else 0j


def as_spot(where: str, given: Any) -> Number | str:
    """Return a letter as it is, a place as a vector. Raises InvalidMechanism naming `where`.

    >>> as_spot("springs.arm.at", "S"), as_spot("springs.arm.at", (1, 2))
    ('S', (1+2j))
    """
    return given if isinstance(given, str) else vector(where, given)


def hold_ends(where: str, pair: str, link: str, beside: Mapping[str, Any]) -> None:
    """Raise InvalidMechanism for ends that are none, or of both sorts.

    `beside` has what is said and should not be.

    >>> hold_ends("springs.arm", "C", "", {"point": "A"})
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidMechanism: springs.arm.point: it is along the pair 'C'; leave point out
    """
    said = [key for key, value in beside.items() if not (isinstance(value, str | int | float) and value in ("", 0))]
    if not pair and not link:
        raise InvalidMechanism(Problem(where, "it has no ends", 'name a link and a point, or write pair="C"'))
    if said:
        what = f"it is along the pair {pair!r}" if pair else "it is between points, which have no coordinate"
        raise InvalidMechanism(Problem(f"{where}.{said[0]}", what, f"leave {', '.join(said)} out"))
