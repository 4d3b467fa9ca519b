"""A state of a mechanism by its drivers: its equation of motion, accelerations, loads and quantities."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.mass_motion import InertiaTerms, MovingMass, inertia_terms
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.laws import Law
from compoundkin.model.loads.attachments import PairLoad
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.motor import Motor, as_motor
from compoundkin.model.pairs import Pair
from compoundkin.structure.mobility_count import DrivenPair


class LinearAngle(NamedTuple):
    """A linear estimate of an angle: its value at values of the drivers, and its derivatives by them."""

    angle: float
    values: Number | None
    slopes: Number

    def at(self, values: Number) -> float:
        """Return the estimate at other values."""
        return self.angle if self.values is None else self.angle + float(self.slopes @ (values - self.values))


def by_drivers(value: Number, names: tuple[str, ...]) -> Number:
    """Return the rates of a coordinate by the drivers: all of a column but the last."""
    return np.broadcast_to(value, (len(names) + 1, 1))[:-1, 0]


def prescribed_rates(law: Law, time: float) -> tuple[float, float, float]:
    """Return value, speed and acceleration of a prescribed driver."""
    moved = law.coordinate(np.array([time]), 2)
    value, speed, acceleration = (float(np.ravel(moved.derivative(k))[0]) for k in range(3))
    return value, speed, acceleration


def pair_named(start: Motion, name: str) -> Pair:
    """Return a pair as a motion has it, or between two links of a multiple pin that no pair joins."""
    found = start.solving_order.pairs.get(name) or start.mechanism.names.coordinate(name)
    assert found is not None
    return found


def first_angle(start: Motion, name: str) -> float:
    """Return the angle of a pair at the only pose of a motion."""
    if name in start.solving_order.pairs:
        return float(np.ravel(start.pairs[name].value)[0])
    first, second = (float(np.ravel(start.links[link].angle)[0]) for link in pair_named(start, name).members[:2])
    return second - first


def needs_time(start: Motion, load: Load) -> bool:
    """Return whether a load depends on the time, which a motion of one pose does not have."""
    try:
        list(load.wrenches(next(iter(loaded_blocks(start)))))
    except InvalidInput:
        return True
    return False


class StateChart(Protocol):
    """The part of a chart that its states need."""

    start: Motion
    free: tuple[str, ...]
    names: tuple[str, ...]
    order: SolvingOrder
    masses: tuple[MovingMass, ...]
    gravity: complex
    loads: tuple[tuple[Load, ...], tuple[Load, ...]]  # those that have a potential, and the others
    turned: dict[str, LinearAngle]  # the counted angles of pairs
    driven: dict[str, tuple[str, DrivenPair]]  # the drivers of pairs, by their names
    stop_contacts: tuple[Any, ...]  # those at stops and in latches
    closed: tuple[Any, ...]  # those of them that are closed
    phase: int  # the number of the phase
    open_pairs: tuple[Any, ...]  # the pairs that have come apart

    def accelerated(self, state: DriverState) -> Number:
        """Return the accelerations of the free drivers at a state."""

    def turns_of(self, pair: str, angle: float, values: Number) -> float:
        """Return an angle of a pair with its turns, at values of the drivers."""


class Rates(NamedTuple):
    """The rates of a state: accelerations of the free drivers, power of loads without a potential."""

    accelerations: Number
    power: float


@dataclass(frozen=True, eq=False)
class DriverState:
    """A pose with the speeds of all drivers, and its equation of motion."""

    chart: StateChart
    time: float
    values: Number
    speeds: Number
    prescribed: Number  # accelerations of the prescribed drivers
    block: Block

    @cached_property
    def terms(self) -> InertiaTerms:
        """The mass matrix and the bias by all drivers."""
        return inertia_terms(self.chart.masses, self.block.world, len(self.values), self.chart.gravity)

    @cached_property
    def loaded(self) -> LoadedState:
        """The state as loads see it."""
        return loaded_state(self.chart.start, self.block, self.time, len(self.values), self._turned)

    def _turned(self, pair: str, angle: float) -> float:
        return self.chart.turns_of(pair, angle, self.values)

    def slopes(self, pair: Pair) -> Number:
        """Return the rates of a pair's coordinate by the drivers."""
        ends, poses = self.block.ends[pair.name], tuple(self.block.world[name] for name in pair.members)
        moved = pair.coordinate(ends, poses).c
        return by_drivers(moved[1], self.chart.names) if len(moved) > 1 else np.zeros(len(self.values))

    def angle_of(self, name: str) -> LinearAngle:
        """Return the angle of a pair here, with its rates by the drivers."""
        angle, slopes = self.loaded.counted_angle(pair_named(self.chart.start, name))
        return LinearAngle(angle, self.values, slopes)

    @cached_property
    def forces(self) -> tuple[Number, Number]:
        """The forces along the drivers' coordinates: those with a potential, and the others."""
        stored, others = (self.loaded.along(loads) for loads in self.chart.loads)
        if motors := rotors_that_lose(self.chart.loads[1]):
            dry = np.concatenate([self._dry(self.terms.weight + stored + others), self.prescribed])
            others = others + rotor_forces(self.loaded, motors, dry, self.response)
        return self.terms.weight + stored, others

    @property
    def push(self) -> Number:
        """The forces of weights and loads along the drivers' coordinates."""
        return self.forces[0] + self.forces[1]

    @cached_property
    def accelerations(self) -> Number:
        """The accelerations of the free drivers, with friction."""
        return self.chart.accelerated(self)

    @property
    def dry(self) -> Number:
        """The accelerations of the free drivers without friction."""
        return self._dry(self.push)

    def _dry(self, along: Number) -> Number:
        n, (matrix, bias, _) = len(self.chart.free), self.terms
        push = along[:n] - bias[:n]
        if len(self.prescribed):
            push = push - matrix[:n, n:] @ self.prescribed
        if n == 1:
            return push / matrix[0, 0]
        try:
            found: Number = np.linalg.solve(matrix[:n, :n], push)
        except np.linalg.LinAlgError:
            found = np.full(n, np.nan)
        return found

    @property
    def rates(self) -> Rates:
        """The rates of the state."""
        return Rates(self.accelerations, float(self.forces[1] @ self.speeds) + self._driven)

    @property
    def _driven(self) -> float:
        """The power of the prescribed drivers."""
        if not len(self.prescribed):
            return 0.0
        n, (matrix, bias, _) = len(self.chart.free), self.terms
        whole = np.concatenate([self.accelerations, self.prescribed])
        efforts = matrix[n:] @ whole + bias[n:] - self.push[n:]
        return float(efforts @ self.speeds[n:])

    @property
    def kinetic(self) -> float:
        """The kinetic energy."""
        return float(self.speeds @ self.terms.matrix @ self.speeds) / 2.0

    def response(self, along: Number) -> Number:
        """Return the accelerations of all drivers by forces along the free ones alone."""
        n, found = len(self.chart.free), np.zeros(len(self.speeds))
        found[:n] = np.linalg.solve(self.terms.matrix[:n, :n], along[:n])
        return found

    @cached_property
    def motion(self) -> Motion:
        """The state as a motion of one pose, with velocities and accelerations."""
        return self.moved(self.accelerations)

    def moved(self, accelerations: Number) -> Motion:
        """Return the state as such a motion with other accelerations of the free drivers."""
        second = np.concatenate([accelerations, self.prescribed])
        return accelerated_motion(self, self.chart.start, second)


