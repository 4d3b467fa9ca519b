"""Equilibrium positions: where released drivers rest under weights, springs and loads, and whether they are stable.

For one driver they are zeros of its effort; for several they are critical points of the potential, found by Newton's
method from a grid of values. The stiffness, or the sign of the effort on both sides, gives the kind.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, degrees
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnassembledPoses
from compoundkin.base.linear import one_thread
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.reactions.virtual_work import virtual_efforts
from compoundkin.kinematics.driver_values import by_name
from compoundkin.kinematics.extremes import Measure, between, zeros
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.jacobian import moved_alone, moved_together
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve, solving_order_of
from compoundkin.model.attributes import EFFORT
from compoundkin.model.geometry import real
from compoundkin.model.mechanism import Mechanism

# An effort below this part of that of a single load is zero: rounding of sums of loads.
ROUNDING = 1e-11
# The default grid of several drivers: values of each, and the greatest number of places.
FEW, MANY = 9, 300


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPosition(ShortRepr):
    """An equilibrium position: the drivers' values and its kind.

    It is "stable", "unstable", "saddle" for several drivers, "indifferent" where neighbouring positions are in
    equilibrium as well, or "half-stable". `stiffness` (free drivers, free drivers) are the derivatives of the holding
    efforts by the values.
    """

    values: Mapping[str, float]
    stability: str
    stiffness: Number


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPositions(Sequence[EquilibriumPosition], ShortRepr):
    """The equilibrium positions of a mechanism in a range, in order.

    `free` are the released drivers. An `indifferent` mechanism is in equilibrium at every place of the range, such as a
    lamp balanced by springs, and none is listed.
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
            return f"Indifferent equilibrium: {', '.join(self.free)} need no effort anywhere in the range."
        if not self.positions:
            return "No equilibrium position in the range."
        return "\n".join(self._row(one) for one in self.positions)

    def _row(self, one: EquilibriumPosition) -> str:
        driven = solving_order_of(self.mechanism).structure.driven_angles
        size = solving_order_of(self.mechanism).size
        told = (f"{name} {np.round(degrees(v), 9) + 0.0:.6g}°" if driven[name]
                else f"{name} {np.round(v / size, 12) * size + 0.0:.6g}" for name, v in one.values.items())  # fmt: skip
        return f"{', '.join(told)}: {one.stability}"


@checked
@one_thread
def equilibria(mechanism: Mechanism, values: Any = None) -> EquilibriumPositions:
    """Return the equilibrium positions under weights, springs and loads, with their stability.

    Drivers whose `values` are arrays (radians or lengths, as in `solve`; by default a full turn of the only driver of a
    pin) are released, and are in equilibrium where they need no effort; the others stay at their single values.
    One driver's positions are the zeros of its effort by virtual work between the least and the greatest value, between
    the poses too; those of several are found by Newton's method from a grid of the values. A position is stable
    where the stiffness, the derivative of the efforts by the values, is positive. Friction is left out.

    Raises InvalidInput for a mechanism without units and where no driver is released.

    Source: virtual work and the second variation of the potential, e.g. C. Lanczos, The Variational Principles of
    Mechanics, 4th ed., Dover 1986.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> parts = link("frame", A=0), link("arm", A=0, B=1), drive("arm"), mass("arm", 2, at="B"), gravity(0, -9.81)
    >>> arm = Mechanism("Pendulum", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> print(equilibria(arm).text())
    arm 90°: unstable
    arm 270°: stable
    """
    _check_equilibrium(mechanism)
    with warnings.catch_warnings(action="ignore", category=UnassembledPoses):
        motion, free = _motion(mechanism, values)
        if len(free) == 1:
            return _of_one(motion, free[0])
        found = critical_points(motion, free)
    return EquilibriumPositions(mechanism, free, found.positions, found.indifferent)


