"""What every kind of kinematic pair answers; each kind lives in one file of this folder.

A pair reports the relative coordinates between its links. The first `held` of them must stay zero (the
constraint); the others are free, and are what a drive may prescribe.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Mapping
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.loop_terms import LoopTerms
from compoundkin.model.pairs.symbols import Mark


class Point(NamedTuple):
    """A relative instant centre at ``(x / w, y / w)``, at infinity in the direction (x, y) where w is zero.

    The free coordinate's rate times (x, y, w) is the motion of the second member relative to the first: the
    velocity of the point p is ``1j * (w * p - (x + 1j * y))`` times that rate.
    """

    x: Number
    y: Number
    w: Number


class Line(NamedTuple):
    """The line ``a x + b y + c w = 0`` that a relative instant centre lies on, such as a common normal."""

    a: Number
    b: Number
    c: Number


# A pair's sides on its members, in the members' own frames; and the members' poses.
Ends: TypeAlias = tuple[End, ...]
Poses: TypeAlias = tuple[Pose, ...]


class Equivalent(NamedTuple):
    """Two lower pairs and a link between them that stand for a higher pair at every pose, not at one only.

    `pairs` join `link` to the first and to the second member; `ends` are their sides by their names.
    """

    link: str
    pairs: tuple[Pair, Pair]
    ends: Mapping[str, Ends]


class Osculation(NamedTuple):
    """Where the profiles of two members have their centres of curvature while they touch, in the world.

    None for a straight one. A bar between the centres, or a block on the straight profile pinned at the other one's
    centre, gives the members the same velocities and accelerations. `normal` is a unit vector between the centres.
    """

    first: Number
    second: Number
    normal: Number


class Freedom(NamedTuple):
    """How a body moves as a coordinate grows at unit rate: about a point of the world, `sense` +1 counterclockwise; or,
    where `about` is None, in the direction `along`."""

    about: Number
    along: Number
    sense: Number


class Pair(ABC):
    """A kinematic pair between two links, or two and their carrier; kinds are frozen dataclasses, one file each."""

    code: ClassVar[str]  # the letter in a group's name
    title: ClassVar[str]  # "revolute pair"
    held: ClassVar[int]  # how many relative coordinates stay zero
    free: ClassVar[tuple[str, ...]]  # the names of the others; the first is its `coordinate`
    free_is_angle: ClassVar[bool]  # whether the coordinate is an angle (else a length)
    counts_turns: ClassVar[bool] = False  # whether it asks for its members' angles with full turns
    is_simple: ClassVar[bool] = False  # whether its coordinate only turns a member about a point, or only shifts it
    has_profile: ClassVar[bool] = (
        False  # whether it leads a member along a profile, so that it has `contact_candidates`
    )
    adds_angles: ClassVar[bool] = False  # whether its closure is a sum of its members' angles times constants
    table: ClassVar[str] = ""  # its table in a mechanism file; "" for pairs that are not written out
    keys: ClassVar[tuple[Key, ...]] = ()

    name: str

    @property
    @abstractmethod
    def members(self) -> tuple[str, ...]:
        """The two links, the one that carries the reference first; a third one is their carrier."""

    @property
    @abstractmethod
    def letters(self) -> tuple[str, ...]:
        """The names of the points it uses; the first is where it is drawn."""

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return "/".join(reversed(self.members))

    @abstractmethod
    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """What is wrong with the pair as written; `links` maps each link to its point names."""

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Pair:
        """The pair with what its words leave to be understood filled in."""
        return self

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """What is wrong with its dimensions: teeth that do not fit, a profile that crosses itself."""
        return iter(())

    @abstractmethod
    def ends(self, geometry: Geometry) -> Ends:
        """The pair's side on each member, in the members' own frames."""

    @abstractmethod
    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """The held relative coordinates as series: zero where the pair is closed."""

    @abstractmethod
    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """The (first) free relative coordinate as a series."""

    def drawn_coordinate(self, sketch: Mapping[str, Number]) -> Number | None:
        """The free coordinate as drawn points alone show it, without the links' poses; None where they do not."""
        return None

    @abstractmethod
    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """The derivatives of `closure` and then `coordinate` by x, y, theta of the first member, then of the second.

        Shape (..., held + 1, 3 members), at the leading coefficient of the poses.
        """

    def centre(self, ends: Ends, poses: Poses) -> Point | Line | None:
        """Where the relative instant centre of the first two members is: a point, a line it must lie on, or nothing.

        At the leading coefficient of the poses; which of the three it is depends on the kind of pair only.
        """
        return None

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Whether a closed pair is in the way that is meant, where its closure does not tell."""
        return True

    @property
    def coordinate_scale(self) -> float:
        """The scale of its coordinate where it has a profile."""
        return 1.0

    @property
    def has_ends(self) -> bool:
        """Whether it has an open profile, which its contact may run off."""
        return False

    @property
    def extent(self) -> float:
        """The size of its profile, where it has one: a length scale of the mechanism."""
        return 0.0

    @property
    def is_drivable(self) -> bool:
        """Whether a driver may prescribe its coordinate: where nothing else is free."""
        return self.held == 2

    def placed(self, ends: Ends, free: Series) -> Pose:
        """The pose of the second member in the first one's frame when the coordinate is `free`; of drivable pairs."""
        raise NotImplementedError(f"a {self.title} leaves more than one coordinate free")

    @abstractmethod
    def generic(self, rng: np.random.Generator) -> Ends:
        """Ends of random geometry in the world at a pose where the pair is closed, for rank tests."""

    @property
    def rank_key(self) -> Hashable:
        """All that the rank of its generic Jacobian may depend on."""
        return type(self)

    def driven_by(self, link: str) -> int:
        """+1 if driving `link` drives the coordinate itself, -1 if its opposite."""
        return 1

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Whether `closure` grows in proportion to the coordinate of the pair `lower`, on which the member `own` is."""
        return False

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """The lower pairs that stand for a higher pair at every pose, where there are such."""
        return None

    def distance_error(self, ends: Ends, poses: Poses) -> Series | None:
        """A length that must be zero though the pair does not hold it: other pairs must; None where there is none."""
        return None

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """The ends of a pair that counts turns where its members' angles are by whole `turns` from the drawn ones."""
        return ends

    def contact_candidates(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> tuple[Number, Number]:
        """The coordinates at which a member of one freedom is in contact in mode -1 and +1, nearly; of pairs that lead.

        `poses` are those where the coordinate is zero; NaN where there is no contact. The modes are those of the lower
        pairs that stand for a round disc.
        """
        raise NotImplementedError(f"a {self.title} has no profile")

    def smooth_piece(self, ends: Ends, poses: Poses) -> Number:
        """On which smooth piece of its profile a pair is, an index: derivatives may jump from one to the next."""
        return 0

    def no_contact_reason(self) -> str:
        """Why a member has no contact where there are no candidates, in a sentence."""
        return f"{self.name} does not close"

    def loop_terms(self, ends: Ends) -> LoopTerms | None:
        """Return what it adds to vector loops; None to have it from its lower pairs, or else from its closure."""
        return None

    def osculation(self, ends: Ends, poses: Poses) -> Osculation | None:
        """The centres of curvature of a higher pair at the leading coefficient of the poses; None for other pairs."""
        return None

    def with_driver_turns(self, ends: Ends, geometry: Geometry, turns: Number) -> Ends:
        """The ends of a driven pair that counts turns where its coordinate is by whole `turns` from the drawn one."""
        return ends

    def round_at(self, link: str) -> str | None:
        """The point about which a member may turn without any effect on the pair, such as a roller's pin."""
        return None

    @abstractmethod
    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """What there is to see of it, in the members' frames: `ends` are numbers, `poses` a whole motion (poses,)."""


def table(*rows: tuple[Number, ...]) -> Number:
    """Jacobian rows of equal length, numbers or arrays, as one array (..., rows, columns).

    >>> table((1.0, 0.0, np.zeros(2), 0.0, 0.0, 0.0)).shape
    (2, 1, 6)
    """
    shape = np.broadcast_shapes(*[np.shape(entry) for row in rows for entry in row])
    out = np.empty((*shape, len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            out[..., i, j] = entry
    return out
