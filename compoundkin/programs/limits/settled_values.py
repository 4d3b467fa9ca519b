"""Values of a program made certain: poses that are not assembled are no numbers, doubtful designs are solved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.errors import FewDigits, UnassembledPoses, warn
from compoundkin.base.series import Number
from compoundkin.kinematics.quantities import quantity
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.limits.limit_look import LimitLook
from compoundkin.programs.limits.solved_designs import Solving, solved_parts

if TYPE_CHECKING:
    from compoundkin.kinematics.motion import Motion


def settled_values(
    numbers: CallNumbers, names: Sequence[str], arrays: list[Number], look: LimitLook | None, by: Solving
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
    poor = _handed(numbers, names, arrays, failed, look.handed, by)
    for array in arrays if failed.any() else ():
        array[failed != 0] = np.nan if array.dtype == float else complex(np.nan, np.nan)
    missing = int(np.count_nonzero(failed))
    if missing:
        how_many = f"{missing} of {failed.size} poses cannot be assembled"
        warn(f"{how_many}: assembled masks them, gaps(found.motion(design=...)) explains", UnassembledPoses)
    if poor:
        warn(f"rates at {poor} of {failed.size} poses have fewer than three digits, next to limit positions", FewDigits)
    return failed if missing else None


def _handed(
    numbers: CallNumbers, names: Sequence[str], arrays: list[Number], failed: Number, designs: Number, by: Solving
) -> int:
    """Put in what solving finds of some designs; return at how many poses rates have few digits."""
    poor = 0
    for part, told in solved_parts(by, numbers, designs):
        failed[part] = told.motion.failed if told else 1
        if told:
            for name, array in zip(names, arrays, strict=True):
                array[part] = _values(told.motion, name)
            poor += told.poor
    return poor


def _values(motion: Motion, name: str) -> Number:
    return np.broadcast_to(quantity(motion, name).values.reshape(motion.failed.shape), motion.failed.shape)
