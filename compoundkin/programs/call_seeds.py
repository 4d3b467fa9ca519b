"""Seeds of a call: what only solving can tell, at every pose, or where designs begin a march along their motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.call_numbers import CallNumbers
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.ready_program import RecordedPath
from compoundkin.programs.recording.input_kinds import DRIVE, HOLDS, STEP, start_of
from compoundkin.programs.recording.recorded_march import side_of
from compoundkin.programs.seed_values import seed_values
from compoundkin.programs.solved_designs import Solving, solved_parts

# Without compiled code a march of fewer designs than these takes longer than solving them.
FEW = 32


def with_seeds(path: RecordedPath, numbers: CallNumbers, by: Solving, backend: str | None) -> CallNumbers:
    """Return the numbers of a call with the seeds that its program needs. Designs are solved `by` what is given."""
    if not path.seeds:
        return numbers
    designs, poses = numbers.extent
    is_quick = designs >= FEW or chosen_back_end(backend) != "numpy"
    signs = path.mechanism.recording.signs
    if not (path.can_march and poses > 1 and is_quick):
        sides = {side_of(solver): np.zeros((1, 1)) for solver in (path.march.solvers if path.march else ())}
        return replace(numbers, given={**numbers.given, **_found(path.seeds, numbers, by, signs), **sides})
    found = {start_of(one) if one != HOLDS else one: value
             for one, value in _found(path.seeds, _first_poses(numbers), by, signs).items()}  # fmt: skip
    return replace(numbers, given={**numbers.given, **found, **_steps(numbers)})


def _found(
    seeds: tuple[InputNumber, ...], numbers: CallNumbers, by: Solving, signs: Mapping[int, int]
) -> dict[InputNumber, Number]:
    """Return seeds and whether they hold, read off the motions of all designs."""
    found = {one: np.full(numbers.extent, np.nan) for one in seeds}
    holds = np.zeros((numbers.extent[0], 1))
    for designs, told in solved_parts(by, numbers, np.arange(numbers.extent[0])):
        if told:
            holds[designs, 0] = _in_configuration(told.motion, signs)
            for one, value in seed_values(seeds, told.motion).items():
                found[one][designs] = value
    return {**found, HOLDS: holds}


def _in_configuration(motion: Motion, signs: Mapping[int, int]) -> Number:
    """Tell which designs have the signs of a program at all poses."""
    designs, poses = np.arange(motion.failed.shape[0])[:, None], np.arange(float(motion.failed.shape[1]))[None]
    good = np.all(motion.failed == 0, axis=1)
    for k, sign in signs.items():
        own = np.broadcast_to(motion.tracker.sign(k, designs, poses), motion.failed.shape)
        good = good & np.all(own == sign, axis=1)
    return good


def _first_poses(numbers: CallNumbers) -> CallNumbers:
    given = {one: value[:, :1] for one, value in numbers.given.items()}
    return replace(numbers, given=given, shape=(numbers.extent[0], 1))


def _steps(numbers: CallNumbers) -> dict[InputNumber, Number]:
    """Return how far drivers go from each pose to the next."""
    values = {one.name: value for one, value in numbers.given.items() if (one.kind, one.part) == (DRIVE, "0")}
    return {
        InputNumber(DRIVE, name, STEP): np.diff(value, axis=1, append=value[:, -1:]) for name, value in values.items()
    }
