"""The configuration of a motion as a mechanism file says it: signs of groups, a drawing where there are none."""

from __future__ import annotations

from compoundkin.kinematics.motion import Motion
from compoundkin.model.elements import Mode, mode


def chosen_signs(motion: Motion) -> tuple[list[Mode], bool]:
    """Return the modes of groups with signs, and whether others need a drawing. The motion has one design.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> chosen_signs(solve(load_named("crank-rocker")))
    ([Mode(links=('coupler',), sign=-1)], False)
    """
    mechanism, solvers = motion.mechanism, motion.solving_order.solvers
    found = []
    for solver in solvers:
        if solver.modes == 2:
            own = next((one for one in mechanism.modes if set(one.links) & set(solver.group.links)), None)
            found.append(mode(motion.sign(solver.index, 0), *(own.links if own else solver.group.links[:1])))
    return found, any(solver.is_numbered for solver in solvers)
