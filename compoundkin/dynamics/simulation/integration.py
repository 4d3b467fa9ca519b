"""The equation of motion integrated by an explicit method, and the course of its steps and states, chart by chart.

Source: E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
section II.10: the method of Dormand and Prince of order 8, as SciPy has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.simulation.coordinate_change import driven_there, fastest_pairs
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import SimulatedState
from compoundkin.dynamics.simulation.simulation_events import (
    END,
    REST,
    SimulationEvent,
    Watch,
    after_impact,
    ended_pair,
    first_passed,
)
from compoundkin.dynamics.simulation.tabulated_chart import FASTER

# The longest step of a driver (radians, parts of the size), so that configurations and turns are tracked.
LONGEST_MOVE = 1.0
# The motion ends where a pair moves so many times as fast as a driver and cannot replace it.
LIMIT = 1e4
# The integration stalls where a step is below this part of the longest.
STALLED = 1e-7
# The name of the event where a load jumps.
JUMP = "jump"
# The name of the event where friction holds a mechanism.
STICKS = "sticks"
# Errors in speeds are measured against this part of the fastest driver's at least.
SLOWEST = 1e-3
# Progress counts so many parts.
PARTS = 1000
Progress = Callable[[int, int], None]


def integrate(chart: DriverChart, state: Number, course: SimulatedCourse, progress: Progress | None) -> None:
    """Add the steps and events that follow from a state of a chart."""
    n = len(chart.free)
    solver = _begun(chart, 0.0, state, course)
    while solver is not None and solver.status == "running":
        solver.max_step = longest_step(chart, solver.y[n : 2 * n], solver.f[n : 2 * n])
        solver.h_abs = min(solver.h_abs, solver.max_step)
        solver.step()
        if solver.status == "failed":
            return _stop(course, "limit", "the motion comes to a limit position")
        course.steps.append(Step(chart, float(solver.t_old), float(solver.t), solver.dense_output(), chart.memory))
        passed = _passed(course) if course.watched else None
        if passed is not None and (passed.state is None or passed.time >= course.until):
            return None
        if passed is None:
            chart.accept(solver.t, solver.y[:n], solver.y[n : 2 * n])
            changed = _changed(chart, solver, course)
            if changed is not None:
                chart, state = changed
                solver = _begun(chart, course.last, state, course)
        else:
            solver = _begun(chart, passed.time, passed.state, course)
        if progress is not None:
            progress(int(PARTS * course.last / course.until), PARTS)
    return None


def _begun(chart: DriverChart, time: float, state: Number, course: SimulatedCourse) -> Any:
    """Return the integrator from a state, after a rest where friction holds it; None where it stays at rest."""
    n = len(chart.free)
    values, speeds = state[:n], state[n : 2 * n]
    if chart.begin(time, values, speeds):
        return _solver(chart, time, state, course)
    last = chart.released(time, values, course.until)
    course.events.append(SimulationEvent(time, STICKS, "friction holds the mechanism", False))
    course.steps.append(Step(chart, time, last, _resting(state), chart.memory))
    if last >= course.until:
        return None
    course.events.append(SimulationEvent(last, "slips", "the loads overcome friction", False))
    chart.begin(last, values, speeds)
    return _solver(chart, last, state, course)


def _resting(state: Number) -> Callable[[Number], Number]:
    """Return a constant state as a function of time."""
    return lambda times: np.repeat(state[:, None], len(times), axis=1) if np.ndim(times) else state


class _Interruption(NamedTuple):
    """The time at which the course is interrupted, and the state from which it continues, None at the end."""

    time: float
    state: Number | None


def _passed(course: SimulatedCourse) -> _Interruption | None:
    """Record the events of the last step; return the interruption by one, if any."""
    step = course.steps[-1]
    for one in first_passed(course.watched, step.chart, (step.first, step.last), step.between):
        n, watch = len(step.chart.free), one.watch
        if watch.name == REST and not watch.asked:
            course.cut(one.time)
            return _Interruption(one.time, np.array([*one.state[:n], *np.zeros(n), one.state[-1]]))
        here = SimulatedState(step.chart.state(one.time, one.state[:n], one.state[n : 2 * n]))
        is_end = watch.name == END and not watch.asked
        text = f"{ended_pair(here).name} comes to an end of its guide" if is_end else watch.text
        if watch.falls and one.time <= 0.0:
            raise InvalidInput(Problem("start", f"{text} at once", "start elsewhere, or with other loads"))
        rebounds = is_end and course.restitution is not None
        impact = after_impact(here, course.restitution or 0.0, course.fastest) if rebounds else None
        stops = watch.stops and impact is None
        course.events.append(SimulationEvent(one.time, watch.name, text, stops))
        if stops or impact is not None:
            course.cut(one.time)
        if stops:
            return _Interruption(one.time, None)
        if impact is not None:
            course.fastest = max(course.fastest, impact.approach)
            return _Interruption(one.time, np.array([*one.state[:n], *impact.speeds, one.state[-1] - impact.lost]))
    return None


def _changed(chart: DriverChart, solver: Any, course: SimulatedCourse) -> tuple[DriverChart, Number] | None:
    """Return another chart and its state to continue with; None where the present one is regular or none is better."""
    n = len(chart.free)
    stalls = solver.step_size < STALLED * min(solver.max_step, course.until)
    if chart.is_regular(solver.y[:n]) and not stalls:
        return None
    here = chart.state(solver.t, solver.y[:n], solver.y[n : 2 * n])
    pairs = fastest_pairs(chart, here)
    if stalls and not any(one.ratio >= FASTER for one in pairs):
        beyond = _beyond_jump(chart, solver, course)
        if beyond is not None:
            return chart, beyond
        solver.status = "finished"
        text = "the loads change there faster than they can be followed, or hold the motion between two sides of a jump"
        _stop(course, JUMP, text)
        return None
    fast = [one for one in pairs if one.ratio >= FASTER or stalls]
    is_new = course.last - course.changed > STALLED * course.until
    for one in fast if is_new or not stalls else ():
        found = driven_there(chart, here, one)
        if found is not None:
            course.changed = course.last
            text = f"next to a limit position of {one.driver}, {one.pair.name} takes its place as the coordinate"
            course.events.append(SimulationEvent(course.last, "coordinate", text, False))
            return found[0], np.append(found[1], solver.y[-1])
    if stalls or (fast and fast[0].ratio > LIMIT):
        driver = fast[0].driver if fast else chart.free[0]
        _ended(solver, course, f"{driver} comes to a limit position, and no other pair can take its place")
    return None


# A jump of the loads lies so many stalled steps ahead at the most; halvings find its time to rounding. It is a jump
# where accelerations differ by this part on both sides of it.
AHEAD, HALVINGS, JUMPS = 64.0, 60, 1e-6
# Jumps that follow each other within so many stalled steps are one at which the motion cannot go on to either side.
AGAIN, MOST_JUMPS = 1e3, 4


def _beyond_jump(chart: DriverChart, solver: Any, course: SimulatedCourse) -> Number | None:
    """Return the state behind a jump of the loads at which the integrator stalled; None where there is none just ahead.

    Up to the jump accelerations are those of the present state; its time is found by halving.
    """
    n = len(chart.free)
    t, y, rates = float(solver.t), solver.y.copy(), solver.f.copy()

    def after(times: Number) -> Number:
        moved = y[:, None] + rates[:, None] * times
        moved[:n] += 0.5 * rates[n : 2 * n, None] * np.square(times)
        return moved

    def accelerations(time: float) -> Number:
        state = after(np.array([time]))[:, 0]
        return chart.rates(t + time, state[:n], state[n : 2 * n]).accelerations

    def jumps(time: float) -> bool:
        change = np.abs(accelerations(time) - rates[n : 2 * n])
        return bool(np.any(change > JUMPS * (1.0 + np.abs(rates[n : 2 * n]))))

    low, high = 0.0, AHEAD * STALLED * min(solver.max_step, course.until)
    if not jumps(high):
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if jumps(middle) else (middle, high)
    recent = [one for one in course.events if one.name == JUMP and t - one.time < AGAIN * STALLED * course.until]
    if len(recent) >= MOST_JUMPS:
        return None
    course.steps.append(Step(chart, t, t + high, lambda times: _one_or_many(after, times - t), chart.memory))
    course.events.append(SimulationEvent(t + high, JUMP, "the loads jump", False))
    return after(np.array([high]))[:, 0]


def _one_or_many(states: Callable[[Number], Number], times: Number) -> Number:
    """Return states in columns, or the state at a single time."""
    found = states(np.atleast_1d(times))
    return found if np.ndim(times) else found[:, 0]


def _ended(solver: Any, course: SimulatedCourse, text: str) -> None:
    """Stop the simulation at its present state."""
    solver.status = "finished"
    _stop(course, "limit", text)


def _stop(course: SimulatedCourse, name: str, text: str) -> None:
    course.events.append(SimulationEvent(course.last, name, text, True))


def _solver(chart: DriverChart, time: float, state: Number, course: SimulatedCourse) -> Any:
    """Return SciPy's integrator at a state of a chart."""
    from scipy.integrate import DOP853

    n = len(chart.free)

    def grown(at: float, y: Number) -> Number:
        course.evaluations += 1
        found = chart.rates(at, y[:n], y[n : 2 * n])
        return np.concatenate([y[n : 2 * n], found.accelerations, [found.power]])

    rates = grown(time, state)
    pace = _driver_paces(chart, state[n : 2 * n], rates[n : 2 * n], course.until - time)
    energy = chart.state(time, state[:n], pace).kinetic
    allowed = np.concatenate([chart.scales, pace, [energy]]) * course.tolerance
    return DOP853(grown, time, state, course.until, rtol=course.tolerance, atol=allowed)


