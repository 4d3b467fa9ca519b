"""The equation of motion in the coordinates of all links, held together by the equations of their pairs.

No coordinate is chosen, so that none can fail: at limit positions of drivers and at change points the same equations
hold, and redundant pairs repeat what others hold. With J the Jacobian of the pairs and of the prescribed drivers,
J v = b and J a = c; what J leaves free of the accelerations, its null space N, obeys N' (M a + h - Q) = 0. After every
step positions and velocities are projected on the pairs' equations.

Source: F. E. Udwadia and R. E. Kalaba, Analytical Dynamics, Cambridge 1996, chapter 3; E. Hairer, C. Lubich and
G. Wanner, Geometric Numerical Integration, 2nd ed., Springer 2006, section IV.4 (projection).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, first_entry, whole_turns
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.mass_motion import InertiaTerms, MovingMass, moving_masses
from compoundkin.dynamics.reactions.undetermined import spare_force
from compoundkin.dynamics.simulation.driver_state import (
    ONLY,
    LoadedState,
    Rates,
    first_angle,
    pair_named,
    prescribed_rates,
    rotor_forces,
    rotors_that_lose,
)
from compoundkin.dynamics.simulation.pair_equations import (
    Equations,
    PairEquations,
    coefficient,
    link_poses,
    plain_number,
)
from compoundkin.dynamics.simulation.simulated_energy import sorted_loads
from compoundkin.dynamics.simulation.stop_contacts import StopContact, holding, is_no_contact, rates_under, sprung
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.model.pairs.profile_contact import as_profile_contact

# Equations that move a link by less than this part of what others do say nothing new: what drifts off redundant pairs
# between two projections is far below, and a change point is that near for an instant only.
RANK = 1e-8
# A change point is near where the least singular value is this part of what it has been, or of the greatest one.
NEAR, NEAR_AT_ALL = 0.1, 1e-3
# Projections end where they move nothing by more than this (parts of the size, radians), or after so many steps. Below
# the third number the Jacobian has hardly changed and is used once more.
PROJECTED, PROJECTIONS, CHORD = 1e-14, 8, 1e-6
# A freedom with less than this part of the greatest inertia has none: rounding squared.
NO_MASS = 1e-20


class _Bodies(NamedTuple):
    """All masses at once: where their links' coordinates begin, and the mass matrix but for its eccentric terms."""

    at: Number
    mass: Number
    centre: Number
    matrix: Number


