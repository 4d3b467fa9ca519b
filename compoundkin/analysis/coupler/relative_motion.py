"""The motion of any link and its points seen from any other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import LinkMotion, Motion, PointMotion
from compoundkin.kinematics.derived.velocity_ratio import SMALL
from compoundkin.kinematics.groups.textbook_dyads import vectors_of
from compoundkin.model.geometry import FRAME

UNKNOWN = complex(np.nan, np.nan)
INFINITE = complex(np.inf, np.inf)


@checked
def relative_link(motion: Motion, link: str, on: str = FRAME) -> LinkMotion:
    """Return the motion of one link in the frame of another.

    Angles in radians, their rates in rad/s; arrays of the motion's shape. Raises UnknownName for an unknown link,
    InvalidInput for a link seen from itself. Source: O. Bottema and B. Roth, Theoretical Kinematics (1979),
    chapter VIII, the pose being ``pose(on)^-1 pose(link)``.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> crank = relative_link(solve(load("crank-rocker"), {"crank": [0.0]}, speed=2.0), "frame", on="crank")
    >>> crank.angular_velocity.tolist()
    [-2.0]
    """
    return LinkMotion(motion.grid, _pose(motion, link, on))


@checked
def relative_point(motion: Motion, link: str, point: Any, on: str = FRAME) -> PointMotion:
    """Return the motion of a point of one link in the frame of another.

    `point` is a letter of the link, or a place in the link's own frame, complex or (x, y), a number or an array.
    Lengths in the user's unit, per second, s^2, s^3; complex arrays of the motion's shape. Turn them by
    ``motion.poses[on].u`` for world axes. Raises UnknownName for an unknown link or letter, InvalidInput for a link
    seen from itself and for an invalid point. Source: as `relative_link`.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=1.0)
    >>> relative_point(motion, "frame", "O", on="rod").speed.round(9).tolist()     # on a circle of radius 1.5
    [3.0]
    """
    return relative_link(motion, link, on).at(local_point(motion, link, point))


def local_point(motion: Motion, link: str, point: Any) -> Number:
    """Return the place of a point in its link's frame, from its letter or coordinates."""
    if isinstance(point, str):
        known = motion.mechanism.geometry.points[link]
        if point not in known:
            raise UnknownName(Problem(point, f"link {link!r} has no such point", suggestion(point, list(known))))
        return known[point]
    return vectors_of("point", point)


def unit_direction(vector: Number) -> Number:
    """Return the unit vector of a planar vector; 0 for the vector 0."""
    length = np.abs(vector)
    return np.where(length > 0, vector / np.where(length > 0, length, 1.0), 0j)


def series_rate(series: Series) -> Series:
    """Return the time derivative of a series, one order lower."""
    return Series(tuple(k * c for k, c in enumerate(series.c[1:], 1)))


