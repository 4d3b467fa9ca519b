"""Forward dynamics: how a mechanism moves under its masses and loads.

The integration gives drivers as functions of time; the motion is then solved again at its times, with a driving law for
every driver.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked, is_finite_real, real_numbers
from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.errors import FewDigits, InvalidInput, Problem, UnassembledPoses, UnknownName, suggestion, warn
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.simulation.contact_watches import begin_at_stops, idle_latches
from compoundkin.dynamics.simulation.coordinate_change import Chart, chart_of, integrable
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import rotors_that_lose
from compoundkin.dynamics.simulation.integration import PARTS, integrate
from compoundkin.dynamics.simulation.load_breaks import breaks_in_time
from compoundkin.dynamics.simulation.phases import SimulationPhase
from compoundkin.dynamics.simulation.simulated_course import ChartStretch, SimulatedCourse
from compoundkin.dynamics.simulation.simulated_energy import SimulatedEnergy, joined_energy, simulated_energy
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.dynamics.simulation.tabulated_chart import counted_angles
from compoundkin.dynamics.simulation.watches import watches
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.curve.driver_path import drawn_value
from compoundkin.kinematics.curve.modes import stated_by
from compoundkin.kinematics.driver_values import inputs
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import first_configuration, solving_order_of
from compoundkin.model.definition import driver_independent_name
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law, as_law, constant_speed, motion_table
from compoundkin.model.loads.attachments import Effort, effort
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends

# A driver whose equivalent inertia is below this part of the heaviest link's moves no mass: rounding squared.
NO_MASS = 1e-20
# The greatest step of a driver between poses of the result (radians, parts of the size), and bounds of their number.
APART, FEWEST, MOST = np.deg2rad(5.0), 100, 20000
# A warning is given for an energy error above this, and above so many times the tolerance.
ENERGY_TOLERANCE, WORSE = 1e-5, 1e4


@checked
@one_thread
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
    """Simulate a mechanism under its masses and loads until a time in seconds.

    The coordinates of its drivers are the unknowns. `start` gives each its value (radians, lengths) or (value, speed),
    a single driver without its name; by default they rest at the drawn pose, else at the first. Drivers with a law are
    `prescribed`, and so are those to which the call gives a law, a function of time, or a constant value. `modes` are
    those of `solve`.

    `events` are functions of the state by name, ``lambda state: state["B.y"] - 20``: a zero of one
    is an event, and the simulation stops there if `stop` names it. It stops at a travel limit of a guide, unless a
    coefficient of `restitution` (0 to 1) gives the rebound, and where a contact lifts off. At the ends of a `stop` it
    goes on by what that says, and where a `release` opens a pair in another one of its `phases`.

    The result is a motion in time at `times`, by default evenly spaced ones, with its forces and energies.
    The error of a step is `tolerance` of the drivers' values and speeds. Near a limit position of a driver another pair
    becomes the coordinate. `progress(done, total)` is called after every step.

    Raises InvalidInput for a mechanism without units or masses, for drivers that move no mass, for times that do not
    increase; UnknownName for unknown drivers.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> bar, units = link("bar", A=0, B=1), {"length": "m", "mass": "kg", "force": "N"}
    >>> weight = mass("bar", 1.0, at="B"), gravity(0, -9.81)
    >>> pendulum = Mechanism("Pendulum", link("frame", A=0), bar, drive("bar"), *weight, units=units)
    >>> swung = simulate(pendulum, start={"bar": -3.0}, until=2.0)
    >>> swung.times[-1], swung.energy.worst < 1e-9
    (np.float64(2.0), True)
    """
    _check_simulated(mechanism, until, tolerance, restitution)
    _check_progress(progress)
    mechanism = _by_pairs(mechanism)
    begun = simulation_start(mechanism, start, prescribed or {}, modes)
    chart = chart_of(begun.motion, tuple(begun.speeds), begun.laws)
    state = np.array([*(begun.values[name] for name in chart.free), *begun.speeds.values(), 0.0])
    watched = watches(mechanism, events or {}, (stop,) if isinstance(stop, str) else tuple(stop))
    breaks = breaks_in_time(mechanism, float(until))
    course = SimulatedCourse(float(until), float(tolerance), watched, restitution, breaks=breaks)
    with np.errstate(all="ignore"):
        _check_inertia(chart, state)
        begin_at_stops(chart, state)
        integrate(*integrable(chart, 0.0, state), course, progress)
        course.events += idle_latches(course.steps[-1].chart, course.last)
        asked = _times(course, times)
        phases, energies = zip(*_phases(course, asked), strict=True)
    energy = joined_energy(energies)
    _warn(energy, tolerance)
    counts = len(course.steps), course.evaluations
    return Simulation(phases, energy, tuple(course.events), course.tolerance, *counts, course)


def _by_pairs(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism whose loads name the pairs of drivers: another pair may take a driver's place."""
    names = {own.name: driver_independent_name(mechanism, own.name) for own in mechanism.drives}
    return mechanism.replace(*(load.renamed({}, names) for load in mechanism.loads.values()))


