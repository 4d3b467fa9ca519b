"""Designs that only solving can tell: their signs, states and lost poses as inputs of a program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.quantities import quantity
from compoundkin.programs.calls.call_numbers import CallNumbers, picked
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.graph.input_kinds import PARAMETER
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.solved_designs import solved_parts
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_number import RecordedNumber

if TYPE_CHECKING:
    from compoundkin.kinematics.motion import Motion
    from compoundkin.programs.path_programs import PathPrograms

# How it is known which poses an output has: at all; where the program finds it assembled; where it was solved.
EVERYWHERE, ASSEMBLED, SOLVED = "everywhere", "assembled", "solved"


def known_poses(path: RecordedPath, names: Sequence[str], how: str) -> tuple[RecordedNumber, dict[str, RecordedNumber]]:
    """Return whether a pose is assembled, and whether each output is known."""
    mechanism = path.mechanism
    if how == SOLVED:
        mask = [RecordedNumber.given(mechanism.graph, _mask(name)) > 0.5 for name in ("", *names)]
        return mask[0], dict(zip(names, mask[1:], strict=True))
    assembled = RecordedLimits(mechanism).failed == 0.0 if how == ASSEMBLED else mechanism.number(True)
    return assembled, dict.fromkeys(names, assembled)


def told_designs(path: PathPrograms, numbers: CallNumbers, designs: Number) -> Iterator[tuple[Number, CallNumbers]]:
    """Solve some designs, and yield what a seeded program is given for them."""
    seeds = path.variant(numbers.still, is_seeded=True).seeds
    names = path.names
    for part, told in solved_parts(path.solved, numbers, designs):
        own = picked(numbers, part)
        found = dict.fromkeys([*map(_mask, ["", *names]), *seeds], np.zeros(own.extent))
        if told:
            found |= {**_masks(told.motion, names), **seed_values(seeds, told.motion)}
        yield part, replace(own, given={**own.given, **found})


def _masks(motion: Motion, names: Sequence[str]) -> Mapping[InputNumber, Number]:
    shape = motion.failed.shape
    values = {name: np.isfinite(quantity(motion, name).values).reshape(shape) for name in names}
    return {_mask(name): known.astype(float) for name, known in {"": motion.failed == 0, **values}.items()}


def _mask(name: str) -> InputNumber:
    """Return the input that tells where an output is known, or without a name which poses are assembled."""
    return InputNumber(PARAMETER, name, "known")
