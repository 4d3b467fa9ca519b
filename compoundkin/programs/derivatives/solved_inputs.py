"""Solved designs as inputs of a program that differentiates them: their signs, states and unassembled poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
    from compoundkin.kinematics.motion import Motion
    from compoundkin.programs.path_programs import PathPrograms

# How it is known which poses an output has: at all; where the program finds it assembled; where it was solved.
ALL_POSES, ASSEMBLED_POSES, SOLVED_POSES = "everywhere", "assembled", "solved"


def known_poses(path: RecordedPath, names: Sequence[str], how: str) -> tuple[RecordedNumber, dict[str, RecordedNumber]]:
    """Return whether a pose is assembled, and whether each output is known."""
    mechanism = path.mechanism
    if how == SOLVED_POSES:
        mask = [RecordedNumber.given(mechanism.graph, _known_input(name)) > 0.5 for name in ("", *names)]
        return mask[0], dict(zip(names, mask[1:], strict=True))
    assembled = RecordedLimits(mechanism).failed == 0.0 if how == ASSEMBLED_POSES else mechanism.number(True)
    return assembled, dict.fromkeys(names, assembled)


def solved_inputs(path: PathPrograms, numbers: CallNumbers, designs: Number) -> Iterator[tuple[Number, CallNumbers]]:
    """Solve some designs, and yield what a seeded program is given for them."""
    seeds = path.variant(numbers.still, is_seeded=True).seeds
    names = path.names
    for part, told in solve_in_parts(path.solved, numbers, designs):
        own = numbers_of_designs(numbers, part)
        found = dict.fromkeys([*map(_known_input, ["", *names]), *seeds], np.zeros(own.extent))
        if told:
            found |= {**_known_masks(told.motion, names), **seed_values(seeds, told.motion)}
        yield part, replace(own, given={**own.given, **found})


def _known_masks(motion: Motion, names: Sequence[str]) -> Mapping[InputNumber, Number]:
    shape = motion.failed.shape
    values = {name: np.isfinite(quantity(motion, name).values).reshape(shape) for name in names}
    return {_known_input(name): known.astype(float) for name, known in {"": motion.failed == 0, **values}.items()}


def _known_input(name: str) -> InputNumber:
    """Return the input that tells where an output is known, or without a name which poses are assembled."""
    return InputNumber(PARAMETER, name, "known")
