"""What quantities are read from, and what a figure is: a quantity that only some points, links or pairs have.

Figures of forces are asked of the forces of a motion, which know their values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

from compoundkin.base.arrays import Number
from compoundkin.base.display import display_function
from compoundkin.base.poses import Pose
from compoundkin.kinematics.driver_values import Inputs, PoseGrid
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import FORCES, Kind
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


def force_figures(kind: Kind) -> Mapping[str, Figure]:
    """Return the figures of forces that points, links, pairs or drivers have."""
    return {word: _figure(kind, word) for word in FORCES[kind]}


def _figure(kind: Kind, word: str) -> Figure:
    """Return a figure that is asked of forces. They are known when it is asked for."""

    def own() -> Figure:
        found: Figure = display_function("force_figure")(kind, word)
        return found

    def values(motion: HasQuantities, name: str) -> Number:
        return own().values(forces_of(motion), name)

    def lack(motion: HasQuantities, name: str) -> Lack | None:
        if motion.mechanism.units is None:
            return Lack("the mechanism has no units of mass and force", "state them: Mechanism(..., units={...})")
        return own().lack(motion, name)

    def unit(motion: HasQuantities, name: str) -> str:
        asked = own().unit
        return asked(forces_of(motion), name) if asked else ""

    def scale(motion: HasQuantities, name: str) -> float:
        asked = own().scale
        return asked(forces_of(motion), name) if asked else 0.0

    return Figure(values, lack, unit, scale)


class AsksForces:
    """A motion whose forces can be asked for."""

    loading: Mapping[str, Any]

    @cached_property
    def forces(self) -> Any:
        """Its forces, of `force_analysis` with what is in `loading`."""
        return display_function("forces")(self, **self.loading)


def forces_of(motion: HasQuantities) -> Any:
    """Return the forces of a motion. They are found when they are first asked for."""
    whole: Any = motion
    return whole.forces
