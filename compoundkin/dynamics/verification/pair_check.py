"""What each pair can carry, by its Jacobian: no work in any motion that it leaves free, but for its driver's."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import Number, complex_of
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.driver_efforts import DriverEffort
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.structure.parts import LINK_FREEDOMS


def strays(forces: FoundForces) -> Iterator[tuple[str, Number]]:
    """Yield the part of every pair's force that its kind cannot carry. Efforts of drivers are left out.

    A pin has no moment, a slide no force along its guide, a contact only its normal force; a tooth force goes through
    the pitch point, and turns both wheels as they can turn.
    """
    efforts = {step.pair.name: DriverEffort(forces, step).wrench for step in forces.motion.structure.driven.values()}
    for name, wrench in forces.wrenches.items():
        pair = forces.motion.solving_order.pairs[name]
        held = wrench - efforts.get(name, Wrench())
        poses = tuple(forces.motion.poses[link] for link in pair.members)
        rows = pair.jacobian(forces.motion.inputs.ends[name], poses)[..., : pair.held, :]
        if len(pair.members) > 2:
            yield name, _of_wheels(forces, pair, rows, held, poses)
        elif as_transmitting_pair(pair):
            # a force that parts comes with the held one: together they go through the pitch point
            x, y, w = pair.centre(forces.motion.inputs.ends[name], poses)
            yield name, np.abs(held.about(complex_of(x / w, y / w))) / forces.motion.size
        else:
            yield name, _of_two(rows[..., LINK_FREEDOMS:], held, poses[1], forces.motion.size)


def _of_two(rows: Number, held: Wrench, pose: Pose, size: float) -> Number:
    """Return how far a wrench on a link is from the span of what a pair holds there."""
    force, moment = held.force, held.about(pose.z.c[0]) / size
    given = np.stack(np.broadcast_arrays(force.real, force.imag, moment), axis=-1)
    basis = rows / np.array([1.0, 1.0, size])
    basis = basis / np.linalg.norm(basis, axis=-1, keepdims=True)
    if basis.shape[-2] == 1:
        return np.linalg.norm(np.cross(basis[..., 0, :], given), axis=-1)
    across = np.cross(basis[..., 0, :], basis[..., 1, :])
    return np.abs(np.sum(across * given, axis=-1)) / np.linalg.norm(across, axis=-1)


def _of_wheels(forces: FoundForces, pair: Pair, rows: Number, held: Wrench, poses: tuple[Pose, ...]) -> Number:
    """Return the work of a tooth force, as both wheels turn about their own points, by the longer way at the pitch."""
    ends = forces.motion.inputs.ends[pair.name]
    first, second = (held.about(pose.at(end.point).c[0]) for pose, end in zip(poses[:2], ends[:2], strict=True))
    by_first, by_second = rows[..., 0, LINK_FREEDOMS - 1], rows[..., 0, 2 * LINK_FREEDOMS - 1]
    # turning by `by_second` and `-by_first` keeps the closure
    greatest = np.maximum(np.abs(by_first), np.abs(by_second))
    return np.abs(second * by_first + first * by_second) / (greatest * forces.motion.size)
