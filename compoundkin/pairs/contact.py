"""What pins in slots, cams and other contacts have in common: two links touch, and slide and roll on each other."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, NamedTuple

from compoundkin.errors import Problem, nearest
from compoundkin.pairs.contract import Ends, Line, Pair, Poses, table
from compoundkin.poses import Pose
from compoundkin.series import Number, Series


class Touch(NamedTuple):
    """Where two links touch or would touch, in the world: a point of their common normal, and their distance there.

    `normal` is a unit vector from the profile's link to the other; `gap` is zero where they touch.
    """

    place: Series
    normal: Series
    gap: Series


class Contact(Pair):
    """A higher pair that holds one coordinate, the distance along a common normal: first the link with the profile."""

    held: ClassVar[int] = 1

    link: str
    on: str

    @property
    def members(self) -> tuple[str, ...]:
        """The link that carries the profile and the one that runs on it."""
        return self.on, self.link

    @abstractmethod
    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Where the two links touch; away from contact, where they are nearest."""

    @abstractmethod
    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, Number, Number]:
        """A place, a direction and a factor: the coordinate's rate is the factor times the sliding velocity there."""

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """The distance along the common normal."""
        return (self.touch(ends, poses).gap,)

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Rows of the distance and of the sliding."""
        place, normal, _ = (series.c[0] for series in self.touch(ends, poses))
        at, along, factor = self.sliding(ends, poses)
        return table(_row(poses, place, normal), tuple(entry * factor for entry in _row(poses, at, along)))

    def centre(self, ends: Ends, poses: Poses) -> Line:
        """On the common normal."""
        place, normal, _ = (series.c[0] for series in self.touch(ends, poses))
        return Line(-normal.imag, normal.real, place.real * normal.imag - place.imag * normal.real)


def _row(poses: Poses, place: Number, along: Number) -> tuple[Number, ...]:
    """By how much the second link passes the first one at a place, in a direction, for each link's x, y, theta."""
    first, second = (along.real * arm.real + along.imag * arm.imag for arm in _arms(poses, place))
    return -along.real, -along.imag, -first, along.real, along.imag, second


def _arms(poses: Sequence[Pose], place: Number) -> tuple[Number, ...]:
    return tuple(1j * (place - pose.z.c[0]) for pose in poses)


def named_problems(
    links: Mapping[str, tuple[str, ...]], where: str, members: Mapping[str, str], points: Mapping[str, tuple[str, str]]
) -> Iterator[Problem]:
    """Links that there are not, one link twice, and points that their link does not have.

    `members` are links by the key that names them, `points` (link, letter) by theirs.
    """
    missing = [(key, name) for key, name in members.items() if name not in links]
    for key, name in missing:
        yield Problem(f"{where}.{key}", f"there is no link {name!r}", nearest(name, list(links)))
    if missing:
        return
    if len(set(members.values())) < len(members):
        key, name = list(members.items())[-1]
        yield Problem(f"{where}.{key}", f"{name!r} cannot run on itself", "name two links")
    for key, (link, letter) in points.items():
        if not letter:
            choice = f"name the one that is meant: {', '.join(links[link])}"
            yield Problem(f"{where}.{key}", f"link {link!r} has several points", choice)
        elif letter not in links[link]:
            remedy = nearest(letter, list(links[link]))
            yield Problem(f"{where}.{key}", f"link {link!r} has no point {letter!r}", remedy)