def _phases(course: SimulatedCourse, times: Number) -> Iterator[tuple[SimulationPhase, SimulatedEnergy]]:
    """Yield the phases with their energies; of several each has its first and its last time."""
    stretches = course.at(times)
    numbers = sorted({one.chart.phase for one in stretches})
    for phase in numbers:
        own = [one for one in stretches if one.chart.phase == phase]
        first, last = float(own[0].times[0]), float(own[-1].times[-1])
        if len(numbers) > 1:
            own = [replace(one, asked=one.asked | np.isin(one.times, (first, last))) for one in own]
        asked = np.concatenate([one.times[one.asked] for one in own])
        motion = simulated_motion(own, _holding(course, phase, asked))
        work = np.concatenate([one.states[-1, one.asked] for one in own])
        yield SimulationPhase(first, last, motion), simulated_energy(motion, work)


def _warn(energy: SimulatedEnergy, tolerance: float) -> None:
    """Warn of an energy error."""
    if energy.worst > max(ENERGY_TOLERANCE, WORSE * tolerance):
        what = f"energies do not add up, {energy.worst:.1g} of the greatest is missing"
        warn(f"{what}: a prescribed speed jumps, digits are lost, or several drivers passed a change point", FewDigits)


def _check_simulated(mechanism: Mechanism, until: float, tolerance: float, restitution: float | None) -> None:
    """Raise InvalidInput for a mechanism without masses, and for numbers out of range."""
    _ = mechanism.stated_units
    if not mechanism.masses:
        raise InvalidInput(Problem("masses", "nothing has a mass", 'write mass("link", 0.2, at=..., inertia=...)'))
    if mechanism.frictions:
        for motor in rotors_that_lose(mechanism.loads.values()):
            what = "with friction, a rotor before a gear with losses is not simulated"
            remedy = "leave its inertia out and give that to its link, gear squared times it, or efficiency=1"
            raise InvalidInput(Problem(motor.where, what, remedy))
    if not 0.0 < until < np.inf:
        raise InvalidInput(Problem("until", f"{until:g} is no end", "give seconds after the start, more than 0"))
    if restitution is not None and not 0.0 <= restitution <= 1.0:
        raise InvalidInput(Problem("restitution", f"{restitution:g} is no coefficient of restitution", "0 to 1"))
    if not 1e-13 <= tolerance <= 1e-2:
        raise InvalidInput(Problem("tolerance", f"{tolerance:g} is too fine or too coarse", "1e-13 to 1e-2"))


def _check_progress(progress: Callable[[int, int], None] | None) -> None:
    """Raise InvalidInput for a progress function that fails."""
    try:
        if progress is not None:
            progress(0, PARTS)
    except Exception as error:  # whatever a user's function does
        remedy = "give a function of two numbers: how much is done, of how much"
        raise InvalidInput(Problem("progress", f"it cannot be called: {error}", remedy)) from error


def _check_inertia(chart: DriverChart, state: Number) -> None:
    """Raise InvalidInput where a free driver moves no mass, and at limit positions and change points."""
    n = len(chart.free)
    matrix = chart.state(0.0, state[:n], state[n : 2 * n]).terms.matrix[:n, :n]
    if not (np.isfinite(matrix).all() and chart.start.regular.all()):
        raise InvalidInput(_singular_start(chart, state))
    heaviest = max(own.mass * chart.order.size**2 + own.inertia for own in chart.masses)
    sizes = np.diag(matrix) * (chart.scales / chart.scales.max()) ** 2
    for name, one in zip(chart.free, sizes, strict=True):
        if not one > NO_MASS * heaviest:
            raise InvalidInput(_no_mass(chart, name, state))


