"""How long the steps of an integration may be, and what it means that they become short.

They are short where loads are stiff, which an implicit method goes over; before a jump of a load; and where
coordinates come to their end.
Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, section IV.2.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.friction.coulomb_friction import TINY
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.dormand_prince import PlainSolver
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart

# The integration stalls where a step is below this part of the longest.
STALLED = 1e-7
# In a gap of a table next to a change point steps that short are so for rounding, and each of their states is solved.
STALLED_IN_GAP = 1e-4
# Errors in speeds are measured against this part of the fastest driver's at least.
SLOWEST = 1e-3
# The name of the event where loads are stiff.
STIFFNESS = "stiff"
# Next to a change point errors of steps may be rounding, up to this.
LOOSEST = 1e-7
# At a jump steps have this many times the tolerance at least, as parts of the longest.
HESITATES = 100.0


def hesitates(solver: Any, course: SimulatedCourse) -> bool:
    """Return whether steps are so short that a jump of the loads may be the cause."""
    if solver.status == "failed":
        return True
    small = max(STALLED, HESITATES * course.tolerance) * min(solver.max_step, course.until)
    return bool(solver.step_size < small) and not _grows(course)


def stalls(chart: Chart, solver: Any, course: SimulatedCourse) -> bool:
    """Return whether steps collapse."""
    least = STALLED
    if isinstance(chart, TabulatedChart) and chart.is_in_gap(float(solver.y[0])):
        least = STALLED_IN_GAP
    collapses = solver.step_size is not None and solver.step_size < least * min(solver.max_step, course.until)
    return solver.status == "failed" or (bool(collapses) and not _grows(course))


def _grows(course: SimulatedCourse) -> bool:
    """Return whether steps grow, as behind a jump and at the start, where the first two are alike."""
    if len(course.steps) < 3:
        return True
    before, _, last = (step.last - step.first for step in course.steps[-3:])
    return last > 2.0 * before


# Steps are checked for stiffness so often; they are short for stability alone where they are longer than this over the
# rate at which speeds die away, and the method is changed where that is so at as many checks in a row.
CHECKED, STIFF, IN_A_ROW = 10, 2.0, 5
# The implicit method that was left takes over again where they die away so many times as fast.
STIFFER = 4.0
# A step as long as this part of the time in which speeds die away has collapsed for that, and nothing else.
DYING = 1e-2
# The rate at which speeds die away is found by so many steps of the power method, with this part of the pace.
POWERS, APART = 3, 1e-5


def decay(chart: Chart, solver: Any) -> float:
    """Return the fastest rate at which speeds die away: the dominant derivative of accelerations by speeds."""
    n = len(chart.free)
    y, f = solver.y, solver.f
    scales, found = chart.scales, 0.0
    way = f[n : 2 * n] / scales
    pace = float(np.max(np.abs(y[n : 2 * n]) / scales) + np.sqrt(np.max(np.abs(way))))
    for _ in range(POWERS):
        size = float(np.linalg.norm(way))
        if not size > 0.0:
            return 0.0
        step = APART * pace * way / size
        speeds = y[n : 2 * n] + scales * step
        if isinstance(solver, PlainSolver):
            beside = np.array([solver.rates(solver.t, float(y[0]), float(speeds[0]))[0]])
        else:
            beside = chart.followed_rates(float(solver.t), y[:n], speeds).accelerations
        change = (beside - f[n : 2 * n]) / scales
        found = -float(step @ change) / float(step @ step)
        way = change
    return found


def driver_paces(chart: Chart, speeds: Number, accelerations: Number, duration: float) -> Number:
    """Return the expected pace of each free driver, by its speed or by its acceleration over its scale."""
    quick = np.maximum(np.abs(speeds), np.sqrt(np.abs(accelerations) * chart.scales))
    # a driver at rest without a load is scaled by the others, and these by their scales over the whole time
    found: Number = np.maximum(quick, chart.scales * max(np.max(quick / chart.scales), 1.0 / duration) * SLOWEST)
    return found


def longest_step(chart: Chart, speeds: Number, accelerations: Number) -> float:
    """Return the longest time step in which no driver moves farther than it may."""
    longest = chart.longest_moves
    if len(speeds) == 1:
        scale = float(longest[0])
        rate, growth = abs(float(speeds[0])) / scale, abs(float(accelerations[0])) / scale
    else:
        rate = float(np.max(np.abs(speeds) / longest))
        growth = float(np.max(np.abs(accelerations) / longest))
    # s = v t + a t^2 / 2, solved for the time without cancellation
    return 2.0 / (rate + sqrt(rate * rate + 2.0 * growth) + TINY)


def changes_method(course: SimulatedCourse, chart: Chart, solver: Any) -> bool:
    """Return whether another method takes over.

    That is an implicit one where steps have become so short for stability alone, and the explicit one again where
    its steps would not be shorter than those of the implicit one, which has a lower order.
    """
    if len(course.steps) % CHECKED:
        return False
    rate = decay(chart, solver)
    if course.implicit:
        fits = solver.step_size * rate < STIFF / 2.0
    else:
        fits = solver.step_size * rate > STIFF and rate > STIFFER * course.left
    course.short = course.short + 1 if fits else 0
    if course.short < IN_A_ROW:
        return False
    course.implicit, course.short = not course.implicit, 0
    text = "motions die away so fast that an implicit method (Radau IIA of order 5) takes over"
    if not course.implicit:
        course.left, text = rate, "motions no longer die away so fast: the explicit method takes over"
    course.events.append(SimulationEvent(course.last, STIFFNESS, text, False))
    return True
