"""The pole triangle of three positions of a link, and its image poles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.coupler.displacement import Displacement, LinkPosition, displacement
from compoundkin.analysis.coupler.relative_motion import INFINITE, direction
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr


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
        """The angles at the corners, each half that of the rotation.

        But for half turns: from the side towards the pole before to that towards the pole after, between -pi/2 and
        pi/2; NaN at infinity.
        """
        one, two, three = self.displacements
        return _corner(one, three, two), _corner(two, one, three), _corner(three, two, one)

    @property
    def images(self) -> tuple[Number, Number, Number]:
        """The image poles: the point that comes to P23, in position 1.

        And that of P31 in position 2, that of P12 in position 3. Each is the mirror image of the pole in the opposite
        side of the triangle; inf where the pole is.
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
    return np.where(other.infinite, other.direction, direction(other.pole - at.pole))


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
    # poles that coincide have no line, and are their own image
    image = through + along**2 * np.conj(pole.pole - through)
    return np.where(pole.infinite, INFINITE, image)[()]
