"""Values of a program made certain: poses that are not assembled are no numbers, doubtful designs are solved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.errors import FewDigits, InvalidMechanism, NotAssembled, NotDetermined, UnassembledPoses, warn
from compoundkin.base.series import Number
from compoundkin.kinematics.lost_digits import Told
from compoundkin.kinematics.quantities import quantity
from compoundkin.programs.call_numbers import CallNumbers, picked
from compoundkin.programs.limit_look import LimitPrograms

if TYPE_CHECKING:
    from compoundkin.kinematics.motion import Motion

# Solves the designs of some numbers.
Solving = Callable[[CallNumbers], Told]


def settled_values(
    limits: LimitPrograms, numbers: CallNumbers, names: Sequence[str], arrays: list[Number], least: Number, by: Solving
) -> Number | None:
    """Make outputs certain in place; return which poses failed, None where none did.

    `arrays` are (1 or designs, 1 or poses), and put at their full size in the list; `least` is the least of
    `RecordedLimits.certain` over poses, as narrow. Warns UnassembledPoses and FewDigits as `solve`.
    """
    near, early = limits.needed(numbers, least)
    if not (near.any() or early.any()):
        return None
    for k, array in enumerate(arrays):
        if array.shape != numbers.extent:
            arrays[k] = np.array(np.broadcast_to(array, numbers.extent))
    near, early = (np.broadcast_to(each, numbers.extent[:1]) for each in (near, early))
    failed = np.zeros(numbers.extent, dtype=np.int32)
    designs, handed = np.flatnonzero(near), early.copy()
    if len(designs):
        look = limits.look(picked(numbers, designs))
        failed[designs] = look.failed
        handed[designs[look.handed]] = True
    poor = _handed(numbers, names, arrays, failed, np.flatnonzero(handed), by) if handed.any() else 0
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
    try:
        told = by(picked(numbers, designs))
    except (NotAssembled, NotDetermined, InvalidMechanism):
        # one design that cannot be built or assembled at all must not take the others with it
        half = len(designs) // 2
        failed[designs] = 1
        parts = (designs[:half], designs[half:]) if half else ()
        return sum(_handed(numbers, names, arrays, failed, part, by) for part in parts)
    failed[designs] = told.motion.failed
    for name, array in zip(names, arrays, strict=True):
        array[designs] = _values(told.motion, name)
    return told.poor


def _values(motion: Motion, name: str) -> Number:
    return np.broadcast_to(quantity(motion, name).values.reshape(motion.failed.shape), motion.failed.shape)
