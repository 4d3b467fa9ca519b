"""The pose that the drawing of a mechanism shows, and the pose of a motion that is nearest to it."""

from __future__ import annotations

import warnings

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.kinematics.approach import drawn_value
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve

# Places nearer to each other than this part of the size are one.
ROUNDING = 1e-6
# A drawing is exact that is met to this part of the size: what rounding to printed digits never leaves.
DIGITS = 1e-9


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

    None where there is none, or it is not drawn to the last digits.
    """
    shown, sketch = motion.tracker.shown, motion.mechanism.sketch
    values: dict[str, float] = {}
    for name in motion.structure.driven if sketch else ():
        value = drawn_value(motion.solving_order, motion.inputs, name, shown.poses, shown.beside)
        if value is None:
            return None
        values[name] = float(np.ravel(value)[0])
    if not values:
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = solve(motion.structure, values, order=1)
    except (InvalidInput, NotAssembled):
        return None
    off = [abs(complex(np.ravel(found.points[k].position)[0]) - complex(first_entry(p))) for k, p in sketch.items()
           if k in motion.mechanism.carriers]  # fmt: skip
    return found if max(off, default=np.inf) <= DIGITS * motion.size else None
