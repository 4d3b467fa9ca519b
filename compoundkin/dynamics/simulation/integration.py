"""The equation of motion integrated, and the course of its steps and states, chart by chart.

Source: E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
section II.10: the method of Dormand and Prince of order 8, as SciPy has it; E. Hairer and G. Wanner, Solving Ordinary
Differential Equations II, 2nd ed., Springer 1996, section IV.8: Radau IIA, where loads are stiff.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.friction.coulomb_friction import NotUniqueMotion
from compoundkin.dynamics.simulation.contact_watches import ContactWatch, StopWatch, stop_watches
from compoundkin.dynamics.simulation.coordinate_change import Chart, by_links, driven_there, fastest_pairs
from compoundkin.dynamics.simulation.dormand_prince import PlainSolver
from compoundkin.dynamics.simulation.drive_table import FASTER
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import DriverState, SimulatedState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.load_breaks import SAMPLED
from compoundkin.dynamics.simulation.load_jumps import (
    AGAIN,
    HELD_STEPS,
    MOST_JUMPS,
    TO_AND_FRO,
    beyond_jump,
    held_until,
    holding_load,
    tell_held,
)
from compoundkin.dynamics.simulation.phases import OpenPair, landed, without_pair
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse, Step
from compoundkin.dynamics.simulation.simulation_events import (
    BreakWatch,
    Passed,
    PlaceWatch,
    SimulationEvent,
    first_passed,
)
from compoundkin.dynamics.simulation.step_lengths import (
    DYING,
    LOOSEST,
    STALLED,
    changes_method,
    decay,
    driver_paces,
    hesitates,
    longest_step,
    stalls,
)
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.dynamics.simulation.watches import (
    END,
    JUMP,
    REST,
    REVERSES,
    STICKS,
    LiftOffWatch,
    after_impact,
    ended_pair,
    watches,
)
from compoundkin.model.loads.latch import Release

# Where friction has no motion within a step, one that is so many times shorter is tried.
SHORTER = 8.0
# The name of the event where friction has no motion, or several.
WEDGES = "wedges"
# The name of the event from which on friction has a second motion, which this one passes by, and its text.
MAY_WEDGE = "may wedge"
SECOND_MOTION = "from there on friction has a second motion, in which it wedges: a blow may bring that about"
# The name of the event where other coordinates take a driver's place, and how often one pair follows another as such.
COORDINATE, MOST_CHANGES = "coordinate", 2
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
        course.stop(WEDGES, text)


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
    released = held_until(chart, course) if chart.held is not None else None
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
    if solver.status == "running" and changes_method(course, chart, solver):
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
            held = holding_load(chart, time, state, course)
            if held is not None and isinstance(chart, DriverChart):
                chart.held = held
                tell_held(course, time, held)
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
        course.stop(JUMP, TO_AND_FRO)
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
    stalling = stalls(chart, solver, course)
    if stalling and solver.status != "failed" and solver.step_size * decay(chart, solver) > DYING:
        return None
    is_singular = chart.digits_lost(solver.t, solver.y) > course.tolerance or not is_regular
    if hesitates(solver, course) and (chart.mechanism.frictions or not is_singular):
        beyond = beyond_jump(chart, solver, course)
        if beyond is not None:
            return chart, beyond
        stalling = stalls(chart, solver, course)
    if is_regular and not stalling:
        return None
    if isinstance(chart, DriverChart):
        here = chart.state(solver.t, solver.y[:n], solver.y[n : 2 * n])
        changed = _by_another(chart, here, stalling, solver, course)
        if changed is not None:
            return changed
    if stalling:
        since = course.last - AGAIN * STALLED * course.until
        if sum(time > since for time in course.restarts) < MOST_JUMPS:
            # a jump that has just been passed leaves short steps
            course.restarts.append(course.last)
            return chart, solver.y
        solver.status = "finished"
        course.stop(JUMP, TO_AND_FRO)
    return None


def _by_another(
    chart: DriverChart, here: DriverState, stalling: bool, solver: Any, course: SimulatedCourse
) -> tuple[Chart, Number] | None:
    """Return a chart of other coordinates than the drivers', with its state; None where the drivers' will do."""
    pairs = fastest_pairs(chart, here)
    fast = [one for one in pairs if one.ratio >= FASTER]
    has_table = isinstance(chart, TabulatedChart) and chart.table is not None
    if not fast and has_table and not stalling:
        return None
    mayswitch = sum(event.name == COORDINATE for event in course.events) < MOST_CHANGES
    for one in fast if mayswitch else ():
        found = driven_there(chart, here, one)
        if found is not None and found[0].is_regular(found[1][: len(chart.free)]):
            text = f"next to a limit position of {one.driver}, {one.pair.name} takes its place as the coordinate"
            course.events.append(SimulationEvent(course.last, COORDINATE, text, False))
            return found[0], np.append(found[1], solver.y[-1])
    time, y = float(solver.t), solver.y
    if stalling:
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


def _solver(chart: Chart, time: float, state: Number, course: SimulatedCourse, step: float | None = None) -> Any:
    """Return the integrator at a state of a chart, with a first step where one is known."""
    n = len(chart.free)

    def grown(at: float, y: Number) -> Number:
        found = chart.followed_rates(at, y[:n], y[n : 2 * n])
        return np.concatenate([y[n : 2 * n], found.accelerations, [found.power]])

    rates = grown(time, state)
    pace = driver_paces(chart, state[n : 2 * n], rates[n : 2 * n], course.until - time)
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
