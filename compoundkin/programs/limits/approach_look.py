"""The approach from the drawing to the motion of a call, on which a group may pass between its modes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.approach import approach_path, drawn_value
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion


def approach_values(reference: Motion, shown: Shown, values: Mapping[str, Number]) -> Mapping[str, Number] | None:
    """Return drivers' values on the way from where they are drawn. None where they are drawn on the motion.

    `values` are those of the motion, (1 or designs, 1 or poses).
    """
    if not (shown.poses or shown.beside) or _is_passed(reference, shown, values):
        return None
    designs, poses = np.broadcast_shapes(*(value.shape for value in values.values()))
    given = Inputs((designs, poses), reference.inputs.ends, {name: (value,) for name, value in values.items()})
    way, _ = approach_path(reference.solving_order, given, shown.poses, shown.beside)
    return {name: np.atleast_2d(drive[0]) for name, drive in way.drives.items()} if way.poses > 1 else None


def _is_passed(reference: Motion, shown: Shown, values: Mapping[str, Number]) -> bool:
    """Tell whether the only driver surely comes by its drawn value: this lies between its first value and its last."""
    if len(values) != 1:
        return False
    ((name, value),) = values.items()
    drawn = drawn_driver(reference, shown, name)
    if drawn is None:
        return True
    if np.ndim(drawn) or value.shape[0] > 1:
        return False
    first, last = sorted((value[0, 0], value[0, -1]))
    turn = 2.0 * np.pi if reference.structure.driven_angles[name] else np.inf
    # the next place at or after the first where the driver is as it is drawn
    after = drawn + turn * np.ceil((first - drawn) / turn) if np.isfinite(turn) else drawn
    return bool(first <= after <= last)


def drawn_driver(reference: Motion, shown: Shown, name: str) -> Number | None:
    """Return the value at which a driver is drawn. None where it is not."""
    if not (shown.poses or shown.beside):
        return None
    kept = reference.__dict__.setdefault("_drawn_values", {})
    if name not in kept:
        kept[name] = drawn_value(reference.solving_order, reference.inputs, name, shown.poses, shown.beside)
    return kept[name]
