"""A solved motion: points, links, pairs and drivers by name, with all derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.mechanism import Mechanism
from compoundkin.motion.inputs import Inputs, fit
from compoundkin.motion.plan import Plan
from compoundkin.motion.tracking import Tracker
from compoundkin.notebooks import ShowsPicture
from compoundkin.poses import FIXED, Pose
from compoundkin.series import Number, Series
from compoundkin.structure.model import Structure
from compoundkin.words import FRAME, vector

if TYPE_CHECKING:
    from compoundkin.animation import Animation
    from compoundkin.plots import Plot

HIGHEST_ORDER = 3


class Vectors(np.ndarray[Any, np.dtype[np.complex128]]):
    """A complex array of planar vectors; `xy` splits it.

    >>> np.array([1 + 2j]).view(Vectors).xy.tolist()
    [[1.0, 2.0]]
    """

    @property
    def xy(self) -> Number:
        """The components, in a last axis of length 2."""
        plain = np.asarray(self)
        return np.stack([plain.real, plain.imag], axis=-1)


class PointMotion:
    """The motion of a point: complex arrays of the motion's shape; `.xy` of each gives (..., 2)."""

    def __init__(self, motion: Motion, derivative: Any) -> None:
        self._motion = motion
        self._derivative = derivative

    def derivative(self, k: int) -> Vectors:
        """The k-th time derivative of the position; raises InvalidInput beyond the order solved for."""
        self._motion._has(k)
        found: Vectors = self._motion._known(self._derivative(k)).astype(complex, copy=False).view(Vectors)
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


class LinkMotion:
    """The motion of a link: its angle from the frame's x axis, and that of any of its points."""

    def __init__(self, motion: Motion, pose: Pose) -> None:
        self._motion = motion
        self._pose = pose

    @cached_property
    def _turning(self) -> Series:
        return self._pose.u.turning()

    def _rate(self, k: int) -> Number:
        self._motion._has(k)
        if k:
            return self._motion._known(self._turning.derivative(k - 1))
        return self._motion._known(self._pose.angle.c[0])

    @cached_property
    def angle(self) -> Number:
        """The angle of its x axis, radians, unwrapped along the motion; of a driven link or a gear as it is counted."""
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
        return PointMotion(self._motion, self._pose.z.derivative)

    def at(self, point: Any) -> PointMotion:
        """The motion of any point given in its frame, complex or (x, y)."""
        p = self._motion._fitted(vector("point", point))
        return PointMotion(self._motion, lambda k: self._pose.derivative(p, k))


class PairMotion:
    """The free relative coordinate of a pair: an angle (radians, unwrapped) or a displacement, and its rates."""

    def __init__(
        self, motion: Motion, coordinate: Series, is_angle: bool, prescribed: bool = False, counted: bool = False
    ) -> None:
        self._motion = motion
        self._prescribed = prescribed
        self._counted = counted or prescribed
        self.coordinate = coordinate
        self.is_angle = is_angle

    def derivative(self, k: int) -> Number:
        """The k-th time derivative; raises InvalidInput beyond the order solved for."""
        self._motion._has(k)
        value = self.coordinate.derivative(k)
        value = self._motion._shaped(value) if self._prescribed else self._motion._known(value)
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


class _Table(Mapping[str, Any]):
    """Entries made when they are asked for; an unknown name raises UnknownName with the nearest known."""

    def __init__(self, kind: str, names: tuple[str, ...], make: Any) -> None:
        self._kind, self._names, self._make = kind, names, make
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            if name not in self._names:
                raise UnknownName(Problem(str(name), f"there is no such {self._kind}", nearest(str(name), self._names)))
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Any:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


