"""What of a mechanism fails where a design is not assembled, by the number that programs give it."""

from __future__ import annotations

from compoundkin.kinematics.configuration import label
from compoundkin.kinematics.motion import Motion


def is_at_end(motion: Motion, number: int) -> bool:
    """Tell whether it is a guide that is beyond an end.

    Those are numbered behind all groups.
    """
    return number > len(motion.structure.groups)


def failed_name(motion: Motion, number: int) -> str:
    """Return the name of the group that does not close, or of the guide."""
    if is_at_end(motion, number):
        ends = motion.solving_order.guide_ends
        return str(ends.pairs[number - len(motion.structure.groups) - 1].name)
    return label(motion.structure, number - 1)
