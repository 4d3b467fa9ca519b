"""The textbook routines: a point of a link, and the five dyads, as plain functions of moving points and lines.

What is given is read as the sides of pairs, which the solvers of this folder assemble.
Source: libraries of routines for linkages, e.g. A. H. Soni, Mechanism Synthesis and Analysis (1974), and B. Paul,
Kinematics and Dynamics of Planar Machinery (1979); the formulas are those of the solvers.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.kinematics.groups.dyad import COINCIDENT, OuterPair
from compoundkin.kinematics.groups.given_dyads import GivenDyad, SolvedDyad
from compoundkin.kinematics.groups.prp import PRP
from compoundkin.kinematics.groups.rpp import RPP
from compoundkin.kinematics.groups.rpr import RPR
from compoundkin.kinematics.groups.rrp import RRP
from compoundkin.kinematics.groups.rrr import RRR
from compoundkin.kinematics.moving_lines import MovingLine, MovingPoint, numbers_of, point_of, shape_of

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
    found = GivenDyad.of(sides, mode, a=one, b=two, first_length=r1, second_length=r2).closed(RRR)
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
    found = GivenDyad.of(sides, mode, a=one, guide=guide, length=r, offset=e).closed(RRP)
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
    found = GivenDyad.of(sides, mode, a=one, b=two, offset=e).closed(RPR)
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
    found = GivenDyad.of(sides, first=first, second=second, first_offset=e1, second_offset=e2).closed(PRP)
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
    found = GivenDyad.of(sides, a=one, guide=guide, angle=turn, offset=e).closed(RPP)
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