@dataclass(frozen=True)
class Motion(ShowsPicture):
    """A mechanism solved: every link's pose with all derivatives, over designs and poses.

    `shape` is the broadcast shape of dimensions and driver values, the last axis the motion. Poses that
    cannot be assembled are NaN, False in `assembled`, and explained by `compoundkin.gaps`.
    """

    structure: Structure
    order: int
    inputs: Inputs
    poses: Mapping[str, Pose]
    failed: Number  # shape (designs, poses): index of the first group that does not close plus one, or 0
    tracker: Tracker
    time: Number | None = None  # the times (seconds) of a motion in time; broadcasts with its shape

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism that was solved."""
        return self.structure.mechanism

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of every array of the motion."""
        return self.inputs.shape

    @cached_property
    def assembled(self) -> Number:
        """Which poses are assembled, a bool array of the motion's shape."""
        return self._shaped(self.failed == 0)

    @cached_property
    def regular(self) -> Number:
        """Which poses have finite rates, (designs, poses): the assembled ones but for limit positions."""
        good = np.array(self.failed == 0)
        for pose in self.poses.values():
            for c in (*pose.z.c[1:], *pose.u.c[1:]):
                good = good & np.isfinite(c)
        return good

    @property
    def size(self) -> float:
        """The mechanism's length scale."""
        return self._plan.size

    @cached_property
    def points(self) -> Mapping[str, PointMotion]:
        """The motion of every point by its letter."""
        return _Table("point", tuple(self.mechanism.carriers), self._point)

    @cached_property
    def links(self) -> Mapping[str, LinkMotion]:
        """The motion of every link by its name."""
        return _Table("link", tuple(self.mechanism.links), lambda name: LinkMotion(self, self.poses[name]))

    @cached_property
    def pairs(self) -> Mapping[str, PairMotion]:
        """The relative motion in every pair by its name."""
        return _Table("pair", tuple(self._plan.pairs), self._pair)

    @cached_property
    def drives(self) -> Mapping[str, PairMotion]:
        """The prescribed coordinate of every driver by its name."""
        return _Table("driver", tuple(self.inputs.drives), self._drive)

    def plot(self, *names: str, **options: Any) -> Plot:
        """Draw quantities over the driver, the time or any other quantity: `compoundkin.plot` of this motion."""
        # found by its name: plots come after motions, and only who draws pays for them
        drawn: Plot = import_module("compoundkin.plots").plot(self, *names, **options)
        return drawn

    def animate(self, **options: Any) -> Animation:
        """An animation to be saved as GIF, MP4 or SVG: `compoundkin.animate` of this motion."""
        made: Animation = import_module("compoundkin.animation").animate(self, **options)
        return made

    @property
    def _plan(self) -> Plan:
        return self.tracker.plan

    def mended(self, designs: Number, index: Number, poses: Mapping[str, Pose]) -> Motion:
        """The motion with some of its poses put in the place of what was solved there."""
        if not len(designs):
            return self
        shape = (self.inputs.designs, self.inputs.poses)

        def put(series: Series, other: Series) -> Series:
            out = []
            for k in range(self.order + 1):
                full = np.array(np.broadcast_to(series.c[k] if k < len(series.c) else 0.0 * series.c[0], shape))
                full[designs, index] = np.ravel(other.c[k]) if k < len(other.c) else 0.0
                out.append(full)
            return Series(tuple(out))

        def mended(pose: Pose, other: Pose) -> Pose:
            known = pose.theta is not None and other.theta is not None
            return Pose(put(pose.z, other.z), put(pose.u, other.u), put(pose.angle, other.angle) if known else None)

        return replace(self, poses={n: FIXED if n == FRAME else mended(p, poses[n]) for n, p in self.poses.items()})

    def __repr__(self) -> str:
        missing = int(np.count_nonzero(self.failed))
        told = f", {missing} of them not assembled" if missing else ""
        return f"Motion({self.mechanism.title!r} at {self.shape} poses to order {self.order}{told})"

    def _point(self, name: str) -> PointMotion:
        link = self.mechanism.carriers[name][0]
        return PointMotion(self, self._derivative(link, name))

    def _derivative(self, link: str, name: str) -> Any:
        pose = self.poses[link]
        p = fit(self.shape)(self.mechanism.geometry.points[link][name])
        return lambda k: pose.derivative(p, k)

    def _pair(self, name: str) -> PairMotion:
        pair = self._plan.pairs[name]
        ends = self.inputs.ends[name]
        poses = tuple(self.poses[member] for member in pair.members)
        counted = all(pose.theta is not None for pose in poses)
        return PairMotion(self, pair.coordinate(ends, poses), pair.free_is_angle, counted=counted)

    def _drive(self, name: str) -> PairMotion:
        is_angle = self._plan.driven[name].pair.free_is_angle
        return PairMotion(self, self.inputs.series(self.order)[name], is_angle, prescribed=True)

    def _has(self, k: int) -> None:
        if not 0 <= k <= self.order:
            names = ("position", "velocity", "acceleration", "jerk")
            what = names[k] if 0 <= k <= HIGHEST_ORDER else f"derivative {k}"
            remedy = f"solve(..., order={k})" if 0 <= k <= HIGHEST_ORDER else f"0 to {HIGHEST_ORDER}"
            raise InvalidInput(Problem(what, f"the motion was solved to order {self.order}", remedy))

    def _fitted(self, value: Number) -> Number:
        """A value that broadcasts with the motion, in the form (1 or designs, 1 or poses)."""
        try:
            np.broadcast_to(value, self.shape)
        except ValueError:
            what = f"shape {np.shape(value)} does not broadcast with {self.shape}"
            raise InvalidInput(Problem("point", what, "the last axis is the motion")) from None
        return fit(self.shape)(value)

    def _known(self, value: Number) -> Number:
        """A value in the motion's shape, not a number at poses that are not assembled."""
        shaped = self._shaped(value)
        if self._complete:
            return shaped
        return np.where(self.assembled, shaped, complex(np.nan, np.nan) if np.iscomplexobj(shaped) else np.nan)

    @cached_property
    def _complete(self) -> bool:
        return not self.failed.any()

    def _shaped(self, value: Number) -> Number:
        """A value of the form (1 or designs, 1 or poses) in the motion's shape."""
        full = np.broadcast_to(value, (self.inputs.designs, self.inputs.poses))
        return full.reshape(self.shape)


def unwrapped(angle: Number) -> Number:
    """An angle made continuous along the last axis, where it is known; leaps over unassembled poses included.

    >>> unwrapped(np.array([3.0, np.nan, -3.0])).round(3).tolist()
    [3.0, nan, 3.283]
    """
    if np.ndim(angle) == 0 or np.shape(angle)[-1] < 2:
        return angle
    if not np.isnan(angle).any():
        return np.unwrap(angle)
    rows = np.array(angle).reshape(-1, np.shape(angle)[-1])
    for row in rows:
        known = ~np.isnan(row)
        row[known] = np.unwrap(row[known])
    return rows.reshape(np.shape(angle))
