"""Forward dynamics: how a mechanism moves under its masses and loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.errors import FewDigits, InvalidInput, Problem, warn
from compoundkin.dynamics.simulation.coordinate_change import chart_of
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.integration import PARTS, integrate
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse, Step
from compoundkin.dynamics.simulation.simulated_energy import SimulatedEnergy, simulated_energy
from compoundkin.dynamics.simulation.simulated_motion import simulated_motion
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.dynamics.simulation.simulation_events import watches
from compoundkin.dynamics.simulation.simulation_start import simulation_start
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism

# A driver that feels less than this part of the heaviest link, some rounding squared as speeds are, moves no mass.
NO_MASS = 1e-20
# From one pose of the result to the next drivers go so far at most (radians, or parts of the size), in so many poses.
APART, FEWEST, MOST = np.deg2rad(5.0), 100, 20000
# Energies that are so far from adding up, or so many times the tolerance, are told of.
LOST, WORSE = 1e-5, 1e4


@checked
def simulate(
    mechanism: Mechanism,
    *,
    start: Any = None,
    until: float,
    prescribed: Mapping[str, Any] | None = None,
    times: Any = None,
    events: Mapping[str, Any] | None = None,
    stop: str | Sequence[str] = (),
    restitution: float | None = None,
    tolerance: float = 1e-11,
    modes: Mapping[str, int] | str | Configuration | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Simulation:
    """Return how a mechanism moves under its masses and loads. It is followed until a time in seconds.

    Its drivers do not drive: their coordinates are what is found. `start` gives each its value (radians, lengths) or
    (value, speed), a single driver without its name; without it they rest at the drawn pose, else at the first.
    Drivers with a law are `prescribed`, and so are those that the call gives a law, a function of time, or a value at
    which they are held. `modes` are those of `solve`.

    `events` are functions of the state by name, ``lambda state: state["B.y"] - 20``: where one passes through zero it
    is noted, and the simulation stops if `stop` names it. It stops at an end of a guide, unless a coefficient of
    `restitution` (0 to 1) says how fast that is left again, and where a contact lets go.

    The result is a motion in time at `times`, evenly spaced ones without them; with its forces and energies.
    The error of a step is `tolerance` of the drivers' values and speeds. Where a driver comes to a limit position,
    another pair takes its place as the coordinate. `progress(done, total)` is told of every step.

    Raises InvalidInput for a mechanism without units or masses, for drivers that move no mass, for times that do not
    increase; UnknownName for drivers that there are not.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import gravity, mass
    >>> bar, units = link("bar", A=0, B=1), {"length": "m", "mass": "kg", "force": "N"}
    >>> weight = mass("bar", 1.0, at="B"), gravity(0, -9.81)
    >>> pendulum = Mechanism("Pendulum", link("frame", A=0), bar, drive("bar"), *weight, units=units)
    >>> swung = simulate(pendulum, start={"bar": -3.0}, until=2.0)
    >>> swung.times[-1], swung.energy.worst < 1e-9
    (np.float64(2.0), True)
    """
    _hold(mechanism, until, tolerance, restitution)
    _hold_progress(progress)
    begun = simulation_start(mechanism, start, prescribed or {}, modes)
    chart = chart_of(begun.motion, tuple(begun.speeds), begun.laws)
    state = np.array([*(begun.values[name] for name in chart.free), *begun.speeds.values(), 0.0])
    watched = watches(mechanism, events or {}, (stop,) if isinstance(stop, str) else tuple(stop))
    course = SimulatedCourse(float(until), float(tolerance), watched, restitution)
    with np.errstate(all="ignore"):
        _hold_moving(chart, state)
        integrate(chart, state, course, progress)
        stretches = course.at(_times(course, times))
        motion = simulated_motion(stretches)
        energy = simulated_energy(motion, np.concatenate([one.states[-1, one.asked] for one in stretches]))
    _warn(energy, tolerance)
    return Simulation(motion, energy, tuple(course.events), course.tolerance, len(course.steps), course.evaluations)


def _warn(energy: SimulatedEnergy, tolerance: float) -> None:
    """Warn where energies do not add up."""
    if energy.worst > max(LOST, WORSE * tolerance):
        what = f"energies do not add up, {energy.worst:.1g} of the greatest is missing"
        warn(f"{what}: a prescribed speed jumps, digits are lost, or several drivers passed a change point", FewDigits)


def _hold(mechanism: Mechanism, until: float, tolerance: float, restitution: float | None) -> None:
    """Raise InvalidInput for what cannot be simulated."""
    _ = mechanism.stated_units
    if not mechanism.masses:
        raise InvalidInput(Problem("masses", "nothing has a mass", 'write mass("link", 0.2, at=..., inertia=...)'))
    if not 0.0 < until < np.inf:
        raise InvalidInput(Problem("until", f"{until:g} is no end", "give seconds after the start, more than 0"))
    if restitution is not None and not 0.0 <= restitution <= 1.0:
        raise InvalidInput(Problem("restitution", f"{restitution:g} is no coefficient of restitution", "0 to 1"))
    if not 1e-13 <= tolerance <= 1e-2:
        raise InvalidInput(Problem("tolerance", f"{tolerance:g} is too fine or too coarse", "1e-13 to 1e-2"))


def _hold_progress(progress: Callable[[int, int], None] | None) -> None:
    """Raise InvalidInput for what cannot be told of progress."""
    try:
        if progress is not None:
            progress(0, PARTS)
    except Exception as error:  # whatever a user's function does
        remedy = "give a function of two numbers: how much is done, of how much"
        raise InvalidInput(Problem("progress", f"it cannot be told: {error}", remedy)) from error


def _hold_moving(chart: DriverChart, state: Number) -> None:
    """Raise InvalidInput where a free driver moves no mass, and where rates are not finite."""
    n = len(chart.free)
    matrix = chart.state(0.0, state[:n], state[n : 2 * n]).terms.matrix[:n, :n]
    if not (np.isfinite(matrix).all() and chart.start.regular.all()):
        what = "drivers are at a limit position or a change point there"
        raise InvalidInput(Problem("start", what, "start a little beside it, or drive another link"))
    heaviest = max(own.mass * chart.order.size**2 + own.inertia for own in chart.masses)
    sizes = np.diag(matrix) * (chart.scales / chart.scales.max()) ** 2
    for name, one in zip(chart.free, sizes, strict=True):
        if not one > NO_MASS * heaviest:
            raise InvalidInput(
                Problem(f"start.{name}", "this driver moves no mass", "give a link that it moves a mass")
            )


def _times(course: SimulatedCourse, times: Any) -> Number:
    """Return the times of the result: those asked for as far as they are reached, else evenly spaced ones."""
    if times is not None:
        return _asked(times, course)
    speeds = [_farthest(step) / (step.last - step.first) for step in course.steps]
    count = int(np.clip(np.ceil(max(speeds) * course.last / APART), FEWEST, MOST))
    return np.linspace(0.0, course.last, count + 1)


def _farthest(step: Step) -> float:
    """Return how far the free drivers go in a step, by their scales."""
    n = len(step.chart.free)
    first, last = (step.between(time)[:n] for time in (step.first, step.last))
    return float(np.max(np.abs(last - first) / step.chart.scales))


def _asked(times: Any, course: SimulatedCourse) -> Number:
    asked = real_numbers("times", times).reshape(-1)
    if len(asked) < 2 or not np.all(np.diff(asked) > 0.0) or asked[0] < 0.0 or asked[-1] > course.until:
        what = "they are not two or more increasing times within the simulation"
        raise InvalidInput(Problem("times", what, f"give times from 0 to {course.until:g}"))
    return asked[asked <= course.last]
