"""Designs solved by `solve` instead of computed: their motion, and the values and seeds that are read off it.

A program hands over designs near limits; poses that are not assembled become NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import FewDigits, InvalidMechanism, NotAssembled, NotDetermined, UnassembledPoses, warn
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.driver_values import inputs
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.modes import StatedModes
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solution import Description, first_configuration, solved, solving_order_of
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.programs.call_numbers import CallNumbers, numbers_of_designs
from compoundkin.programs.graph.operation_graph import DRIVE, SIGN, TURNS, InputNumber, group_seed
from compoundkin.programs.limit_screening import ScreenedDesigns

# Solves the designs of some numbers.
DesignSolver: TypeAlias = Callable[[CallNumbers], Description]


@dataclass(frozen=True)
class ProgramConfiguration(ShortRepr):
    """The configuration of a program: signs of groups, and where they are shown."""

    signs: dict[int, int]
    shown: StatedModes

    @classmethod
    def of(cls, reference: Motion) -> ProgramConfiguration:
        """Return the configuration of a motion of one design."""
        tracker = reference.tracker
        signs = {s.index: int(np.ravel(tracker.signs[s.index])[0]) for s in reference.solving_order.solvers
                 if not s.is_numbered}  # fmt: skip
        # configurations that are numbered are those nearest to the reference, whatever their number in a design
        near = first_configuration(reference, 0) if reference.solving_order.numbered else None
        if near is None or tracker.shown.points:
            return cls(signs, tracker.shown)
        return cls(signs, StatedModes("configuration", near.points, near.poses, near.points))


def solve_in_parts(
    by: DesignSolver, numbers: CallNumbers, designs: Number
) -> Iterator[tuple[Number, Description | None]]:
    """Solve some designs, and yield them in parts.

    It is None where nothing can be built or assembled. One design of which there is nothing must not take the others
    with it.
    """
    if not len(designs):
        return
    try:
        yield designs, by(numbers_of_designs(numbers, designs))
    except (NotAssembled, NotDetermined, InvalidMechanism):
        half = len(designs) // 2
        if not half:
            yield designs, None
            return
        yield from solve_in_parts(by, numbers, designs[:half])
        yield from solve_in_parts(by, numbers, designs[half:])


def solve_designs(
    designed: Mechanism, numbers: CallNumbers, configuration: ProgramConfiguration, order: int
) -> Description:
    """Return the motion of all designs of some numbers; raises NotAssembled as `solve`."""
    solving_order = solving_order_of(designed)
    drives: dict[str, list[object]] = {}
    for one, value in numbers.given.items():
        if one.kind == DRIVE:
            drives.setdefault(one.name, []).append(np.broadcast_to(value, numbers.extent))
    columns = {name: (*values, *[0.0] * (4 - len(values))) for name, values in drives.items()}
    values, *rates = ({name: each[k] for name, each in columns.items()} for k in range(4))
    with np.errstate(all="ignore"):
        given = inputs(solving_order, values, rates[0], rates[1], rates[2])
        return solved(solving_order, given, configuration.signs, configuration.shown, order)


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
            numbers = _group_seeds(motion, block, solvers[name], parts)
        elif name in order.pairs:
            numbers = dict(_contact_seeds(motion, block, name, parts))
        else:
            numbers = {TURNS: motion.poses[name].angle.c[0]}
        found.update({seed: np.array(np.broadcast_to(numbers[seed.part], shape), float) for seed in parts})
    return found


def _group_seeds(motion: Motion, block: Block, solver: GroupSolver, parts: Sequence[InputNumber]) -> dict[str, Number]:
    """Return the sign of a group at every pose, or its state."""
    if any(seed.part == SIGN for seed in parts):
        designs, poses = motion.failed.shape
        return {SIGN: motion.tracker.sign(solver.index, np.arange(designs)[:, None], np.arange(float(poses))[None])}
    return {str(k): number for k, number in enumerate(solver.state(block))}


def _contact_seeds(
    motion: Motion, block: Block, name: str, parts: Sequence[InputNumber]
) -> Iterator[tuple[str, Number]]:
    """Yield a profile's parameter at its contact, and its Taylor coefficients there."""
    pair = as_profile_contact(motion.solving_order.pairs[name])
    assert pair is not None
    parameter = pair.parameter(block.ends[name], tuple(block.world[member] for member in pair.members))
    yield "parameter", parameter
    highest = max((int(seed.part[1:]) for seed in parts if seed.part[0] in "xy"), default=0)
    for k, coefficient in enumerate(pair.curve.expansion(parameter, highest)):
        yield f"x{k}", coefficient.real
        yield f"y{k}", coefficient.imag


def values_near_limits(
    numbers: CallNumbers, names: Sequence[str], arrays: list[Number], look: ScreenedDesigns | None, by: DesignSolver
) -> Number | None:
    """Make outputs certain in place; return which poses failed, None where none did.

    `arrays` are (1 or designs, 1 or poses), and put at their full size in the list; `look` is what was found at limits,
    if any design came near one. Warns UnassembledPoses and FewDigits as `solve`.
    """
    if look is None:
        return None
    for k, array in enumerate(arrays):
        if array.shape != numbers.extent:
            arrays[k] = np.array(np.broadcast_to(array, numbers.extent))
    failed = look.failed
    poor = _put_solved_values(numbers, names, arrays, failed, look.to_solve, by)
    for array in arrays if failed.any() else ():
        array[failed != 0] = np.nan if array.dtype == float else complex(np.nan, np.nan)
    missing = int(np.count_nonzero(failed))
    if missing:
        how_many = f"{missing} of {failed.size} poses cannot be assembled"
        warn(f"{how_many}: assembled masks them, gaps(found.motion(design=...)) explains", UnassembledPoses)
    if poor:
        warn(f"rates at {poor} of {failed.size} poses have fewer than three digits, next to limit positions", FewDigits)
    return failed if missing else None


def _put_solved_values(
    numbers: CallNumbers, names: Sequence[str], arrays: list[Number], failed: Number, designs: Number, by: DesignSolver
) -> int:
    """Put in what solving finds of some designs; return at how many poses rates have few digits."""
    poor = 0
    for part, told in solve_in_parts(by, numbers, designs):
        failed[part] = told.motion.failed if told else 1
        if told:
            for name, array in zip(names, arrays, strict=True):
                array[part] = _solved_values(told.motion, name)
            poor += told.poor
    return poor


def _solved_values(motion: Motion, name: str) -> Number:
    return np.broadcast_to(quantity(motion, name).values.reshape(motion.failed.shape), motion.failed.shape)
