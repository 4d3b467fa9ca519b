"""The instant centres of a motion, as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.analysis.centres.centre_velocities import (
    CentreVectors,
    Velocities,
    VelocityCheck,
    collinearity_of,
    velocities_of,
    velocity_check,
)
from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation_steps import DerivationStep, crossing_text
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion

# A centre farther away than this many times the mechanism's size is at infinity: rounding hides anything farther.
INFINITY = 1e13
# Below this conditioning fewer than four digits of a centre are left: it is not given.
NOTHING = 1e-12


class Status(IntEnum):
    """Why a centre is given at a pose, or not."""

    FOUND = 0
    NOT_ASSEMBLED = 1
    SINGULAR = 2  # every way to it degenerates at this pose
    AT_REST = 3  # the two links do not move relative to each other
    UNDETERMINED = 4  # geometry and rates do not give it


@dataclass(frozen=True, repr=False)
class Centre(ShortRepr):
    """The relative instant centre of two links. Arrays of the motion's shape, NaN where `status` is not FOUND.

    `homogeneous` (..., 3) is (x, y, w) in the user's length unit, a unit vector in the mechanism's own
    coordinates. `conditioning` is 1 where the centre is as exact as a pin, near 0 where rounding is magnified.
    `how` says how it is derived, `how_at` how it was found at a pose where other lines were better.
    """

    links: tuple[str, str]
    how: str
    homogeneous: Number
    conditioning: Number
    status: Number
    size: float
    elsewhere: tuple[Number, tuple[str, ...]]

    @cached_property
    def at_infinity(self) -> Number:
        """Where it is at infinity, a bool array."""
        x, y, w = np.moveaxis(self.homogeneous, -1, 0)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.abs(w) * (INFINITY * self.size) <= np.hypot(x, y))

    @cached_property
    def point(self) -> Number:
        """Where it is, a complex array; inf where it is at infinity."""
        x, y, w = np.moveaxis(self.homogeneous, -1, 0)
        near = ~self.at_infinity
        with np.errstate(all="ignore"):
            return np.where(near, (x + 1j * y) / np.where(near, w, 1.0), complex(np.inf))

    @cached_property
    def direction(self) -> Number:
        """The direction in which it is at infinity, a unit vector of either sign. NaN where it is finite."""
        x, y, _ = np.moveaxis(self.homogeneous, -1, 0)
        with np.errstate(all="ignore"):
            return np.where(self.at_infinity, (x + 1j * y) / np.hypot(x, y), complex(np.nan, np.nan))

    @property
    def found(self) -> Number:
        """Where it is given, a bool array."""
        return np.asarray(self.status == Status.FOUND)

    def how_at(self, *pose: int) -> str:
        """Return how it was found at one pose, an index into the motion's shape. Raises InvalidInput outside it."""
        shape = np.shape(self.status)
        if len(pose) != len(shape) or any(not -n <= k < n for k, n in zip(pose, shape, strict=True)):
            raise InvalidInput(Problem("pose", f"{pose} is not a pose of a motion of shape {shape}"))
        flat = int(np.ravel_multi_index([k % n for k, n in zip(pose, shape, strict=True)], shape)) if shape else 0
        status = Status(int(np.ravel(self.status)[flat]))
        if status is not Status.FOUND:
            return status.name.lower().replace("_", " ")
        places, texts = self.elsewhere
        at = np.flatnonzero(places == flat)
        return texts[int(at[0])] if at.size else self.how


