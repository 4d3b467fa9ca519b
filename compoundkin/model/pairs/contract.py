"""The contract of a kinematic pair, with the optional answers that only some kinds give.

A pair reports the relative coordinates between its links: the first `held` of them stay zero, the others are free.
Each kind lives in one file; each optional answer has one function that asks for it, such as `as_drivable`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, complex_of
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import NORMAL, TANGENTIAL
from compoundkin.model.fields import (
    DeclaredKeys,
    Item,
    NameWording,
    implied_points,
    link_fields,
    name_problems,
    value_key,
)
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.symbols import Mark

if TYPE_CHECKING:
    from compoundkin.model.pairs.loop_terms import LoopTerms


class Point(NamedTuple):
    """A relative instant centre at ``(x / w, y / w)``, at infinity in the direction (x, y) where w is zero.

    The free coordinate's rate times (x, y, w) is the motion of the second member relative to the first: the
    velocity of the point p is ``1j * (w * p - (x + 1j * y))`` times that rate.
    """

    x: Number
    y: Number
    w: Number


class Line(NamedTuple):
    """A line ``a x + b y + c w = 0`` through a relative instant centre, such as a common normal."""

    a: Number
    b: Number
    c: Number


class DimensionFit(NamedTuple):
    """What of a pair's dimensions must fit: `room` is above zero where it does.

    Else `words`, texts and numbers, tell what is wrong with the key `key`, and `remedy` what to do.
    """

    key: str
    room: Number
    words: tuple[str | Number, ...]
    remedy: str


def misfit_problems(fits: Iterable[DimensionFit], where: str) -> Iterator[Problem]:
    """Find the first of a pair's fits that no design has. The others of several designs are not assembled."""
    for one in fits:
        is_off = ~np.asarray(one.room > 0.0)
        if np.all(is_off) if np.ndim(is_off) > 1 else np.any(is_off):
            at = int(np.argmax(is_off))
            yield Problem(
                f"{where}.{one.key}", "".join(_word(word, is_off.shape, at) for word in one.words), one.remedy
            )
            return


def _word(word: str | Number, shape: tuple[int, ...], at: int) -> str:
    return word if isinstance(word, str) else f"{np.ravel(np.broadcast_to(word, shape))[at]:.6g}"


# A pair's sides on its members, in the members' own frames; and the members' poses.
Ends: TypeAlias = tuple[End, ...]
Poses: TypeAlias = tuple[Pose, ...]


