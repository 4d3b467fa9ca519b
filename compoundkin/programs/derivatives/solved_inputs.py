"""Solved designs as inputs of a program that differentiates them: their signs, states and unassembled poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.quantities import quantity
from compoundkin.programs.call_numbers import CallNumbers, numbers_of_designs
from compoundkin.programs.graph.operation_graph import PARAMETER, InputNumber
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.solved_designs import seed_values, solve_in_parts

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms

# The poses that have an output: all; those that the program itself assembles; those that were solved.
ALL_POSES, ASSEMBLED_POSES, SOLVED_POSES = "everywhere", "assembled", "solved"


def known_poses(path: RecordedPath, names: Sequence[str], how: str) -> tuple[RecordedNumber, dict[str, RecordedNumber]]:
    """Return whether a pose is assembled, and for each output whether it is known there."""
    mechanism = path.mechanism
    if how == SOLVED_POSES:
        mask = [RecordedNumber.given(mechanism.graph, _known_input(name)) > 0.5 for name in ("", *names)]
        return mask[0], dict(zip(names, mask[1:], strict=True))
    assembled = RecordedLimits(mechanism).failed == 0.0 if how == ASSEMBLED_POSES else mechanism.number(True)
    return assembled, dict.fromkeys(names, assembled)


def solved_inputs(path: PathPrograms, numbers: CallNumbers, designs: Number) -> Iterator[tuple[Number, CallNumbers]]:
    """Solve some designs, and yield the numbers of a seeded program for them, part by part."""
    seeds = path.variant(numbers.still, is_seeded=True).seeds
    names = path.names
    for part, solved in solve_in_parts(path.solve, numbers, designs):
        own = numbers_of_designs(numbers, part)
        inputs = dict.fromkeys([*map(_known_input, ["", *names]), *seeds], np.zeros(own.extent))
        if solved:
            motion = solved.motion
            inputs[_known_input("")] = (motion.failed == 0).astype(float)
            for name in names:
                known = np.isfinite(quantity(motion, name).values).reshape(motion.failed.shape)
                inputs[_known_input(name)] = known.astype(float)
            inputs |= seed_values(seeds, motion)
        yield part, replace(own, given={**own.given, **inputs})


def _known_input(name: str) -> InputNumber:
    """Return the input that tells where an output is known, or without a name which poses are assembled."""
    return InputNumber(PARAMETER, name, "known")
