"""The equation of motion integrated, and the course of its steps and states, chart by chart.

Source: E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
section II.10: the method of Dormand and Prince of order 8, as SciPy has it; E. Hairer and G. Wanner, Solving Ordinary
Differential Equations II, 2nd ed., Springer 1996, section IV.8: Radau IIA, where loads are stiff.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.friction.coulomb_friction import TINY, NotUniqueMotion
from compoundkin.dynamics.friction.friction_contacts import LoadedContact
from compoundkin.dynamics.simulation.coordinate_change import Chart, by_links, driven_there, fastest_pairs
from compoundkin.dynamics.simulation.dormand_prince import PlainSolver, PlainStep, states_between
from compoundkin.dynamics.simulation.driver_chart import BESIDE, DriverChart, HeldSpeed
from compoundkin.dynamics.simulation.driver_state import DriverState, KnownState, SimulatedState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.load_breaks import SAMPLED, LoadBreak
from compoundkin.dynamics.simulation.phases import OpenPair, landed, without_pair
from compoundkin.dynamics.simulation.simulation_events import (
    END,
    JUMP,
    REST,
    REVERSES,
    BreakWatch,
    ContactWatch,
    LiftOffWatch,
    Passed,
    PlaceWatch,
    SimulationEvent,
    StopWatch,
    Watch,
    after_impact,
    ended_pair,
    first_passed,
    stop_watches,
    watches,
)
from compoundkin.dynamics.simulation.stop_contacts import StopContact, holding, is_no_contact
from compoundkin.dynamics.simulation.tabulated_chart import FASTER, TabulatedChart
from compoundkin.model.loads.attachments import PairLoad
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.latch import Latch, Release
from compoundkin.model.loads.stop import Stop

# Where friction has no motion within a step, one that is so many times shorter is tried.
SHORTER = 8.0
# The integration stalls where a step is below this part of the longest.
STALLED = 1e-7
# In a gap of a table next to a change point steps that short are so for rounding, and each of their states is solved.
STALLED_IN_GAP = 1e-4
# The name of the event where friction holds a mechanism.
STICKS = "sticks"
# Errors in speeds are measured against this part of the fastest driver's at least.
SLOWEST = 1e-3
# The name of the event where friction has no motion, or several.
WEDGES = "wedges"
# The name of the event from which on friction has a second motion, which this one passes by, and its text.
MAY_WEDGE = "may wedge"
SECOND_MOTION = "from there on friction has a second motion, in which it wedges: a blow may bring that about"
# The name of the event where other coordinates take a driver's place, and how often one pair follows another as such.
COORDINATE, MOST_CHANGES = "coordinate", 2
# The name of the event where loads are stiff.
STIFFNESS = "stiff"
# Next to a change point errors of steps may be rounding, up to this.
LOOSEST = 1e-7
# Progress counts so many parts.
PARTS = 1000
Progress = Callable[[int, int], None]


def integrate(chart: Chart, state: Number, course: SimulatedCourse, progress: Progress | None) -> None:
    """Add the steps and events that follow from a state of a chart.

    Raises NotUniqueMotion where friction has no motion, or several, at the start; later the course ends there.
    """
    try:
        _integrate(chart, state, course, progress)
    except NotUniqueMotion:
        if not course.steps:
            raise
        text = "friction has no or several motions from there on: the mechanism wedges, or jumps"
        _stop(course, WEDGES, text)


def _integrate(chart: Chart, state: Number, course: SimulatedCourse, progress: Progress | None) -> None:
    solver = _begun(chart, 0.0, state, course)
    while solver is not None and solver.status == "running":
        before, n = _prepared(chart, solver, course), len(chart.free)
        _step(chart, solver, course)
        if solver.status == "failed":
            changed = _changed(chart, solver, course)
            if changed is None:
                return
            chart, state = changed
            solver = _begun(chart, course.last, state, course)
            continue
        course.steps.append(
            Step(chart, float(solver.t_old), float(solver.t), _between(solver, before, n), chart.memory)
        )
        passed = _passed(course, _by_ends(before, solver, n))
        if passed is None:
            chart, solver = _after_step(chart, solver, course)
        elif passed.state is None or passed.time >= course.until:
            return
        else:
            chart, solver = _after_event(chart, solver, passed, passed.state, course)
        if progress is not None:
            progress(int(PARTS * course.last / course.until), PARTS)


def _prepared(chart: Chart, solver: Any, course: SimulatedCourse) -> _Begin:
    """Bound the next step of a solver and set its tolerance; return where it begins."""
    n, y, f = len(chart.free), solver.y, solver.f
    longest = course.until if chart.held is None and not chart.closed else course.until / HELD_STEPS
    solver.max_step = min(longest, longest_step(chart, y[n : 2 * n], f[n : 2 * n]))
    solver.h_abs = min(solver.h_abs, solver.max_step)
    # next to a change point no tolerance is kept that is below the rounding there
    loosened = max(1.0, min(chart.digits_lost(solver.t, y), LOOSEST) / course.tolerance)
    solver.rtol, solver.atol = loosened * course.tolerance, loosened * solver.allowed
    before = _Begin(solver.t, y, f)
    _shorten(chart, solver, before, course)
    return before


def _after_step(chart: Chart, solver: Any, course: SimulatedCourse) -> tuple[Chart, Any]:
    """Return the chart and the solver with which it goes on after a step in which nothing happened."""
    released = _released(chart, course) if chart.held is not None else None
    if released is not None:
        return chart, _begun(chart, course.last, released, course)
    n, y = len(chart.free), solver.y
    chart.accept(solver.t, y[:n], y[n : 2 * n])
    settled = chart.settled(solver.t, y)
    if settled is not y:
        solver.y, solver.f = settled, solver.fun(solver.t, settled)
    changed = _changed(chart, solver, course)
    if changed is not None:
        chart, state = changed
        return chart, _begun(chart, course.last, state, course)
    if solver.status == "finished" and course.last < course.until and not course.ended:
        return chart, _behind_break(chart, solver, course)
    if solver.status == "running" and course.changes_method(chart, solver):
        return chart, _begun(chart, course.last, solver.y, course)
    return chart, solver


def _after_event(
    chart: Chart, solver: Any, passed: _Interruption, state: Number, course: SimulatedCourse
) -> tuple[Chart, Any]:
    """Return the chart and the solver with which it goes on from the state that an event leaves."""
    if passed.released is not None or passed.landing is not None:
        chart, state = _next_phase(chart, passed, state, course)
    # friction changes, and nothing else: steps are as long as before
    paced = solver.h_abs if passed.is_smooth and not solver.is_implicit else passed.step
    return chart, _begun(chart, passed.time, state, course, paced)


def _step(chart: Chart, solver: Any, course: SimulatedCourse) -> None:
    """Make a step, a shorter one where friction has no motion, or several, within it or at its end."""
    while True:
        before, asked = dict(vars(solver)), solver.nfev
        try:
            solver.step()
            if isinstance(chart, FrictionTable) and solver.status != "failed":
                has_second = chart.has_second_motion(float(solver.t), solver.y[:1], solver.y[1:2])
                if has_second and not course.may_wedge:
                    course.events.append(SimulationEvent(float(solver.t), MAY_WEDGE, SECOND_MOTION, False))
                course.may_wedge = has_second
            course.evaluations += solver.nfev - asked
            return
        except NotUniqueMotion:
            tried = min(solver.h_abs if solver.t == before["t"] else solver.t - before["t"], solver.max_step)
            # SciPy's solvers have no way back from a step but their fields
            vars(solver).update(before)
            solver.h_abs = tried / SHORTER
            if solver.h_abs < STALLED * course.until:
                raise


def _next_phase(chart: Chart, passed: _Interruption, state: Number, course: SimulatedCourse) -> tuple[Chart, Number]:
    """Return the chart and the state with which it goes on with other pairs; their events are watched there."""
    n = len(chart.free)
    chart.accept(passed.time, state[:n], state[n : 2 * n])
    state = chart.settled(passed.time, state)
    here = chart.state(passed.time, state[:n], state[n : 2 * n])
    if passed.released is not None:
        found = without_pair(here, passed.released, float(state[-1]))
        if found.lost:
            course.events[-1] = replace(course.events[-1], lost=found.lost, loser=passed.released.pair)
    else:
        assert passed.landing is not None
        found = landed(here, passed.landing, float(state[-1]))
        course.events[-1] = replace(course.events[-1], lost=found.lost)
    own = tuple(one for one in course.watched if one.asked)
    course.watched = (*watches(found.chart.mechanism, {}, ()), *own)
    return found.chart, found.state


def _begun(chart: Chart, time: float, state: Number, course: SimulatedCourse, step: float | None = None) -> Any:
    """Return the integrator from a state, after a rest where friction holds it; None where it stays at rest."""
    n = len(chart.free)
    values, speeds = state[:n], state[n : 2 * n]
    moves = chart.begin(time, values, speeds)
    if isinstance(chart, FrictionChart):
        state = chart.settled(time, state)
        course.events += [SimulationEvent(time, name, text, False) for name, text in chart.told]
        chart.told.clear()
    if moves:
        if chart.held is None and not speeds.any():
            held = _holding(chart, time, state, course)
            if held is not None and isinstance(chart, DriverChart):
                chart.held = held
                _tell_held(course, time, held)
        return _solver(chart, time, state, course, step)
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
    released: Release | None = None  # the pair that comes apart there
    landing: OpenPair | None = None  # the contact that closes there
    is_smooth: bool = False  # whether speeds and states go on as they are
    step: float | None = None  # the first step from there


def _passed(course: SimulatedCourse, by_ends: Callable[[Number], Number]) -> _Interruption | None:
    """Record the events of the last step; return the interruption by one, if any."""
    step = course.steps[-1]
    watched, times = (*course.watched, *stop_watches(step.chart)), (step.first, step.last)
    for one in first_passed(watched, step.chart, times, step.between, by_ends) if watched else ():
        found = _met(one, step, course)
        if found is not None:
            return found
    if course.near is not None:
        watch, course.near = course.near, None
        beyond = step.last + BEYOND * (step.last - step.first)
        found_there = watch.passed(step.chart, (step.last, beyond), step.between) if beyond < course.until else None
        if found_there is not None:
            state = step.between(np.array(found_there.time))
            return _behind_place(Passed(watch, found_there.time, state, found_there.at), step, course)
    return None


def _met(one: Passed, step: Step, course: SimulatedCourse) -> _Interruption | None:
    """Record what a step passed; return how it interrupts the course. None where the course goes on."""
    n, watch = len(step.chart.free), one.watch
    if isinstance(watch, BreakWatch):
        return _up_to_break(one, watch, step, course)
    if isinstance(watch, ContactWatch):
        return _at_contact(one, watch, step, course)
    if watch.name == REST and not watch.asked:
        course.cut(one.time)
        return _Interruption(one.time, np.array([*one.state[:n], *np.zeros(n), one.state[-1]]))
    if watch.name == REVERSES and not watch.asked:
        course.cut(one.time)
        return _Interruption(one.time, one.state, is_smooth=True)
    return _at_event(one, step, course)


def _at_contact(one: Passed, watch: ContactWatch, step: Step, course: SimulatedCourse) -> _Interruption:
    """Record that a contact closes or opens; return the state behind it."""
    course.cut(one.time, False)
    damped = course.damped(watch.contact, True) if isinstance(watch, StopWatch) else 0.0
    met = watch.passage(step.chart, one.time, one.state, course.fastest)
    course.fastest = max(course.fastest, met.approach)
    course.events.append(replace(met.event, lost=met.event.lost + damped))
    return _Interruption(one.time, None if met.event.stops else met.state, met.released, met.landing)


def _at_event(one: Passed, step: Step, course: SimulatedCourse) -> _Interruption | None:
    """Record an event that is asked for or ends the motion; where a guide ends, links may rebound.

    Raises InvalidInput for what is lost at the start already.
    """
    n, watch = len(step.chart.free), one.watch
    here = SimulatedState(step.chart.state(one.time, one.state[:n], one.state[n : 2 * n]), step.chart.order)
    is_end = watch.name == END and not watch.asked
    text = f"{ended_pair(here).name} comes to an end of its guide" if is_end else watch.text
    why, remedy = "", "start elsewhere, or with other loads"
    if isinstance(watch, LiftOffWatch):
        why = watch.reason([step.state(time) for time in (step.first, step.last)])
        remedy = f'press it by a spring or by gravity, or let it lift off: release("{watch.pair}")'
    if watch.falls and one.time <= 0.0:
        raise InvalidInput(Problem("start", f"{text} at once{why}", remedy))
    rebounds = is_end and course.restitution is not None
    impact = after_impact(here, course.restitution or 0.0, course.fastest) if rebounds else None
    stops = watch.stops and impact is None
    lost = (0.0, "") if impact is None else (impact.lost, ended_pair(here).name)
    course.events.append(SimulationEvent(one.time, watch.name, text + why, stops, *lost))
    if stops:
        course.cut(one.time)
        return _Interruption(one.time, None)
    if impact is None:
        return None
    course.cut(one.time)
    course.fastest = max(course.fastest, impact.approach)
    return _Interruption(one.time, np.array([*one.state[:n], *impact.speeds[:n], one.state[-1] - impact.lost]))


# A step that is made again up to a break of a load ends before it by this part of its length, so that nothing behind
# the break is in it, and is extended by as much again at most: its polynomial holds as well there.
SHORT, BEYOND = 1e-3, 1e-2
# What is nearer to a break than this part of the whole is there; jumps nearer than the second are one.
AT_BREAK, ONE_JUMP = 1e-13, 1e-10


def _shorten(chart: Chart, solver: Any, before: _Begin, course: SimulatedCourse) -> None:
    """Let the next step end just before a break of a load to which the present acceleration leads."""
    watched = [one for one in course.watched if isinstance(one, BreakWatch) and not one.is_idle(chart)]
    if not watched:
        return
    n, t = len(chart.free), float(before.time)
    accelerated = np.concatenate([before.rates[: 2 * n], [0.0]])
    second = np.concatenate([before.rates[n : 2 * n], np.zeros(n + 1)])

    def states(times: Number) -> Number:
        since = np.atleast_1d(times) - t
        moved = before.state[:, None] + accelerated[:, None] * since + 0.5 * second[:, None] * np.square(since)
        return moved if np.ndim(times) else moved[:, 0]

    end = min(t + solver.h_abs, course.until)
    for watch in watched:
        found = watch.passed(chart, (t, end), states)
        if found is not None and found.time - t > AT_BREAK * course.until:
            end, course.near = found.time, watch
            solver.h_abs = (end - t) * (1.0 - SHORT)


def _up_to_break(passed: Passed, watch: BreakWatch, step: Step, course: SimulatedCourse) -> _Interruption:
    """Return the interruption by which a step over a break of a load is made again up to it."""
    far = passed.time - step.first
    if step.last - step.first < AT_BREAK * course.until or far < AT_BREAK * course.until:
        return _behind_place(passed, step, course)
    course.steps.pop()
    course.near = watch
    return _Interruption(step.first, step.between(np.array(step.first)), step=far * (1.0 - SHORT))


def _by_ends(begin: _Begin, solver: Any, n: int) -> Callable[[Number], Number]:
    """Return coordinates and speeds in the last step by values, speeds and accelerations at both ends."""
    y, f, length = solver.y, solver.f, solver.t - begin.time
    q0, v0, a0 = begin.state[:n], begin.state[n : 2 * n] * length, begin.rates[n : 2 * n] * length**2
    v1, a1 = y[n : 2 * n] * length, f[n : 2 * n] * length**2
    off, over, last = y[:n] - q0 - v0 - a0 / 2.0, v1 - v0 - a0, a1 - a0
    c3, c4, c5 = 10 * off - 4 * over + last / 2, -15 * off + 7 * over - last, 6 * off - 3 * over + last / 2

    def states(times: Number) -> Number:
        x = (np.atleast_1d(times) - begin.time) / length
        rows = [one[:, None] for one in (q0, v0, a0 / 2.0, c3, c4, c5)]
        places = sum(row * x**k for k, row in enumerate(rows))
        speeds = sum(k * row * x ** (k - 1) for k, row in enumerate(rows) if k) / length
        found = np.concatenate([places, speeds, np.zeros((1, len(x)))])
        return found if np.ndim(times) else found[:, 0]

    return states


def _behind_place(passed: Passed, step: Step, course: SimulatedCourse) -> _Interruption:
    """Return the interruption at a break of a load; where the motion goes to and fro between both sides, it ends."""
    assert passed.at is not None
    course.steps[-1] = replace(step, last=passed.time)
    since = passed.time - AGAIN * STALLED * course.until
    recent = [place for time, place in course.places if time > since and place == passed.at]
    course.places.append((passed.time, passed.at))
    if len(recent) >= MOST_JUMPS:
        _stop(course, JUMP, TO_AND_FRO)
        return _Interruption(passed.time, None)
    last = course.events[-1] if course.events else None
    is_known = last is not None and last.name == JUMP and passed.time - last.time < ONE_JUMP * course.until
    if passed.at.jumps and not is_known:
        course.events.append(SimulationEvent(passed.time, JUMP, passed.watch.text, False))
    first = None
    if passed.at.wakes and isinstance(passed.watch, PlaceWatch):
        # in the first step behind it no short pulse is gone over
        ends = [passed.watch.value(step.chart, t, step.between(np.array(t))) for t in (step.first, passed.time)]
        moved, size = abs(ends[1] - ends[0]), step.chart.order.size
        first = (passed.time - step.first) * passed.watch.place.sample(size) / moved if moved else None
    elif passed.at.wakes:
        moved = abs(float(step.between(np.array(passed.time))[0] - step.between(np.array(step.first))[0]))
        first = (passed.time - step.first) * float(step.chart.scales[0]) / (SAMPLED * moved) if moved else None
    return _Interruption(passed.time, passed.state, step=first)


def _changed(chart: Chart, solver: Any, course: SimulatedCourse) -> tuple[Chart, Number] | None:
    """Return another chart and its state to continue with; None where the present one is regular or none is better.

    Next to a limit position of the driver another pair is the coordinate, where one is regular. Else, and where none
    stays regular for long, the coordinates of all links are. Behind the last step nothing is to be continued.
    """
    if solver.status == "finished":
        return None
    n = len(chart.free)
    is_regular = chart.is_regular(solver.y[:n])
    stalls = _stalls(chart, solver, course)
    if stalls and solver.status != "failed" and solver.step_size * _decay(chart, solver) > DYING:
        return None
    is_singular = chart.digits_lost(solver.t, solver.y) > course.tolerance or not is_regular
    if _hesitates(solver, course) and (chart.mechanism.frictions or not is_singular):
        beyond = _beyond_jump(chart, solver, course)
        if beyond is not None:
            return chart, beyond
        stalls = _stalls(chart, solver, course)
    if is_regular and not stalls:
        return None
    if isinstance(chart, DriverChart):
        here = chart.state(solver.t, solver.y[:n], solver.y[n : 2 * n])
        changed = _by_another(chart, here, stalls, solver, course)
        if changed is not None:
            return changed
    if stalls:
        since = course.last - AGAIN * STALLED * course.until
        if sum(time > since for time in course.restarts) < MOST_JUMPS:
            # a jump that has just been passed leaves short steps
            course.restarts.append(course.last)
            return chart, solver.y
        solver.status = "finished"
        _stop(course, JUMP, TO_AND_FRO)
    return None


def _by_another(
    chart: DriverChart, here: DriverState, stalls: bool, solver: Any, course: SimulatedCourse
) -> tuple[Chart, Number] | None:
    """Return a chart of other coordinates than the drivers', with its state; None where the drivers' will do."""
    pairs = fastest_pairs(chart, here)
    fast = [one for one in pairs if one.ratio >= FASTER]
    has_table = isinstance(chart, TabulatedChart) and chart.table is not None
    if not fast and has_table and not stalls:
        return None
    mayswitch = sum(event.name == COORDINATE for event in course.events) < MOST_CHANGES
    for one in fast if mayswitch else ():
        found = driven_there(chart, here, one)
        if found is not None and found[0].is_regular(found[1][: len(chart.free)]):
            text = f"next to a limit position of {one.driver}, {one.pair.name} takes its place as the coordinate"
            course.events.append(SimulationEvent(course.last, COORDINATE, text, False))
            return found[0], np.append(found[1], solver.y[-1])
    time, y = float(solver.t), solver.y
    if stalls:
        time, y = _before_collapse(chart, time, y, course)
        here = chart.state(time, y[:1], y[1:2]) if len(y) == 3 else here
    if not np.isfinite(here.terms.matrix).all():
        here = _retraced(chart, course)
    driver = fast[0].driver if fast else chart.free[0]
    text = f"no pair is a coordinate like {driver} for long: those of all links take its place"
    course.events.append(SimulationEvent(course.last, COORDINATE, text, False))
    # what was stiff by one coordinate need not be so from there on
    course.implicit, course.short = False, 0
    links, state = by_links(chart, here)
    return links, links.settled(time, np.append(state, y[-1]))


# Steps below this part of the longest one of the last few have collapsed.
COLLAPSED, LAST_FEW = 0.1, 20


def _before_collapse(chart: DriverChart, time: float, y: Number, course: SimulatedCourse) -> tuple[float, Number]:
    """Go back to where steps were long, for other coordinates that go over what these come near to; return the state.

    Steps before an event stay.
    """
    since = max((event.time for event in course.events), default=0.0)
    own = [step for step in course.steps[-LAST_FEW:] if step.chart is chart and step.first > since]
    if len(own) < len(course.steps[-LAST_FEW:]):
        own = own[1:]
    longest = max((step.last - step.first for step in own), default=0.0)
    back = None
    while own and (step := own.pop()).last - step.first < COLLAPSED * longest:
        back = course.steps.pop()
    if back is None:
        return time, y
    chart.recall(back.memory)
    return back.first, back.between(np.array(back.first))


# A step of a table is retraced in so many parts.
RETRACED = 16


def _retraced(chart: DriverChart, course: SimulatedCourse) -> DriverState:
    """Return the present state with groups that have been followed here: in a table they are not."""
    n, own = len(chart.free), [step for step in course.steps if step.chart is chart]
    chart.recall(own[0].memory)
    for step in own:
        for time in np.linspace(step.first, step.last, RETRACED + 1)[1:]:
            y = step.between(np.array(time))
            DriverChart.accept(chart, float(time), y[:n], y[n : 2 * n])
    return chart.state(own[-1].last, y[:n], y[n : 2 * n])


# At a jump steps have this many times the tolerance at least, as parts of the longest.
HESITATES = 100.0


def _hesitates(solver: Any, course: SimulatedCourse) -> bool:
    """Return whether steps are so short that a jump of the loads may be the cause."""
    if solver.status == "failed":
        return True
    small = max(STALLED, HESITATES * course.tolerance) * min(solver.max_step, course.until)
    return bool(solver.step_size < small) and not _grows(course)


def _stalls(chart: Chart, solver: Any, course: SimulatedCourse) -> bool:
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


def _beyond_jump(chart: Chart, solver: Any, course: SimulatedCourse) -> Number | None:
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
    held = _holding(chart, found.behind, state, course)
    if held is None:
        course.events.append(SimulationEvent(found.behind, JUMP, "the loads jump", False))
        return state
    assert isinstance(chart, DriverChart)
    chart.held = held
    n = len(chart.free)
    state[n : 2 * n] = held.moved(chart, found.behind, state[:n], state[n : 2 * n], 0.0)
    _tell_held(course, found.behind, held)
    return state


def _tell_held(course: SimulatedCourse, time: float, held: HeldSpeed) -> None:
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


def _holding(chart: Chart, time: float, state: Number, course: SimulatedCourse) -> HeldSpeed | None:
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


def _released(chart: Chart, course: SimulatedCourse) -> Number | None:
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


def _behind_break(chart: Chart, solver: Any, course: SimulatedCourse) -> Any:
    """Return the integrator from the other side of a time at which a load jumps or has a corner."""
    one = next(one for one in course.breaks if one.before >= solver.t)
    if one.behind >= course.until:
        # the end of the simulation, from before the jump
        course.steps[-1] = replace(course.steps[-1], last=course.until)
        return None
    if one.jumps:
        course.events.append(SimulationEvent(one.behind, JUMP, "the loads jump", False))
    # in the first step behind it no short pulse is gone over
    return _begun(chart, one.behind, solver.y, course, course.until / SAMPLED if one.wakes else None)


def _stop(course: SimulatedCourse, name: str, text: str) -> None:
    course.ended = True
    course.events.append(SimulationEvent(course.last, name, text, True))


def _solver(chart: Chart, time: float, state: Number, course: SimulatedCourse, step: float | None = None) -> Any:
    """Return the integrator at a state of a chart, with a first step where one is known."""
    n = len(chart.free)

    def grown(at: float, y: Number) -> Number:
        found = chart.followed_rates(at, y[:n], y[n : 2 * n])
        return np.concatenate([y[n : 2 * n], found.accelerations, [found.power]])

    rates = grown(time, state)
    pace = _driver_paces(chart, state[n : 2 * n], rates[n : 2 * n], course.until - time)
    energy = chart.state(time, state[:n], pace).kinetic
    allowed = np.concatenate([chart.scales, pace, [energy]]) * course.tolerance
    end = next((one.before for one in course.breaks if one.before > time), course.until)
    first = None if step is None else min(step, end - time)
    if isinstance(chart, TabulatedChart) and not course.implicit:
        return PlainSolver(chart.plain_rates(), time, state, end, course.tolerance, allowed, first)
    from scipy.integrate import DOP853, Radau

    method = Radau if course.implicit else DOP853
    solver: Any = method(grown, time, state, end, rtol=course.tolerance, atol=allowed, first_step=first)
    solver.allowed, solver.is_implicit = allowed, course.implicit
    return solver


class _Begin(NamedTuple):
    """The time, the state and its rates at the beginning of a step."""

    time: float
    state: Number
    rates: Number


def _between(solver: Any, begin: _Begin, n: int) -> Callable[[Number], Number]:
    """Return the state as a function of the time in the last step.

    What an implicit method knows in between is coarse: there coordinates are polynomials of order 5 by their values,
    speeds and accelerations at both ends, and the work one of order 3 by the powers.
    """
    if not solver.is_implicit:
        found: Callable[[Number], Number] = solver.dense_output()
        return found
    from scipy.interpolate import BPoly

    ends, states, rates = [begin.time, solver.t], (begin.state, solver.y), (begin.rates, solver.f)
    moved = [[y[:n], f[:n], f[n : 2 * n]] for y, f in zip(states, rates, strict=True)]
    places = BPoly.from_derivatives(ends, moved)
    work = BPoly.from_derivatives(ends, [[y[-1:], f[-1:]] for y, f in zip(states, rates, strict=True)])
    speeds = places.derivative()
    return lambda times: np.concatenate([places(times), speeds(times), work(times)], axis=-1).T


# Steps are checked for stiffness so often; they are short for stability alone where they are longer than this over the
# rate at which speeds die away, and the method is changed where that is so at as many checks in a row.
CHECKED, STIFF, IN_A_ROW = 10, 2.0, 5
# The implicit method that was left takes over again where they die away so many times as fast.
STIFFER = 4.0
# A step as long as this part of the time in which speeds die away has collapsed for that, and nothing else.
DYING = 1e-2
# The rate at which speeds die away is found by so many steps of the power method, with this part of the pace.
POWERS, APART = 3, 1e-5


def _decay(chart: Chart, solver: Any) -> float:
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


def _driver_paces(chart: Chart, speeds: Number, accelerations: Number, duration: float) -> Number:
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


# The nodes of a quadrature over a step: exact to the order 16, above that of the method.
NODES = 8


@dataclass(frozen=True, eq=False)
class Step:
    """A step of the integration: its chart, its times, and the state as a function of time."""

    chart: Chart
    first: float
    last: float
    between: Callable[[Number], Number]
    memory: tuple[Any, ...]  # the configuration at its beginning

    def integral(self, function: Callable[[KnownState], float]) -> float:
        """Return the integral of a function of the state over the step."""
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        half = (self.last - self.first) / 2.0
        return half * float(weights @ [function(self.state(self.first + half * (one + 1.0))) for one in nodes])

    def state(self, time: float) -> KnownState:
        """Return the state at a time in the step."""
        n, y, memory = len(self.chart.free), self.between(np.array(time)), self.chart.memory
        self.chart.recall(self.memory)
        found = self.chart.state(float(time), y[:n], y[n : 2 * n])
        self.chart.recall(memory)
        return found

    def rubbed(self) -> dict[str, float]:
        """Return the energy that each pair with friction takes in the step, by its name."""
        chart, n = self.chart, len(self.chart.free)
        if not isinstance(chart, FrictionTable | FrictionChart):
            return {}
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        half, memory, found = (self.last - self.first) / 2.0, chart.memory, np.zeros(len(chart.contacts))
        chart.recall(self.memory)
        for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True):
            time = self.first + half * (node + 1.0)
            y = chart.settled(time, self.between(np.array(time)))
            found -= half * weight * chart.friction_powers(time, y[:n], y[n : 2 * n])
        chart.recall(memory)
        return {one.name: lost for one, lost in zip(chart.contacts, found.tolist(), strict=True)}

    def sticking(self, time: float) -> list[tuple[LoadedContact, float]]:
        """Return the pairs that friction holds at a time in the step, with their efforts."""
        if not isinstance(self.chart, FrictionChart):
            return []
        memory = self.chart.memory
        self.chart.recall(self.memory)
        found = self.chart.sticking(time, self.chart.settled(time, self.between(np.array(time))))
        self.chart.recall(memory)
        return found

    def holding(self, time: float) -> list[tuple[StopContact, float]]:
        """Return the contacts that hold a coordinate at a time in the step, with their forces."""
        if not self.memory[0][1]:  # none is closed
            return []
        chart, memory, n = self.chart, self.chart.memory, len(self.chart.free)
        chart.recall(self.memory)
        rigid, y, forces = chart.rigid, self.between(np.array(time)), np.empty(0)
        if rigid:
            here = chart.state(time, y[:n], y[n : 2 * n])
            free = chart.unheld_rates(time, y[:n], y[n : 2 * n])
            forces = holding([one.at(here) for one in rigid], here, free)
        chart.recall(memory)
        return list(zip(rigid, forces.tolist(), strict=True))

    def settled(self, times: Number) -> Number:
        """Return the states at times in the step, in columns."""
        self.chart.recall(self.memory)
        return np.array([self.chart.settled(t, y) for t, y in zip(times, self.between(times).T, strict=True)]).T

    def accelerations_at(self, times: Number, states: Number) -> Number:
        """Return the accelerations of the free drivers at times in the step, in columns."""
        n, chart = len(self.chart.free), self.chart
        chart.recall(self.memory)
        if type(chart) is TabulatedChart:
            plain = chart.plain_rates()
            return np.array([[plain(t, *y)[0] for t, y in zip(times.tolist(), states[:2].T.tolist(), strict=True)]])
        found = [chart.accelerations_at(t, y[:n], y[n : 2 * n]) for t, y in zip(times, states.T, strict=True)]
        return np.array(found).T

    @property
    def moved(self) -> Number:
        """How far each free driver has moved."""
        n, between = len(self.chart.free), self.between
        if isinstance(between, PlainStep) and self.last == between.first + between.length:
            return np.array([between.end[0] - between.begin[0]])
        found: Number = between(np.array(self.last))[:n] - between(np.array(self.first))[:n]
        return found


@dataclass(frozen=True, eq=False)
class ChartStretch:
    """The course in one chart, with states in columns, its first and last among them.

    `asked` is a mask of the requested times.
    """

    chart: Chart
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
    breaks: tuple[LoadBreak, ...] = ()
    near: BreakWatch | None = None  # of a break behind the present step
    places: list[tuple[float, LoadBreak]] = field(default_factory=list)  # breaks over coordinates, when passed
    restarts: list[float] = field(default_factory=list)  # times of restarts behind steps that collapsed
    ended: bool = False
    may_wedge: bool = False  # whether friction had a second motion at the end of the last step
    implicit: bool = False  # whether an implicit method has taken over
    short: int = 0  # checks in a row at which another method would do better
    left: float = 0.0  # the rate of decay at which the implicit method was last left

    def changes_method(self, chart: Chart, solver: Any) -> bool:
        """Return whether another method takes over.

        That is an implicit one where steps have become so short for stability alone, and the explicit one again where
        its steps would not be shorter than those of the implicit one, which has a lower order.
        """
        if len(self.steps) % CHECKED:
            return False
        decay = _decay(chart, solver)
        if self.implicit:
            fits = solver.step_size * decay < STIFF / 2.0
        else:
            fits = solver.step_size * decay > STIFF and decay > STIFFER * self.left
        self.short = self.short + 1 if fits else 0
        if self.short < IN_A_ROW:
            return False
        self.implicit, self.short = not self.implicit, 0
        text = "motions die away so fast that an implicit method (Radau IIA of order 5) takes over"
        if not self.implicit:
            self.left, text = decay, "motions no longer die away so fast: the explicit method takes over"
        self.events.append(SimulationEvent(self.last, STIFFNESS, text, False))
        return True

    def at(self, times: Number) -> list[ChartStretch]:
        """Return the states at times in order, chart by chart."""
        charts = list(dict.fromkeys(step.chart for step in self.steps))
        runs = [[step for step in self.steps if step.chart is chart] for chart in charts]
        return [_stretch(steps, times, k == 0) for k, steps in enumerate(runs)]

    def cut(self, time: float, keeps_one: bool = True) -> None:
        """Let the last step end at a time; an empty step is dropped, the only one if another follows."""
        step = self.steps.pop()
        if time > step.first or (keeps_one and not self.steps):
            self.steps.append(replace(step, last=time))

    def damped(self, contact: StopContact, is_left: bool) -> float:
        """Return the energy that an elastic stop has taken since its contact closed; zero where it is open.

        What is stored when it is left, where the damping holds it back, is lost too.
        """
        total, first = 0.0, None
        for step in reversed(self.steps):
            if contact not in step.memory[0][1] or not contact.stop.needs_rates:
                break
            total, first = total + step.integral(contact.damping_power), step
        if first is not None:
            total -= contact.stored(first.state(first.first))
            total += contact.stored(self.steps[-1].state(self.last)) if is_left else 0.0
        return total

    def holding(self, phase: int, times: Number) -> dict[Stop | Latch, Number]:
        """Return the efforts that rigid stops and latches have at times in a phase while they hold a coordinate."""
        steps = [step for step in self.steps if step.chart.phase == phase]
        index = np.minimum(np.searchsorted([step.last for step in steps], times), len(steps) - 1)
        found: dict[Stop | Latch, Number] = {}
        for k, time in enumerate(times):
            for one, force in steps[index[k]].holding(float(time)):
                found.setdefault(one.stop, np.zeros(len(times)))[k] += one.side * force
        return found

    def sticking(self, phase: int, times: Number) -> dict[str, Number]:
        """Return the efforts at times in a phase with which friction holds pairs, by their names."""
        steps = [step for step in self.steps if step.chart.phase == phase]
        index = np.minimum(np.searchsorted([step.last for step in steps], times), len(steps) - 1)
        found: dict[str, Number] = {}
        for k, time in enumerate(times):
            for one, force in steps[index[k]].sticking(float(time)):
                found.setdefault(one.name, np.zeros(len(times)))[k] += force
        return found

    @property
    def losses(self) -> dict[str, float]:
        """The energy lost up to now, by stops and pairs."""
        found = {one.loser: 0.0 for one in self.events if one.loser}
        for event in self.events:
            if event.loser:
                found[event.loser] += event.lost
        for contact in self.steps[-1].memory[0][1]:
            found[contact.stop.name] = found.get(contact.stop.name, 0.0) + self.damped(contact, False)
        for step in self.steps:
            for name, lost in step.rubbed().items():
                found[f"friction in {name}"] = found.get(f"friction in {name}", 0.0) + lost
        return found

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
    used, firsts = np.unique(index, return_index=True)
    cuts = [slice(a, b) for a, b in pairwise([*firsts.tolist(), len(whole)])]
    plain = [step.between for step in steps if isinstance(step.between, PlainStep)]
    if len(plain) == len(steps):
        states = states_between(plain, index, whole)
    else:
        states = np.concatenate([steps[k].settled(whole[cut]) for k, cut in zip(used, cuts, strict=True)], axis=1)
    rates = [steps[k].accelerations_at(whole[cut], states[:, cut]) for k, cut in zip(used, cuts, strict=True)]
    return ChartStretch(steps[0].chart, whole, states, np.concatenate(rates, axis=1), np.isin(whole, own))
