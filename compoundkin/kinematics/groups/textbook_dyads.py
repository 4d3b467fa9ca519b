"""The textbook routines: a point of a link, and the five dyads, as plain functions of moving points and lines."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number, entry, is_number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotAssembled, Problem, UnassembledPoses, warn
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series, constant
from compoundkin.kinematics.groups.dyad import COINCIDENT, DyadSolver, OuterPair
from compoundkin.kinematics.groups.prp import PRP
from compoundkin.kinematics.groups.rpp import RPP
from compoundkin.kinematics.groups.rpr import RPR
from compoundkin.kinematics.groups.rrp import RRP
from compoundkin.kinematics.groups.rrr import RRR
from compoundkin.kinematics.motion import PointMotion
from compoundkin.model.geometry import vector

RIGHT_ANGLE = np.pi / 2.0


# The origin of a link's own frame, and its x axis.
ORIGIN, X_AXIS = 0j, 1 + 0j


@checked
def link(line: MovingLine, along: Any, across: Any = 0.0) -> MovingPoint:
    """Return the motion of a link's point from that of a line.

    The line belongs to the link; the point is so far `along` it from the line's own point, and `across` to its left,
    numbers or arrays that broadcast. Raises InvalidInput for what does not. Source: the velocity is v + omega x r, the
    acceleration a + alpha x r - omega^2 r.

    >>> crank = MovingLine((0, 0), angle=[0.0, RIGHT_ANGLE], angular_velocity=3.0)
    >>> link(crank, 2.0).velocity.round(12).tolist()
    [6j, (-6+0j)]
    """
    x, y = _finite("along", along), _finite("across", across)
    shape = shape_of(line=line, along=x, across=y)
    return _point(line.point.series + line.along * (x + 1j * y), shape)


@checked
def line_through(a: Any, b: Any) -> MovingLine:
    """Return the line from one moving point through another.

    Both are points of one link, or of two; each a MovingPoint, a point of a motion, or a place at rest. Raises
    InvalidInput where they coincide. Source: as `link`, solved for omega and alpha.

    >>> line_through((1, 0), MovingPoint((1, 2), velocity=(-6, 0))).angular_velocity
    3.0
    """
    one, two = point_of("a", a), point_of("b", b)
    shape = shape_of(a=one, b=two)
    way = two.series - one.series
    if np.any(np.abs(way.c[0]) <= COINCIDENT * (np.abs(one.position) + np.abs(two.position))):
        raise InvalidInput(Problem("b", "a and b coincide, so that the line has no direction", "give two places"))
    angle = way.unit().angle()
    return MovingLine(one, *(np.broadcast_to(angle.derivative(k), shape) for k in range(3)))


@checked
def rrr(a: Any, b: Any, first_length: Any, second_length: Any, mode: Any = 1) -> SolvedDyad:
    """Solve the RRR dyad: two links, pinned to `a`, `b` and each other.

    `a`, `b` are each a MovingPoint, a point of a motion, or a place at rest; lengths are numbers or arrays that
    broadcast. Mode +1: a, the inner pin and b run counterclockwise. The links are the lines from `a` and from `b` to
    the inner pin. Raises InvalidInput for what does not fit, NotAssembled where no pose can be assembled; warns
    UnassembledPoses where some cannot.

    >>> rrr((0, 0), (6, 0), 5.0, 5.0, mode=-1).inner.position
    (3+4j)
    """
    one, two = point_of("a", a), point_of("b", b)
    r1, r2 = _length("first_length", first_length), _length("second_length", second_length)
    sides = _pin(one), (End(r1 + 0j), End(r2 + 0j)), _pin(two)
    found = DyadData.of(sides, mode, a=one, b=two, first_length=r1, second_length=r2).closed(RRR)
    first, second = found.poses
    return found.told(first.at(r1 + 0j), ((first.z, first.u), (second.z, second.u)))


@checked
def rrp(a: Any, guide: MovingLine, length: Any, offset: Any = 0.0, mode: Any = 1) -> SolvedDyad:
    """Solve the RRP dyad: a rod pinned to `a` and to a sliding block.

    The block slides along `guide`, the inner pin `offset` to the left of it. Mode +1: the pin is the one farther along
    the guide. The links are the line from `a` to the inner pin, and that through the inner pin along the guide; the
    travel is counted from the guide's point. Arguments, errors and warnings as of `rrr`.

    >>> rrp((0, 3), MovingLine((0, 0), 0.0), 5.0).travels[0].value
    4.0
    """
    one, r, e = point_of("a", a), _length("length", length), _finite("offset", offset)
    sides = _pin(one), (End(r + 0j), End(1j * e)), _guide(guide)
    found = DyadData.of(sides, mode, a=one, guide=guide, length=r, offset=e).closed(RRP)
    rod, block = found.poses
    inner = rod.at(r + 0j)
    return found.told(inner, ((rod.z, rod.u), (inner, block.u)), _travel(guide, inner))


@checked
def rpr(a: Any, b: Any, offset: Any = 0.0, mode: Any = 1) -> SolvedDyad:
    """Solve the RPR dyad: a guide pinned to `a`, its block to `b`.

    The guide runs through `a`, and `b` is `offset` to its left. Mode +1: b is farther along the guide than a. The links
    are the guide's line at `a` and the block's at `b`, both in the guide's direction; `inner` is the foot of `b` on the
    guide, and the travel its way from `a`. Arguments, errors and warnings as of `rrr`.

    >>> round(rpr((0, 0), (0, 5), offset=3.0).travels[0].value, 12)
    4.0
    """
    one, two, e = point_of("a", a), point_of("b", b), _finite("offset", offset)
    sides = _pin(one), (End(ORIGIN, X_AXIS), End(ORIGIN, X_AXIS)), _pin(two, 1j * e)
    found = DyadData.of(sides, mode, a=one, b=two, offset=e).closed(RPR)
    rocker, block = found.poses
    travel = rocker.u.dot(block.z - rocker.z)
    return found.told(block.z, ((rocker.z, rocker.u), (block.at(1j * e), block.u)), travel)


@checked
def prp(first: MovingLine, second: MovingLine, first_offset: Any = 0.0, second_offset: Any = 0.0) -> SolvedDyad:
    """Solve the PRP dyad: two blocks, each on its guide, pinned together.

    The inner pin runs so far to the left of each guide. The links are the lines through the inner pin along the guides,
    the travels are counted from the guides' points. There is one mode. Errors and warnings as of `rrr`.

    >>> trammel = prp(MovingLine((0, 0), 0.0), MovingLine((3, 4), RIGHT_ANGLE))
    >>> [round(travel.value, 12) for travel in trammel.travels]
    [3.0, -4.0]
    """
    e1, e2 = _finite("first_offset", first_offset), _finite("second_offset", second_offset)
    sides = _guide(first), (End(1j * e1), End(1j * e2)), _guide(second)
    found = DyadData.of(sides, first=first, second=second, first_offset=e1, second_offset=e2).closed(PRP)
    one, two = found.poses
    inner = one.at(1j * e1)
    return found.told(inner, ((inner, one.u), (inner, two.u)), _travel(first, inner), _travel(second, inner))


@checked
def rpp(a: Any, guide: MovingLine, angle: Any = RIGHT_ANGLE, offset: Any = 0.0) -> SolvedDyad:
    """Solve the RPP dyad: a pinned link on a slide of a sliding one.

    The first is pinned to `a`; the second slides along `guide` and carries a line that crosses it at an `angle`
    (radians), with `a` so far to its left as `offset` says. The links are that line's direction at `a`, and the line
    itself where it crosses the guide; `inner` is the foot of `a` on it. The travels are that of the foot from the
    crossing, and that of the crossing from the guide's point. There is one mode. Errors and warnings as of `rrr`.

    >>> [round(travel.value, 12) for travel in rpp((3, 4), MovingLine((0, 0), 0.0)).travels]     # a Scotch yoke
    [4.0, 3.0]
    """
    one, turn, e = point_of("a", a), _finite("angle", angle), _finite("offset", offset)
    sides = _pin(one), (End(-1j * e, X_AXIS), End(ORIGIN, np.exp(1j * turn))), _guide(guide)
    found = DyadData.of(sides, a=one, guide=guide, angle=turn, offset=e).closed(RPP)
    rod, yoke = found.poses
    foot = rod.at(-1j * e)
    travels = rod.u.dot(foot - yoke.z), _travel(guide, yoke.z)
    return found.told(foot, ((rod.z, rod.u), (yoke.z, rod.u)), *travels)


def _pin(point: MovingPoint, local: Number = ORIGIN) -> OuterPair:
    """Return a pin on a moving point, and where the link has it."""
    return OuterPair(End(point.series), End(local))


def _guide(line: MovingLine) -> OuterPair:
    """Return a slide along a moving line, on which a block's own x axis lies."""
    return OuterPair(End(line.point.series, line.along), End(ORIGIN, X_AXIS))


