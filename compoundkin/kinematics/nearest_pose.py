"""The pose of a motion that is nearest to the drawing of its mechanism."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import NotAssembled, Problem
from compoundkin.kinematics.motion import Motion

# Places nearer to each other than this part of the size are one.
ROUNDING = 1e-6


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
