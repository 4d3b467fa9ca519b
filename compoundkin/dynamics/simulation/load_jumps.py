"""Jumps of loads over speeds and places that steps run into: passed, or such that they hold a speed.

Source: A. F. Filippov, Differential Equations with Discontinuous Righthand Sides, Kluwer 1988: a jump that both sides
lead to holds the motion, by the part of both sides that keeps it there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.driver_chart import BESIDE, DriverChart, HeldSpeed
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse, Step
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent
from compoundkin.dynamics.simulation.step_lengths import STALLED
from compoundkin.dynamics.simulation.stop_contacts import is_no_contact
from compoundkin.dynamics.simulation.watches import JUMP, STICKS
from compoundkin.model.loads.attachments import PairLoad
from compoundkin.model.loads.contract import Load

# A jump of the loads lies so many stalled or so many present steps ahead at the most; halvings find its time to
# rounding. It is a jump where accelerations change by this part of them, most of that between two neighbouring times.
AHEAD, NEXT, HALVINGS, JUMPS, MOST = 64.0, 8.0, 80, 1e-9, 0.5
# Jumps that follow each other within so many stalled steps are one at which the motion cannot go on to either side.
AGAIN, MOST_JUMPS = 1e3, 4
TO_AND_FRO = "the loads change there faster than they can be followed, or hold the motion between two sides of a jump"


class _Jump(NamedTuple):
    """Times just before and behind a jump of the loads, and the course there."""

    before: float
    behind: float
    course: Callable[[Number], Number]


def _next_jump(chart: Chart, solver: Any, course: SimulatedCourse) -> _Jump | None:
    """Return the jump of the loads at which the integrator stalled; None where there is none just ahead.

    Up to the jump accelerations are those of the present state; its time is found by halving.
    """
    n = len(chart.free)
    t, y, rates = float(solver.t), solver.y.copy(), solver.f.copy()

    def after(times: Number) -> Number:
        since = np.atleast_1d(times) - t
        moved = y[:, None] + rates[:, None] * since
        moved[:n] += 0.5 * rates[n : 2 * n, None] * np.square(since)
        return moved if np.ndim(times) else moved[:, 0]

    def accelerations(time: float) -> Number:
        state = after(np.array(time))
        return chart.followed_rates(time, state[:n], state[n : 2 * n]).accelerations

    low, high = t, t + max(AHEAD * STALLED * min(solver.max_step, course.until), NEXT * (solver.step_size or 0.0))
    first, last = rates[n : 2 * n], accelerations(high)
    change = float(np.max(np.abs(last - first)))
    if not change > JUMPS * max(float(np.max(np.abs(one))) for one in (first, last)):
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        found = accelerations(middle)
        if np.max(np.abs(found - first)) > np.max(np.abs(found - last)):
            high = middle
        else:
            low = middle
    jumps = np.max(np.abs(accelerations(high) - accelerations(low))) > MOST * change
    return _Jump(low, high, after) if jumps else None


def beyond_jump(chart: Chart, solver: Any, course: SimulatedCourse) -> Number | None:
    """Return the state behind the jump of the loads at which steps collapse, or held by it; None without one."""
    found = _next_jump(chart, solver, course)
    if found is None:
        return None
    since = found.behind - AGAIN * STALLED * course.until
    recent = [one for one in course.events if one.name == JUMP and one.time > since]
    if len(recent) >= MOST_JUMPS:
        return None
    if found.behind > solver.t:
        course.steps.append(Step(chart, float(solver.t), found.behind, found.course, chart.memory))
    state = found.course(np.array(found.behind))
    held = holding_load(chart, found.behind, state, course)
    if held is None:
        course.events.append(SimulationEvent(found.behind, JUMP, "the loads jump", False))
        return state
    assert isinstance(chart, DriverChart)
    chart.held = held
    n = len(chart.free)
    state[n : 2 * n] = held.moved(chart, found.behind, state[:n], state[n : 2 * n], 0.0)
    tell_held(course, found.behind, held)
    return state


def tell_held(course: SimulatedCourse, time: float, held: HeldSpeed) -> None:
    """Record that a load holds a speed."""
    if held.speed == 0.0:
        course.events.append(SimulationEvent(time, STICKS, f"{held.load.name} holds it at rest", False))
    else:
        text = f"{held.load.name} holds its speed of {held.speed:.6g}"
        course.events.append(SimulationEvent(time, "slides", text, False))


# Speeds below this part of the fastest are zero: that a jump is at rest, and not at rounding beside it.
AT_REST = 1e-9
# Sides of a jump nearer by this show whether it is one.
NARROW = 0.01


def holding_load(chart: Chart, time: float, state: Number, course: SimulatedCourse) -> HeldSpeed | None:
    """Return the load that jumps with its speed at a state and holds it; None where the motion passes the jump.

    By the coordinates of all links none is held.
    """
    if not isinstance(chart, DriverChart):
        return None
    n = len(chart.free)
    loads = [one for some in chart.loads for one in some if one.needs_rates and is_no_contact(one)]
    found = [held for held in (_held_by(load, chart, time, state, course) for load in loads) if held is not None]
    return max(found, key=lambda held: held.jump(chart, time, state[:n], state[n : 2 * n]), default=None)


def _held_by(load: Load, chart: DriverChart, time: float, state: Number, course: SimulatedCourse) -> HeldSpeed | None:
    """Return a load as one that holds its present speed, None where it does not jump there or does not hold it."""
    n = len(chart.free)
    values, speeds = state[:n], state[n : 2 * n]
    loaded = chart.state(time, values, speeds).loaded
    given = load.speed_at(loaded)
    if given is None:
        return None
    pace, speed = _fastest(chart, course, speeds), float(np.ravel(given)[0])
    if isinstance(load, PairLoad) and (plain := load.plain_effort()) is not None:
        # most loads show by themselves that they do not jump
        place = float(np.ravel(loaded.coordinate(load.pair).c[0])[0])
        wide, narrow = (abs(plain(place, speed + part * pace, time) - plain(place, speed - part * pace, time))
                        for part in (BESIDE, NARROW * BESIDE))  # fmt: skip
        if not narrow > MOST * wide:
            return None
    held = HeldSpeed(load, speed if abs(speed) > AT_REST * pace else 0.0, pace)
    if not _holds(held.sides(chart, time, values, speeds)[2]):
        return None
    # what is smooth changes the less the nearer both sides are
    wide, narrow = (
        np.max(np.abs(np.subtract(*(one.accelerations for one in held.sides(chart, time, values, speeds, near)[:2]))))
        for near in (1.0, NARROW)
    )
    return held if narrow > MOST * wide else None


def _holds(part: float) -> bool:
    """Return whether a jump holds a speed by a part of one of its sides; at the ends, rounding does not decide."""
    return -ROUNDING <= part <= 1.0 + ROUNDING


# Parts of the sides of a jump have rounding of this size.
ROUNDING = 1e-9


def _fastest(chart: Chart, course: SimulatedCourse, speeds: Number) -> float:
    """Return the size of the speeds up to now."""
    n = len(chart.free)
    known = [np.abs(step.between(np.array(step.first))[n : 2 * n]) for step in course.steps if step.chart is chart]
    # at rest from the start, what is reached in the whole time or over the scale of a driver
    return float(np.max([np.abs(speeds), *known])) or float(np.max(chart.scales)) / course.until


# The fewest steps of a simulation in which a load holds a speed, and the places of a step at which it is checked.
HELD_STEPS, HELD_SAMPLES = 16, 8


def held_until(chart: Chart, course: SimulatedCourse) -> Number | None:
    """Return the state in which a held speed is left in the last step; None where it is held on."""
    held, step, n = chart.held, course.steps[-1], len(chart.free)
    assert isinstance(chart, DriverChart)
    assert held is not None

    def part(time: float) -> float:
        y = step.between(np.array(time))
        return held.sides(chart, time, y[:n], y[n : 2 * n])[2]

    times = np.linspace(step.first, step.last, HELD_SAMPLES + 1)
    late = next((float(time) for time in times[1:] if not _holds(part(float(time)))), None)
    if late is None:
        return None
    early = late - (step.last - step.first) / HELD_SAMPLES
    while early < (middle := 0.5 * (early + late)) < late:
        early, late = (middle, late) if _holds(part(middle)) else (early, middle)
    course.cut(late)
    y = step.between(np.array(late))
    # what is above 1 leaves upwards
    side = 1.0 if part(late) > 1.0 else -1.0
    y[n : 2 * n] = held.moved(chart, late, y[:n], y[n : 2 * n], side * LEAVES * held.pace)
    chart.held = None
    course.events.append(SimulationEvent(late, "slips", f"{held.load.name} holds its speed no longer", False))
    return y


# A held speed is left at this part of the pace: well above its rounding.
LEAVES = 1e-13