def _check_equilibrium(mechanism: Mechanism) -> None:
    _ = mechanism.stated_units
    if not mechanism.loads and not (mechanism.masses and mechanism.gravity != 0):
        remedy = "write gravity(...) and masses, spring(...), force(...)"
        raise InvalidInput(Problem("loads", "nothing acts on the mechanism: every position is in equilibrium", remedy))


def _motion(mechanism: Mechanism, values: Any) -> tuple[Motion, tuple[str, ...]]:
    """Return the motion at rest over the range, and the released drivers. Several make a grid of designs."""
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
        told = "no driver is released" if not free else "a range is not a list of numbers"
        raise InvalidInput(
            Problem("values", told, 'give each driver that is free a range: {"arm": deg(range(0, 361))}')
        )
    if len(free) > 1:
        axes = np.meshgrid(*(np.asarray(given[name], dtype=float) for name in free), indexing="ij")
        given = {**given, **{name: axis.reshape(-1, 1) for name, axis in zip(free, axes, strict=True)}}
    return solve(mechanism, given, speed=rest, acceleration=rest, order=1), free


def _of_one(motion: Motion, driver: str) -> EquilibriumPositions:
    """Return the equilibrium positions of one driver: zeros of its effort."""
    holding = HoldingEfforts((driver,))
    scale = float(holding.scales(motion)[0])

    def effort(at: Motion) -> Number:
        return _zero_where_rounding(holding.at(at)[0], scale).reshape(at.shape)

    found = zeros(motion, Measure(f"{driver}.{EFFORT}", "", 1, effort, scale=scale))
    last = motion.inputs.poses - 1
    if np.any((found.until - found.at.place) >= last - SAME_PLACE):
        return EquilibriumPositions(motion.mechanism, (driver,), (), True)
    there = between(motion, found.at.design, found.at.place, 1)
    values = {name: np.ravel(np.broadcast_to(v[0], there.failed.shape)) for name, v in there.inputs.drives.items()}
    grows = np.sign(_ahead(motion, found.at.place, driver))
    slopes = holding.slopes(there)[0, 0, 0]
    positions = []
    for k in np.argsort(values[driver], kind="stable"):
        stays = found.until[k] > found.at.place[k] + SAME_PLACE
        own = {name: float(v[k]) for name, v in values.items()}
        kind = equilibrium_kind(slopes[k].reshape(1, 1), np.array([scale]), found.sense[k] * grows[k], bool(stays))
        positions.append(EquilibriumPosition(own, kind, slopes[k].reshape(1, 1)))
    return EquilibriumPositions(motion.mechanism, (driver,), tuple(positions), False)


def _zero_where_rounding(values: Number, scale: float) -> Number:
    return np.where(np.abs(values) <= ROUNDING * scale, 0.0, values)


def _ahead(motion: Motion, places: Number, driver: str) -> Number:
    """Return the step of a driver from the pose before each place to the next one."""
    rows = np.ravel(np.broadcast_to(motion.drives[driver].value, motion.failed.shape)[0])
    k = np.clip(np.floor(places).astype(int), 0, motion.inputs.poses - 2)
    return rows[k + 1] - rows[k]


STABLE, UNSTABLE, SADDLE, INDIFFERENT = "stable", "unstable", "saddle", "indifferent"
# Displaced to one side it returns, to the other it departs.
HALF_STABLE = "half-stable"
# A stiffness below this part of a load's effort over a radian, or over the mechanism's size, is zero: the error of
# differences.
NO_STIFFNESS = 1e-8


