"""What seeds of a program are at a call: read off a motion that was solved to order 0 in `solve`'s own way."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.motion import Motion
from compoundkin.model.pairs.profile_contact import as_profiled
from compoundkin.programs.graph.input_kinds import SIGN, TURNS, group_seed
from compoundkin.programs.graph.operation_graph import InputNumber


def seed_values(wanted: Collection[InputNumber], motion: Motion) -> dict[InputNumber, Number]:
    """Return the seeds at every pose of a motion.

    Each is an array (designs, poses), NaN where a pose is not assembled. The motion may have any order.
    """
    order, inputs, shape = motion.solving_order, motion.inputs, motion.failed.shape
    block = order.start(inputs.ends, inputs.series(0), 0, shape)
    block.world.update({name: pose.trimmed(0) for name, pose in motion.poses.items()})
    solvers = {group_seed(solver.index): solver for solver in order.solvers}
    found: dict[InputNumber, Number] = {}
    for name in dict.fromkeys(seed.name for seed in wanted):
        parts = [seed for seed in wanted if seed.name == name]
        if name in solvers:
            numbers = _of_group(motion, block, solvers[name], parts)
        elif name in order.pairs:
            numbers = dict(_at_contact(motion, block, name, parts))
        else:
            numbers = {TURNS: motion.poses[name].angle.c[0]}
        found.update({seed: np.array(np.broadcast_to(numbers[seed.part], shape), float) for seed in parts})
    return found


def _of_group(motion: Motion, block: Block, solver: GroupSolver, parts: Sequence[InputNumber]) -> dict[str, Number]:
    """Return the sign of a group at every pose, or its state."""
    if any(seed.part == SIGN for seed in parts):
        designs, poses = motion.failed.shape
        return {SIGN: motion.tracker.sign(solver.index, np.arange(designs)[:, None], np.arange(float(poses))[None])}
    return {str(k): number for k, number in enumerate(solver.state(block))}


def _at_contact(motion: Motion, block: Block, name: str, parts: Sequence[InputNumber]) -> Iterator[tuple[str, Number]]:
    """Yield a profile's parameter at its contact, and its Taylor coefficients there."""
    pair = as_profiled(motion.solving_order.pairs[name])
    assert pair is not None
    parameter = pair.parameter(block.ends[name], tuple(block.world[member] for member in pair.members))
    yield "parameter", parameter
    highest = max((int(seed.part[1:]) for seed in parts if seed.part[0] in "xy"), default=0)
    for k, coefficient in enumerate(pair.curve.expansion(parameter, highest)):
        yield f"x{k}", coefficient.real
        yield f"y{k}", coefficient.imag