def _travel(guide: MovingLine, place: Series) -> Series:
    """Return how far a place is along a guide from the guide's point."""
    return guide.along.dot(place - guide.point.series)


def _point(series: Series, shape: tuple[int, ...]) -> MovingPoint:
    return MovingPoint(*(np.broadcast_to(series.derivative(k), shape) for k in range(3)))


def _finite(where: str, given: Any) -> Number:
    """Return real numbers; raises InvalidInput where one is not finite."""
    found = numbers_of(where, given)
    if not np.all(np.isfinite(found)):
        raise InvalidInput(Problem(where, "it is not finite", "give numbers"))
    return found


def _length(where: str, given: Any) -> Number:
    """Return lengths; raises InvalidInput where one is not above 0."""
    found = _finite(where, given)
    if not np.all(found > 0.0):
        raise InvalidInput(Problem(where, f"{np.min(found):g} is no length of a link", "give one above 0"))
    return found


# The letters of the outer pairs and the inner one, in what is said of a dyad that cannot be assembled.
LETTERS = ("A", "C", "B")


LEGEND = "A and B are the outer pairs, C is the inner one"


# What a solver of a dyad asks for.
Sides = tuple[OuterPair, tuple[End, End], OuterPair]


@dataclass(frozen=True, eq=False, repr=False)
class SolvedDyad(ShortRepr):
    """Two links found: the motion of their inner pair and of both. Numbers or arrays of the shape of what was given.

    `inner` is the inner pin, or the place on a guide where its block is; `first` and `second` are the two links, each a
    line of its own (see the routine), angles between -pi and pi; `travels` are those of the slides, in the order of the
    dyad's name. Where `assembled` is False all are NaN. `margin` tells how far it is from its limit position, negative
    beyond: for two modes the squared sine of the angle in which they differ, for one the sine between the guides. At
    the limit position itself rates are not finite.
    """

    inner: MovingPoint
    first: MovingLine
    second: MovingLine
    travels: tuple[Travel, ...]
    assembled: Number
    margin: Number


