"""The displacement of a link from one position to another, and the pole triangle of three positions.

A displacement is a rotation about its pole, or a translation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.coupler.relative_motion import INFINITE, UNKNOWN, relative_link, unit_direction
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.velocity_ratio import SMALL
from compoundkin.kinematics.groups.textbook_dyads import numbers_of, shape_of, vectors_of
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True, eq=False, repr=False)
class LinkPosition(ShortRepr):
    """A position of a link: the place of one of its points, and its angle.

    `point` is complex or (x, y), the angle in radians; numbers, or arrays that broadcast. NaN for an unknown position.
    Raises InvalidInput for anything else.

    >>> LinkPosition((3, 4), angle=0.5).point
    (3+4j)
    """

    point: Number
    angle: Number

    def __post_init__(self) -> None:
        """Convert the fields to a vector and a number."""
        object.__setattr__(self, "point", vectors_of("point", self.point))
        object.__setattr__(self, "angle", numbers_of("angle", self.angle))
        shape_of(point=self.point, angle=self.angle)
        for where, value in (("point", self.point), ("angle", self.angle)):
            if np.isinf(value).any():
                raise InvalidInput(Problem(where, "it is infinite", "give finite numbers"))


@dataclass(frozen=True, eq=False, repr=False)
class Displacement(ShortRepr):
    """The displacement of a link between two positions. Numbers or arrays of their shape.

    `angle` is that of the rotation, between -pi and pi; `translation` that of the reference point of the
    positions; `pole` the fixed point. Where the link is only translated (`infinite`) the pole is
    inf and `direction` the unit vector towards it, up to its sign; elsewhere `direction` is 0. Where the pole is not
    `defined` both are NaN: the positions are not known, or are one and the same.
    """

    first: LinkPosition
    second: LinkPosition
    angle: Number
    translation: Number
    pole: Number
    direction: Number
    infinite: Number
    defined: Number

    def moved(self, points: Any) -> Number:
        """Return the second places of points of the link from the first ones.

        Complex or (x, y), a number or an array that broadcasts with the positions.
        """
        places = vectors_of("points", points)
        shape_of(points=places, positions=self.angle)
        return self.second.point + np.exp(1j * self.angle) * (places - self.first.point)


@checked
def link_position(motion: Motion, link: str, at: Any, on: str = FRAME) -> LinkPosition:
    """Return the position of a link at poses of a motion, in the frame of another.

    `at` is the index of a pose along the motion, or an array of them; the position is
    that of the link's origin, of the shape of designs and indices, NaN where it is not assembled. Raises UnknownName
    for an unknown link, InvalidInput for an invalid index or a link seen from itself, NotAssembled where none of the
    poses is assembled.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("crank-rocker"), {"crank": np.deg2rad([0, 30, 60])})
    >>> round(float(np.rad2deg(link_position(motion, "crank", 2).angle)), 9)
    60.0
    """
    seen = relative_link(motion, link, on)
    poses = motion.inputs.poses
    wanted = numbers_of("at", at)
    if not np.size(wanted) or not np.all((wanted >= -poses) & (wanted < poses) & (np.floor(wanted) == wanted)):
        raise InvalidInput(Problem("at", "it is not the index of a pose", f"0 to {poses - 1}"))
    index = np.asarray(wanted).astype(int)
    angle, point = (np.reshape(value, (*motion.shape[:-1], poses))[..., index]
                    for value in (seen.angle, np.asarray(seen.origin.position)))  # fmt: skip
    if np.isnan(angle).all():
        raise NotAssembled(Problem("at", "the mechanism cannot be assembled there", "gaps() tells where and why"))
    return LinkPosition(point, angle)


@checked
def displacement(first: LinkPosition, second: LinkPosition) -> Displacement:
    """Return the displacement of a link from one position to another.

    Both are given by the same point of the link, and seen from the same other link; their arrays broadcast. Raises
    InvalidInput where they do not. Source: O. Bottema and B. Roth, Theoretical Kinematics (1979), chapter VIII;
    R. Beyer, Technische Kinematik (1931): the pole is above the middle of a point's way, at half the angle.

    >>> quarter = displacement(LinkPosition((2, 1), 0.0), LinkPosition((1, 2), np.pi / 2))
    >>> complex(np.round(quarter.pole, 12)), round(float(quarter.angle), 6)
    ((1+1j), 1.570796)
    >>> displacement(LinkPosition((0, 0), 1.0), LinkPosition((2, 0), 1.0)).direction
    np.complex128(1j)
    """
    shape = shape_of(first=first.point + first.angle, second=second.point + second.angle)
    one, two = (np.broadcast_to(position.point, shape) for position in (first, second))
    angle = np.asarray(wrapped(np.broadcast_to(second.angle - first.angle, shape)))
    # a rotation within rounding is none
    angle = np.where(np.abs(angle) <= SMALL, 0.0 * angle, angle)
    translation = two - one
    at_rest = (angle == 0.0) & (np.abs(translation) <= SMALL * (np.abs(one) + np.abs(two)))
    defined = np.isfinite(translation) & np.isfinite(angle) & ~at_rest
    infinite = defined & (angle == 0.0)
    with np.errstate(all="ignore"):
        finite = (one + two) / 2.0 + 0.5j * translation / np.tan(angle / 2.0)
    pole = np.where(infinite, INFINITE, np.where(defined, finite, UNKNOWN))
    far = np.where(infinite, 1j * unit_direction(translation), np.where(defined, 0j, UNKNOWN))
    return Displacement(first, second, angle[()], translation[()], pole[()], far[()], infinite[()], defined[()])


@dataclass(frozen=True, eq=False, repr=False)
class PoleTriangle(ShortRepr):
    """The displacements from position 1 to 2, 2 to 3, and 3 to 1.

    Their poles are the corners of a triangle. All come in this order, numbers or arrays of the positions' shape, NaN
    where a pole is not defined.
    """

    displacements: tuple[Displacement, Displacement, Displacement]

    @property
    def poles(self) -> tuple[Number, Number, Number]:
        """The corners P12, P23 and P31; inf for a translation."""
        one, two, three = self.displacements
        return one.pole, two.pole, three.pole

    @property
    def angles(self) -> tuple[Number, Number, Number]:
        """The angles of the rotations, between -pi and pi."""
        one, two, three = self.displacements
        return one.angle, two.angle, three.angle

    @property
    def corner_angles(self) -> tuple[Number, Number, Number]:
        """The angles at the corners, each half that of the rotation, up to half turns.

        From the side towards the previous pole to that towards the next one, between -pi/2 and pi/2; NaN at infinity.
        """
        one, two, three = self.displacements
        return _corner(one, three, two), _corner(two, one, three), _corner(three, two, one)

    @property
    def images(self) -> tuple[Number, Number, Number]:
        """The image poles: of P23 in position 1, of P31 in position 2, of P12 in position 3.

        Each is the mirror image of the pole in the opposite side of the triangle; inf where the pole is.
        """
        one, two, three = self.displacements
        return _mirrored(two, one, three), _mirrored(three, two, one), _mirrored(one, three, two)


@checked
def pole_triangle(first: LinkPosition, second: LinkPosition, third: LinkPosition) -> PoleTriangle:
    """Return the pole triangle of three positions of a link.

    All are given by the same point of the link; their arrays broadcast. Raises InvalidInput where they do not.
    Source: R. Beyer, Kinematische Getriebesynthese (1953); J. M. McCarthy and G. S. Soh, Geometric Design of Linkages
    (2011), chapter 2; A. S. Hall, Kinematics and Linkage Design (1961).

    >>> turned = [LinkPosition(place, angle) for place, angle in (((0, 0), 0.0), ((2, 0), np.pi), ((0, 2), 0.0))]
    >>> triangle = pole_triangle(*turned)
    >>> complex(np.round(triangle.poles[0], 12)), complex(np.round(triangle.poles[1], 12))     # two half turns
    ((1+0j), (1+1j))
    >>> bool(triangle.displacements[2].infinite)
    True
    """
    return PoleTriangle((displacement(first, second), displacement(second, third), displacement(third, first)))


@np.errstate(all="ignore")
def _toward(at: Displacement, other: Displacement) -> Number:
    """Return the direction from one pole to another, which may be at infinity."""
    return np.where(other.infinite, other.direction, unit_direction(other.pole - at.pole))


@np.errstate(all="ignore")
def _corner(at: Displacement, before: Displacement, after: Displacement) -> Number:
    turn = np.conj(_toward(at, before)) * _toward(at, after)
    known = at.defined & ~at.infinite & before.defined & after.defined & (turn != 0)
    return np.where(known, np.angle(turn**2) / 2.0, np.nan)[()]


@np.errstate(all="ignore")
def _mirrored(pole: Displacement, one: Displacement, two: Displacement) -> Number:
    """Return the mirror image of a pole in the line through two others."""
    through = np.where(one.infinite, two.pole, one.pole)
    along: Number = np.where(one.infinite, one.direction, _toward(one, two))
    # coincident poles have no line, and are their own image
    image = through + along**2 * np.conj(pole.pole - through)
    return np.where(pole.infinite, INFINITE, image)[()]
