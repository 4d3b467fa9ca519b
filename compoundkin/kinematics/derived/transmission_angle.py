"""The transmission angle of the dyad that solves a link, and the transmission index of any group that does."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.derived.contract import HasQuantities, Lack
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.model.attributes import TRANSMISSION_INDEX
from compoundkin.model.geometry import FRAME


def solver_of_link(motion: HasQuantities, link: str) -> GroupSolver | None:
    """Return what solves the group of a link. None for the frame and the links that drivers place on it."""
    return next((one for one in motion.solving_order.solvers if link in one.group.links), None)


def transmission_angle(motion: HasQuantities, link: str) -> Number:
    """Return the transmission angle of the dyad that solves a link.

    Folded to 0 to pi / 2; a right angle is best, and at 0 nothing is transmitted.
    """
    found = _transmission(motion, link)
    return motion.grid.known(np.arctan2(np.abs(found.imag), np.abs(found.real)))


def transmission_index(motion: HasQuantities, link: str) -> Number:
    """Return the transmission index of the group that solves a link.

    It is 0 to 1, the sine of the transmission angle for a dyad.
    """
    found = _transmission(motion, link)
    with np.errstate(invalid="ignore", divide="ignore"):
        return motion.grid.known(np.abs(found.imag) / np.abs(found))


def _transmission(motion: HasQuantities, link: str) -> Number:
    solver = solver_of_link(motion, link)
    assert solver is not None
    with np.errstate(all="ignore"):
        return solver.transmission(block_of(motion, solver))


def block_of(motion: HasQuantities, solver: GroupSolver) -> Block:
    """Return the poses of a group, and of what it is attached to, as the block in which it is solved."""
    group = solver.group
    poses = {name: motion.poses[name].trimmed(0) for name in (*group.links, *group.uses)}
    local: Mapping[str, Pose] = {
        name: poses[body.links[0]].inverse().compose(poses[name]) for body in group.bodies for name in body.links[1:]
    }
    return Block(motion.grid.failed.shape, motion.inputs.ends, poses, local, 0)


def no_angle(motion: HasQuantities, link: str) -> Lack | None:
    """Return why a link has no transmission angle."""
    solver = solver_of_link(motion, link)
    if solver is not None and solver.has_transmission_angle:
        return None
    if solver is not None and solver.tells_transmission:
        size = len(solver.group.bodies)
        return Lack(f"a group of {size} links has no single angle", f"it has an index: '{link}.{TRANSMISSION_INDEX}'")
    return _no_group(motion, link, solver)


def no_index(motion: HasQuantities, link: str) -> Lack | None:
    """Return why a link has no transmission index."""
    solver = solver_of_link(motion, link)
    return None if solver is not None and solver.tells_transmission else _no_group(motion, link, solver)


def _no_group(motion: HasQuantities, link: str, solver: GroupSolver | None) -> Lack:
    told = [name for name in motion.links if (one := solver_of_link(motion, name)) and one.tells_transmission]
    remedy = f"known: {', '.join(told)}" if told else "no link of this mechanism has one"
    if solver is not None and solver.is_numbered:
        return Lack("no body of its group passes on a single force", remedy)
    if solver is not None:
        return Lack("it moves in fixed proportion to what drives it, as gears do", remedy)
    return Lack("it stands still" if link == FRAME else "a driver moves it, and no force is passed on to it", remedy)