class DyadData(NamedTuple):
    """A dyad as it is given: sides, mode, shape, and where all is known."""

    sides: Sides
    mode: Number
    shape: tuple[int, ...]
    known: Number

    @classmethod
    def of(cls, sides: Sides, mode: Any = 1, **given: Any) -> DyadData:
        """Make one of its sides, whose parts are given by their names."""
        signs = numbers_of("mode", mode)
        if not np.all(np.abs(signs) == 1.0):
            raise InvalidInput(Problem("mode", "a mode is +1 or -1", "the two ways to assemble a dyad"))
        shape = shape_of(mode=signs, **given)
        parts = [part for part in given.values() if isinstance(part, MovingPoint | MovingLine)]
        known = np.broadcast_to(np.all([np.broadcast_to(part.known, shape) for part in parts], axis=0), shape)
        if not known.any():
            raise InvalidInput(Problem(", ".join(given), "NaN at every pose: no position is known", "give numbers"))
        return cls(sides, signs, shape, known)

    def closed(self, kind: type[DyadSolver]) -> DyadSolution:
        """Have it assembled. Raises NotAssembled where it never can be, warns where it sometimes cannot."""
        first, inner, second = self.sides
        with np.errstate(all="ignore"):
            poses, margin, meeting = kind.assemble(first, inner, second, self.mode)
            if meeting is not None:
                reach = np.abs(as_series(first.world.point).c[0]) + np.abs(as_series(second.world.point).c[0])
                margin = np.where(np.abs(meeting.c[0]) > COINCIDENT * reach, margin, np.nan)
            margin = np.where(self.known, margin, np.nan)
        found = DyadSolution(poses, margin >= 0, margin, self.shape)
        if missing := np.argwhere(self.known & ~found.assembled).tolist():
            self._tell(kind, missing, found)
        return found

    def _tell(self, kind: type[DyadSolver], missing: list[list[int]], found: DyadSolution) -> None:
        """Say of poses that cannot be assembled how many they are, and why the first one cannot."""
        at = tuple(missing[0])
        first, inner, second = self.sides
        one, two = (OuterPair(_picked(pair.world, at), _picked(pair.local, at)) for pair in (first, second))
        why = kind.explain(one, (_picked(inner[0], at), _picked(inner[1], at)), two, 0, LETTERS)
        text = f"{len(missing)} of {found.assembled.size} poses cannot be assembled: {why}" if at else why
        if not found.assembled.any():
            raise NotAssembled(Problem(kind.name, text, LEGEND))
        where = f"{text} at {at if len(at) > 1 else at[0]}; {LEGEND}"
        warn(f"{kind.name}: {where}; `assembled` masks them", UnassembledPoses)


