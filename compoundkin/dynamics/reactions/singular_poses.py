"""Poses at which a group is singular: whether its forces are finite there, without limit, or left open.

At a change point the equations of a group do not determine its forces, though they do nearby; the limit from both sides
is taken. At a limit position forces grow without limit unless the loads vanish.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import comb

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.motion import Motion

# Forces beside a pose are found at so many places on each side, so far apart (radians, sizes) by the drivers: the
# polynomial through them leaves some 1e-12 of forces that change over a radian, and rounding no more.
PLACES, STEP = 8, 0.01
# All of them are nearer than the next pose.
NEAR_STEP = 0.9
# Limits from both sides, or by one place less, are one where they agree to this part of the greatest force there.
AGREEMENT = 1e-6
FINITE, LEFT_OPEN, INFINITE = "finite", "undetermined", "infinite"
CHANGE_POINT, LIMIT_POSITION = "change point", "limit position"
WrenchesOf = Callable[[Motion], Mapping[str, Wrench]]


@dataclass(frozen=True)
class SingularPose:
    """A pose at which forces follow from the equations of a group no more.

    `pose` is the index into the motion's shape, `kind` "change point" or "limit position", `links` those of the groups.
    `forces` are "finite", the limit from neighbouring poses; "infinite", then these are NaN; or
    "undetermined", where that differs by side.
    """

    pose: tuple[int, ...]
    kind: str
    links: tuple[str, ...]
    forces: str

    def __str__(self) -> str:
        where = ", ".join(map(str, self.pose))
        return f"pose {where}: {self.kind} of {', '.join(self.links)}, forces {self.forces}"


def at_singular_poses(motion: Motion, wrenches: Mapping[str, Wrench], found: WrenchesOf) -> tuple[SingularPose, ...]:
    """Put limits in the place of wrenches at singular poses. Return these poses.

    What has no limit there becomes NaN. `found` gives the wrenches of another motion.
    """
    designs, poses = np.nonzero(_singular(motion, wrenches))
    at = designs, poses
    if not len(poses):
        return ()
    with np.errstate(all="ignore"):
        beside = _Beside.of(motion, at, found)
        worst = np.zeros(len(at[0]), dtype=int)
        for name, wrench in wrenches.items():
            word, limit = beside.limit(name)
            worst = np.maximum(worst, word)
            limit = np.where((word == 0)[:, None], limit, np.nan)
            wrench.force[at], wrench.moment[at] = limit[:, 0] + 1j * limit[:, 1], limit[:, 2] * motion.size
    return tuple(
        _named(motion, design, pose, (FINITE, LEFT_OPEN, INFINITE)[k])
        for design, pose, k in zip(designs.tolist(), poses.tolist(), worst, strict=True)
    )


def _named(motion: Motion, design: int, pose: int, word: str) -> SingularPose:
    at = np.unravel_index(int(design) * motion.inputs.poses + int(pose), motion.shape or (1,))
    kind = CHANGE_POINT if not motion.order or motion.regular[design, pose] else LIMIT_POSITION
    return SingularPose(tuple(int(i) for i in at), kind, _links(motion, design, pose), word)


def _singular(motion: Motion, wrenches: Mapping[str, Wrench]) -> Number:
    """Return the poses at which rates or forces have no limit, and the change points, (designs, poses)."""
    closed = motion.failed == 0
    found = closed & ~motion.regular if motion.order else np.zeros(closed.shape, dtype=bool)
    if motion.is_whole and motion.followed.expanded is not None:
        found[motion.followed.expanded[:2]] = True
    for wrench in wrenches.values():
        found |= closed & ~(np.isfinite(wrench.force) & np.isfinite(wrench.moment))
    return found & closed


def _links(motion: Motion, design: int, pose: int) -> tuple[str, ...]:
    """Return the links of the groups that are singular at a pose."""
    solvers = motion.solving_order.solvers
    if motion.is_whole and motion.followed.expanded is not None and motion.regular[design, pose]:
        which = motion.followed.expanded[2]
        return tuple(link for solver in solvers if solver.index in which for link in solver.group.links)
    for solver in solvers:
        for link in solver.group.links:
            series = (motion.poses[link].z, motion.poses[link].u)
            rates = [np.broadcast_to(c, motion.failed.shape)[design, pose] for part in series for c in part.c[1:]]
            if not np.all(np.isfinite(rates)):
                return tuple(solver.group.links)
    return ()


@dataclass(frozen=True)
class _Beside:
    """Wrenches beside some poses: by name (poses, sides, places, parts), and which sides there are, (poses, sides).

    Parts are x, y, and the moment at the mechanism's size. `powers` are the distances of the places, or their roots.
    """

    values: Mapping[str, Number]
    there: Number
    powers: Number

    @classmethod
    def of(cls, motion: Motion, at: tuple[Number, Number], found: WrenchesOf) -> _Beside:
        """Compute the wrenches; near limit positions they depend on the root of the distance."""
        powers, last = np.arange(1.0, PLACES + 1.0), motion.inputs.poses - 1
        is_limit = ~motion.regular[at] if motion.order else np.zeros(len(at[0]), dtype=bool)
        steps = np.where(is_limit[:, None], powers**2, powers)
        apart = np.stack([_apart(motion, at, side, steps[:, -1]) for side in (-1, 1)], axis=1)
        places = at[1][:, None, None] + apart[..., None] * np.array([-1.0, 1.0])[:, None] * steps[:, None]
        there = np.all((places >= 0.0) & (places <= last), axis=-1)
        if not there.any():
            return cls({}, there, powers)
        picked = np.where(there[..., None], places, at[1][:, None, None])
        beside = between(motion, np.broadcast_to(at[0][:, None, None], picked.shape).ravel(), picked.ravel())
        there = there & np.all(beside.failed.reshape(picked.shape) == 0, axis=-1)
        values = {name: _parts(wrench, motion.size, picked.shape) for name, wrench in found(beside).items()}
        return cls(values, there, powers)

    def limit(self, name: str) -> tuple[Number, Number]:
        """Return whether a wrench has a limit, 0, is open, 1, or has none, 2; and which, (poses, parts)."""
        if name not in self.values:
            return np.ones(len(self.there), dtype=int), np.full((len(self.there), 3), np.nan)
        there = self.there[..., None]
        values = np.where(there[..., None], self.values[name], 0.0)
        bound = AGREEMENT * np.max(np.abs(values), axis=(1, 2, 3))
        poles = np.max(np.abs(_extrapolated(values * self.powers[:, None])), axis=(1, 2))
        limits, fewer = _extrapolated(values), _extrapolated(values[:, :, :-1])
        both = self.there.all(axis=1)
        # from one side alone, by one place less
        apart = np.where(there & ~both[:, None, None], limits - fewer, 0.0)
        apart[both] = (limits[:, :1] - limits[:, 1:])[both]
        is_open = (np.max(np.abs(apart), axis=(1, 2)) > bound) | ~self.there.any(axis=1)
        mean = np.sum(limits, axis=1) / np.maximum(np.sum(self.there, axis=1), 1)[:, None]
        return np.where(~(poles <= bound), 2, np.where(is_open, 1, 0)), mean


def _apart(motion: Motion, at: tuple[Number, Number], side: int, steps: Number) -> Number:
    """Return the distance of the nearest place from each pose, in poses."""
    other = np.clip(at[1] + side, 0, motion.inputs.poses - 1)
    pace: Number = np.zeros(len(other))
    for name, drive in motion.drives.items():
        values = np.broadcast_to(motion.inputs.drives[name][0], motion.failed.shape)
        way = np.abs(values[at[0], other] - values[at]) / (1.0 if drive.is_angle else motion.size)
        pace = np.maximum(pace, way)
    return np.minimum(STEP / np.maximum(pace, STEP), NEAR_STEP / steps)


def _parts(wrench: Wrench, size: float, shape: tuple[int, ...]) -> Number:
    force, moment = np.reshape(wrench.force, shape), np.reshape(wrench.moment, shape)
    return np.stack([force.real, force.imag, moment / size], axis=-1)


def _extrapolated(values: Number) -> Number:
    """Return the value at 0 of the polynomial through equidistant places 1, 2 ..., the axis before the last."""
    count = values.shape[-2]
    weights = np.array([(-1.0) ** k * comb(count, k + 1) for k in range(count)])
    return np.asarray(np.sum(weights[:, None] * values, axis=-2))