ONLY = slice(0, 1)


class TrueRates(dict[str, Pose]):
    """Poses as plain numbers, made on access, with the true rates, which are the last of each column."""

    def __init__(self, world: dict[str, Pose]) -> None:
        super().__init__()
        self.columns = world

    def __missing__(self, link: str) -> Pose:
        pose = self.columns[link]
        found = self[link] = pose if pose is FIXED else Pose(_true(pose.z), _true(pose.u))
        return found


class KnownCoordinate(NamedTuple):
    """A pair's coordinate with its rate, its rates at unit rate of each coordinate of a state, and its acceleration.

    That is the one at no accelerations of these.
    """

    value: float
    rate: float
    slopes: Number
    bias: float = 0.0


@dataclass(frozen=True, eq=False)
class LoadedState(LoadedBlock):
    """A single pose as loads see it, and their forces along each of `count` coordinates.

    The rates of each pose of `columns` are those at unit rate of every coordinate, and last the true ones; the block
    has the true ones alone. `turns` adds to an angle of a pair its full turns; `driven` are coordinates of pairs that
    are known with their rates, the drivers' own and those of a table.
    """

    columns: dict[str, Pose] | None = None
    seconds: float = 0.0
    count: int = 0
    turns: Callable[[str, float], float] | None = None
    driven: Mapping[str, KnownCoordinate] = field(default_factory=dict)

    @property
    def time(self) -> Number | None:
        """The time in seconds."""
        return np.array([[self.seconds]])

    def fitted(self, value: Any, where: str = "load") -> Number:
        """Return a single number. Raises InvalidInput for an array along a motion."""
        if isinstance(value, float | complex | int):
            return value
        if np.size(value) != 1:
            what = "it is an array over poses, and the poses of a simulation are not known in advance"
            raise InvalidInput(Problem(where, what, "give a number, a function of time or a table"))
        return np.ravel(value)[0].item()

    def along(self, loads: Iterable[Load]) -> Number:
        """Return the forces of loads along each coordinate."""
        total = np.zeros(self.count)
        turns_freely = self.motion.structure.passive
        for load in loads:
            if isinstance(load, PairLoad) and not turns_freely:
                total += np.ravel(load.effort(self)) * self.rates_of(load.pair)[0]
                continue
            for link, wrench in load.wrenches(self):
                total += np.ravel(self.freed(link, wrench).power(self._unit(link)))
        return total

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a pair or a driver. Angles are counted along the motion."""
        pair, sign = self._meant(name)
        known = self.driven.get(pair.name)
        return super().coordinate(name) if known is None else Series((sign * known.value, sign * known.rate))

    def rates_of(self, name: str) -> tuple[Number, float]:
        """Return the rates of a coordinate by the drivers, and its acceleration at zero accelerations of them."""
        assert self.columns is not None
        pair, sign = self._meant(name)
        if pair.name in self.driven:
            return sign * self.driven[pair.name].slopes, sign * self.driven[pair.name].bias
        moved = pair.coordinate(self._ends(pair), tuple(self.columns[link] for link in pair.members)).c
        bias = 2.0 * float(np.ravel(moved[2])[-1]) if len(moved) > 2 else 0.0
        return sign * self._slopes(moved), sign * bias

    def counted_angle(self, pair: Pair) -> tuple[float, Number]:
        """Return the angle of a pair with its turns, and its rates by the drivers, in the sense of the pair itself."""
        assert self.columns is not None
        moved = pair.coordinate(self._ends(pair), tuple(self.columns[link] for link in pair.members)).c
        return float(np.ravel(self._counted(pair))[0]), self._slopes(moved)

    def _slopes(self, moved: Sequence[Number]) -> Number:
        """Return the rates of a coordinate at unit rate of each of the state's."""
        row = np.ravel(moved[1]) if len(moved) > 1 else np.zeros(1)
        return row[:-1] if row.size > 1 else np.broadcast_to(row, self.count)

    def _unit(self, link: str) -> Pose:
        """Return the pose of a link with its rates at unit rate of each coordinate."""
        assert self.columns is not None
        pose = self.columns[link]
        return pose if pose is FIXED else Pose(self._rows(pose.z), self._rows(pose.u))

    def _rows(self, series: Series) -> Series:
        rates = [np.ravel(c)[: self.count] for c in series.c[1:2]]
        return Series((_number(series.c[0]), *rates))

    def _counted(self, pair: Pair) -> Number:
        """Return an angle with its turns."""
        assert self.turns is not None
        found = pair.coordinate(self._ends(pair), self._poses(pair))
        return self.turns(pair.name, float(np.ravel(found.c[0])[0]))