class DyadSolution(NamedTuple):
    """The two bodies of a dyad as they were assembled, and where."""

    poses: tuple[Pose, Pose]
    assembled: Number
    margin: Number
    shape: tuple[int, ...]

    def told(self, inner: Series, lines: tuple[tuple[Series, Series], ...], *travels: Series) -> SolvedDyad:
        """Return what is told of it. The lines of both links are each a point and a direction."""
        first, second = (MovingLine(MovingPoint(*self._rates(z)), *self._rates(u.angle())) for z, u in lines)
        slides = tuple(Travel(*(numbers_of("travel", rate) for rate in self._rates(travel))) for travel in travels)
        assembled, margin = (np.broadcast_to(value, self.shape) for value in (self.assembled, self.margin))
        if not self.shape:
            return SolvedDyad(MovingPoint(*self._rates(inner)), first, second, slides, bool(assembled), float(margin))
        return SolvedDyad(MovingPoint(*self._rates(inner)), first, second, slides, assembled, margin)

    def _rates(self, series: Series) -> list[Number]:
        """Return position, velocity and acceleration of a series, NaN where it is not assembled."""
        unknown = complex(np.nan, np.nan) if np.iscomplexobj(series.c[0]) else np.nan
        return [np.where(self.assembled, np.broadcast_to(series.derivative(k), self.shape), unknown) for k in range(3)]


def _picked(end: End, at: tuple[int, ...]) -> End:
    """Return a side of a pair at one design and pose."""
    point, along = (None if v is None else Series((entry(as_series(v).c[0], at),)) for v in end[:2])
    return End(point, along)


@dataclass(frozen=True, eq=False, repr=False)
class MovingPoint(ShortRepr):
    """A point with its velocity and acceleration. Complex numbers or arrays that broadcast.

    Each is given as a complex number, as (x, y), or as a complex array; in the user's length unit, per second and s^2.
    What is NaN is not known. Raises InvalidInput for what is no vector, for infinite positions, and for shapes that do
    not broadcast.

    >>> MovingPoint((1, 2)).position, MovingPoint(1j, velocity=(3, 0)).velocity
    ((1+2j), (3+0j))
    """

    position: Number
    velocity: Number = 0j
    acceleration: Number = 0j

    def __post_init__(self) -> None:
        """Read what is given as vectors."""
        for field in fields(self):
            object.__setattr__(self, field.name, vectors_of(field.name, getattr(self, field.name)))
        _refuse_infinite(fields(self)[0].name, self.position)
        self.shape  # raises where they do not broadcast  # noqa: B018

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of its arrays together."""
        return shape_of(**{field.name: getattr(self, field.name) for field in fields(self)})

    @property
    def known(self) -> Number:
        """Where its position is known."""
        return ~np.isnan(self.position)

    @property
    def series(self) -> Series:
        """Its position as a series in time."""
        return series_of(self.position, self.velocity, self.acceleration)


@dataclass(frozen=True, eq=False, repr=False)
class MovingLine(ShortRepr):
    """A line of a link in motion: one of its points, and its angle.

    Both have their rates, so that it stands for the whole link as well. `point` is a MovingPoint, a point of a motion,
    or a place if it rests; the angle from the x axis is in radians, its rates in rad/s and rad/s^2, real numbers or
    arrays that broadcast. Raises InvalidInput for anything else.

    >>> MovingLine((0, 0), [0.0, 1.0], angular_velocity=2.0).shape
    (2,)
    """

    point: Any
    angle: Number
    angular_velocity: Number = 0.0
    angular_acceleration: Number = 0.0

    def __post_init__(self) -> None:
        """Read what is given as a point and numbers."""
        object.__setattr__(self, "point", point_of("point", self.point))
        for field in fields(self)[1:]:
            object.__setattr__(self, field.name, numbers_of(field.name, getattr(self, field.name)))
        _refuse_infinite("angle", self.angle)
        self.shape  # raises where they do not broadcast  # noqa: B018

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of its arrays together."""
        return shape_of(**{field.name: getattr(self, field.name) for field in fields(self)})

    @property
    def known(self) -> Number:
        """Where its position is known."""
        return self.point.known & ~np.isnan(self.angle)

    @property
    def along(self) -> Series:
        """Its direction, a unit vector, as a series in time."""
        return series_of(self.angle, self.angular_velocity, self.angular_acceleration).turn()