# Beside a singular start it is tried at so many radians, or at this part of the size.
STEP_BESIDE = np.deg2rad(1.0)


def _singular_start(chart: DriverChart, state: Number) -> Problem:
    """Return the problem of a start at a limit position or a change point of the drivers."""
    what = "drivers are at a limit position or a change point there"
    if len(chart.names) != 1:
        return Problem("start", what, "start at a distance from it, or drive another link")
    (name,), step = chart.names, STEP_BESIDE * float(chart.scales[0])
    beside = [float(state[0]) + side * step for side in (1.0, -1.0)]
    met = [value for value in beside if _is_assembled(chart, name, value)]
    if not met:
        return Problem("start", what, "start at a distance from it, or drive another link")
    shown = f"ck.deg({np.rad2deg(met[0]):.6g})" if chart.start.structure.driven_angles[name] else f"{met[0]:.6g}"
    if len(met) < 2:
        what = f"{name!r} is at a limit position there, where its speed moves nothing"
        return Problem("start", what, f'start beside it, start={{"{name}": {shown}}}, or drive another link')
    what = f"{name!r} is at a change point there: branches meet, and no start says on which it goes on"
    remedy = (
        f'start beside it, start={{"{name}": {shown}}}, on the branch that you mean, by its `drawn` points or by '
        "modes=... of the call; it goes through the change point on that branch"
    )
    return Problem("start", what, remedy)


