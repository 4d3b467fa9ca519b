"""What a motion shows of a point, a link, a pair or a driver: arrays of all derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, Vectors, unwrapped
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.inputs import PoseGrid
from compoundkin.model.geometry import vector


class PointMotion:
    """The motion of a point: complex arrays of the motion's shape. `.xy` of each gives (..., 2)."""

    def __init__(self, grid: PoseGrid, derivative: Any, name: str = "") -> None:
        self._grid, self._name = grid, name
        self._derivative = derivative

    def derivative(self, k: int) -> Vectors:
        """Return the k-th time derivative of the position. Raises InvalidInput beyond the order solved for."""
        self._grid.require(k)
        found: Vectors = self._grid.known(self._derivative(k)).astype(complex, copy=False).view(Vectors)
        return found

    @property
    def position(self) -> Vectors:
        """Where it is, in the user's length unit."""
        return self.derivative(0)

    @property
    def velocity(self) -> Vectors:
        """Its velocity, length/s."""
        return self.derivative(1)

    @property
    def acceleration(self) -> Vectors:
        """Its acceleration, length/s^2."""
        return self.derivative(2)

    @property
    def jerk(self) -> Vectors:
        """Its jerk, length/s^3."""
        return self.derivative(3)

    @property
    def x(self) -> Number:
        """The first coordinate of its position."""
        return np.asarray(self.position.real)

    @property
    def y(self) -> Number:
        """The second coordinate of its position."""
        return np.asarray(self.position.imag)

    @property
    def speed(self) -> Number:
        """The length of its velocity."""
        return np.abs(np.asarray(self.velocity))

    def __repr__(self) -> str:
        return told(self, self._grid, self._name)


class LinkMotion:
    """The motion of a link. Its angle from the frame's x axis, and that of any of its points."""

    def __init__(self, grid: PoseGrid, pose: Pose, name: str = "") -> None:
        self._grid, self._name = grid, name
        self._pose = pose

    @cached_property
    def _turning(self) -> Series:
        return self._pose.u.turning()

    def _rate(self, k: int) -> Number:
        self._grid.require(k)
        if k:
            return self._grid.known(self._turning.derivative(k - 1))
        return self._grid.known(self._pose.angle.c[0])

    @cached_property
    def angle(self) -> Number:
        """The angle of its x axis, radians, unwrapped along the motion.

        A driven link or a gear has it as it is counted.
        """
        return unwrapped(self._rate(0)) if self._pose.theta is None else self._rate(0)

    @property
    def angular_velocity(self) -> Number:
        """Its angular velocity, rad/s."""
        return self._rate(1)

    @property
    def angular_acceleration(self) -> Number:
        """Its angular acceleration, rad/s^2."""
        return self._rate(2)

    @property
    def angular_jerk(self) -> Number:
        """Its angular jerk, rad/s^3."""
        return self._rate(3)

    @property
    def origin(self) -> PointMotion:
        """The motion of the origin of its frame."""
        return PointMotion(self._grid, self._pose.z.derivative)

    def at(self, point: Any) -> PointMotion:
        """Return the motion of any point given in its frame, complex or (x, y)."""
        p = self._grid.fitted(vector("point", point))
        return PointMotion(self._grid, partial(self._pose.derivative, p))

    def __repr__(self) -> str:
        return told(self, self._grid, self._name)


class PairMotion:
    """The free relative coordinate of a pair.

    It is an angle (radians, unwrapped) or a displacement, and has its rates.
    """

    def __init__(
        self, grid: PoseGrid, coordinate: Series, is_angle: bool, prescribed: bool = False, counted: bool = False
    ) -> None:
        self._grid = grid
        self._prescribed = prescribed
        self._counted = counted or prescribed
        self.coordinate = coordinate
        self.is_angle = is_angle

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative; raises InvalidInput beyond the order solved for."""
        self._grid.require(k)
        value = self.coordinate.derivative(k)
        value = self._grid.shaped(value) if self._prescribed else self._grid.known(value)
        return unwrapped(value) if k == 0 and self.is_angle and not self._counted else value

    @property
    def value(self) -> Number:
        """The relative angle or displacement."""
        return self.derivative(0)

    @property
    def rate(self) -> Number:
        """Its first time derivative."""
        return self.derivative(1)

    @property
    def second(self) -> Number:
        """Its second time derivative."""
        return self.derivative(2)

    @property
    def third(self) -> Number:
        """Its third time derivative."""
        return self.derivative(3)

    def __repr__(self) -> str:
        return told(self, self._grid, "angle" if self.is_angle else "displacement")


class Named(Mapping[str, Any]):
    """Entries made when they are asked for. An unknown name raises UnknownName with the nearest known."""

    def __init__(self, kind: str, names: tuple[str, ...], make: Any) -> None:
        self._kind, self._names, self._make = kind, names, make
        self._made: dict[str, Any] = {}

    def __getstate__(self) -> dict[str, Any]:
        # all entries, for what makes them may be a function within another, which cannot be pickled
        return {"_kind": self._kind, "_names": self._names, "_make": None, "_made": dict(self)}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            if name not in self._names:
                raise UnknownName(
                    Problem(str(name), f"there is no such {self._kind}", suggestion(str(name), self._names))
                )
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Any:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        more = f", ... {len(self)} in all" if len(self) > 6 else ""
        return f"Named({self._kind}: {', '.join(self._names[:6])}{more})"


def told(part: object, grid: PoseGrid, name: str) -> str:
    """Return what is told of a part of a motion in short. It has its name, shape and order."""
    named = f"{name}: " if name else ""
    return f"{type(part).__name__}({named}{grid.shape} poses to order {grid.order})"