# The senses in which power goes through gears of motors are found in turn, each again so often.
TURNS_OF_SENSES = 8


def rotors_that_lose(loads: Iterable[Load]) -> tuple[Motor, ...]:
    """Return the motors whose effort depends on the acceleration."""
    return tuple(one for one in map(as_motor, loads) if one is not None and one.loses_at_rotor)


def rotor_forces(
    at: LoadedState, motors: Sequence[Motor], accelerations: Number, response: Callable[[Number], Number]
) -> Number:
    """Return the forces along all coordinates by which efforts of motors differ from those at constant speed.

    `accelerations` are those under efforts at constant speed, `response` those by a force along all coordinates. An
    effort has a corner where the power through the gear changes its sense: Newton's method ends on a piece of it.
    """
    rates = [at.rates_of(one.pair) for one in motors]
    rows = np.array([row for row, _ in rates])
    answers = rows @ np.array([response(row) for row in rows]).T

    def efforts(second: Number) -> tuple[Number, Number]:
        both = [motor.effort_while(at, a) for motor, a in zip(motors, second, strict=True)]
        return np.array([np.ravel(one)[0] for one, _ in both]), np.array([np.ravel(slope)[0] for _, slope in both])

    begun = rows @ accelerations + [bias for _, bias in rates]
    still, (here, slopes) = efforts(np.zeros(len(motors)))[0], efforts(begun)
    second = begun
    for _ in range(TURNS_OF_SENSES):
        off, before = second - begun - answers @ (here - still), slopes
        second = second - np.linalg.solve(np.eye(len(motors)) - answers * slopes, off)
        here, slopes = efforts(second)
        if np.array_equal(slopes, before):
            break
    found: Number = (here - still) @ rows
    return found


def loaded_state(
    motion: Motion, block: Block, seconds: float, count: int, turns: Callable[[str, float], float]
) -> LoadedState:
    """Return a state of a block of columns as loads see it."""
    true = Block((1, 1), block.ends, TrueRates(block.world), {}, 1)
    return LoadedState(motion, true, ONLY, ONLY, columns=block.world, seconds=seconds, count=count, turns=turns)


