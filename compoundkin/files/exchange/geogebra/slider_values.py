"""Where sliders begin: at the pose that is shown, as far as it is within their ranges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.errors import InvalidInput, NotAssembled
from compoundkin.files.exchange.shown_mechanism import ShownMechanism, shown_mechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.nearest_pose import turned_within

# What rounding leaves of values, as a part of their range: one at its end seems beyond it by so much.
_ROUNDING = 1e-9
# Points nearer to each other than this part of the size are one.
_SAME = 1e-9


def slider_values(shown: ShownMechanism, motion: Motion) -> tuple[Mapping[str, float], tuple[str, ...]]:
    """Return where sliders begin, and the drivers whose ranges end before that.

    Values are by driver, radians or lengths. An angle beyond its range is told by another one that differs by whole
    turns and is the same pose, which it is not where wheels turn with it. Any other value beyond becomes that end of
    the range which is nearest.
    """
    rows = {name: np.ravel(drive.value) for name, drive in motion.drives.items()}
    wanted = {name: shown.values.get(name, float(row[0])) for name, row in rows.items()}
    lifted = {name: turned_within(value, rows[name]) if motion.structure.driven_angles[name] else value
              for name, value in wanted.items()}  # fmt: skip
    if lifted != wanted and not _is_shown(shown, lifted):
        lifted = wanted
    found = {name: float(np.clip(value, rows[name].min(), rows[name].max())) for name, value in lifted.items()}
    return found, tuple(
        name for name, value in found.items() if abs(value - lifted[name]) > _ROUNDING * np.ptp(rows[name])
    )


def _is_shown(shown: ShownMechanism, values: Mapping[str, float]) -> bool:
    """Return whether the pose at values is the one that is shown."""
    try:
        other = shown_mechanism(shown.mechanism, values)
    except (InvalidInput, NotAssembled):
        return False
    size = shown.mechanism.geometry.size
    return all(
        abs(shown.place(link, letter) - other.place(link, letter)) <= _SAME * size
        for link, own in shown.points.items()
        for letter in own
    )