def _is_assembled(chart: DriverChart, name: str, value: float) -> bool:
    """Whether the mechanism can be assembled at a value of its only driver."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return not bool(solve(chart.mechanism, {name: [value]}, order=0).failed.any())


def _no_mass(chart: DriverChart, driver: str, state: Number) -> Problem:
    """Return the problem of a driver that moves no mass: none, or points on which links turn."""
    n = len(chart.free)
    speeds = np.array([float(name == driver) for name in chart.free])
    world = chart.state(0.0, state[:n], speeds).loaded.block.world
    moved = [own for own in chart.mechanism.masses.values() if np.any(world[own.link].u.turning().c[0] != 0.0)]
    points = [own.link for own in moved if np.all(np.asarray(own.inertia) == 0.0)]
    where = f"start.{driver}"
    if not points:
        return Problem(where, "this driver moves no mass", "give a link that it moves a mass")
    assumed = chart.mechanism.masses[points[0]].assumed
    why = f" ({assumed})" if assumed else ""
    what = f"this driver only turns {', '.join(map(repr, points))} about a mass centre, where all the mass is{why}"
    return Problem(where, what, f'give an inertia: mass("{points[0]}", ..., inertia=...)')


def _times(course: SimulatedCourse, times: Any) -> Number:
    """Return the times of the result: the given ones up to the end, else evenly spaced ones."""
    if times is not None:
        return _requested_events(times, course)
    moving = [step for step in course.steps if step.last > step.first]
    speeds = [float(np.max(np.abs(one.moved) / one.chart.scales)) / (one.last - one.first) for one in moving]
    count = int(np.clip(np.ceil(max(speeds, default=0.0) * course.last / APART), FEWEST, MOST))
    return np.linspace(0.0, course.last, count + 1)


def _holding(course: SimulatedCourse, phase: int, times: Number) -> tuple[Effort, ...]:
    """Return what stops, latches and friction hold with, as loads over the motion: drivers are left without effort."""
    found = course.holding(phase, times) if course.steps[-1].chart.adds_stops else {}
    held = [effort(one.pair, force, name=f"hold of {one.name}") for one, force in found.items()]
    stuck = course.sticking(phase, times).items()
    return (*held, *(effort(pair, force, name=f"friction at rest in {pair}") for pair, force in stuck))


def _requested_events(times: Any, course: SimulatedCourse) -> Number:
    asked = real_numbers("times", times).reshape(-1)
    if len(asked) < 2 or not np.all(np.diff(asked) > 0.0) or asked[0] < 0.0 or asked[-1] > course.until:
        what = "they are not two or more increasing times within the simulation"
        raise InvalidInput(Problem("times", what, f"give times from 0 to {course.until:g}"))
    return asked[asked <= course.last]


@dataclass(frozen=True, eq=False)
class SimulationStart:
    """The first pose as a motion, the speeds of free drivers, and the laws of the others."""

    motion: Motion
    speeds: Mapping[str, float]
    laws: Mapping[str, Law]

    @property
    def values(self) -> Mapping[str, float]:
        """The values of the free drivers."""
        return {name: float(np.ravel(self.motion.inputs.drives[name][0])[0]) for name in self.speeds}


def simulation_start(
    mechanism: Mechanism,
    start: Any,
    prescribed: Mapping[str, Any],
    modes: Mapping[str, int] | str | Configuration | None,
) -> SimulationStart:
    """Return the start of a simulation. Raises InvalidInput and UnknownName for invalid arguments."""
    names = [own.name for own in mechanism.drives]
    if start is not None and not isinstance(start, Mapping):
        if len(names) != 1:
            raise InvalidInput(Problem("start", "there is more than one driver", "name them: {'driver': value}"))
        start = {names[0]: start}
    starts: Mapping[str, Any] = start or {}
    for where, given in (("start", starts), ("prescribed", prescribed)):
        for name in given:
            if name not in names:
                raise UnknownName(
                    Problem(f"{where}.{name}", f"there is no driver {name!r}", suggestion(str(name), names))
                )
    laws = _laws(mechanism, starts, prescribed)
    free = {name: _pair(f"start.{name}", starts[name]) if name in starts else (None, 0.0)
            for name in names if name not in laws}  # fmt: skip
    if not free:
        raise InvalidInput(Problem("prescribed", "all drivers are prescribed", "leave one free, or use solve()"))
    motion = _first_pose(mechanism, {name: value for name, (value, _) in free.items()}, laws, modes)
    return SimulationStart(motion, {name: speed for name, (_, speed) in free.items()}, laws)


def _first_pose(
    mechanism: Mechanism,
    free: Mapping[str, float | None],
    laws: Mapping[str, Law],
    modes: Mapping[str, int] | str | Configuration | None,
) -> Motion:
    """Return the first pose. Raises InvalidInput where it cannot be assembled."""
    shown = _written_value(mechanism)
    values = {name: shown[name] if value is None else value for name, value in free.items()}
    values |= {name: float(np.ravel(law.coordinate(np.zeros(1), 0).c[0])[0]) for name, law in laws.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        warnings.simplefilter("ignore", FewDigits)  # another pair takes the driver's place there
        motion = solve(mechanism, {name: [value] for name, value in values.items()}, order=1, modes=modes)
    if motion.failed.any():
        reasons = "; ".join(gap.reason for gap in gaps(motion))
        raise InvalidInput(Problem("start", reasons or "it cannot be assembled there", "start elsewhere"))
    return motion


def _laws(mechanism: Mechanism, start: Mapping[str, Any], prescribed: Mapping[str, Any]) -> dict[str, Law]:
    """Return the laws of the drivers prescribed by the call or by the mechanism."""
    found: dict[str, Law] = {}
    for own in mechanism.drives:
        if own.name in prescribed and own.name in start:
            what = "it has a start as a free driver, and is prescribed too"
            raise InvalidInput(Problem(f"prescribed.{own.name}", what, "leave one of both out"))
        if own.name in prescribed:
            given = prescribed[own.name]
            law = constant_speed(0.0, start=given) if is_finite_real(given) else as_law(f"prescribed.{own.name}", given)
            if law is not None:
                found[own.name] = law
        elif own.law is not None and own.name not in start:
            found[own.name] = own.law
    return found


def _pair(where: str, given: Any) -> tuple[float, float]:
    """Return value and speed of a free driver."""
    parts = given if isinstance(given, tuple | list) else (given, 0.0)
    if len(parts) != 2 or not all(is_finite_real(part) for part in parts):
        remedy = "give a value in radians or lengths, or (value, speed)"
        raise InvalidInput(Problem(where, f"{given!r} is no start", remedy))
    return float(parts[0]), float(parts[1])


def _written_value(mechanism: Mechanism) -> dict[str, float]:
    """Return the drivers' values in the drawing, else at the first pose."""
    order = solving_order_of(mechanism)
    given = inputs(order, {own.name: 0.0 for own in mechanism.drives if own.values is None}, None, None, None)
    shown = stated_by(order)
    found = {}
    for own in mechanism.drives:
        value = drawn_value(order, given, own.name, shown.poses, shown.beside) if own.values is None else own.values
        found[own.name] = 0.0 if value is None else float(np.ravel(value)[0])
    return found


# Forces need accelerations.
ORDER = 2
# The number of coordinates that are tried, the last ones first.
TRIES = 3
# Poses by two drivers agree within this part of the size.
SAME = 1e-6
# Value, speed and acceleration of a coordinate at times.
SolvedCourse = tuple[Number, Number, Number]