def _true(series: Series) -> Series:
    return Series((_number(series.c[0]), *[_number(c, -1) for c in series.c[1:2]]))


def _number(value: Number, at: int = 0) -> Number:
    return value.item(at) if isinstance(value, np.ndarray) else value


class SeenState(Protocol):
    """The part of a state that gaps of contacts need."""

    @property
    def loaded(self) -> LoadedState:
        """The state as loads see it."""

    @property
    def speeds(self) -> Number:
        """The rates of all coordinates."""


class PushedState(SeenState, Protocol):
    """The part of a state that the forces of contacts need."""

    @property
    def prescribed(self) -> Number:
        """The accelerations of the prescribed drivers that are coordinates."""

    @property
    def terms(self) -> InertiaTerms:
        """The mass matrix, the bias and the weights."""

    def response(self, along: Number) -> Number:
        """Return the accelerations of all coordinates by a force along them alone."""


class KnownState(PushedState, Protocol):
    """The part of a state that events and stops need, whichever coordinates it is in."""

    @property
    def chart(self) -> Any:
        """What it is a state of."""

    @property
    def time(self) -> float:
        """The time, seconds."""

    @property
    def values(self) -> Number:
        """The values of all coordinates."""

    @property
    def block(self) -> Block:
        """The solved pose."""

    @property
    def motion(self) -> Motion:
        """The state as a motion of one pose, with velocities and accelerations."""

    def moved(self, accelerations: Number) -> Motion:
        """Return the state as such a motion with other accelerations of the free coordinates."""

    @property
    def kinetic(self) -> float:
        """The kinetic energy."""

    def slopes(self, pair: Pair) -> Number:
        """Return the rates of a pair's coordinate by all coordinates."""


@dataclass(frozen=True, eq=False)
class SimulatedState:
    """A state of a simulation, with quantities by name as of a motion: ``state["B.y"]``."""

    state: KnownState
    order: SolvingOrder

    @property
    def time(self) -> float:
        """The time, seconds."""
        return self.state.time

    @property
    def block(self) -> Block:
        """The solved pose."""
        return self.state.block

    @property
    def motion(self) -> Motion:
        """The state as a motion of one pose, with velocities and accelerations."""
        return self.state.motion

    def __getitem__(self, name: str) -> Any:
        return np.ravel(quantity(self.motion, name).values)[0]


def accelerated_motion(state: DriverState, start: Motion, second: Number) -> Motion:
    """Return a state as a motion of one pose with such accelerations of the drivers."""
    rows = zip(state.chart.names, state.values, state.speeds, second.tolist(), strict=True)
    drives: dict[str, tuple[Number, ...]] = {
        name: tuple(np.array([[one]]) for one in (value, speed, a)) for name, value, speed, a in rows
    }

    def true(series: Series) -> Series:
        if len(series.c) < 3:
            return Series((_entry(series.c[0]), *[0.0 * _entry(series.c[0])] * 2))
        rows = by_drivers(series.c[1], state.chart.names)
        moved, grown = (np.reshape(rows @ by, (1, 1)) for by in (state.speeds, second / 2.0))
        return Series((_entry(series.c[0]), moved, _entry(series.c[2]) + grown))

    return _single_pose(state, start, drives, true)


def unit_motion(state: DriverState, start: Motion) -> Motion:
    """Return a state of a single driver as a motion of one pose at unit speed, without acceleration."""
    (name,), value = state.chart.names, state.values[0]
    drives: dict[str, tuple[Number, ...]] = {name: tuple(np.array([[one]]) for one in (value, 1.0, 0.0))}

    def unit(series: Series) -> Series:
        return Series(tuple(np.reshape(np.ravel(c)[0], (1, 1)) for c in (*series.c, 0.0, 0.0)[:3]))

    return _single_pose(state, start, drives, unit)


def _single_pose(
    state: DriverState, start: Motion, drives: Mapping[str, tuple[Number, ...]], changed: Callable[[Series], Series]
) -> Motion:
    """Return a state as a motion of one pose, with the series of its poses changed."""
    poses = {name: pose if pose is FIXED else pose.mapped(changed) for name, pose in state.block.world.items()}
    inputs = replace(start.inputs.driven(drives), shape=(1,))
    failed = np.zeros((1, 1), dtype=int)
    return replace(start, order=2, inputs=inputs, poses=poses, failed=failed, time=np.full(1, state.time))


def _entry(value: Number) -> Number:
    """Return the last of a column: that of the true motion."""
    return np.reshape(np.ravel(value)[-1], (1, 1))