def _driver_paces(chart: DriverChart, speeds: Number, accelerations: Number, duration: float) -> Number:
    """Return the expected pace of each free driver, by its speed or by its acceleration over its scale."""
    quick = np.maximum(np.abs(speeds), np.sqrt(np.abs(accelerations) * chart.scales))
    # a driver at rest without a load is scaled by the others, and these by their scales over the whole time
    found: Number = np.maximum(quick, chart.scales * max(np.max(quick / chart.scales), 1.0 / duration) * SLOWEST)
    return found


def longest_step(chart: DriverChart, speeds: Number, accelerations: Number) -> float:
    """Return the longest time step in which no driver exceeds LONGEST_MOVE."""
    rate = np.max(np.abs(speeds) / chart.scales)
    growth = np.max(np.abs(accelerations) / chart.scales)
    # s = v t + a t^2 / 2, solved for the time without cancellation
    return float(
        2.0 * LONGEST_MOVE / (rate + np.sqrt(rate * rate + 2.0 * growth * LONGEST_MOVE) + np.finfo(float).tiny)
    )


@dataclass(frozen=True, eq=False)
class Step:
    """A step of the integration: its chart, its times, and the state as a function of time."""

    chart: DriverChart
    first: float
    last: float
    between: Callable[[Number], Number]
    memory: tuple[Any, ...]  # the configuration at its beginning

    def accelerations_at(self, times: Number, states: Number) -> Number:
        """Return the accelerations of the free drivers at times in the step, in columns."""
        n = len(self.chart.free)
        self.chart.recall(self.memory)
        found = [self.chart.accelerations_at(t, y[:n], y[n : 2 * n]) for t, y in zip(times, states.T, strict=True)]
        return np.array(found).T