@dataclass(frozen=True, eq=False)
class Pair(Item, ABC):
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
    takes: ClassVar[
        tuple[str, ...]
    ] = ()  # which of "effort", "friction", "efficiency", "pretension" may be written of it
    is_simple: ClassVar[bool] = False  # whether its coordinate only turns a member about a point, or only shifts it
    is_geared: ClassVar[bool] = False  # whether its closure is linear in its members' angles
    force_words: ClassVar[tuple[str, ...]] = ()  # what components of its force along its unit wrenches are called
    table: ClassVar[str] = ""  # its table in a mechanism file; "" for pairs that are not written out
    wording: ClassVar[NameWording] = NameWording()  # how it says what is wrong with its names
    keys = DeclaredKeys()  # the keys of its table in a mechanism file, by its fields

    def __post_init__(self) -> None:
        """A pair without a name is named after its links."""
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
        """Its default name."""
        return "/".join(getattr(self, name) for name in link_fields(type(self))[:2])

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find problems of the pair's definition. `links` maps each link to its point names."""
        yield from name_problems(self, links, where, self.wording)

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Pair:
        """Return the pair with omitted points filled in; itself where there are none."""
        found = implied_points(self, links)
        return replace(self, **found) if found else self

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find problems of its dimensions, such as a line without direction or a profile that crosses itself."""
        return iter(())

    def fits(self, geometry: Geometry) -> tuple[DimensionFit, ...]:
        """Return what must fit, such as teeth and axes. A design that does not is not assembled."""
        return ()

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
        """Return the derivatives of `closure` and then of `coordinate` by x, y, theta of each member.

        Shape (..., held + 1, 3 members), at the leading coefficient of the poses. By series by default.
        """
        fixed = tuple(End(*(side.c[0] if isinstance(side, Series) else side for side in end)) for end in ends)
        still = [pose.trimmed(0) for pose in poses]
        columns = []
        for k, pose in enumerate(still):
            for moved in unit_motions(pose):
                moving = (*still[:k], moved, *still[k + 1 :])
                rows = *self.closure(fixed, moving), self.coordinate(fixed, moving)
                columns.append([row.c[1] if len(row.c) > 1 else 0.0 for row in rows])
        return jacobian_of_rows(*zip(*columns, strict=True))

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return unit wrenches on the second member; their opposites act on the first.

        There is one for each held coordinate; the last is that of an effort along the free coordinate. By the
        Jacobian, unless a kind knows the place where its force acts.
        """
        rows, origin = self.jacobian(ends, poses), poses[1].z.c[0]
        return tuple(
            Wrench.at(origin, complex_of(rows[..., k, 3], rows[..., k, 4]), rows[..., k, 5])
            for k in range(self.held + 1)
        )

    @property
    def extent(self) -> float:
        """The size of its profile; zero for a pair without one."""
        return 0.0

    @property
    def acts_at(self) -> str:
        """The name of the reference point of its moment."""
        return self.letters[0]

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the reference point in the world."""
        return poses[1].at(ends[1].point).c[0]

    def centre(self, ends: Ends, poses: Poses) -> Point | Line:
        """Return the relative instant centre of the first two members: a point, or a line through it.

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
            return Point(*(at / line_at(free, place) for at in place))
        axes = [pose.at(end.point).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True)]
        one, two = ((axis.real, axis.imag, 1.0) for axis in axes)
        turn, other = -line_at(second[0], two), line_at(first[0], one)
        rate = turn * line_at(first[-1], one) + other * line_at(second[-1], two)
        return Point(*((other * at - turn * before) / rate for before, at in zip(one, two, strict=True)))

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Return whether a closed pair is assembled as intended, which its closure alone does not determine."""
        return True

    @abstractmethod
    def generic(self, rng: np.random.Generator) -> Ends:
        """Return random ends in the world, at which the pair is closed, for rank tests."""

    @property
    def rank_key(self) -> Hashable:
        """The key on which the rank of its generic Jacobian depends."""
        return type(self)

    def loop_terms(self, ends: Ends) -> LoopTerms | None:
        """Return its terms in vector loops; None to use its lower pairs, or else its closure."""
        return None

    def round_at(self, link: str) -> str | None:
        """Return the point about which a member may turn without effect on the pair, such as a roller's pin."""
        return None

    @abstractmethod
    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the symbols of the pair, in the members' frames, for ends of numbers and poses (poses,)."""


def jacobian_of_rows(*rows: tuple[Number, ...]) -> Number:
    """Join Jacobian rows of equal length in one array (..., rows, columns). The rows are numbers or arrays.

    >>> jacobian_of_rows((1.0, 0.0, np.zeros(2), 0.0, 0.0, 0.0)).shape
    (2, 1, 6)
    """
    shape = np.broadcast_shapes(*{getattr(entry, "shape", ()) for row in rows for entry in row})
    out = np.empty((*shape, len(rows), len(rows[0]))) if shape else np.array(rows, dtype=float)  # one pose: at once
    for i, row in enumerate(rows if shape else ()):
        for j, entry in enumerate(row):
            out[..., i, j] = entry
    return out


class DrawnNumbers(Pair):
    """A pair that may read some of its numbers off the drawing."""

    @abstractmethod
    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the fields that are drawn and not stated, by the pair's ends."""


class DrawnGuide(DrawnNumbers):
    """A guide whose offset and whose block's turn may be drawn."""

    link: str
    on: str
    through: str

    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the drawn offset and turn, as far as they are not stated."""
        if not ({self.on, self.link} <= geometry.as_drawn and self.on in geometry.drawn):
            return {}
        guide, block = ends
        away = np.conjugate(guide.along.c[0]) * (guide.point - geometry.points[self.on][self.through])
        drawn = {"offset": away.imag, "turn": 0.0 - np.angle(block.along.c[0])}
        return {name: value for name, value in drawn.items() if getattr(self, name) is None}


class DrawnPhase(DrawnNumbers):
    """A pair of wheels whose phase may be drawn. It is on their carrier, else on the first member."""

    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the drawn phase, unless it is stated."""
        is_drawn = all(name in geometry.drawn for name in self.members)
        return {"phase": ends[2 % len(ends)].measure} if getattr(self, "phase", 0.0) is None and is_drawn else {}