def simulated_motion(stretches: list[ChartStretch], more: tuple[Effort, ...] = ()) -> Motion:
    """Return the motion of all stretches together, at the requested times.

    It is driven by a coordinate that determines the pose throughout, where there is one. Its mechanism has `more`
    loads.
    """
    if len(stretches) == 1:
        return _solved(_asked(stretches[0]), more)
    parts = [_poses_of(one) for one in stretches]
    times = np.concatenate([one.times[one.asked] for one in stretches])
    poses = _joined(parts, stretches)
    known = {one.chart.free: one.chart for one in reversed(stretches) if isinstance(one.chart, DriverChart)}
    charts, tried = list(known.values()), list[Motion]()
    # the coordinates of all links keep digits that those of drivers lose next to limit positions
    by_drivers = all(isinstance(one.chart, DriverChart) for one in stretches)
    for chart in charts[: TRIES if by_drivers else 1]:
        motion, agrees = _driven_by(chart, parts, stretches, times, poses, more)
        if by_drivers and agrees and _starts_alike(motion, stretches[0].chart.start):
            return motion
        tried.append(motion)
    # no coordinate is regular everywhere, or only the first one starts with its turns: each pose is that of the
    # coordinate of its stretch
    motion = tried[0]
    if not _starts_alike(motion, stretches[0].chart.start):
        motion, _ = _driven_by(charts[-1], parts, stretches, times, poses, more)
    mended = motion.mended(np.zeros(len(times), dtype=int), np.arange(len(times)), poses)
    return replace(mended, failed=np.zeros_like(motion.failed))


def _starts_alike(motion: Motion, first: Motion) -> bool:
    """Whether the angles by whose turns loads go start in a motion as in the first pose."""
    block, begun = (next(iter(loaded_blocks(one))) for one in (motion, first))
    names = {name for load in motion.mechanism.loads.values() for name in counted_angles(load, block)}
    return all(
        whole_turns(np.ravel(begun.coordinate(name).c[0])[0] - np.ravel(block.coordinate(name).c[0])[0]) == 0.0
        for name in names
    )


def _asked(stretch: ChartStretch) -> ChartStretch:
    """Return the requested times of a stretch alone."""
    some = stretch.asked
    states, accelerations = stretch.states[:, some], stretch.accelerations[:, some]
    return replace(stretch, times=stretch.times[some], states=states, accelerations=accelerations,
                   asked=np.ones(int(np.count_nonzero(some)), dtype=bool))  # fmt: skip


def _solved(stretch: ChartStretch, more: tuple[Effort, ...] = ()) -> Motion:
    """Return the motion of a stretch. By the coordinates of all links its poses are known without the drivers."""
    chart = stretch.chart
    if isinstance(chart, DriverChart):
        return in_time(chart, stretch.times, _moved(stretch), first_configuration(chart.start, 0), more)
    poses = chart.poses(stretch.states, stretch.accelerations)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        courses = chart.courses(stretch.times, stretch.states, stretch.accelerations)
        motion = in_time(chart, stretch.times, courses, first_configuration(chart.start, 0), more)
    mended = motion.mended(np.zeros(len(stretch.times), dtype=int), np.arange(len(stretch.times)), poses)
    return replace(mended, failed=np.zeros_like(motion.failed))


def _has_poses(motion: Motion, poses: Mapping[str, Pose]) -> bool:
    """Return whether a motion has given poses."""
    return all(
        bool(np.all(np.abs(one.c[0] - other.c[0]) < SAME * scale))
        for name, pose in motion.poses.items()
        for one, other, scale in ((pose.z, poses[name].z, motion.size), (pose.u, poses[name].u, 1.0))
    )


class _StretchPoses(NamedTuple):
    """The poses of all links at the times of a stretch, in a row, with the sides of pairs."""

    poses: Mapping[str, Pose]
    ends: Mapping[str, Ends]
    times: int

    def row(self, value: Number) -> Number:
        """Return a value at all times."""
        return np.broadcast_to(value, (1, self.times))


def _poses_of(stretch: ChartStretch) -> _StretchPoses:
    """Return the poses of a stretch. By the coordinates of all links nothing is to be solved for them."""
    chart, count = stretch.chart, len(stretch.times)
    if isinstance(chart, DriverChart):
        motion = _solved(stretch)
        return _StretchPoses(motion.poses, motion.inputs.ends, count)
    return _StretchPoses(chart.poses(stretch.states, stretch.accelerations), chart.ends, count)


