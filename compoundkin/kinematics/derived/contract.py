"""What quantities are read from, and what a figure is: a quantity that only some points, links or pairs have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.kinematics.driver_values import Inputs, PoseGrid
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism


class HasQuantities(Protocol):
    """A motion, or whatever else has points, links, pairs and drivers by name."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism, which tells the unit of lengths."""

    @property
    def points(self) -> Mapping[str, Any]:
        """The points."""

    @property
    def links(self) -> Mapping[str, Any]:
        """The links."""

    @property
    def pairs(self) -> Mapping[str, Any]:
        """The pairs: each tells whether it `is_angle`."""

    @property
    def drives(self) -> Mapping[str, Any]:
        """The drivers: each tells whether it `is_angle`."""

    @property
    def solving_order(self) -> SolvingOrder:
        """What solved it."""

    @property
    def inputs(self) -> Inputs:
        """All numbers it was solved with."""

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""

    @property
    def regular(self) -> Number:
        """Which poses have finite rates, (designs, poses)."""

    @property
    def grid(self) -> PoseGrid:
        """How its numbers are shown."""


@runtime_checkable
class OfMotion(Protocol):
    """What belongs to a motion, whose quantities are its own: forces."""

    @property
    def motion(self) -> HasQuantities:
        """The motion."""


def motion_of(whole: HasQuantities | OfMotion) -> HasQuantities:
    """Return the motion of something, a motion itself."""
    return whole.motion if isinstance(whole, OfMotion) else whole


@dataclass(frozen=True)
class Lack:
    """Why there is no such figure, and what to do about it."""

    reason: str
    remedy: str = ""


@dataclass(frozen=True)
class Figure:
    """A quantity that only some owners have. Its values at every pose, and why others do not have it."""

    values: Callable[[HasQuantities, str], Number]
    lack: Callable[[HasQuantities, str], Lack | None]
    # where it is not that of its attribute
    unit: Callable[[HasQuantities, str], str] | None = None
    # what its rounding is relative to, where that does not follow from the unit
    scale: Callable[[HasQuantities, str], float] | None = None

    def own(self, motion: HasQuantities, name: str) -> dict[str, Any]:
        """Return in what a quantity differs from what follows from its attribute."""
        # a ratio of rates takes velocities, and is no rate itself; nor is a force
        found: dict[str, Any] = {"unit": self.unit(motion, name), "order": 0} if self.unit else {}
        return {**found, "scale": self.scale(motion, name)} if self.scale else found