def drawn_fields(pair: Pair, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
    """Return what a pair reads off the drawing, by its fields."""
    return pair.read_off(ends, geometry) if isinstance(pair, DrawnNumbers) else {}


class Drivable(Pair):
    """A pair that a driver may prescribe: its coordinate is its only freedom."""

    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    @abstractmethod
    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the second member's pose in the first one's frame, for the coordinate `free`."""

    def driven_by(self, link: str) -> int:
        """Return +1 if driving `link` drives the coordinate itself, else -1."""
        return 1

    def effort(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the torque or thrust of a wrench on the second member: its power at unit rate of the coordinate."""
        x, y, w = self.centre(ends, poses)
        return wrench.force.real * y - wrench.force.imag * x + wrench.moment * w

    def drawn_coordinate(self, ends: Ends, poses: Poses) -> Number:
        """Return the free coordinate at the members' drawn poses."""
        return self.coordinate(ends, poses).c[0]

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return the free coordinate by other poses and points of the drawing; None where it is that of its members."""
        return None

    def drawn_length(self, sketch: Mapping[str, Number]) -> Number | None:
        """Return the absolute value of the free coordinate by drawn points alone, None where it takes poses."""
        return None


def as_drivable(pair: Pair) -> Drivable | None:
    """Return a pair as a drivable one, or None."""
    return pair if isinstance(pair, Drivable) else None


class DrawnPair(NamedTuple):
    """A pair in a drawing: its ends, the known poses of its members, and the places of letters."""

    ends: Ends
    poses: tuple[Pose | None, ...]
    sketch: Mapping[str, Number]


class Orienting(Pair):
    """A pair from which a member's angle follows by the others' poses, such as a slide, a gear, a wheel."""

    @abstractmethod
    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the angle of the member `own`, or None if it does not follow."""


def as_orienting(pair: Pair) -> Orienting | None:
    """Return a pair as an orienting one, or None."""
    return pair if isinstance(pair, Orienting) else None


class TurnCounting(DrawnPhase, Orienting):
    """A pair that needs its members' angles with full turns, such as a gear, a belt, a rack, a rolling wheel."""

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends for members' angles that are whole `turns` from the drawn ones."""
        return ends

    def stated_turns(self, ends: Ends, angles: tuple[Number, ...], own: Sequence[int]) -> Number:
        """Return the whole turns by which members, one body, are ahead of all members' drawn angles, by a stated phase.

        Zero without one, or where it does not tell.
        """
        return 0.0

    def with_driver_turns(self, ends: Ends, geometry: Geometry, turns: Number) -> Ends:
        """Return the ends of a driven pair for whole `turns` of its coordinate from the drawn one."""
        return ends

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Return whether `closure` is linear in the coordinate of the pair `lower` of the member `own`."""
        return False

    def distance_error(self, ends: Ends, poses: Poses) -> Series | None:
        """Return a length that other pairs must hold at zero, or None."""
        return None


def as_turn_counting(pair: Pair) -> TurnCounting | None:
    """Return a pair as a turn-counting one, or None."""
    return pair if isinstance(pair, TurnCounting) else None


class Guided(Pair):
    """A pair with a guide on the first member. A point of the second runs along it."""

    def guided(self, ends: Ends) -> Number:
        """Return this point, in the frame of its link."""
        return ends[1].point


def guided_point(pair: Pair, ends: Ends) -> Number | None:
    """Return the point of the second member that runs along a guide, or None."""
    return pair.guided(ends) if isinstance(pair, Guided) else None


class StraightLine(Pair):
    """A pair along a line of its first member: through a point, in a direction or toward a second point."""

    line_word: ClassVar[str] = "line"  # what messages call it

    at: str
    through: str
    angle: Number
    toward: str | None

    @property
    def letters(self) -> tuple[str, ...]:
        """The point on the line and the points that fix it."""
        return (self.at, self.through) if self.toward is None else (self.at, self.through, self.toward)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find also a line from a point to itself."""
        yield from super().problems(links, where)
        if self.toward == self.through:
            yield Problem(f"{where}.toward", f"a {self.line_word} from {self.through!r} to itself has no direction")

    def line(self, geometry: Geometry) -> tuple[Number, Number]:
        """Return a point of the line and its direction, in the first member's frame."""
        points = geometry.points[self.members[0]]
        start = points[self.through]
        if self.toward is None:
            return start, np.cos(self.angle) + 1j * np.sin(self.angle)
        return start, (points[self.toward] - start) / np.abs(points[self.toward] - start)

    def line_problems(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find two coincident points of the line."""
        points = geometry.points[self.members[0]]
        if self.toward is not None and not np.all(np.abs(points[self.toward] - points[self.through]) > 0):
            what = (
                f"{self.through!r} and {self.toward!r} are at one place, so that the {self.line_word} has no direction"
            )
            yield Problem(f"{where}.toward", what, "name another point or give an angle")


class Equivalent(NamedTuple):
    """The lower pairs, and the link between them, that are equivalent to a higher pair at every pose.

    `pairs` join `link` to the first and to the second member; `ends` are their sides by their names.
    """

    link: str
    pairs: tuple[Drivable, Drivable]
    ends: Mapping[str, Ends]


class Osculation(NamedTuple):
    """The centres of curvature of two members' profiles at their contact, in the world.

    None for a straight one. A bar between the centres, or a block on the straight profile pinned at the other one's
    centre, gives the members the same velocities and accelerations. `normal` is a unit vector between the centres.
    """

    first: Number
    second: Number
    normal: Number


class Replaceable(Pair):
    """A higher pair with equivalent lower pairs, at every pose or for velocities and accelerations at one."""

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """Return the equivalent lower pairs; None where the dimensions allow none."""
        return None

    def osculation(self, ends: Ends, poses: Poses) -> Osculation | None:
        """Return the centres of curvature at the leading coefficient of the poses, or None."""
        return None


def lower_equivalent(pair: Pair, ends: Ends) -> Equivalent | None:
    """Return the lower pairs equivalent to a pair at every pose, or None."""
    return pair.equivalent(ends) if isinstance(pair, Replaceable) else None


def osculation(pair: Pair, ends: Ends, poses: Poses) -> Osculation | None:
    """Return the centres of curvature of a higher pair, or None."""
    return pair.osculation(ends, poses) if isinstance(pair, Replaceable) else None


class TransmittingPair(Pair):
    """A pair whose transmitted force comes with forces that do no work: teeth part wheels, strands pull pulleys."""

    @abstractmethod
    def transmitted(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the share of its unit wrench in a wrench on the second member."""

    @abstractmethod
    def accompanying(self, ends: Ends, poses: Poses, transmitted: Number, pretension: Number | None = None) -> Wrench:
        """Return the wrench without work that comes with a transmitted force, on the second member.

        `pretension` is the pull in each strand at rest, None for a chain that hangs loose.
        """


def as_transmitting_pair(pair: Pair) -> TransmittingPair | None:
    """Return a pair as a transmitting one, or None."""
    return pair if isinstance(pair, TransmittingPair) else None


def constraint_scales(pair: Pair, size: Number) -> tuple[Number, ...]:
    """Return the scale of each held coordinate: 1 for angles, the size for lengths."""
    return tuple(1.0 if k in pair.held_angles else size for k in range(pair.held))


class RollingContact(Pair):
    """A wheel that rolls without slip; its normal and tangential forces act at the contact."""

    force_words: ClassVar[tuple[str, ...]] = (NORMAL, TANGENTIAL)

    @abstractmethod
    def contact(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the place of contact, and the unit normal there into the wheel."""

    @property
    def acts_at(self) -> str:
        """The contact."""
        return "contact"

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the place of contact."""
        return self.contact(ends, poses)[0]


class BeltDrive(TransmittingPair):
    """Two pulleys with a belt, whose two strands pull."""

    @abstractmethod
    def strands(self, ends: Ends, poses: Poses) -> tuple[Wrench, Wrench]:
        """Return the wrench of a unit pull in each strand on the second pulley."""


def as_belt_drive(pair: Pair) -> BeltDrive | None:
    """Return a pair as a belt drive, or None."""
    return pair if isinstance(pair, BeltDrive) else None


def line_rows(rows: Number, z: Number) -> list[tuple[Number, Number, Number]]:
    """Return the line (a, b, c) of each row of a Jacobian: a twist about (x, y, w) changes ``a x + b y + c w``."""
    across = np.moveaxis(rows, (-2, -1), (0, 1))
    return [(-y, x, turn + y * z.real - x * z.imag) for x, y, turn in across]


def line_at(line: tuple[Number, ...], place: tuple[Number, ...]) -> Number:
    """Return the value of a line at a place in homogeneous coordinates."""
    return sum(own * at for own, at in zip(line, place, strict=True))


def unit_motions(pose: Pose) -> Iterator[Pose]:
    """Yield a pose that moves at unit rate in x, in y and in angle."""
    yield Pose(Series((pose.z.c[0], 1.0 + 0j)), pose.u, pose.theta)
    yield Pose(Series((pose.z.c[0], 1j)), pose.u, pose.theta)
    theta = None if pose.theta is None else Series((pose.theta.c[0], 1.0))
    yield Pose(pose.z, Series((pose.u.c[0], 1j * pose.u.c[0])), theta)