@dataclass(frozen=True, eq=False, repr=False)
class Travel(ShortRepr):
    """How far a slide has moved, with its rates. Real numbers or arrays; length, per second, per s^2."""

    value: Number
    rate: Number
    second: Number


def point_of(where: str, given: Any) -> MovingPoint:
    """Return a moving point of what is given as one.

    That of a motion is taken as arrays, a place as a point at rest.

    >>> point_of("a", (3, 4)).position
    (3+4j)
    """
    if isinstance(given, MovingPoint):
        return given
    if isinstance(given, PointMotion):
        return MovingPoint(*(np.asarray(given.derivative(k)) for k in range(3)))
    try:
        return MovingPoint(given)
    except InvalidInput as error:
        remedy = "give a MovingPoint, or (x, y) of a point at rest"
        raise InvalidInput(Problem(where, problem.what, remedy) for problem in error.problems) from None


def numbers_of(where: str, given: Any) -> Number:
    """Return real numbers: one as a float, several as an array.

    >>> numbers_of("angle", 1), numbers_of("angle", range(2)).tolist()
    (1.0, [0.0, 1.0])
    """
    value = real_numbers(where, given)
    return float(value) if value.ndim == 0 else value


def vectors_of(where: str, given: Any) -> Number:
    """Return planar vectors, written as complex numbers or (x, y); raises InvalidInput for others.

    >>> vectors_of("point", (1, 2))
    (1+2j)
    """
    try:
        with np.errstate(invalid="ignore"):  # of infinite numbers
            return vector(where, given)
    except InvalidMechanism as error:
        raise InvalidInput(error.problems) from None


def series_of(value: Number, rate: Number, second: Number) -> Series:
    """Return a series to second order; a constant of what rests.

    >>> series_of(1.0, 2.0, 6.0).c, series_of(1.0, 0.0, 0.0).c
    ((1.0, 2.0, 3.0), (1.0,))
    """
    if is_number(rate, 0) and is_number(second, 0):
        return constant(value)
    return Series((value, rate, second * 0.5))


def shape_of(**given: Any) -> tuple[int, ...]:
    """Return the shape that arrays, points and lines broadcast to.

    Raises InvalidInput where they do not.

    >>> shape_of(a=np.zeros(3), b=np.zeros((2, 1)), c=2.0)
    (2, 3)
    """
    moving = (MovingPoint, MovingLine)
    shapes = {name: value.shape if isinstance(value, moving) else np.shape(value) for name, value in given.items()}
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
        remedy = "axes of all are the same designs and poses; one of length 1 stands for every place along it"
        raise InvalidInput(Problem("shapes", f"they do not broadcast: {told}", remedy)) from None


def _refuse_infinite(where: str, value: Number) -> None:
    if np.isinf(value).any():
        raise InvalidInput(Problem(where, f"{short_repr(value)} is infinite", "NaN says that none is known"))