@dataclass(frozen=True, eq=False)
class RelativeMotion:
    """A relative motion as series: `z`, `u` are the pose of `link` in the frame of `on`.

    Divided by powers of the relative angular velocity all of it is geometry, with the angle as the parameter
    (instantaneous invariants).
    """

    motion: Motion
    link: str
    on: str
    z: Series
    u: Series

    @cached_property
    def omega(self) -> Series:
        """The relative angular velocity, exactly 0 within rounding."""
        omega = self.u.turning()
        return Series((np.where(np.abs(omega.c[0]) > SMALL * self.scale(1), omega.c[0], 0.0), *omega.c[1:]))

    @cached_property
    def numerator(self) -> Series:
        """The numerator of the pole. The pole is at ``(omega z + i z') / omega``."""
        return self.omega * Series(self.z.c[:-1]) + 1j * series_rate(self.z)

    @cached_property
    def pole(self) -> Series:
        """The pole in the frame of `on`."""
        return self.numerator / self.omega

    @cached_property
    def pole_by_angle(self) -> Series:
        """The derivative of the pole by the relative angle, still a series in time."""
        return series_rate(self.pole) / Series(self.omega.c[:-1])

    @cached_property
    def turning(self) -> Number:
        """Whether the links turn relative to each other: the pole is finite and rates by the angle exist."""
        return self.regular & (self.omega.c[0] != 0)

    @cached_property
    def resting(self) -> Number:
        """Whether the links stand still relative to each other, for an instant or always."""
        still = np.abs(self.numerator.c[0]) <= SMALL * self.scale(1) * self.reach
        return self.regular & (self.omega.c[0] == 0) & still

    @cached_property
    def regular(self) -> Number:
        """Whether the pose is assembled and all its rates are finite."""
        return self.motion.regular.reshape(self.motion.shape)

    @cached_property
    def reach(self) -> Number:
        """The lengths that rounding is relative to."""
        return self.motion.size + np.abs(self.z.c[0])

    @cached_property
    def noise(self) -> Number:
        """The rounding of lengths that come from accelerations by the relative angle."""
        return SMALL * self.reach * np.maximum(1.0, self.scale(2) / self.omega.c[0] ** 2)

    def scale(self, k: int) -> Number:
        """Return the greatest rate of links and drivers at a pose, in rad/s^k, the scale of rounding."""
        if k not in self._scales:
            self._scales[k] = self._scale(k)
        return self._scales[k]

    @cached_property
    def _scales(self) -> dict[int, Number]:
        """The scales that were asked for, by their k."""
        return {}

    def _scale(self, k: int) -> Number:
        size, links, drives = self.motion.size, self.motion.links, self.motion.drives.values()
        rates = [np.abs(d.derivative(k)) / (1.0 if d.is_angle else size) for d in drives]
        for name in (self.link, self.on):
            rates += [np.abs(np.asarray(links[name].at(p).derivative(k))) / size for p in (0.0, size)]
        largest = np.maximum.reduce(np.broadcast_arrays(*rates))
        return largest if k == 1 else np.maximum(largest, self.scale(1) ** k)

    def masked(self, values: Number, where: Number) -> Number:
        """Return values where they are defined, and NaN elsewhere."""
        return np.where(where, values, UNKNOWN if np.iscomplexobj(values) else np.nan)


def relative_motion(motion: Motion, link: str, on: str, order: int, what: str) -> RelativeMotion:
    """Return the relative motion of two links with derivatives up to `order`.

    Raises InvalidInput where the motion was not solved to that order, or where no driver moves at some pose.
    """
    pose = _pose(motion, link, on)
    if motion.order < order:
        text = f"it takes derivatives to order {order}; the motion was solved to order {motion.order}"
        raise InvalidInput(Problem(what, text, f"solve(..., order={order})"))
    check_moving(motion, what)
    return RelativeMotion(motion, link, on, _shaped(motion, pose.z.derivative), _shaped(motion, pose.u.derivative))


def check_moving(motion: Motion, what: str) -> None:
    """Raise InvalidInput if no driver moves at some pose, where velocities define nothing."""
    speeds = [np.broadcast_to(np.abs(drive.rate), motion.shape) for drive in motion.drives.values()]
    still = np.asarray(motion.assembled & (np.max([*speeds, np.zeros(motion.shape)], axis=0) == 0))
    if still.any():
        pose = tuple(int(i) for i in np.argwhere(still)[0])
        text = f"no driver moves at pose {pose}: every driver's speed is zero"
        raise InvalidInput(Problem(what, text, "solve(..., speed=1): it does not depend on the driver's speed"))


def _pose(motion: Motion, link: str, on: str) -> Pose:
    for name in (link, on):
        motion.mechanism.link(name)
    if link == on:
        known = ", ".join(name for name in motion.mechanism.links if name != link)
        raise InvalidInput(Problem("on", f"{link!r} does not move relative to itself", f"another link: {known}"))
    if on == FRAME:
        return motion.poses[link]
    return motion.poses[on].inverse().compose(motion.poses[link])


def _shaped(motion: Motion, derivative: Callable[[int], Number]) -> Series:
    point = PointMotion(motion.grid, derivative)
    return Series(tuple(np.asarray(point.derivative(k)) / factorial(k) for k in range(motion.order + 1)))