def equilibrium_kind(stiffness: Number, scales: Number, sense: float = 0.0, stays: bool = False) -> str:
    """Return the kind of an equilibrium.

    Rounding is relative to the stiffnesses `scales`; `sense` is the sign of the slope of a single driver's effort.
    """
    if stays:
        return INDIFFERENT
    root = np.sqrt(np.where(scales > 0.0, scales, 1.0))
    own = stiffness / np.outer(root, root)
    sizes = np.linalg.eigvalsh(own) if np.all(np.isfinite(own)) else np.zeros(1)
    if np.all(np.abs(sizes) > NO_STIFFNESS):
        return STABLE if np.all(sizes > 0) else UNSTABLE if np.all(sizes < 0) else SADDLE
    if len(scales) == 1:
        return {1.0: STABLE, -1.0: UNSTABLE}.get(float(np.sign(sense)), HALF_STABLE)
    return SADDLE if np.any(sizes < -NO_STIFFNESS) and np.any(sizes > NO_STIFFNESS) else INDIFFERENT


# The greatest number of steps from a place of the grid, and the longest step in spacings of the grid.
NEWTON_STEPS, LONGEST = 40, 2.0
# Points nearer than this (radians, parts of the size) are one.
SAME_POINT = 1e-6
# Residuals after Newton's last step, in units of the efforts' rounding: slopes are differences.
RESIDUAL_ROUNDING = 1e3


@dataclass(frozen=True, eq=False, repr=False)
class CriticalPoints(ShortRepr):
    """Critical points in a range, or `indifferent` for a range of them."""

    positions: tuple[EquilibriumPosition, ...]
    indifferent: bool


def critical_points(motion: Motion, free: tuple[str, ...]) -> CriticalPoints:
    """Return the critical points found from a grid of places, which are a motion's designs.

    Efforts below the part `ROUNDING` of a load's are zero.
    """
    holding = HoldingEfforts(free)
    scales = holding.scales(motion)
    places = _places(motion, free)
    low, high = places.min(axis=0), places.max(axis=0)
    if np.nanmax(np.abs(_efforts(holding, motion)) / np.maximum(scales, np.finfo(float).tiny)) <= ROUNDING:
        return CriticalPoints((), True)
    reach = LONGEST * np.array([_spacing(places[:, k]) for k in range(len(free))])
    for _ in range(NEWTON_STEPS):
        efforts, slopes = _efforts(holding, motion), np.moveaxis(holding.slopes(motion)[..., 0], -1, 0)
        with np.errstate(all="ignore"):
            steps = _steps(slopes, efforts)
        steps = steps / np.maximum(np.max(np.abs(steps) / reach, axis=1, keepdims=True), 1.0)
        places = places - steps
        # iterates that leave the range are dropped; others cover it
        kept = np.all((places >= low - reach) & (places <= high + reach), axis=1)
        again = _solved(motion, free, places[kept]) if np.any(kept) else None
        if again is None:
            return CriticalPoints((), False)
        motion, places = again, places[kept]
        if np.max(np.abs(steps[kept]) / reach) <= ROUNDING:
            break
    small = np.all(np.abs(_efforts(holding, motion)) <= RESIDUAL_ROUNDING * ROUNDING * scales, axis=1)
    within = np.all((places >= low - SAME_POINT * reach) & (places <= high + SAME_POINT * reach), axis=1)
    return CriticalPoints(_distinct(motion, holding, places, small & within, scales), False)


def _steps(slopes: Number, efforts: Number) -> Number:
    """Return Newton's steps (places, drivers), NaN where the matrix is singular."""
    good = np.all(np.isfinite(slopes), axis=(1, 2)) & np.all(np.isfinite(efforts), axis=1)
    good[good] = np.abs(np.linalg.det(slopes[good])) > 0.0
    found = np.full(efforts.shape, np.nan)
    found[good] = np.linalg.solve(slopes[good], efforts[good][..., None])[..., 0]
    return found


def _efforts(holding: HoldingEfforts, motion: Motion) -> Number:
    return holding.at(motion)[..., 0].T


def _places(motion: Motion, free: tuple[str, ...]) -> Number:
    """Return the values of the free drivers, (places, drivers)."""
    shape = motion.failed.shape
    return np.stack([np.broadcast_to(motion.inputs.drives[name][0], shape)[:, 0] for name in free], axis=1)


