"""The approach from the drawing to the motion of a call, on which a group may pass between its modes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import approach_path, drawn_value
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion


class DrawnApproach(PrintsShort):
    """Where a path's drivers are drawn, and the ways from there to motions."""

    def __init__(self, reference: Motion, shown: Shown) -> None:
        self.reference, self.shown = reference, shown
        self._drawn: dict[str, Number | None] = {}

    @property
    def is_shown(self) -> bool:
        """Whether the configuration is shown anywhere."""
        return bool(self.shown.poses or self.shown.beside)

    def values(self, values: Mapping[str, Number]) -> Mapping[str, Number] | None:
        """Return drivers' values on the way from where they are drawn. None where they are drawn on the motion.

        `values` are those of the motion, (1 or designs, 1 or poses).
        """
        if not self.is_shown or self._is_passed(values):
            return None
        designs, poses = np.broadcast_shapes(*(value.shape for value in values.values()))
        drives = {name: (value,) for name, value in values.items()}
        given = Inputs((designs, poses), self.reference.inputs.ends, drives)
        way, _ = approach_path(self.reference.solving_order, given, self.shown.poses, self.shown.beside)
        return {name: np.atleast_2d(drive[0]) for name, drive in way.drives.items()} if way.poses > 1 else None

    def drawn(self, name: str) -> Number | None:
        """Return the value at which a driver is drawn. None where it is not."""
        if name not in self._drawn:
            order, given, shown = self.reference.solving_order, self.reference.inputs, self.shown
            found = drawn_value(order, given, name, shown.poses, shown.beside) if self.is_shown else None
            self._drawn[name] = found
        return self._drawn[name]

    def _is_passed(self, values: Mapping[str, Number]) -> bool:
        """Tell whether the only driver surely comes by its drawn value."""
        if len(values) != 1:
            return False
        ((name, value),) = values.items()
        drawn = self.drawn(name)
        if drawn is None:
            return True
        if np.ndim(drawn) or value.shape[0] > 1:
            return False
        is_angle = self.reference.structure.driven_angles[name]
        return comes_by(float(drawn), value.item(0), value.item(-1), is_angle)


def comes_by(drawn: float, first: float, last: float, is_angle: bool) -> bool:
    """Tell whether a driver comes by its drawn value on a motion.

    It does where that lies between its first value and its last.

    >>> comes_by(0.5, 6.0, 7.0, True), comes_by(0.5, 6.0, 7.0, False)
    (True, False)
    """
    low, high = (first, last) if first <= last else (last, first)
    # the next place at or after the lower one where the driver is as it is drawn
    after = drawn - TURN * ((drawn - low) // TURN) if is_angle else drawn
    return low <= after <= high
