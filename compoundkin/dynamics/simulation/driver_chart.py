"""Chart: a mechanism in the coordinates of its drivers, some free and some prescribed, solved one state at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number, first_entry, whole_turns
from compoundkin.base.poses import FIXED, Pose
from compoundkin.dynamics.mass_motion import moving_masses
from compoundkin.dynamics.simulation.driver_state import (
    DriverState,
    LinearAngle,
    PushedState,
    Rates,
    by_drivers,
    first_angle,
    prescribed_rates,
)
from compoundkin.dynamics.simulation.simulated_energy import sorted_loads
from compoundkin.dynamics.simulation.stop_contacts import StopContact, is_no_contact, rates_under, sprung
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.contract import equations_of
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import run
from compoundkin.model.laws import Law
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_drivable


@dataclass(eq=False)
class DriverChart:
    """Configurations around one pose as functions of the drivers; the `free` ones obey the equation of motion.

    `start` is a motion of one pose; `laws` prescribe the other drivers. The configuration is that of the signs of dyads
    and of the states of other groups, which are updated at every accepted state.
    """

    start: Motion
    free: tuple[str, ...]
    laws: Mapping[str, Law]
    signs: dict[int, float] = field(init=False)
    states: dict[int, Number] = field(init=False)
    near: dict[str, LinearAngle] = field(init=False)
    turned: dict[str, LinearAngle] = field(init=False)
    held: HeldSpeed | None = field(init=False, default=None)
    stop_contacts: tuple[StopContact, ...] = field(init=False, default=())  # those at stops and in latches
    closed: tuple[StopContact, ...] = field(init=False, default=())  # those of them that are closed
    phase: int = field(init=False, default=0)
    open_pairs: tuple[Any, ...] = field(init=False, default=())  # those that have come apart

    # whether loads are those of the chart, so that stops are added as they are closed
    adds_stops: ClassVar[bool] = True

    def __post_init__(self) -> None:
        self.names = (*self.free, *self.laws)
        self.mechanism = self.start.mechanism
        self.order = self.start.solving_order
        self.masses = moving_masses(self.start.structure)
        self.gravity = complex(first_entry(self.mechanism.free_fall))
        self.loads = sorted_loads(self.start)
        if self.adds_stops:
            stored, others = self.loads
            self.loads = tuple(filter(is_no_contact, stored)), tuple(filter(is_no_contact, others))
        self.ends = self.start.inputs.cut(slice(0, 1), slice(0, 1)).ends
        self.signs = {s.index: float(self.start.sign(s.index, 0)) for s in self.order.solvers if not s.is_numbered}
        self.states, self.near, self.turned = {}, {}, {}
        self.driven = {own.pair.name: (name, own) for name, own in self.start.structure.driven.items()}
        self._follow(self.start.poses, None)

    @cached_property
    def candidates(self) -> tuple[Pair, ...]:
        """The pairs that could be driven instead, each the only one between its links."""
        pairs = self.start.structure.pairs
        sides = [frozenset(pair.members) for pair in pairs]
        single = zip(pairs, sides, strict=True)
        return tuple(pair for pair, both in single if as_drivable(pair) and len(both) == 2 and sides.count(both) == 1)

    @cached_property
    def scales(self) -> Number:
        """The length scale of each free driver: a radian, or the mechanism's size."""
        return np.array([self.order.unit(name) for name in self.free])

    @property
    def longest_moves(self) -> Number:
        """The longest move of each free driver in a step, so that configurations and turns are tracked."""
        return self.scales

    def prescribed(self, time: float) -> tuple[Number, Number, Number]:
        """Return values, speeds and accelerations of the prescribed drivers."""
        rows = np.array([prescribed_rates(law, time) for law in self.laws.values()])
        return rows[:, 0], rows[:, 1], rows[:, 2]

    def state(self, time: float, values: Number, speeds: Number) -> DriverState:
        """Return the state at values and speeds of the free drivers."""
        given = self.prescribed(time) if self.laws else (np.empty(0),) * 3
        whole, rates = np.concatenate([values, given[0]]), np.concatenate([speeds, given[1]])
        return DriverState(self, time, whole, rates, given[2], self._block(whole, rates))

    def seen(self, time: float, values: Number, speeds: Number) -> PushedState:
        """Return a state as contacts see it."""
        return self.state(time, values, speeds)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state."""
        return self.state(time, values, speeds).rates

    def followed_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state, between both sides of a jump where a load holds a speed."""
        free = self.free_rates(time, values, speeds)
        return rates_under(self._added, self.seen(time, values, speeds), free) if self._added else free

    def unheld_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state without the rigid contacts."""
        free = self.free_rates(time, values, speeds)
        return sprung(self._added, self.seen(time, values, speeds), free) if self._added else free

    pressing_rates = unheld_rates

    def free_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state without the contacts at stops and in latches."""
        return self.rates(time, values, speeds) if self.held is None else self.held.rates(self, time, values, speeds)

    def pressing(self, name: str, time: float, values: Number, speeds: Number) -> float | None:
        """Return the force that presses a contact, None where it is to be found from the forces of the state."""
        return None

    @property
    def _added(self) -> tuple[StopContact, ...]:
        """The closed contacts whose forces are not among the loads."""
        return self.closed if self.adds_stops else tuple(one for one in self.closed if not one.stop.is_elastic)

    @property
    def rigid(self) -> tuple[StopContact, ...]:
        """The closed contacts that hold a coordinate."""
        return tuple(one for one in self.closed if not one.stop.is_elastic)

    def accelerated(self, state: DriverState) -> Number:
        """Return the accelerations of the free drivers at a state."""
        return state.dry

    def begin(self, time: float, values: Number, speeds: Number) -> bool:
        """Start from a state; return whether it moves, which friction may prevent."""
        return True

    def released(self, time: float, values: Number, until: float) -> float:
        """Return the time at which friction releases the mechanism, at the latest the end."""
        return until

    def accelerations_at(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the accelerations of the free drivers at a state of the solution."""
        return self.followed_rates(time, values, speeds).accelerations

    @property
    def memory(self) -> tuple[Any, ...]:
        """The configuration at the last accepted state."""
        return (self.held, self.closed), dict(self.states), dict(self.near), dict(self.turned)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Restore a configuration."""
        self.held, self.closed = memory[0]
        self.states, self.near, self.turned = (dict(own) for own in memory[1:4])

    def sign(self, k: int, values: Number) -> float:
        """Return the sign of a dyad's mode at values of the drivers."""
        return self.signs[k]

    def is_regular(self, values: Number) -> bool:
        """Return whether no pair is known to move much faster than a driver."""
        return False

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Update the configuration at an accepted state."""
        if self.states or self.order.turning or self.turned:
            found = self.state(time, values, speeds)
            self._follow(found.block.world, found.values)
            for pair in self.turned:
                self.turned[pair] = found.angle_of(pair)

    def digits_lost(self, time: float, state: Number) -> float:
        """Return that rounding is as everywhere."""
        return 0.0

    def settled(self, time: float, state: Number) -> Number:
        """Return a state as it is: drivers' coordinates have no constraints that could drift."""
        return state

    def count_on(self, before: DriverState) -> None:
        """Count angles on from a state of another chart, at the same stops."""
        self.phase, self.open_pairs = before.chart.phase, before.chart.open_pairs
        self.stop_contacts, self.closed = before.chart.stop_contacts, before.chart.closed
        angles = [name for name, (_, own) in before.chart.driven.items() if own.pair.free_is_angle]
        for name in (*before.chart.turned, *angles):
            self.turned[name] = LinearAngle(before.angle_of(name).angle, None, np.zeros(len(self.names)))

    def _follow(self, world: Mapping[str, Pose], values: Number | None) -> None:
        """Store the states of groups without signs, and the counted angles with their rates by the drivers."""
        self._store_states(world)
        for link in self.order.turning:
            if (turned := world[link].theta) is None:
                continue
            slopes = (
                np.zeros(len(self.names))
                if values is None or len(turned.c) < 2
                else by_drivers(turned.c[1], self.names)
            )
            self.near[link] = LinearAngle(float(np.ravel(turned.c[0])[0]), values, slopes)

    def _store_states(self, world: Mapping[str, Pose]) -> None:
        """Store the states of groups without signs."""
        for solver in (s for s in self.order.solvers if s.is_numbered):
            bodies = [still(world[body.links[0]]) for body in solver.group.bodies]
            self.states[solver.index] = equations_of(solver).state(bodies).reshape(1, 1, -1)

    def turns_of(self, pair: str, angle: float, values: Number) -> float:
        """Return an angle of a pair with its full turns."""
        if pair in self.driven:
            name, own = self.driven[pair]
            return float(values[self.names.index(name)]) * own.pair.driven_by(own.drive.link)
        if pair not in self.turned:
            self.turned[pair] = LinearAngle(first_angle(self.start, pair), None, np.zeros(len(self.names)))
        return angle + float(whole_turns(self.turned[pair].at(values) - angle))

    def _block(self, values: Number, speeds: Number) -> Block:
        """Solve a pose with the rates at unit rate of each driver, and last the true ones."""
        count = len(values)
        table = np.vstack([np.eye(count), speeds])[:, :, None]
        drives = {name: (values[k : k + 1, None], table[:, k]) for k, name in enumerate(self.names)}
        part = self.start.inputs.driven(drives)
        block = self.order.start(self.ends, part.series(2), 2, (count + 1, 1))
        return run(self.order, block, _ConfigurationChoice(self, values))


# Both sides of a jump are this part of the speed apart from it, and rates are differences over this part of the time.
BESIDE, INSTANT = 1e-8, 2e-3


@dataclass(frozen=True, eq=False)
class HeldSpeed:
    """A load that jumps where its speed passes a value, and so holds it there: the motion slides along the jump.

    Source: A. F. Filippov, Differential Equations with Discontinuous Righthand Sides, Kluwer 1988, section 4.
    """

    load: Load
    speed: float
    pace: float  # the size of speeds

    def excess(self, chart: DriverChart, time: float, values: Number, speeds: Number) -> float:
        """Return the excess of the load's speed over the one at which it jumps."""
        return _speed_of(self.load, chart.state(time, values, speeds)) - self.speed

    def linear(self, chart: DriverChart, time: float, values: Number, speeds: Number) -> tuple[float, Number]:
        """Return the excess, and the rates of the load's speed by the speeds of the free drivers."""
        here = self.excess(chart, time, values, speeds)
        steps = self.pace * np.eye(len(speeds))
        slopes = np.array([self.excess(chart, time, values, speeds + step) - here for step in steps]) / self.pace
        return here, slopes

    def moved(self, chart: DriverChart, time: float, values: Number, speeds: Number, excess: float) -> Number:
        """Return the speeds of the free drivers at which the load's speed has an excess."""
        return _at_excess(speeds, excess, *self.linear(chart, time, values, speeds))

    def sides(
        self, chart: DriverChart, time: float, values: Number, speeds: Number, near: float = 1.0
    ) -> tuple[Rates, Rates, float]:
        """Return the rates below and above the jump, and the part of those above under which the speed is held.

        The part is from 0 to 1 where it can be held. The sides are `near` times as far apart as usual.
        """
        parts, grown = [], []
        here, slopes = self.linear(chart, time, values, speeds)
        for side in (-1.0, 1.0):
            beside = _at_excess(speeds, side * near * BESIDE * self.pace, here, slopes)
            found = chart.rates(time, values, beside)
            # the power is that at the speed itself
            off = float(chart.state(time, values, beside).forces[1][: len(speeds)] @ (beside - speeds))
            parts.append(Rates(found.accelerations, found.power - off))
            grown.append(self._growth(chart, time, values, speeds, parts[-1].accelerations, here))
        return parts[0], parts[1], grown[0] / (grown[0] - grown[1]) if grown[0] > grown[1] else np.nan

    def jump(self, chart: DriverChart, time: float, values: Number, speeds: Number) -> float:
        """Return by how much the load jumps."""
        here = self.linear(chart, time, values, speeds)
        ends = [chart.state(time, values, _at_excess(speeds, side * BESIDE * self.pace, *here)) for side in (-1.0, 1.0)]
        return float(np.max(np.abs(np.subtract(*(one.loaded.along((self.load,)) for one in ends)))))

    def _growth(
        self, chart: DriverChart, time: float, values: Number, speeds: Number, second: Number, here: float
    ) -> float:
        """Return the rate of the load's speed, whose excess is known, at accelerations of the free drivers."""
        quick = max(float(np.max(np.abs(speeds) / chart.scales)), float(np.sqrt(np.max(np.abs(second) / chart.scales))))
        step = INSTANT / quick if quick else INSTANT

        def over(h: float) -> float:
            ends = [self.excess(chart, time + d, values + d * speeds + d * d * second / 2.0, speeds + d * second)
                    for d in (-h, h)]  # fmt: skip
            return (ends[1] - ends[0]) / (2.0 * h)

        # Richardson's extrapolation; what has drifted off the jump returns to it within about a radian
        return (4.0 * over(step / 2.0) - over(step)) / 3.0 + quick * here

    def rates(self, chart: DriverChart, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates between those of both sides under which the speed is held."""
        if len(speeds) == 1 and speeds[0] == self.speed == 0.0:
            return Rates(np.zeros(1), 0.0)
        below, above, part = self.sides(chart, time, values, speeds)
        return Rates(below.accelerations + part * (above.accelerations - below.accelerations),
                     below.power + part * (above.power - below.power))  # fmt: skip


def _at_excess(speeds: Number, excess: float, here: float, slopes: Number) -> Number:
    found: Number = speeds + (excess - here) * slopes / float(slopes @ slopes)
    return found


def _speed_of(load: Load, state: DriverState) -> float:
    speed = load.speed_at(state.loaded)
    assert speed is not None
    return float(np.ravel(speed)[0])


@dataclass(frozen=True)
class _ConfigurationChoice:
    """The choice of modes that continues the configuration of a chart."""

    chart: DriverChart
    values: Number

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the sign or the state."""
        return self.chart.states[solver.index] if solver.is_numbered else self.chart.sign(solver.index, self.values)

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return an estimate of a counted angle."""
        known = self.chart.near.get(link)
        return None if known is None else known.at(self.values)


def still(pose: Pose) -> Pose:
    """Return a pose at its first entry, without rates."""
    return pose if pose is FIXED else pose.trimmed(0).entry((0, 0))
