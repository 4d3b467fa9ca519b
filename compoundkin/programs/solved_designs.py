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
from compoundkin.kinematics.curve.modes import StatedModes
from compoundkin.kinematics.driver_values import Inputs, inputs
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solution import Description, first_configuration, solved, solving_order_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.programs.call_numbers import CallNumbers, numbers_of_designs
from compoundkin.programs.graph.operation_graph import DRIVE, PARAMETER, SIGN, TURNS, InputNumber, group_seed
from compoundkin.programs.limit_screening import ScreenedDesigns

# Solves the designs of some numbers.
DesignSolver: TypeAlias = Callable[[CallNumbers], Description]


@dataclass(frozen=True)
class ProgramConfiguration(ShortRepr):
    """The configuration of a program: signs of groups, and the poses that show it."""

    signs: dict[int, int]
    shown: StatedModes

    @classmethod
    def of(cls, reference: Motion) -> ProgramConfiguration:
        """Return the configuration of a motion of one design."""
        curve = reference.followed.curve
        signs = {s.index: int(np.ravel(curve.signs[s.index])[0]) for s in reference.solving_order.solvers
                 if not s.is_numbered}  # fmt: skip
        # of numbered configurations that nearest to the reference is taken, whatever its number in a design
        near = first_configuration(reference, 0) if reference.solving_order.numbered else None
        if near is None or curve.shown.points:
            return cls(signs, curve.shown)
        return cls(signs, StatedModes("configuration", near.points, near.poses, near.points))


def solve_in_parts(
    by: DesignSolver, numbers: CallNumbers, designs: Number
) -> Iterator[tuple[Number, Description | None]]:
    """Solve some designs, and yield them in parts with what `by` returns: None where none can be built or assembled.

    A design that cannot be assembled must not fail the others, so that parts are halved.
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
    with np.errstate(all="ignore"):
        given = inputs_of_numbers(numbers, solving_order)
        return solved(solving_order, given, configuration.signs, configuration.shown, order)


def inputs_of_numbers(numbers: CallNumbers, solving_order: SolvingOrder) -> Inputs:
    """Return the drivers of some numbers."""
    drives: dict[str, list[object]] = {}
    for one, value in numbers.given.items():
        if one.kind == DRIVE:
            drives.setdefault(one.name, []).append(np.broadcast_to(value, numbers.extent))
    columns = {name: (*values, *[0.0] * (4 - len(values))) for name, values in drives.items()}
    values, *rates = ({name: each[k] for name, each in columns.items()} for k in range(4))
    return inputs(solving_order, values, rates[0], rates[1], rates[2])


def seed_values(wanted: Collection[InputNumber], motion: Motion) -> dict[InputNumber, Number]:
    """Return the seeds at every pose of a motion.

    Each is an array (designs, poses), NaN where a pose is not assembled. The motion may have any order.
    """
    order, inputs, shape = motion.solving_order, motion.inputs, motion.failed.shape
    block = order.start(inputs.ends, inputs.series(0), 0, shape)
    block.world.update({name: pose.trimmed(0) for name, pose in motion.poses.items()})
    solvers = {group_seed(solver.index): solver for solver in order.solvers}
    seeds: dict[InputNumber, Number] = {}
    for name in dict.fromkeys(seed.name for seed in wanted):
        parts = [seed for seed in wanted if seed.name == name]
        if name in solvers:
            numbers = _group_seeds(motion, block, solvers[name], parts)
        elif name in order.pairs:
            numbers = dict(_contact_seeds(motion, block, name, parts))
        else:
            numbers = {TURNS: motion.poses[name].angle.c[0]}
        seeds.update({seed: np.array(np.broadcast_to(numbers[seed.part], shape), float) for seed in parts})
    return seeds


def _group_seeds(motion: Motion, block: Block, solver: GroupSolver, parts: Sequence[InputNumber]) -> dict[str, Number]:
    """Return the sign of a group at every pose, or its state."""
    if any(seed.part == SIGN for seed in parts):
        designs, poses = motion.failed.shape
        return {SIGN: motion.followed.sign(solver.index, np.arange(designs)[:, None], np.arange(float(poses))[None])}
    if len(parts) > solver.width:
        # this design has a sign where the program's own has none
        solver = solver.followed() or solver
    return {str(k): number for k, number in enumerate(solver.state(block))}


def _contact_seeds(
    motion: Motion, block: Block, name: str, parts: Sequence[InputNumber]
) -> Iterator[tuple[str, Number]]:
    """Yield a profile's parameter at its contact, and its Taylor coefficients there."""
    pair = as_profile_contact(motion.solving_order.pairs[name])
    assert pair is not None
    parameter = pair.parameter(block.ends[name], tuple(block.world[member] for member in pair.members))
    yield PARAMETER, parameter
    highest = max((int(seed.part[1:]) for seed in parts if seed.part[0] in "xy"), default=0)
    for k, coefficient in enumerate(pair.curve.expansion(parameter, highest)):
        yield f"x{k}", coefficient.real
        yield f"y{k}", coefficient.imag


def values_near_limits(
    numbers: CallNumbers, names: Sequence[str], arrays: list[Number], screened: ScreenedDesigns | None, by: DesignSolver
) -> Number | None:
    """Correct outputs near limits in place; return which poses failed, None where none did.

    `arrays` are (1 or designs, 1 or poses), and in the list brought to their full size; `screened` is None where no
    design came near a limit. Unassembled poses become NaN. Warns UnassembledPoses and FewDigits as `solve`.
    """
    if screened is None:
        return None
    for k, array in enumerate(arrays):
        if array.shape != numbers.extent:
            arrays[k] = np.array(np.broadcast_to(array, numbers.extent))
    failed, imprecise = screened.failed, 0
    for part, result in solve_in_parts(by, numbers, screened.to_solve):
        failed[part] = result.motion.failed if result else np.where(failed[part] == 0, 1, failed[part])
        if result:
            shape = result.motion.failed.shape
            for name, array in zip(names, arrays, strict=True):
                array[part] = np.broadcast_to(quantity(result.motion, name).values.reshape(shape), shape)
            imprecise += result.poor
    for array in arrays if failed.any() else ():
        array[failed != 0] = np.nan if array.dtype == float else complex(np.nan, np.nan)
    missing = int(np.count_nonzero(failed))
    if missing:
        how_many = f"{missing} of {failed.size} poses cannot be assembled"
        warn(f"{how_many}: assembled masks them, gaps(found.motion(design=...)) explains", UnassembledPoses)
    if imprecise:
        few = f"rates at {imprecise} of {failed.size} poses have fewer than three digits"
        warn(f"{few}, next to limit positions", FewDigits)
    return failed if missing else None
