"""Critical points of the potential of several drivers: by Newton's method from a grid of their values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import NotAssembled
from compoundkin.dynamics.drives.equilibrium_kind import EquilibriumPosition, kind_of
from compoundkin.dynamics.work.held_efforts import HeldEfforts
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve

# So many steps lead from a place of the grid to a critical point, or to none; a step is at most so many spacings.
STEPS, LONGEST = 40, 2.0
# Points nearer than this (radians, parts of the size) are one.
SAME = 1e-6
# Newton's last step leaves so many times the rounding of the efforts: slopes are differences.
LEFT = 1e3


@dataclass(frozen=True, eq=False, repr=False)
class CriticalPoints(ShortRepr):
    """Critical points in a range, or that it is indifferent throughout."""

    positions: tuple[EquilibriumPosition, ...]
    indifferent: bool


def critical_points(motion: Motion, free: tuple[str, ...], rounding: float) -> CriticalPoints:
    """Return the critical points near places of a grid, a motion's designs.

    Efforts below the part `rounding` of what a load asks are none.
    """
    held = HeldEfforts(free)
    scales = held.scales(motion)
    places = _places(motion, free)
    low, high = places.min(axis=0), places.max(axis=0)
    if np.nanmax(np.abs(_efforts(held, motion)) / np.maximum(scales, np.finfo(float).tiny)) <= rounding:
        return CriticalPoints((), True)
    reach = LONGEST * np.array([_spacing(places[:, k]) for k in range(len(free))])
    for _ in range(STEPS):
        efforts, slopes = _efforts(held, motion), np.moveaxis(held.slopes(motion)[..., 0], -1, 0)
        with np.errstate(all="ignore"):
            steps = _steps(slopes, efforts)
        steps = steps / np.maximum(np.max(np.abs(steps) / reach, axis=1, keepdims=True), 1.0)
        places = places - steps
        # what leaves the range leads nowhere; other places of the grid find what is there
        kept = np.all((places >= low - reach) & (places <= high + reach), axis=1)
        again = _solved(motion, free, places[kept]) if np.any(kept) else None
        if again is None:
            return CriticalPoints((), False)
        motion, places = again, places[kept]
        if np.max(np.abs(steps[kept]) / reach) <= rounding:
            break
    small = np.all(np.abs(_efforts(held, motion)) <= LEFT * rounding * scales, axis=1)
    within = np.all((places >= low - SAME * reach) & (places <= high + SAME * reach), axis=1)
    return CriticalPoints(_distinct(motion, held, places, small & within, scales), False)


def _steps(slopes: Number, efforts: Number) -> Number:
    """Return Newton's steps (places, drivers), NaN where there is none."""
    good = np.all(np.isfinite(slopes), axis=(1, 2)) & np.all(np.isfinite(efforts), axis=1)
    good[good] = np.abs(np.linalg.det(slopes[good])) > 0.0
    found = np.full(efforts.shape, np.nan)
    found[good] = np.linalg.solve(slopes[good], efforts[good][..., None])[..., 0]
    return found


def _efforts(held: HeldEfforts, motion: Motion) -> Number:
    return held.at(motion)[..., 0].T


def _places(motion: Motion, free: tuple[str, ...]) -> Number:
    """Return the values of the free drivers, (places, drivers)."""
    shape = motion.failed.shape
    return np.stack([np.broadcast_to(motion.inputs.drives[name][0], shape)[:, 0] for name in free], axis=1)


def _spacing(values: Number) -> float:
    return float(np.min(np.diff(np.unique(values))))


def _solved(motion: Motion, free: tuple[str, ...], places: Number) -> Motion | None:
    """Return the motion at other places of the grid. None where nothing is assembled."""
    values = {name: v[0] for name, v in motion.inputs.drives.items()}
    values |= {name: places[:, k : k + 1] for k, name in enumerate(free)}
    try:
        rest = dict.fromkeys(values, 0.0)
        return solve(motion.mechanism, values, speed=rest, acceleration=rest, order=1)
    except NotAssembled:
        return None


def _distinct(
    motion: Motion, held: HeldEfforts, places: Number, good: Number, scales: Number
) -> tuple[EquilibriumPosition, ...]:
    """Return every point once, in order of the values. Whole turns make no other point."""
    angles = np.array([motion.drives[name].is_angle for name in held.free])
    units = np.array([motion.solving_order.unit(name) for name in held.free])
    slopes = np.moveaxis(held.slopes(motion)[..., 0], -1, 0)
    found: list[int] = []
    for k in np.flatnonzero(good):
        away = places[found] - places[k]
        away = np.where(angles, away - 2.0 * np.pi * np.round(away / (2.0 * np.pi)), away) / units
        if not len(found) or np.max(np.abs(away), axis=1).min() > SAME:
            found.append(int(k))
    found.sort(key=lambda k: tuple(np.round(places[k] / units, 9)))
    held_values = {name: float(np.ravel(v[0])[0]) for name, v in motion.inputs.drives.items() if name not in held.free}
    return tuple(
        EquilibriumPosition(
            {**dict(zip(held.free, places[k].tolist(), strict=True)), **held_values},
            kind_of(slopes[k], scales / units),
            slopes[k],
        )
        for k in found
    )