@dataclass(frozen=True, eq=False)
class ChartStretch:
    """The course in one chart, with states in columns, its first and last among them.

    `asked` is a mask of the requested times.
    """

    chart: DriverChart
    times: Number
    states: Number
    accelerations: Number
    asked: Number


@dataclass(eq=False)
class SimulatedCourse:
    """The steps from the start. A state is the free drivers' values, their speeds, and the work done.

    `fastest` is the approach speed of the fastest impact.
    """

    until: float
    tolerance: float
    watched: tuple[Watch, ...] = ()
    restitution: float | None = None
    steps: list[Step] = field(default_factory=list)
    events: list[SimulationEvent] = field(default_factory=list)
    evaluations: int = 0
    fastest: float = 0.0
    changed: float = -np.inf  # the time of the last change of coordinate

    def at(self, times: Number) -> list[ChartStretch]:
        """Return the states at times in order, chart by chart."""
        charts = list(dict.fromkeys(step.chart for step in self.steps))
        runs = [[step for step in self.steps if step.chart is chart] for chart in charts]
        return [_stretch(steps, times, k == 0) for k, steps in enumerate(runs)]

    def cut(self, time: float) -> None:
        """Let the last step end at a time; an empty step is dropped."""
        step = self.steps.pop()
        if time > step.first or not self.steps:
            self.steps.append(replace(step, last=time))

    @property
    def last(self) -> float:
        """The time reached."""
        return self.steps[-1].last if self.steps else 0.0


def _stretch(steps: list[Step], times: Number, is_first: bool) -> ChartStretch:
    """Return the states at times in the steps of one chart. A time at which charts change belongs to the first."""
    first, last = steps[0].first, steps[-1].last
    own = times[((times >= first) if is_first else (times > first)) & (times <= last)]
    whole = np.unique(np.concatenate([[first], own, [last]]))
    index = np.minimum(np.searchsorted([step.last for step in steps], whole), len(steps) - 1)
    states, accelerations = [], []
    for k in np.unique(index):
        here = whole[index == k]
        states.append(steps[k].between(here))
        accelerations.append(steps[k].accelerations_at(here, states[-1]))
    whole_states, rates = (np.concatenate(parts, axis=1) for parts in (states, accelerations))
    return ChartStretch(steps[0].chart, whole, whole_states, rates, np.isin(whole, own))