@dataclass(eq=False)
class BodyChart:
    """All configurations of a mechanism, by the coordinates of its links: x, y and the angle of each.

    `start` is a motion of one pose, `drivers` are its free drivers, and `laws` prescribe the others; `world` has the
    poses that it starts from. It has the interface of a `DriverChart`, with the coordinates in the place of drivers.
    """

    start: Motion
    drivers: tuple[str, ...]
    laws: Mapping[str, Law]
    world: Mapping[str, Pose]
    held: ClassVar[None] = None
    stop_contacts: tuple[StopContact, ...] = ()  # those at stops and in latches
    closed: tuple[StopContact, ...] = ()
    phase: int = 0
    open_pairs: tuple[Any, ...] = ()  # those that have come apart
    adds_stops: ClassVar[bool] = True

    def __post_init__(self) -> None:
        self.mechanism = self.start.mechanism
        self.order: SolvingOrder = self.start.solving_order
        self.size = self.order.size
        self.names = (*self.drivers, *self.laws)
        self.links = tuple(link for link in self.world if link != FRAME)
        self.free = tuple(f"{link}.{part}" for link in self.links for part in ("x", "y", "angle"))
        self.gravity = complex(first_entry(self.mechanism.free_fall))
        stored, others = (tuple(filter(is_no_contact, loads)) for loads in sorted_loads(self.start))
        self.loads = stored, others
        self.first = np.array([part for link in self.links for part in _coordinates(self.world[link])])
        self.pair_equations = PairEquations(self.start, self.links, self.laws, self.first)
        self.index, self.ends = self.pair_equations.index, self.pair_equations.ends
        self.scales = self.pair_equations.lengths[:-3]
        self.bodies = self._bodies(moving_masses(self.start.structure))
        self.turned = {name: float(np.ravel(one.value)[0]) for name, one in self._angles()}
        self.farthest = self.state(0.0, self.first, np.zeros_like(self.first)).least

    @property
    def longest_moves(self) -> Number:
        """The longest move of each coordinate in a step: a radian, the size."""
        return self.scales

    def _bodies(self, masses: Sequence[MovingMass]) -> _Bodies:
        at = np.array([3 * self.index[own.link] for own in masses], dtype=int)
        mass, centre = np.array([own.mass for own in masses]), np.array([own.centre for own in masses])
        matrix = np.zeros((len(self.first), len(self.first)))
        matrix[at, at] = matrix[at + 1, at + 1] = mass
        matrix[at + 2, at + 2] = [own.inertia for own in masses] + mass * np.square(np.abs(centre))
        return _Bodies(at, mass, centre, matrix)

    def _angles(self) -> Iterable[tuple[str, Any]]:
        return ((pair.name, self.start.pairs[pair.name]) for pair in self.start.structure.pairs
                if pair.free_is_angle and pair.name in self.order.pairs)  # fmt: skip

    def state(self, time: float, values: Number, speeds: Number) -> BodyState:
        """Return the state at the coordinates of all links and their rates."""
        return BodyState(self, time, values, speeds)

    def seen(self, time: float, values: Number, speeds: Number) -> BodyState:
        """Return a state as contacts see it."""
        return self.state(time, values, speeds)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state."""
        return self._projected(time, values, speeds).rates

    free_rates = rates

    def _projected(self, time: float, values: Number, speeds: Number) -> BodyState:
        """Return a state, next to a change point the projected one: what is open there would be enlarged."""
        here = self.state(time, values, speeds)
        if here.is_near_change_point:
            n = len(values)
            projected = self.settled(time, np.concatenate([values, speeds, [0.0]]))
            here = self.state(time, projected[:n], projected[n : 2 * n])
        return here

    def followed_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state, with the contacts at stops and in latches."""
        here = self._projected(time, values, speeds)
        return rates_under(self.closed, here, here.rates) if self.closed else here.rates

    def unheld_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state without the rigid contacts."""
        here = self._projected(time, values, speeds)
        return sprung(self.closed, here, here.rates) if self.closed else here.rates

    pressing_rates = unheld_rates

    def pressing(self, name: str, time: float, values: Number, speeds: Number) -> float | None:
        """Return the force that presses a contact with a profile, by the forces that the equations of pairs have.

        None with gears and belts, whose equations do not tell where teeth and strands are.
        """
        held = list[tuple[str, int, float]]()
        for one in self.pair_equations.others:
            contact = as_profile_contact(one.pair)
            if as_transmitting_pair(one.pair) is not None:
                return None
            if contact is not None and not contact.has_ends:
                held.append((one.pair.name, self.pair_equations.rows[one.pair.name].start, float(one.scales[0])))
        names, rows, scales = zip(*held, strict=True)
        here = self._projected(time, values, speeds)
        forces, states = here.pair_forces(), here.self_stress
        at, sizes = list(rows), np.array(scales)
        return spare_force(names.index(name), forces[at] / sizes, states[at].T / sizes)

    @property
    def rigid(self) -> tuple[StopContact, ...]:
        """The closed contacts that hold a coordinate."""
        return tuple(one for one in self.closed if not one.stop.is_elastic)

    def accelerations_at(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the accelerations of all coordinates at a state of the solution."""
        return self.followed_rates(time, values, speeds).accelerations

    def begin(self, time: float, values: Number, speeds: Number) -> bool:
        """Start from a state; it moves."""
        return True

    def released(self, time: float, values: Number, until: float) -> float:
        """Return the end: nothing holds it."""
        return until

    def is_regular(self, values: Number) -> bool:
        """Return that no coordinate is better."""
        return True

    @property
    def memory(self) -> tuple[Any, ...]:
        """The contacts at stops: else a state says where everything is."""
        return ((self.held, self.closed),)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Restore the contacts at stops."""
        _, self.closed = memory[0]

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Note how far from a change point it has been."""
        self.farthest = max(self.farthest, self.state(time, values, speeds).least)

    def settled(self, time: float, state: Number) -> Number:
        """Return a state with coordinates and rates projected on the equations of the pairs."""
        n, found = len(self.free), state.copy()
        here = self.state(time, found[:n], found[n : 2 * n])
        inverse, is_near = here.inverse, here.is_near_change_point
        for _ in range(PROJECTIONS):
            moved = inverse @ here.equations.open
            found[:n] -= self.scales * moved
            here = self.state(time, found[:n], found[n : 2 * n])
            largest = float(np.max(np.abs(moved), initial=0.0))
            if largest <= PROJECTED:
                break
            if largest > CHORD or is_near:
                inverse = here.inverse
        jacobian, rates = here.equations.jacobian, here.equations.rates
        for _ in range(2):
            found[n : 2 * n] -= self.scales * (inverse @ (jacobian @ (found[n : 2 * n] / self.scales) - rates))
        return found

    def digits_lost(self, time: float, state: Number) -> float:
        """Return the relative rounding error of accelerations: digits are lost twice next to change points."""
        n = len(self.free)
        return float(np.finfo(float).eps) / self.state(time, state[:n], state[n : 2 * n]).least ** 2

    def courses(self, times: Number, states: Number, accelerations: Number) -> dict[str, tuple[Number, ...]]:
        """Return value, speed and acceleration of the free drivers at states in columns."""
        n, found = len(self.free), dict[str, tuple[Number, ...]]()
        poses = self.poses(states, accelerations)
        for name in self.drivers:
            own = self.start.structure.driven[name]
            sense = float(own.pair.driven_by(own.drive.link))
            ends = self.pair_equations.ends_of(own.pair)
            series = own.pair.coordinate(ends, tuple(poses[link] for link in own.pair.members))
            rows = [np.broadcast_to(np.ravel(series.derivative(k)), times.shape) * sense for k in range(3)]
            if own.pair.free_is_angle:
                begun = float(np.ravel(self.start.drives[name].value)[0])
                rows[0] = rows[0] + whole_turns(begun + sense * self._turning(own.pair, states[:n]) - rows[0])
            found[name] = rows[0], rows[1], rows[2]
        return found

    def poses(self, states: Number, accelerations: Number) -> dict[str, Pose]:
        """Return the poses of all links at states in columns, as a row."""
        n, found = len(self.free), {FRAME: FIXED}
        x, v = states[:n], states[n : 2 * n]
        for link, k in self.index.items():
            if link != FRAME:
                found[link] = _pose(*(part[3 * k : 3 * k + 3][:, None, :] for part in (x, v, accelerations)))
        return found

    def _turning(self, pair: Pair, values: Number) -> Number:
        """Return by which angle a pair has turned since the start."""
        first, second = (self._angle_since(link, values) for link in pair.members[:2])
        return second - first

    def _angle_since(self, link: str, values: Number) -> Number:
        k = self.index[link]
        return np.zeros(values.shape[1:]) if link == FRAME else values[3 * k + 2] - self.first[3 * k + 2]

    def turns_of(self, pair: str, angle: float, values: Number) -> float:
        """Return an angle of a pair with its full turns."""
        for name, own in self.start.structure.driven.items():
            if own.pair.name == pair:
                begun = float(np.ravel(self.start.drives[name].value)[0]) * own.pair.driven_by(own.drive.link)
                break
        else:
            if pair not in self.turned:
                self.turned[pair] = first_angle(self.start, pair)
            begun, own = self.turned[pair], None
        meant = pair_named(self.start, pair) if own is None else own.pair
        return angle + float(whole_turns(begun + self._turning(meant, values) - angle))


