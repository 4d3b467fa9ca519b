"""The pose that the drawing of a mechanism shows, and the pose of a motion that is nearest to it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.arrays import Number, first_entry, turns_above
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.kinematics.curve.driver_path import drawn_value
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import quietly_solved

# Places nearer to each other than this part of the size are one.
ROUNDING = 1e-6
# A drawing is exact that is met to this part of the size: what rounding to printed digits never leaves.
DIGITS = 1e-9
# What rounding leaves of angles (radians): one at the end of a range seems beyond it by so much.
_ROUNDING = 1e-9


def pose_nearest_to_drawing(motion: Motion) -> int:
    """Return the index of the assembled pose nearest to the drawn points. Of several that are, the first.

    Raises NotAssembled where there is none.

    >>> from compoundkin.model.elements import drawn, drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.kinematics import solve
    >>> crank = link("frame", A=0), link("crank", A=0, B=2), drive("crank"), drawn(A=0, B=2j)
    >>> pose_nearest_to_drawing(solve(Mechanism("m", *crank), {"crank": [0.0, 1.5, 3.0]}))
    1
    """
    known = np.flatnonzero(np.ravel(motion.failed) == 0)
    if not known.size:
        what = "no pose of its motion can be assembled"
        raise NotAssembled(Problem(motion.mechanism.title, what, "gaps() tells why; name another pose"))
    off = np.zeros(known.size)
    for letter, drawn in motion.mechanism.sketch.items():
        if letter in motion.mechanism.carriers:
            places = np.ravel(motion.points[letter].position)
            off += np.abs((places if places.size == 1 else places[known]) - first_entry(drawn)) ** 2
    near = known[off <= off.min() + (ROUNDING * motion.size) ** 2]
    return int(near[0])


def exactly_drawn(motion: Motion) -> Motion | None:
    """Return the pose that the drawing shows, solved to the first order.

    None where there is none, or it is not drawn to the last digits. Drivers' angles are within the motion's ranges if
    whole turns bring them there and it is the same pose.
    """
    shown, sketch = motion.followed.curve.shown, motion.mechanism.sketch
    values: dict[str, float] = {}
    for name in motion.structure.driven if sketch else ():
        value = drawn_value(motion.solving_order, motion.inputs, name, shown.poses, shown.beside)
        if value is None:
            return None
        values[name] = float(np.ravel(value)[0])
    if not values:
        return None
    inside = {
        name: turned_within(value, motion.drives[name].value) if motion.structure.driven_angles[name] else value
        for name, value in values.items()
    }
    found = _drawn_at(motion, inside)
    return _drawn_at(motion, values) if found is None and inside != values else found


def turned_within(angle: float, row: Number) -> float:
    """Return an angle within a range that differs by whole turns.

    It is the angle itself where there is none.

    >>> turned_within(-1.0, np.array([5.0, 6.0])), turned_within(-1.0, np.array([0.0, 1.0]))
    (5.283185307179586, -1.0)
    """
    low, high = float(np.min(row)) - _ROUNDING, float(np.max(row)) + _ROUNDING
    if low <= angle <= high:
        return angle
    found = angle - float(turns_above(np.float64(angle), np.float64(low)))
    return found if found <= high else angle


def _drawn_at(motion: Motion, values: Mapping[str, float]) -> Motion | None:
    """Return the pose at driver values if it is the drawn one."""
    sketch = motion.mechanism.sketch
    try:
        found = quietly_solved(motion.structure, values)
    except (InvalidInput, NotAssembled):
        return None
    off = [abs(complex(np.ravel(found.points[k].position)[0]) - complex(first_entry(p))) for k, p in sketch.items()
           if k in motion.mechanism.carriers]  # fmt: skip
    return found if max(off, default=np.inf) <= DIGITS * motion.size else None