def _spacing(values: Number) -> float:
    return float(np.min(np.diff(np.unique(values))))


def _solved(motion: Motion, free: tuple[str, ...], places: Number) -> Motion | None:
    """Return the motion at other places, None where nothing is assembled."""
    values = {name: v[0] for name, v in motion.inputs.drives.items()}
    values |= {name: places[:, k : k + 1] for k, name in enumerate(free)}
    try:
        rest = dict.fromkeys(values, 0.0)
        return solve(motion.mechanism, values, speed=rest, acceleration=rest, order=1)
    except NotAssembled:
        return None


def _distinct(
    motion: Motion, holding: HoldingEfforts, places: Number, good: Number, scales: Number
) -> tuple[EquilibriumPosition, ...]:
    """Return every point once, in order of the values; full turns do not count."""
    angles = np.array([motion.drives[name].is_angle for name in holding.free])
    units = np.array([motion.solving_order.unit(name) for name in holding.free])
    slopes = np.moveaxis(holding.slopes(motion)[..., 0], -1, 0)
    found: list[int] = []
    for k in np.flatnonzero(good):
        away = places[found] - places[k]
        away = np.where(angles, away - 2.0 * np.pi * np.round(away / (2.0 * np.pi)), away) / units
        if not len(found) or np.max(np.abs(away), axis=1).min() > SAME_POINT:
            found.append(int(k))
    found.sort(key=lambda k: tuple(np.round(places[k] / units, 9)))
    fixed_values = {
        name: float(np.ravel(v[0])[0]) for name, v in motion.inputs.drives.items() if name not in holding.free
    }
    return tuple(
        EquilibriumPosition(
            {**dict(zip(holding.free, places[k].tolist(), strict=True)), **fixed_values},
            equilibrium_kind(slopes[k], scales / units),
            slopes[k],
        )
        for k in found
    )


# Slopes are differences of fourth order with this step (radians, parts of the size): truncation and rounding errors
# are both some 1e-12 of the slope.
STEP = 1e-3
STENCIL = ((-2, 1.0 / 12.0), (-1, -8.0 / 12.0), (1, 8.0 / 12.0), (2, -1.0 / 12.0))


@dataclass(frozen=True, eq=False, repr=False)
class HoldingEfforts(ShortRepr):
    """The efforts that hold the free drivers at rest; the other drivers stay."""

    free: tuple[str, ...]

    def at(self, motion: Motion) -> Number:
        """Return the efforts at rest, (drivers, designs, poses)."""
        found = virtual_efforts(motion, False)
        return np.array([found[name] for name in self.free])

    def slopes(self, motion: Motion) -> Number:
        """Return the derivatives of the efforts by the drivers' values, (effort, value, designs, poses)."""
        columns = []
        for name in self.free:
            step = STEP * motion.solving_order.unit(name)
            parts = (weight * self.at(self._beyond(motion, {name: k * step})) for k, weight in STENCIL)
            columns.append(sum(parts) / step)
        found = np.stack(columns, axis=1)
        return 0.5 * (found + np.swapaxes(found, 0, 1))

    @staticmethod
    def _beyond(motion: Motion, values: Mapping[str, Number]) -> Motion:
        moved: Motion = moved_together(motion, {}, 1, values)
        return moved

    def scales(self, motion: Motion) -> Number:
        """Return the largest effort of a single load at each driver, (drivers,)."""
        found = np.zeros(len(self.free))
        for k, name in enumerate(self.free):
            with np.errstate(all="ignore"):
                for at, unit in zip(loaded_blocks(motion), loaded_blocks(moved_alone(motion, name)), strict=True):
                    for _, link, wrench in at.named_loads():
                        power = np.abs(at.freed(link, wrench).power(unit.pose(link)))
                        found[k] = max(found[k], float(np.max(power, initial=0.0, where=np.isfinite(power))))
        return found