@dataclass(frozen=True, eq=False)
class _LoadedBodies(LoadedState):
    """A state by the coordinates of all links as loads see it. `slopes` are a pair's rates by them."""

    slopes: Callable[[Pair], Number] | None = None

    def rates_of(self, name: str) -> tuple[Number, float]:
        """Return the rates of a coordinate by those of all links, and its acceleration at none of theirs."""
        assert self.columns is not None
        assert self.slopes is not None
        pair, sign = self._meant(name)
        moved = pair.coordinate(self._ends(pair), tuple(self.columns[link] for link in pair.members))
        return sign * self.slopes(pair), sign * 2.0 * coefficient(moved, 2)


@dataclass(frozen=True, eq=False)
class BodyState:
    """A pose of all links with their velocities, and its equation of motion."""

    chart: BodyChart
    time: float
    values: Number
    speeds: Number

    @cached_property
    def world(self) -> dict[str, Pose]:
        """The poses of all links, with their rates."""
        return link_poses(self.chart.links, self.values, self.speeds)

    @cached_property
    def equations(self) -> Equations:
        """The equations of all pairs."""
        return self.chart.pair_equations.at(self.time, self.values, self.speeds, self.world)

    @cached_property
    def _parts(self) -> tuple[Number, Number, float, Number]:
        """The pseudoinverse of the Jacobian, its null spaces, and its least singular value as a part of the greatest.

        The second null space is that of the forces which balance each other.
        """
        u, s, v = np.linalg.svd(self.equations.jacobian)
        rank = int(np.count_nonzero(s > RANK * s[0])) if len(s) else 0
        least = float(s[rank - 1] / s[0]) if rank else 1.0
        return (v[:rank].T / s[:rank]) @ u[:, :rank].T, v[rank:].T, least, u[:, rank:]

    @property
    def inverse(self) -> Number:
        """The pseudoinverse of the Jacobian."""
        return self._parts[0]

    @property
    def self_stress(self) -> Number:
        """The states of self-stress: forces in the equations that balance each other, in columns."""
        return self._parts[3]

    def pair_forces(self) -> Number:
        """Return the forces in the equations, the least ones where several balance the same."""
        found: Number = self.inverse.T @ (self.chart.scales * self.constraint)
        return found

    @property
    def constraint(self) -> Number:
        """The forces in the pairs along all coordinates, with the contacts at stops and in latches."""
        free = sprung(self.chart.closed, self, self.rates)
        found = rates_under(self.chart.closed, self, self.rates)
        given = self.forces[0] + self.forces[1]
        for one in self.chart.closed:
            if one.stop.is_elastic:
                given = given + one.at(self).normal * one.push(self)
        if rigid := [one.at(self) for one in self.chart.rigid]:
            given = given + holding(rigid, self, free) @ np.array([one.normal for one in rigid])
        whole: Number = self.terms.matrix @ found.accelerations + self.terms.bias - given
        return whole

    @property
    def least(self) -> float:
        """The least singular value of the Jacobian as a part of the greatest: small next to change points."""
        return self._parts[2]

    @property
    def is_near_change_point(self) -> bool:
        """Whether some equations are nearly the others' sum."""
        return self.least < max(NEAR * self.chart.farthest, NEAR_AT_ALL)

    @cached_property
    def block(self) -> Block:
        """The poses as a block."""
        return Block((1, 1), self.chart.ends, self.world, {}, 1)

    @cached_property
    def loaded(self) -> LoadedState:
        """The state as loads see it."""
        flat = {name: pose.trimmed(1) for name, pose in self.world.items()}
        block = Block((1, 1), self.chart.ends, flat, {}, 1)
        return _LoadedBodies(self.chart.start, block, ONLY, ONLY, columns=self.world, seconds=self.time,
                             count=len(self.values), turns=self._turned, slopes=self.slopes)  # fmt: skip

    def _turned(self, pair: str, angle: float) -> float:
        return self.chart.turns_of(pair, angle, self.values)

    @property
    def prescribed(self) -> Number:
        """Nothing: prescribed drivers are among what holds the links."""
        return np.empty(0)

    @cached_property
    def terms(self) -> InertiaTerms:
        """The mass matrix, the centrifugal terms and the weights, by the coordinates of the links."""
        chart = self.chart
        bodies, g = chart.bodies, chart.gravity
        matrix, bias, weight = bodies.matrix.copy(), np.zeros(len(self.values)), np.zeros(len(self.values))
        at = bodies.at
        c = bodies.mass * bodies.centre * np.exp(1j * self.values[at + 2])
        inward = np.square(self.speeds[at + 2]) * c
        matrix[at, at + 2] = matrix[at + 2, at] = -c.imag
        matrix[at + 1, at + 2] = matrix[at + 2, at + 1] = c.real
        bias[at], bias[at + 1] = -inward.real, -inward.imag
        weight[at], weight[at + 1] = bodies.mass * g.real, bodies.mass * g.imag
        weight[at + 2] = c.real * g.imag - c.imag * g.real
        return InertiaTerms(matrix, bias, weight)

    @cached_property
    def forces(self) -> tuple[Number, Number]:
        """The forces along all coordinates: those with a potential, and the others."""
        stored, others = (self._along(loads) for loads in self.chart.loads)
        if motors := rotors_that_lose(self.chart.loads[1]):
            dry = self._accelerated(self.terms.weight + stored + others)
            others = others + rotor_forces(self.loaded, motors, dry, self.response)
        return self.terms.weight + stored, others

    def _along(self, loads: Iterable[Load]) -> Number:
        total = np.zeros(len(self.values) + 3)
        for load in loads:
            for link, wrench in load.wrenches(self.loaded):
                free, at = self.loaded.freed(link, wrench), 3 * self.chart.index[link]
                force = complex(plain_number(free.force))
                total[at : at + 3] += force.real, force.imag, float(plain_number(free.about(self.world[link].z.c[0])))
        return total[:-3]

    def response(self, along: Number) -> Number:
        """Return the accelerations by a force along all coordinates alone."""
        scales, null = self.chart.scales, self._parts[1]
        inertia = null.T @ (scales[:, None] * self.terms.matrix * scales) @ null
        sizes, ways = np.linalg.eigh(inertia)
        push = ways.T @ (null.T @ (scales * along))
        moved = np.where(sizes > NO_MASS * sizes[-1:], push / sizes, 0.0)
        found: Number = scales * (null @ (ways @ moved))
        return found

    @cached_property
    def accelerations(self) -> Number:
        """The accelerations of all coordinates."""
        return self._accelerated(self.forces[0] + self.forces[1])

    def _accelerated(self, push: Number) -> Number:
        terms = self.terms
        led = self.chart.scales * (self.inverse @ self.equations.second)
        found: Number = led + self.response(push - terms.bias - terms.matrix @ led)
        return found

    @property
    def rates(self) -> Rates:
        """The rates of the state."""
        given = 0.0
        if self.chart.laws:
            terms, push = self.terms, self.forces[0] + self.forces[1]
            given = float(self.speeds @ (terms.matrix @ self.accelerations + terms.bias - push))
        return Rates(self.accelerations, float(self.forces[1] @ self.speeds) + given)

    @property
    def kinetic(self) -> float:
        """The kinetic energy."""
        return float(self.speeds @ self.terms.matrix @ self.speeds) / 2.0

    def slopes(self, pair: Pair) -> Number:
        """Return the rates of a pair's coordinate by all coordinates."""
        equations, poses = self.chart.pair_equations, tuple(self.world[link] for link in pair.members)
        columns, found = equations.columns(pair), np.zeros(len(self.values) + 3)
        found[columns] = np.reshape(pair.jacobian(equations.ends_of(pair), poses), (-1, len(columns)))[-1]
        return found[:-3]

    @cached_property
    def motion(self) -> Motion:
        """The state as a motion of one pose, with velocities and accelerations."""
        return self.moved(self.accelerations)

    def moved(self, accelerations: Number) -> Motion:
        """Return the state as such a motion with other accelerations."""
        chart, start = self.chart, self.chart.start
        column = np.concatenate([self.values, self.speeds])[:, None]
        second = accelerations[:, None]
        drives: dict[str, tuple[Number, ...]] = {
            name: tuple(part[None] for part in course)
            for name, course in chart.courses(np.zeros(1), column, second).items()
        }
        for name, law in chart.laws.items():
            drives[name] = tuple(np.array([[part]]) for part in prescribed_rates(law, self.time))
        inputs = replace(start.inputs.driven(drives), shape=(1,))
        return replace(start, order=2, inputs=inputs, poses=chart.poses(column, second),
                       failed=np.zeros((1, 1), dtype=int), time=np.full(1, self.time))  # fmt: skip


def _coordinates(pose: Pose) -> tuple[float, float, float]:
    z = complex(plain_number(pose.z.c[0]))
    return z.real, z.imag, float(plain_number(pose.angle.c[0]))


def _pose(x: Number, v: Number, a: Number) -> Pose:
    """Return a pose by its coordinates, their rates and accelerations."""
    u = np.exp(1j * x[2])
    second = (1j * a[2] - np.square(v[2])) * u / 2.0
    z = Series((x[0] + 1j * x[1], v[0] + 1j * v[1], (a[0] + 1j * a[1]) / 2.0))
    return Pose(z, Series((u, 1j * v[2] * u, second)), Series((x[2], v[2], a[2] / 2.0)))
