"""Points and lines of links as they are given and found: with their velocities and accelerations, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number, is_number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.results import PointMotion
from compoundkin.model.geometry import vector


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
