"""The independent verification of a motion: one table of findings."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.checks.continuation_check import choice_findings, continuation_findings
from compoundkin.analysis.checks.difference_check import difference_findings
from compoundkin.analysis.checks.residuals import centre_findings, residuals
from compoundkin.base.arguments import checked
from compoundkin.base.buffers import without_collection
from compoundkin.base.linear import one_thread
from compoundkin.kinematics import Motion
from compoundkin.kinematics.finding import Check, Checkable, Finding

__all__ = ["Check", "Finding", "verify"]


@checked
@one_thread
def verify(motion: Motion | Checkable) -> Check:
    """Check a motion or its forces, without the formulas that found them.

    Closure, velocities, accelerations and jerks in the pairs' own equations; velocities from centres, and the
    collinearity of every three; derivatives against differences of positions; each pose as the continuation of the one
    before it, and gaps as places to which nothing leads: the groups before the one that is named close there, and that
    one does not; the configuration that is drawn, and the modes that are written. Where rounding leaves fewer digits,
    next to limit positions, `Motion.error` tells how many are held to. At limit positions themselves, which have no
    rates, only the position is checked.

    Of forces: the balance of every link by Newton and Euler, of every pin and of the frame; what each kind of pair can
    carry; the efforts of drivers by virtual work; the balance of power.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> verify(solve(crank)).passed
    True
    """
    if not isinstance(motion, Motion):
        return motion.check()
    closed = int(np.count_nonzero(motion.failed == 0))
    if not closed:
        return Check((), 0, 0)
    # the numbers of many links are many objects, none of which refers to itself
    with np.errstate(all="ignore"), without_collection():
        found = [
            *residuals(motion),
            *centre_findings(motion),
            *difference_findings(motion),
            *continuation_findings(motion),
            *choice_findings(motion),
        ]
    return Check(tuple(found), closed, closed - int(np.count_nonzero(motion.regular)))
