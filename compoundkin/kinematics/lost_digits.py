"""Rates of which rounding has left no digit: looked for next to limit positions only, so that solving stays fast."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import factorial
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block, poses_at
from compoundkin.kinematics.error_estimate import LinkErrors, errors_at
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder

# Where the margin, a squared sine, is above this rates have digits enough: a third derivative loses most, at a change
# point, where rounding is divided by the margin squared.
DOUBTFUL = 1e-6
# A group that tells no margin comes to a limit position where it is so many times as fast as the drivers: by the square
# root of the distance, so that it loses digits only far nearer.
FAST = 1e4
# Rates of which no more than this part is uncertain have three digits.
UNCERTAIN = 1e-3


class Told(NamedTuple):
    """A motion without lost rates, and at how many poses they have few digits."""

    motion: Motion
    poor: int


def doubtful(solving_order: SolvingOrder, part: Inputs, block: Block, near: Iterable[int]) -> Number:
    """Return the poses of a block whose rates may have lost digits.

    `near` are the groups with small margins.
    """
    found: Number = np.zeros((1, 1), dtype=bool)
    if not block.order:
        return found
    for k in near:
        found = found | (block.margins[k] < DOUBTFUL)
    silent = [solver for solver in solving_order.solvers if not solver.tells_margin]
    fast = FAST * _pace(solving_order, part) if silent else 0.0
    for name in (body.links[0] for solver in silent for body in solver.group.bodies):
        pose = block.world[name]
        for series, size in ((pose.u, 1.0), (pose.z, solving_order.size)):
            found = found | (np.abs(series.c[1]) > fast * size) if series.order else found
    return found


def _pace(solving_order: SolvingOrder, part: Inputs) -> Number:
    """Return the speed of the fastest driver: radians, or parts of the size, per second."""
    fastest: Number = 0.0
    for name, values in part.drives.items():
        speed = values[1] if len(values) > 1 else 0.0
        fastest = np.maximum(fastest, np.abs(speed) / solving_order.unit(name))
    return fastest


def without_lost(motion: Motion, where: Number) -> Told:
    """Return a motion whose rates without digits are no numbers.

    Return also at how many poses they have fewer than three.

    `where` are the poses that may have such, (designs, poses).
    """
    designs, index = np.nonzero(where & (motion.failed == 0))
    if not len(designs) or not motion.order:
        return Told(motion, 0)
    part, s = motion.inputs.pick(designs, index.astype(float)), index[:, None].astype(float)
    with np.errstate(all="ignore"):
        errors = errors_at(motion.tracker, part, motion.order, s, designs[:, None])
        poses = poses_at(motion.poses, motion.failed.shape, designs, index)
        allowed = _natural(poses, motion.order, motion.size)
        lost = {name: [~(e <= a) for e, a in zip(found, allowed, strict=True)] for name, found in errors.items()}
        few = _any(errors, [UNCERTAIN * a for a in allowed]) & ~_any(errors, allowed)
    if not any(np.any(one) for found in lost.values() for one in found[1:]):
        return Told(motion, int(np.count_nonzero(few)))
    kept = {name: _kept(pose, lost[name]) if name in lost else pose for name, pose in poses.items()}
    return Told(motion.mended(designs, index, kept), int(np.count_nonzero(few)))


def uncertain(motion: Motion) -> Number:
    """Return the poses at which some rates have fewer than three digits, (designs, poses)."""
    found: Number = np.zeros(motion.failed.shape, dtype=bool)
    with np.errstate(all="ignore"):
        allowed = _natural(motion.poses, motion.order, motion.size)
        for k in range(1, motion.order + 1):
            error = motion.error(k).reshape(motion.failed.shape)
            found = found | (np.isfinite(error) & ~(error <= UNCERTAIN * allowed[k]))
    return found


def _any(errors: LinkErrors, allowed: list[Number]) -> Number:
    """Return the poses at which any link's rates are more uncertain than is allowed."""
    found: Number = np.zeros((1, 1), dtype=bool)
    for link in errors.values():
        for error, most in zip(link[1:], allowed[1:], strict=True):
            found = found | ~(error <= most)
    return found


def _natural(poses: Mapping[str, Pose], order: int, size: float) -> list[Number]:
    """Return the largest derivative of any link at each pose, in each order; no less than speeds to that power."""
    found, speed = list[Number](), 0.0
    for k in range(order + 1):
        largest: Number = 0.0
        for pose in poses.values():
            for series, unit in ((pose.z, 1.0), (pose.u, size)):
                value = np.abs(series.c[k]) * factorial(k) * unit if k < len(series.c) else 0.0
                largest = np.fmax(largest, np.where(np.isfinite(value), value, 0.0))
        speed = largest / size if k == 1 else speed
        found.append(np.maximum(largest, size * speed**k) if k else largest)
    return found


def _kept(pose: Pose, lost: list[Number]) -> Pose:
    """Return a pose with what is lost, and all higher derivatives, no numbers."""

    def part(series: Series) -> Series:
        kept, gone = [series.c[0]], np.zeros((1, 1), dtype=bool)
        for k, here in enumerate(lost[1:], start=1):
            gone = gone | here
            kept.append(np.where(gone, np.nan, series.c[k] if k < len(series.c) else 0.0))
        return Series(tuple(kept))

    return pose.mapped(part)
