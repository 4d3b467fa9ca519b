"""What every kind of kinematic pair answers; each kind lives in one file of this folder.

A pair reports the relative coordinates between its links: the first `held` of them stay zero, the others are free.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import joined
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import DeclaredKeys, NameWording, link_fields, name_problems, only_points, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.loop_terms import LoopTerms
from compoundkin.model.pairs.pose_rates import line_rows, moved_alone_in, row_at
from compoundkin.model.pairs.symbols import Mark


class Point(NamedTuple):
    """A relative instant centre at ``(x / w, y / w)``. It is at infinity in the direction (x, y) where w is zero.

    The free coordinate's rate times (x, y, w) is the motion of the second member relative to the first: the
    velocity of the point p is ``1j * (w * p - (x + 1j * y))`` times that rate.
    """

    x: Number
    y: Number
    w: Number


class Line(NamedTuple):
    """A line that a relative instant centre lies on. It is ``a x + b y + c w = 0``, such as a common normal."""

    a: Number
    b: Number
    c: Number


# A pair's sides on its members, in the members' own frames; and the members' poses.
Ends: TypeAlias = tuple[End, ...]
Poses: TypeAlias = tuple[Pose, ...]


@dataclass(frozen=True, eq=False)
class Pair(ABC):
    """A kinematic pair between two links, or two and their carrier. Kinds are frozen dataclasses, one file each."""

    name: str = field(
        default="",
        kw_only=True,
        metadata=value_key("name", "What the pair is called in reports; {called} where it is left out."),
    )

    code: ClassVar[str]  # the letter in a group's name
    title: ClassVar[str]  # "revolute pair"
    held: ClassVar[int]  # how many relative coordinates stay zero
    held_angles: ClassVar[tuple[int, ...]] = ()  # which of these are angles (else lengths)
    free: ClassVar[tuple[str, ...]]  # the names of the others; the first is its `coordinate`
    free_is_angle: ClassVar[bool]  # whether the coordinate is an angle (else a length)
    takes: ClassVar[tuple[str, ...]] = ()  # which of "effort", "friction", "pretension" may be written of it
    is_simple: ClassVar[bool] = False  # whether its coordinate only turns a member about a point, or only shifts it
    force_words: ClassVar[tuple[str, ...]] = ()  # what components of its force along its unit wrenches are called
    table: ClassVar[str] = ""  # its table in a mechanism file; "" for pairs that are not written out
    wording: ClassVar[NameWording] = NameWording()  # how it says what is wrong with its names
    keys = DeclaredKeys()  # the keys of its table in a mechanism file, by its fields

    def __post_init__(self) -> None:
        """A pair that is given no name has that of its links."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    @abstractmethod
    def members(self) -> tuple[str, ...]:
        """The two links, the one that carries the reference first. A third one is their carrier."""

    @property
    @abstractmethod
    def letters(self) -> tuple[str, ...]:
        """The names of the points it uses; the first is where it is drawn."""

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return "/".join(getattr(self, name) for name in link_fields(type(self))[:2])

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find what is wrong with the pair as written. `links` maps each link to its point names."""
        yield from name_problems(self, links, where, self.wording)

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Pair:
        """Return the pair with the points that its words leave open; itself without any."""
        found = only_points(self, links)
        return replace(self, **found) if found else self

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find what is wrong with its dimensions. Such are teeth that do not fit, a profile that crosses itself."""
        return iter(())

    @abstractmethod
    def ends(self, geometry: Geometry) -> Ends:
        """Return the pair's side on each member, in the members' own frames."""

    @abstractmethod
    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the held relative coordinates as series: zero where the pair is closed."""

    @abstractmethod
    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the (first) free relative coordinate as a series."""

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the derivatives of `closure` and then of `coordinate`.

        They go by x, y, theta of the first member, then of the second.

        Shape (..., held + 1, 3 members), at the leading coefficient of the poses. By series, unless a kind knows it.
        """
        fixed = tuple(End(*(side.c[0] if isinstance(side, Series) else side for side in end)) for end in ends)
        still = [pose.trimmed(0) for pose in poses]
        columns = []
        for k, pose in enumerate(still):
            for moved in moved_alone_in(pose):
                moving = (*still[:k], moved, *still[k + 1 :])
                rows = *self.closure(fixed, moving), self.coordinate(fixed, moving)
                columns.append([row.c[1] if len(row.c) > 1 else 0.0 for row in rows])
        return table(*zip(*columns, strict=True))

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return unit wrenches on the second member, the opposites on the first. Those by which it holds come first.

        There is one for each held coordinate; the last is that of an effort along the free coordinate. By the
        Jacobian, unless a kind knows the place where its force acts.
        """
        rows, origin = self.jacobian(ends, poses), poses[1].z.c[0]
        return tuple(
            Wrench.at(origin, joined(rows[..., k, 3], rows[..., k, 4]), rows[..., k, 5]) for k in range(self.held + 1)
        )

    @property
    def acts_at(self) -> str:
        """What the point is called about which the moment of its force is told."""
        return self.letters[0]

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return that point in the world."""
        return poses[1].at(ends[1].point).c[0]

    def centre(self, ends: Ends, poses: Poses) -> Point | Line:
        """Return the relative instant centre of the first two members. It is a point, or a line it must lie on.

        At the leading coefficient of the poses; which of the two it is depends on the kind of pair only. By the
        Jacobian, unless a kind knows it; with a carrier the members turn about their own points.
        """
        rows = self.jacobian(ends, poses)
        first, second = (line_rows(rows[..., 3 * k : 3 * k + 3], poses[k].z.c[0]) for k in range(2))
        if len(self.members) == 2 and self.held == 1:
            return Line(*second[0])
        if len(self.members) == 2:
            (a, b, c), (d, e, f), free = second
            place = b * f - c * e, c * d - a * f, a * e - b * d
            return Point(*(at / row_at(free, place) for at in place))
        axes = [pose.at(end.point).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True)]
        one, two = ((axis.real, axis.imag, 1.0) for axis in axes)
        turn, other = -row_at(second[0], two), row_at(first[0], one)
        rate = turn * row_at(first[-1], one) + other * row_at(second[-1], two)
        return Point(*((other * at - turn * before) / rate for before, at in zip(one, two, strict=True)))

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Tell whether a closed pair is in the way that is meant. Its closure alone does not tell."""
        return True

    @abstractmethod
    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw ends of random geometry in the world for rank tests. The pair is closed at their pose."""

    @property
    def rank_key(self) -> Hashable:
        """All that the rank of its generic Jacobian may depend on."""
        return type(self)

    def loop_terms(self, ends: Ends) -> LoopTerms | None:
        """Return what it adds to vector loops. None to have it from its lower pairs, or else from its closure."""
        return None

    def round_at(self, link: str) -> str | None:
        """Return the point about which a member may turn freely.

        The turn has no effect on the pair, such as that about a roller's pin.
        """
        return None

    @abstractmethod
    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the symbols of the pair, in the members' frames.

        `ends` are numbers, `poses` a whole motion (poses,).
        """


def table(*rows: tuple[Number, ...]) -> Number:
    """Join Jacobian rows of equal length in one array (..., rows, columns). The rows are numbers or arrays.

    >>> table((1.0, 0.0, np.zeros(2), 0.0, 0.0, 0.0)).shape
    (2, 1, 6)
    """
    shape = np.broadcast_shapes(*{getattr(entry, "shape", ()) for row in rows for entry in row})
    out = np.empty((*shape, len(rows), len(rows[0]))) if shape else np.array(rows, dtype=float)  # one pose: at once
    for i, row in enumerate(rows if shape else ()):
        for j, entry in enumerate(row):
            out[..., i, j] = entry
    return out
