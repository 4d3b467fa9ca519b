"""Over which values a driver is followed: a full turn, several where gears ask for them, or lengths within reach."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.circuits.strands import Strands, base
from compoundkin.circuits.sweep import Sweep
from compoundkin.errors import InvalidInput, Problem
from compoundkin.motion.plan import Plan
from compoundkin.motion.steps import AffineStep, TrainStep
from compoundkin.series import Number

# A turn begins here: special positions lie at round angles, and none of them shall fall on the seam.
BEGIN = -2.5066282746310002
# Gears are tried for so many turns of the driver before their mechanism counts as one that never repeats.
MOST_TURNS = 60
# Orientations this near are one: rounding of angles of many turns.
SAME = 1e-9
TURN = 2.0 * np.pi
# Lengths are followed beyond the reach, for a limit position may lie at the reach itself.
BEYOND = 1.25


def range_of(sweep: Sweep, between: Sequence[float] | None) -> tuple[Strands, float]:
    """The strand of the driver alone, and the period of its value (0 where it has none).

    Raises InvalidInput for a range that is none, and for gears that never come back to where they were.
    """
    if between is not None:
        low, high = _checked(between)
        return base(low, high, periodic=False), 0.0
    driven = sweep.plan.driven[sweep.driver]
    if driven.pair.free_is_angle:
        period = TURN * _turns(sweep)
        return base(BEGIN, BEGIN + period, periodic=True), period
    reach = BEYOND * reach_of(sweep.plan)
    on_frame = driven.link in sweep.plan.structure.ground.links
    return base(-reach if on_frame else 0.0, reach, periodic=False), 0.0


def _checked(between: Sequence[float]) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in between)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("between", f"{between!r} is not a range", "give two values (low, high)")) from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise InvalidInput(Problem("between", f"{low:g} to {high:g} is not a range", "give two values (low, high)"))
    return low, high


def reach_of(plan: Plan) -> float:
    """A length that no displacement of links that are pinned to one another exceeds: the sum of their extents."""
    points = plan.structure.mechanism.geometry.points.values()
    return float(sum(_extent(list(placed.values())) for placed in points)) or plan.size


def _extent(points: list[Number]) -> float:
    if len(points) < 2:
        return 0.0
    x, y = ([part(p) for p in points] for part in (np.real, np.imag))
    wide, high = (max(float(np.max(v)) for v in c) - min(float(np.min(v)) for v in c) for c in (x, y))
    return float(np.hypot(wide, high))


def _turns(sweep: Sweep) -> int:
    """After how many turns of the driver the bodies of gear trains are where they were."""
    geared = [k for k, step in enumerate(sweep.plan.steps) if isinstance(step, AffineStep | TrainStep)]
    if not geared:
        return 1
    hung = {link for k in geared for link in sweep.plan.steps[k].hangs_on}  # type: ignore[union-attr]
    turns = TURN * np.arange(MOST_TURNS + 1)[None]
    run = sweep.start(BEGIN + turns)
    for k, step in enumerate(sweep.plan.steps):
        if k in geared and hung <= set(run.world):
            step.run(run)  # type: ignore[call-arg]
    bodies = [run.world[link].u.c[0] for k in geared for link in sweep.plan.steps[k].group.links if link in run.world]
    back = np.max([np.abs(np.broadcast_to(u, turns.shape) - np.ravel(u)[0])[0] for u in bodies], axis=0)
    again = np.flatnonzero(back[1:] < SAME)
    if not len(again):
        what = f"its gears do not come back to where they were within {MOST_TURNS} turns of {sweep.driver!r}"
        raise InvalidInput(Problem(f"drivers.{sweep.driver}", what, "give a range of the driver: between=(low, high)"))
    return int(again[0]) + 1
