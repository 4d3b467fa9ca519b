"""The independent verification of a motion: one table of findings."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.checks.difference_check import continuity_findings, difference_findings
from compoundkin.analysis.checks.finding import Check, Finding
from compoundkin.analysis.checks.residuals import centre_findings, residuals
from compoundkin.base.arguments import checked
from compoundkin.kinematics import Motion

__all__ = ["Check", "Finding", "verify"]


@checked
def verify(motion: Motion) -> Check:
    """Check a motion in ways that do not use the formulas that solved it.

    Closure, velocities, accelerations and jerks in the pairs' own equations; velocities from centres, and
    the collinearity of every three; derivatives against differences of positions; continuity. Poses that
    cannot be assembled are left out; at limit positions, where rates are infinite, only the position is checked.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> verify(solve(crank)).passed
    True
    """
    with np.errstate(all="ignore"):
        found = [
            *residuals(motion),
            *centre_findings(motion),
            *difference_findings(motion),
            *continuity_findings(motion),
        ]
    closed = int(np.count_nonzero(motion.failed == 0))
    return Check(tuple(found), closed, closed - int(np.count_nonzero(motion.regular)))
