"""The states of designs: whether they assemble over the whole motion, on which branch and circuit, and why not."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.configuration import label
from compoundkin.kinematics.table import ASSEMBLED
from compoundkin.model.attributes import DEGREES, unit_suffix
from compoundkin.studies.responses.assembled_range import AssembledRange, assembled_range
from compoundkin.studies.responses.designs import Designs
from compoundkin.studies.responses.failed_parts import failed_name, is_at_end

STATES = (ASSEMBLED, "branch", "circuit", "order_defect", "reason")
_, BRANCH, CIRCUIT, ORDER_DEFECT, REASON = STATES
# What the sign of a group becomes whose limit position lies within the motion: there both its modes meet.
BOTH = "+-"


def design_states(designs: Designs) -> dict[str, Number]:
    """Return the states of designs by name.

    They are (designs,) each; texts are objects, None where there is none.
    """
    found, modes = assembled_range(designs), designs.path.compiled.modes
    branch = modes if isinstance(modes, str) else modes.name
    defect = np.broadcast_to(_turns_back(designs), designs.number)
    return {
        ASSEMBLED: found.assembled,
        BRANCH: _everywhere(branch, designs),
        CIRCUIT: _circuits(designs, found, branch),
        ORDER_DEFECT: defect.copy(),
        REASON: _reasons(designs, found),
    }


def _everywhere(text: str, designs: Designs) -> Number:
    """Return one text for all designs: the same object, not a million equal ones."""
    return np.repeat(np.array([text], dtype=object), designs.number)


def _turns_back(designs: Designs) -> Number:
    """Tell of which designs a driver does not go through the poses in one sense."""
    found: Number = np.zeros(1, dtype=bool)
    for value, *_ in designs.inputs.drives.values():
        step = np.diff(np.atleast_2d(value), axis=1)
        found = found | ((step > 0.0).any(axis=1) & (step < 0.0).any(axis=1))
    return found


def _circuits(designs: Designs, found: AssembledRange, branch: str) -> Number:
    """Return the branch of each design, with both signs for groups that meet their limit on the way."""
    if found.assembled.all():
        return _everywhere(branch, designs)
    groups = 1 + np.arange(len(designs.path.reference.structure.groups))
    meets = np.array([(found.failed == k).any(axis=1) | (found.between == k) for k in groups])
    kinds, which = np.unique(meets, axis=1, return_inverse=True)
    names = [_circuit(designs, branch, groups[kind] - 1) for kind in kinds.T]
    return np.array([*names, None], dtype=object)[np.ravel(which)]


def _circuit(designs: Designs, branch: str, groups: Number) -> str:
    """Return the name of a branch with both signs for some groups."""
    for k in groups:
        own = label(designs.path.reference.structure, k)
        branch = re.sub(re.escape(own) + "[+-]", own + BOTH, branch)
    return branch


def _reasons(designs: Designs, found: AssembledRange) -> Number:
    """Return why designs are not assembled, which group between which values of the driver; else None."""
    reasons = np.full(designs.number, None, dtype=object)
    lost = np.flatnonzero(~found.assembled)
    if not len(lost):
        return reasons
    bad = found.failed[lost] != 0
    first = np.argmax(bad, axis=1)
    # the first run of poses that are not assembled: to its last one
    after = np.where(bad | (np.arange(designs.poses) < first[:, None]), designs.poses, np.arange(designs.poses))
    last = after.min(axis=1) - 1
    at_poses = bad.any(axis=1)
    group = np.where(at_poses, found.failed[lost, first], found.between[lost])
    begin = np.where(at_poses, first, found.after[lost])
    end = np.where(at_poses, last, -1)
    codes, which = np.unique(np.stack([group, begin, end], axis=1), axis=0, return_inverse=True)
    reasons[lost] = np.array(list(_texts(designs, codes)), dtype=object)[np.ravel(which)]
    return reasons


def _texts(designs: Designs, codes: Number) -> Iterator[str]:
    """Yield what is said of a group that fails from a pose to another; after one pose where that is -1."""
    motion = designs.path.reference
    driver, values, unit = _shown(designs)
    for group, begin, end in codes.tolist():
        why = "is beyond an end" if is_at_end(motion, group) else "cannot be assembled"
        told = f"{failed_name(motion, group)} {why}"
        if end < 0:
            yield f"{told} between {driver} {values[begin]} and {values[begin + 1]}{unit}"
        else:
            yield f"{told} at {driver} {values[begin]}{f' to {values[end]}' if end > begin else ''}{unit}"


def _shown(designs: Designs) -> tuple[str, list[str], str]:
    """Return the only driver that moves, its values and their unit; the numbers of the poses where there is none."""
    moving = {name: value for name, (value, *_) in designs.inputs.drives.items()
              if np.ndim(value) and len(value) == 1 and np.ptp(value)}  # fmt: skip
    if len(moving) != 1:
        return "pose", [str(k) for k in range(designs.poses)], ""
    ((name, value),) = moving.items()
    is_angle = designs.path.reference.structure.driven_angles[name]
    shown = np.rad2deg(value[0]) if is_angle else value[0]
    unit = f" {DEGREES}" if is_angle else unit_suffix(False, designs.path.reference.mechanism.unit)
    return name, [f"{one:.6g}" for one in shown], unit