def _joined(parts: list[_StretchPoses], stretches: list[ChartStretch]) -> dict[str, Pose]:
    """Return the poses of all links at the requested times, in a row."""

    def row(name: str, side: str, k: int) -> Number:
        found = []
        for part, one in zip(parts, stretches, strict=True):
            c = getattr(part.poses[name], side).c
            found.append(part.row(c[k] if k < len(c) else 0.0)[:, one.asked])
        return np.concatenate(found, axis=1)

    def series(name: str, side: str) -> Series:
        return Series(tuple([row(name, side, k) for k in range(ORDER + 1)]))

    return {name: FIXED if name == FRAME else Pose(series(name, "z"), series(name, "u")) for name in parts[0].poses}


def _driven_by(
    chart: DriverChart,
    parts: list[_StretchPoses],
    stretches: list[ChartStretch],
    times: Number,
    poses: Mapping[str, Pose],
    more: tuple[Effort, ...],
) -> tuple[Motion, bool]:
    """Return the motion by the free drivers of one chart, and whether it has the poses of the simulation."""
    moved = {name: _followed(chart, name, parts, stretches) for name in chart.free}
    first = Configuration(chart.start.structure, {}, placed_at(poses, (0, 0)), {}, {},
                          dimensions_at(chart.start.structure, 0, 0))  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = in_time(chart, times, moved, first, more)
    return motion, bool(np.all(motion.regular)) and _has_poses(motion, poses)


def _followed(chart: DriverChart, name: str, parts: list[_StretchPoses], stretches: list[ChartStretch]) -> SolvedCourse:
    """Return the course of a chart's driver over all stretches, read off their motions."""
    own = chart.start.structure.driven[name]
    sense, found, begins, last = float(own.pair.driven_by(own.drive.link)), [], [], None
    for part, one in zip(parts, stretches, strict=True):
        # by the poses: at a multiple pin another driver leads to other pairs
        ends = part.ends.get(own.pair.name) or own.pair.ends(chart.mechanism.geometry)
        series = own.pair.coordinate(ends, tuple(part.poses[link] for link in own.pair.members))
        rows = [part.row(series.derivative(k))[0] * sense for k in range(ORDER + 1)]
        if own.pair.free_is_angle:
            rows[0] = np.unwrap(rows[0])
            rows[0] = rows[0] + (0.0 if last is None else whole_turns(last - rows[0][0]))
        last = rows[0][-1]
        begins.append(rows[0][0])
        found.append(np.array(rows)[:, one.asked])
    value, speed, acceleration = np.concatenate(found, axis=1)
    if own.pair.free_is_angle:
        index = [one.chart is chart for one in stretches].index(True)
        value += whole_turns(stretches[index].states[chart.free.index(name), 0] - begins[index])
    return value, speed, acceleration


def _moved(stretch: ChartStretch) -> dict[str, SolvedCourse]:
    """Return the courses of the free drivers in a stretch."""
    chart, n = stretch.chart, len(stretch.chart.free)
    values, speeds = stretch.states[:n], stretch.states[n : 2 * n]
    rates = stretch.accelerations
    if not np.isfinite(rates).all():
        late = stretch.times[np.argmin(np.isfinite(rates).all(axis=0))]
        what = f"at {late:g} s the mechanism is at a limit position of its drivers, where their rates are unknown"
        raise InvalidInput(Problem("until", what, "end earlier, or drive other links"))
    return {name: (values[k], speeds[k], rates[k]) for k, name in enumerate(chart.free)}


def in_time(
    chart: Chart,
    times: Number,
    moved: Mapping[str, SolvedCourse],
    first: Configuration | None,
    more: tuple[Effort, ...] = (),
) -> Motion:
    """Return a motion in time of a chart's mechanism, whose free drivers have laws through their simulated courses."""
    laws = {**chart.laws, **{name: motion_table(times, *one) for name, one in moved.items()}}
    drives = [Drive(item.name, item.link, item.on, item.pair, law=laws[item.name]) for item in chart.mechanism.items
              if isinstance(item, Drive)]  # fmt: skip
    mechanism = chart.mechanism.replace(*drives, *more, time=times)
    return solve(mechanism, time=times, order=ORDER, modes=first)
