"""Equilibrium positions: where drivers that are let go stay under weights, springs and loads."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, degrees
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnassembledPoses
from compoundkin.dynamics.drives.critical_points import critical_points
from compoundkin.dynamics.drives.equilibrium_kind import EquilibriumPosition, kind_of
from compoundkin.dynamics.work.held_efforts import HeldEfforts
from compoundkin.kinematics.driver_values import by_name
from compoundkin.kinematics.extremes import Measure, between, zeros
from compoundkin.kinematics.extremes.places import SAME_PLACE
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve, solving_order_of
from compoundkin.model.attributes import EFFORT
from compoundkin.model.geometry import real
from compoundkin.model.mechanism import Mechanism

# An effort that is below this part of what a single load asks is none: rounding of sums of some loads.
ROUNDING = 1e-11
# So many values of each of several drivers make the grid where none are given, of so many places at most.
FEW, MANY = 9, 300


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPositions(Sequence[EquilibriumPosition], ShortRepr):
    """The equilibrium positions of a mechanism in a range, in order.

    `free` are the drivers that were let go. Where it is `indifferent` it stays at every place of the range, as a lamp
    that springs balance does, and none is listed.
    """

    mechanism: Mechanism
    free: tuple[str, ...]
    positions: tuple[EquilibriumPosition, ...]
    indifferent: bool

    def __len__(self) -> int:
        return len(self.positions)

    @overload
    def __getitem__(self, index: int) -> EquilibriumPosition: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[EquilibriumPosition, ...]: ...

    def __getitem__(self, index: int | slice) -> EquilibriumPosition | tuple[EquilibriumPosition, ...]:
        """Return one of the positions, or some."""
        return self.positions[index]

    def __iter__(self) -> Iterator[EquilibriumPosition]:
        return iter(self.positions)

    def text(self) -> str:
        """Return them as text, angles in degrees."""
        if self.indifferent:
            return f"It stays wherever it is: {', '.join(self.free)} need no effort anywhere in the range."
        if not self.positions:
            return "No equilibrium position in the range."
        return "\n".join(self._row(one) for one in self.positions)

    def _row(self, one: EquilibriumPosition) -> str:
        driven = solving_order_of(self.mechanism).structure.driven_angles
        size = solving_order_of(self.mechanism).size
        told = (f"{name} {np.round(degrees(v), 9) + 0.0:.6g} deg" if driven[name]
                else f"{name} {np.round(v / size, 12) * size + 0.0:.6g}" for name, v in one.values.items())  # fmt: skip
        return f"{', '.join(told)}: {one.stability}"


@checked
def equilibria(mechanism: Mechanism, values: Any = None) -> EquilibriumPositions:
    """Return the equilibrium positions under weights, springs and loads, with their stability.

    Drivers whose `values` are arrays (radians or lengths, as of `solve`; a full turn of a single driver of a pin
    without them) are let go, and are at rest where they need no effort; the others are held at their single values.
    One driver's positions are the zeros of its effort by virtual work between the least and the greatest value, found
    between the poses; those of several are found by Newton's method from a grid of the values. A position is stable
    where the stiffness, the derivative of the efforts by the values, is positive. Friction is left out.

    Raises InvalidInput for a mechanism without units and where no driver is let go.

    Source: virtual work and the second variation of the potential, e.g. C. Lanczos, The Variational Principles of
    Mechanics, 4th ed., Dover 1986.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import gravity, mass
    >>> parts = link("frame", A=0), link("arm", A=0, B=1), drive("arm"), mass("arm", 2, at="B"), gravity(0, -9.81)
    >>> arm = Mechanism("Pendulum", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> print(equilibria(arm).text())
    arm 90 deg: unstable
    arm 270 deg: stable
    """
    _hold(mechanism)
    with warnings.catch_warnings(action="ignore", category=UnassembledPoses):
        motion, free = _motion(mechanism, values)
        if len(free) == 1:
            return _of_one(motion, free[0])
        found = critical_points(motion, free, ROUNDING)
    return EquilibriumPositions(mechanism, free, found.positions, found.indifferent)


def _hold(mechanism: Mechanism) -> None:
    _ = mechanism.stated_units
    if not mechanism.loads and not (mechanism.masses and mechanism.gravity != 0):
        remedy = "write gravity(...) and masses, spring(...), force(...)"
        raise InvalidInput(Problem("loads", "nothing acts on the mechanism: it stays everywhere", remedy))


def _motion(mechanism: Mechanism, values: Any) -> tuple[Motion, tuple[str, ...]]:
    """Return the motion over the range at rest, and the drivers that are let go. Several make a grid of designs."""
    rest = dict.fromkeys((drive.name for drive in solving_order_of(mechanism).structure.mechanism.drives), 0.0)
    given = by_name(mechanism, values)
    if not given:
        motion = solve(mechanism, speed=rest, acceleration=rest, order=1)
        values_of = {name: np.ravel(drive.value) for name, drive in motion.drives.items()}
        free = tuple(name for name, value in values_of.items() if np.ptp(value) > 0)
        if len(free) == 1:
            return motion, free
        few = min(FEW, int(MANY ** (1.0 / max(len(free), 1))))
        given = {name: np.linspace(np.min(value), np.max(value), few) if name in free else value[:1]
                 for name, value in values_of.items()}  # fmt: skip
    given = {name: real(f"values.{name}", value) for name, value in given.items()}
    free = tuple(name for name, value in given.items() if np.size(value) > 1)
    if not free or any(np.ndim(given[name]) != 1 for name in free):
        told = "no driver is let go" if not free else "a range is not a list of numbers"
        raise InvalidInput(
            Problem("values", told, 'give each driver that is free a range: {"arm": deg(range(0, 361))}')
        )
    if len(free) > 1:
        axes = np.meshgrid(*(np.asarray(given[name], dtype=float) for name in free), indexing="ij")
        given = {**given, **{name: axis.reshape(-1, 1) for name, axis in zip(free, axes, strict=True)}}
    return solve(mechanism, given, speed=rest, acceleration=rest, order=1), free


def _of_one(motion: Motion, driver: str) -> EquilibriumPositions:
    """Return the equilibrium positions of one driver: zeros of its effort."""
    held = HeldEfforts((driver,))
    scale = float(held.scales(motion)[0])

    def effort(at: Motion) -> Number:
        return _none_where_rounding(held.at(at)[0], scale).reshape(at.shape)

    found = zeros(motion, Measure(f"{driver}.{EFFORT}", "", 1, effort, scale=scale))
    last = motion.inputs.poses - 1
    if np.any((found.until - found.at.place) >= last - SAME_PLACE):
        return EquilibriumPositions(motion.mechanism, (driver,), (), True)
    there = between(motion, found.at.design, found.at.place, 1)
    values = {name: np.ravel(np.broadcast_to(v[0], there.failed.shape)) for name, v in there.inputs.drives.items()}
    grows = np.sign(_ahead(motion, found.at.place, driver))
    slopes = held.slopes(there)[0, 0, 0]
    positions = []
    for k in np.argsort(values[driver], kind="stable"):
        stays = found.until[k] > found.at.place[k] + SAME_PLACE
        own = {name: float(v[k]) for name, v in values.items()}
        kind = kind_of(slopes[k].reshape(1, 1), np.array([scale]), found.sense[k] * grows[k], bool(stays))
        positions.append(EquilibriumPosition(own, kind, slopes[k].reshape(1, 1)))
    return EquilibriumPositions(motion.mechanism, (driver,), tuple(positions), False)


def _none_where_rounding(values: Number, scale: float) -> Number:
    return np.where(np.abs(values) <= ROUNDING * scale, 0.0, values)


def _ahead(motion: Motion, places: Number, driver: str) -> Number:
    """Return the way of a driver from the pose before each place to the one behind it."""
    rows = np.ravel(np.broadcast_to(motion.drives[driver].value, motion.failed.shape)[0])
    k = np.clip(np.floor(places).astype(int), 0, motion.inputs.poses - 2)
    return rows[k + 1] - rows[k]