@dataclass(frozen=True, eq=False)
class Centres(CentreVectors, DisplaysHtml):
    """All n (n - 1) / 2 instant centres of a motion. ``centres["crank", "bar"]``, either link first."""

    def derivation(self) -> tuple[DerivationStep, ...]:
        """Return the steps in order. Primary centres first, then each secondary one with the lines that give it.

        Links that never move relative to each other have no centre and no step.
        """
        return self.plan.steps

    def __getitem__(self, links: tuple[str, str]) -> Centre:
        i, j = self._numbers(links)
        names = (self.plan.diagram.links[i], self.plan.diagram.links[j])
        c = couple(self.plan.body[i], self.plan.body[j])
        if c[0] == c[1]:
            nowhere = np.full((3, 1), np.nan)
            return self._centre(names, "at rest relative to each other", nowhere, np.full(1, np.inf), Status.AT_REST)
        how = self._how[c]
        return self._centre(names, how, self.units[c], self.spread[c], self._missing(c), self._elsewhere(c))

    def __iter__(self) -> Iterator[tuple[str, str]]:
        names = self.plan.diagram.links
        return ((names[i], names[j]) for i, j in self.plan.diagram.couples)

    def __len__(self) -> int:
        return len(self.plan.diagram.couples)

    def _numbers(self, links: Any) -> Couple:
        names = self.plan.diagram.links
        if not isinstance(links, tuple) or len(links) != 2:
            raise InvalidInput(Problem("centre", f"{links!r} are not two links", 'centres["crank", "bar"]'))
        for name in links:
            if name not in names:
                raise UnknownName(Problem(str(name), "there is no such link", suggestion(str(name), names)))
        if links[0] == links[1]:
            raise InvalidInput(Problem("centre", f"{links[0]!r} has no centre relative to itself", "name two links"))
        return names.index(links[0]), names.index(links[1])

    def __repr__(self) -> str:
        return f"Centres({len(self)} of {len(self.plan.diagram.links)} links)"

    @cached_property
    def velocities(self) -> Velocities:
        """Every link's velocity from the centres and the drivers' rates alone."""
        return velocities_of(self)

    def velocity_check(self, motion: Motion | None = None) -> VelocityCheck:
        """Compare solved velocities with those from centres.

        Raises InvalidInput for a motion of order 0.
        """
        motion = motion or self.motion
        motion.grid.require(1)
        return velocity_check(self.velocities, motion)

    def collinearity(self) -> dict[tuple[str, str, str], Number]:
        """Return how far three links' centres are from one line. It is 0 to 1, NaN where one is poor or unknown."""
        return collinearity_of(self)

    @cached_property
    def _how(self) -> dict[Couple, str]:
        links = {name: k for k, name in enumerate(self.plan.diagram.links)}
        return {couple(links[step.centre[0]], links[step.centre[1]]): step.text for step in self.plan.steps}

    @cached_property
    def _at_rest(self) -> Number:
        """Where no driver moves; with several drivers, some centres need them to."""
        return np.all([rate == 0.0 for rate in np.broadcast_arrays(*self.places.rates)], axis=0)

    def _missing(self, c: Couple) -> Status:
        if self._how[c] == "solved velocities" and self.motion.order < 1:
            return Status.UNDETERMINED
        return Status.SINGULAR

    def _elsewhere(self, c: Couple) -> tuple[Number, tuple[str, ...]]:
        if c not in self.lines:
            return np.zeros(0, dtype=int), ()
        at, first, second = self.lines[c]
        texts = tuple(crossing_text(self.plan.diagram, c, (int(a), int(b))) for a, b in zip(first, second, strict=True))
        return at, texts

    def _centre(
        self,
        names: tuple[str, str],
        how: str,
        unit: Number,
        spread: Number,
        otherwise: Status,
        elsewhere: tuple[Number, tuple[str, ...]] = (np.zeros(0, dtype=int), ()),
    ) -> Centre:
        designs, poses = self.motion.inputs.designs, self.motion.inputs.poses
        count = designs * poses
        with np.errstate(all="ignore"):
            conditioning = np.broadcast_to(1.0 / spread, (count,))
        found = conditioning >= NOTHING
        failed = np.broadcast_to(self.motion.failed != 0, (designs, poses)).ravel()
        resting = np.broadcast_to(self._at_rest, (count,)) & (len(self.places.rates) > 1)
        status = np.select([failed, found, resting], [Status.NOT_ASSEMBLED, Status.FOUND, Status.AT_REST], otherwise)
        point = np.where(status == Status.FOUND, self.scale.world(unit), np.nan)
        shape = self.motion.shape
        shown = np.where(failed, np.nan, conditioning)
        return Centre(
            names, how, point.T.reshape(*shape, 3), shown.reshape(shape),
            status.astype(np.int8).reshape(shape), self.scale.size, elsewhere,
        )  # fmt: skip
