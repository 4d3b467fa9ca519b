"""Coulomb friction in the coordinates of all links: any number of drivers, gears and belts, stops and latches.

What the pairs' equations push determines the normal forces, which are affine in the frictions. A contact slides in a
sense, or sticks: then it holds its two links like a pair, as long as the force for that is below the limit of friction.
Where contacts come to rest at the same time, each force is the one of Gauss's principle of least constraint within the
limits of friction, which are those under these forces.

Source: F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapters 5 and 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_friction import (
    SUM_ROUNDING,
    TINY,
    FrictionInfluence,
    NormalForceComponents,
    NotUniqueMotion,
    PoseInfluence,
    regular_solution,
)
from compoundkin.dynamics.friction.friction_contacts import (
    LoadedContact,
    friction_contacts_of,
    undetermined_friction,
)
from compoundkin.dynamics.simulation.body_chart import NO_MASS, BodyChart, BodyState
from compoundkin.dynamics.simulation.driver_state import Rates, needs_time
from compoundkin.dynamics.simulation.friction_table import RELEASE_SAMPLES, released_between
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.attachments import Effort
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import TransmittingPair, as_transmitting_pair

# A contact is at rest where it slides slower than this part of the fastest link up to now: event times are that good.
AT_REST = 1e-9
# A contact slips where its force exceeds the limit by this part: at the limit rounding does not decide.
EXCEEDS = 1e-10
# What is within this part of a change of friction may change within a step.
NEARLY = 0.01
# A change is met where the margin is below this: that of an event is zero but for rounding.
MET = 1e-11
# Limits of friction and forces within them are computed in turn so often, until they change by less than this part.
TURNS, SETTLED = 200, 1e-13
# A contact at rest accelerates where it does so by more than this part of what adds up to its acceleration.
ACCELERATES = 1e-11
# Equations of contacts at rest that say this part of the others' say nothing new.
RANK = 1e-9
# Derivatives of directions are differences over this part of the size, extrapolated once.
STEP = 1e-3
# Modes that change so often at one time never settle.
MOST_CHANGES = 40
# Flanks of teeth are those of the solution after so many tries at most.
FLANKS = 4
# Forces that equilibrium leaves open have more than this part of a state of self-stress.
UNDETERMINED = 1e-6


class _ContactRows(NamedTuple):
    """The rows of a contact's pair among the equations, the link whose columns tell its wrench, and the sense."""

    rows: slice
    link: int
    sense: float


class ContactModes(NamedTuple):
    """How contacts move: the senses in which they slide, 0 where they stick; the signs by which normal forces count.

    `blocked` are those whose sliding rigid stops prevent, so that friction has nothing to hold. `sides` has an entry
    for each normal force of all contacts, zero for those that are vectors.
    """

    senses: Number
    blocked: Number
    sides: Number | None = None

    @property
    def stuck(self) -> Number:
        """Which contacts hold their two links."""
        found: Number = (self.senses == 0.0) & ~self.blocked
        return found


class FrictionSolution(NamedTuple):
    """The accelerations of all coordinates, the frictions and their limits, and the forces at rigid stops.

    `components` are those of the normal forces, `constraint` the forces in the pairs along all coordinates.
    """

    accelerations: Number
    sizes: Number
    limits: Number
    stops: Number
    components: Number
    constraint: Number


class _GearedPair(NamedTuple):
    """A gear or belt at a pose: what accompanies a unit transmitted backward, none, and one forward."""

    pair: TransmittingPair
    place: _ContactRows
    ends: Any
    poses: Any
    beside: tuple[Wrench, ...]


class _AffineMotion(NamedTuple):
    """Coordinates in which the mass matrix is unity, as affine functions of frictions: columns are none, each alone."""

    motion: Number  # (freedoms, 1 + frictions)
    holds: Number  # the forces of what is held (held, 1 + frictions)
    constraint: Number  # along all coordinates (coordinates, 1 + frictions)
    pressed: Number  # in the equations (equations, 1 + frictions)
    transmitted: Number  # by gears and belts (gears, 1 + frictions)


@dataclass(eq=False)
class FrictionChart(BodyChart):
    """The chart of all links of a mechanism whose pairs have friction."""

    modes: ContactModes = field(init=False)
    has_left: bool = field(init=False, default=False)
    told: list[tuple[str, str]] = field(init=False, default_factory=list)
    parts: dict[tuple[bool, ...], tuple[Number, NormalForceComponents]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        first = super().state(0.0, self.first, np.zeros_like(self.first)).loaded
        found = friction_contacts_of(self.start)
        self.contacts = tuple(one for one in found if float(np.ravel(first.fitted(one.friction.factor))[0]) != 0.0)
        count = len(self.contacts)
        self.modes = ContactModes(np.zeros(count), np.zeros(count, dtype=bool))
        self.pace, self.fastest, self.changes = np.zeros(count), 0.0, (-np.inf, 0)
        self.begun = False
        self._row_of = self._rows()
        geared = (as_transmitting_pair(one.pair) for one in self.pairs)
        self.geared = tuple((pair, self._row_of[pair.name]) for pair in geared if pair is not None)
        self.places = tuple(self._place(one) for one in self.contacts)
        self._lay_out()
        self._check_determined()

    def _rows(self) -> dict[str, slice]:
        """Return the rows of each pair among the equations."""
        structure = self.start.structure
        pins = [pair for pair in structure.pairs if pair.is_simple and pair.free_is_angle]
        slides = [pair for pair in structure.pairs if pair.is_simple and not pair.free_is_angle]
        found = {pair.name: slice(2 * k, 2 * k + 2) for k, pair in enumerate(pins)}
        first, n = 2 * len(pins), len(slides)
        found |= {pair.name: slice(first + k, first + n + k + 1, n) for k, pair in enumerate(slides)}
        ends = np.cumsum([first + 2 * n, *(len(one.scales) for one in self.pairs)]).tolist()
        found |= {one.pair.name: slice(*rows) for one, rows in zip(self.pairs, pairwise(ends), strict=True)}
        return found

    def _place(self, contact: LoadedContact) -> _ContactRows:
        first, second = contact.pair.members[:2]
        if contact.name not in self._row_of:
            what = f"the forces between the links at {contact.name} are not known in the coordinates of all links"
            raise InvalidInput(Problem(f"frictions.{contact.friction.pair}", what, "leave this friction out"))
        sense = 1.0 if second != FRAME else -1.0
        return _ContactRows(self._row_of[contact.name], 3 * self.index[second if second != FRAME else first], sense)

    def _lay_out(self) -> None:
        """Find which normal forces belong to each contact, and which of them are vectors."""
        loaded = super().state(0.0, self.first, np.zeros_like(self.first)).loaded
        each = [one.normal_forces(loaded, Wrench(1.0 + 0j, 1.0)) for one in self.contacts]
        owners = [k for k, some in enumerate(each) for _ in some]
        flat = [one for some in each for one in some]
        self.layout = NormalForceComponents(owners, [k for k, one in enumerate(flat) if np.iscomplexobj(one)])
        # friction of a pin is a couple, and what presses in it is the force of its equations
        is_pin = [one.pair.is_simple and one.pair.free_is_angle for one in self.contacts]
        rows = FrictionState(self, 0.0, self.first, np.zeros_like(self.first)).rows_along(range(len(self.contacts)))
        self.couples = np.where(np.array(is_pin)[:, None], rows, 0.0)
        self.pin_forces = np.array([k for k, own in enumerate(owners) if is_pin[own]], dtype=int)
        self.pin_rows = np.array([self.places[own].rows.start for own in owners if is_pin[own]], dtype=int)
        self.others = [k for k, pin in enumerate(is_pin) if not pin]
        self.other_forces = np.array([k for k, own in enumerate(owners) if not is_pin[own]], dtype=int)

    def sliding_part(self, slides: Number) -> tuple[Number, NormalForceComponents]:
        """Return the normal forces of the contacts that slide, and their components."""
        key = tuple(slides.tolist())
        if key not in self.parts:
            own = np.flatnonzero(slides[self.layout.owners])
            vectors = np.flatnonzero(np.isin(own, self.layout.vectors)).tolist()
            owners = (np.cumsum(slides) - 1)[self.layout.owners[own]].tolist()
            self.parts[key] = own, NormalForceComponents(owners, vectors)
        return self.parts[key]

    def _check_determined(self) -> None:
        """Raise InvalidInput where equilibrium does not determine the normal force of a friction."""
        here = self.state(0.0, self.first, np.zeros_like(self.first))
        equations = here.pair_columns
        _, s, v = np.linalg.svd(equations)
        free = v[np.count_nonzero(s > RANK * s[0]) :]
        for contact, place in zip(self.contacts, self.places, strict=True):
            if free.size and np.max(np.abs(free[:, place.rows])) > UNDETERMINED:
                raise undetermined_friction(contact)

    def state(self, time: float, values: Number, speeds: Number) -> FrictionState:
        """Return the state at the coordinates of all links and their rates."""
        return FrictionState(self, time, values, speeds)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state, with contacts at stops and in latches."""
        here = self._projected(time, values, speeds)
        assert isinstance(here, FrictionState)
        if self._rests(here):
            return Rates(np.zeros_like(values), 0.0)
        if here.margin < NEARLY:
            self.has_left = True
        return here.rates

    def _rests(self, here: FrictionState) -> bool:
        """Whether friction holds everything."""
        return not self.laws and not self.modes.senses.any() and here.freedoms == 0

    free_rates = followed_rates = rates

    def unheld_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state with the forces of rigid contacts taken away, and their frictions kept."""
        return self._without_stops(self.state(time, values, speeds), False)

    def pressing_rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return these rates, where friction holds what rigid contacts block as well as it can."""
        here = self.state(time, values, speeds)
        if np.any(self.modes.stuck & ~here.at_rest):
            # behind an impact
            self.begin(time, values, speeds)
            here = self.state(time, values, speeds)
        return self._without_stops(here, True)

    def _without_stops(self, here: FrictionState, with_friction: bool) -> Rates:
        found = here.rates
        if not self.rigid:
            return found
        normals = np.array([one.at(here).normal for one in self.rigid])
        forces = here.solution.stops + (here.more_at_stops(normals) if with_friction else 0.0)
        return Rates(found.accelerations - here.response(forces @ normals), found.power)

    def begin(self, time: float, values: Number, speeds: Number) -> bool:
        """Find which contacts stick; return whether anything moves."""
        here = self.state(time, values, speeds)
        before = self.modes
        self._note(here)
        changes = self.changes[1] + 1 if time <= self.changes[0] else 1
        self.changes = max(time, self.changes[0]), changes
        if changes > MOST_CHANGES:
            raise NotUniqueMotion(time)
        at_rest, turned = here.at_rest, None
        leaving = np.zeros(len(self.contacts))
        if self.begun:
            leaving, turned = here.leaving
            leaving = np.where(at_rest, leaving, 0.0)
        resting = at_rest & (leaving == 0.0)
        senses = np.where(resting, 0.0, np.where(leaving != 0.0, leaving, np.sign(here.sliding)))
        self.modes = ContactModes(senses, np.zeros(len(senses), dtype=bool))
        if resting.any():
            self.modes = here.again.modes_at_rest(resting)
        self.modes = self.modes._replace(sides=here.again.sides(turned))
        moves = bool(self.laws) or here.again.freedoms > 0
        if self.begun and moves:
            self._tell(before)
        self.begun = True
        return moves

    def _tell(self, before: ContactModes) -> None:
        """Note which contacts stick from now on, or slide."""
        changes = zip(self.contacts, before.stuck.tolist(), self.modes.stuck.tolist(), self.modes.blocked, strict=True)
        for contact, was, now, blocked in changes:
            if now and not was:
                self.told.append(("sticks", f"friction holds {contact.name}"))
            elif was and not now and not blocked:
                self.told.append(("slips", f"friction no longer holds {contact.name}"))

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Note how far from a change point it has been, and how fast contacts have slid."""
        super().accept(time, values, speeds)
        self._note(self.state(time, values, speeds))
        self.has_left = False

    def _note(self, here: FrictionState) -> None:
        self.pace = np.maximum(self.pace, np.abs(here.sliding))
        self.fastest = max(self.fastest, float(np.max(np.abs(here.speeds) / self.scales)))

    def settled(self, time: float, state: Number) -> Number:
        """Return a state projected on the equations of the pairs, with contacts that stick at rest."""
        found = super().settled(time, state)
        if not self.begun:  # which contacts stick is not known yet
            return found
        n = len(self.free)
        here = self.state(time, found[:n], found[n : 2 * n])
        stuck = self.modes.stuck
        if stuck.any():
            rows = here.along[stuck]
            moved = np.linalg.pinv(rows @ here.free_motion, rcond=RANK) @ (rows @ here.speeds)
            found[n : 2 * n] -= here.free_motion @ moved
        if self._rests(here):
            # exactly, so that it is known to rest
            found[n : 2 * n] = 0.0
        return found

    def margin_at(self, time: float, state: Number) -> float:
        """Return how far it is until friction changes, negative beyond."""
        n = len(self.free)
        return self.state(time, state[:n], state[n : 2 * n]).margin

    def friction_powers(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the powers of all frictions, never positive."""
        here = self.state(time, values, speeds)
        found: Number = np.where(self.modes.senses != 0.0, here.solution.sizes * here.sliding, 0.0)
        return found

    def sticking(self, time: float, state: Number) -> list[tuple[LoadedContact, float]]:
        """Return the contacts that stick, with the efforts along their coordinates that hold them."""
        n = len(self.free)
        here = self.state(time, state[:n], state[n : 2 * n])
        held = zip(self.contacts, here.solution.sizes.tolist(), self.modes.stuck.tolist(), strict=True)
        return [(one, size * here.effort_of(one)) for one, size, stuck in held
                if stuck and Effort.title in one.pair.takes]  # fmt: skip

    def released(self, time: float, values: Number, until: float) -> float:
        """Return the time at which loads overcome friction at rest, at the latest the end."""
        if not any(needs_time(self.start, load) for loads in self.loads for load in loads):
            return until
        still = np.zeros_like(values)

        def push(at: float) -> Number:
            here = self.state(at, values, still)
            return here.pushed

        def moves(at: float) -> bool:
            resting = np.ones(len(self.contacts), dtype=bool)
            return bool(self.state(at, values, still).modes_at_rest(resting).senses.any())

        first, early = push(time), time
        for late in np.linspace(time, until, RELEASE_SAMPLES + 1)[1:].tolist():
            if np.any(push(late) != first) and moves(late):
                break
            early = late
        else:
            return until
        found = released_between(moves, early, late, until)
        self.begun = False
        return found

    @property
    def memory(self) -> tuple[Any, ...]:
        """The contacts at stops, and how those with friction move."""
        return (*super().memory, self.modes)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Restore them."""
        super().recall(memory)
        self.modes = memory[1]


@dataclass(frozen=True, eq=False)
class FrictionState(BodyState):
    """A pose of all links with their velocities, and its motion under friction by the chart's modes."""

    chart: FrictionChart

    @property
    def again(self) -> FrictionState:
        """The same state by the chart's present modes."""
        return FrictionState(self.chart, self.time, self.values, self.speeds)

    @cached_property
    def along(self) -> Number:
        """The rate of each contact's sliding by all coordinates, times its coefficient of friction."""
        found = self.chart.couples.copy()
        found[self.chart.others] = self.rows_along(self.chart.others)
        return found

    def rows_along(self, which: Sequence[int]) -> Number:
        """Return the rates of the sliding of some contacts."""
        found = np.zeros((len(which), len(self.values) + 3))
        for row, k in zip(found, which, strict=True):
            contact = self.chart.contacts[k]
            unit = contact.unit(self.loaded)
            for link, sense in zip(contact.pair.rubbing, (-1.0, 1.0), strict=True):
                row[3 * self.chart.index[link] : 3 * self.chart.index[link] + 3] += sense * self._parts_of(unit, link)
        return found[:, :-3]

    def _parts_of(self, wrench: Wrench, link: str) -> Number:
        """Return the force of a wrench along a link's coordinates."""
        force = complex(np.ravel(wrench.force)[0])
        turning = wrench.about(self.world[link].z.c[0])
        return np.array([force.real, force.imag, float(np.real(np.ravel(turning)[0]))])

    @cached_property
    def sliding(self) -> Number:
        """The rates at which contacts slide, times their coefficients."""
        found: Number = self.along @ self.speeds
        return found

    @property
    def at_rest(self) -> Number:
        """Which contacts do not slide."""
        found: Number = np.abs(self.sliding) <= AT_REST * self.chart.fastest * (np.abs(self.along) @ self.chart.scales)
        return found

    @cached_property
    def pair_columns(self) -> Number:
        """The forces along all scaled coordinates by the unit forces in the equations.

        Those of gears and belts are where teeth and strands are, which their equations do not tell.
        """
        found = self.equations.jacobian.T.copy()
        for pair, rows in self.chart.geared:
            ends, poses = self.chart.ends_of(pair), tuple(self.world[link] for link in pair.members)
            columns = np.zeros((len(self.values) + 3, rows.stop - rows.start))
            for column, unit in zip(columns.T, pair.wrenches(ends, poses)[: rows.stop - rows.start], strict=True):
                self._add(column, pair, unit)
            found[:, rows] = columns[:-3] * self.chart.scales[:, None]
        return found

    def _add(self, row: Number, pair: Pair, wrench: Wrench) -> None:
        """Add a wrench on a pair's second member to forces along all coordinates and the frame's."""
        for link, sense in zip(pair.members[:2], (-1.0, 1.0), strict=True):
            at = 3 * self.chart.index[link]
            row[at : at + 3] += sense * self._parts_of(wrench, link)

    def effort_of(self, contact: LoadedContact) -> float:
        """Return the effort of a contact's friction for a unit normal force."""
        unit = contact.unit(self.loaded)
        return float(np.ravel(unit.moment if contact.pair.is_couple else np.abs(unit.force))[0])

    @cached_property
    def _to_pairs(self) -> Number:
        """The forces in the equations by the forces along all scaled coordinates that they balance."""
        if not self.chart.geared:
            return self.inverse.T
        return np.linalg.pinv(self.pair_columns, rcond=RANK)

    @cached_property
    def free_motion(self) -> Number:
        """The freedoms, by all coordinates: the mass matrix of them is unity."""
        scales, null = self.chart.scales, self._parts[1]
        sizes, ways = np.linalg.eigh(null.T @ (scales[:, None] * self.terms.matrix * scales) @ null)
        keep = sizes > NO_MASS * sizes[-1:]
        found: Number = scales[:, None] * (null @ (ways[:, keep] / np.sqrt(sizes[keep])))
        return found

    @cached_property
    def _led(self) -> Number:
        """The accelerations that the equations ask for."""
        found: Number = self.chart.scales * (self.inverse @ self.equations.second)
        return found

    @cached_property
    def pushed(self) -> Number:
        """The forces of weights, loads and elastic contacts along all coordinates."""
        found = self.forces[0] + self.forces[1]
        for one in self.chart.closed:
            if one.stop.is_elastic:
                found = found + one.at(self).normal * one.push(self)
        return found

    def _held(self, stuck: Number) -> tuple[Number, Number]:
        """Return the rows by which contacts that stick and rigid stops hold, and their accelerations otherwise."""
        stops = [one.at(self) for one in self.chart.rigid]
        rows = np.array([*self.along[stuck], *(one.normal for one in stops)]).reshape(-1, len(self.values))
        bias = np.array([*(self._bias(k) for k in np.flatnonzero(stuck).tolist()), *(one.bias for one in stops)])
        return rows, rows @ self._led + bias

    def _bias(self, k: int) -> float:
        """Return the acceleration of a contact's sliding without accelerations of coordinates."""
        pace = float(np.max(np.abs(self.speeds) / self.chart.scales))
        if self.chart.contacts[k].pair.is_couple or pace == 0.0:
            return 0.0

        def over(step: float) -> float:
            ends = [self.chart.state(self.time, self.values + way * step * self.speeds, self.speeds).sliding[k]
                    for way in (-1.0, 1.0)]  # fmt: skip
            return float(ends[1] - ends[0]) / (2.0 * step)

        return (4.0 * over(0.5 * STEP / pace) - over(STEP / pace)) / 3.0

    def _affine(self, stuck: Number, sliding: Number) -> _AffineMotion:
        """Return the motion as an affine function of the frictions of some contacts while others stick."""
        moved, matrix = self.free_motion, self.terms.matrix
        rows, needed = self._held(stuck)
        forces = self.along[sliding].T
        applied = np.column_stack([self.pushed - self.terms.bias - matrix @ self._led, forces])
        free = moved.T @ applied
        held = rows @ moved
        inverse = np.linalg.pinv(held, rcond=RANK) if len(rows) else np.zeros((moved.shape[1], 0))
        asked = held @ free
        asked[:, 0] += needed
        motion, holds = free - inverse @ asked, -inverse.T @ (inverse @ asked)
        constraint = matrix @ (moved @ motion) - applied - rows.T @ holds
        pressed = self._to_pairs @ (self.chart.scales[:, None] * constraint)
        transmitted = [self._transmitted(one, pressed) for one in self._geared]
        return _AffineMotion(motion, holds, constraint, pressed, np.reshape(transmitted, (-1, pressed.shape[1])))

    def _normal_forces(self, pressed: Number, beside: dict[str, Wrench]) -> Number:
        """Return the normal forces (normal forces, columns) by the forces in the equations."""
        chart, others = self.chart, list[Number]()
        found = np.empty((len(chart.layout.owners), pressed.shape[1]), dtype=complex)
        found[chart.pin_forces] = (pressed[chart.pin_rows] + 1j * pressed[chart.pin_rows + 1]) / chart.size
        for k in chart.others:
            contact = chart.contacts[k]
            wrench = self._wrench(pressed, chart.places[k]) + beside.get(contact.name, Wrench())
            others += [np.broadcast_to(one, pressed.shape[1:]) for one in contact.normal_forces(self.loaded, wrench)]
        if others:
            found[chart.other_forces] = others
        return found

    def _wrench(self, pressed: Number, place: _ContactRows) -> Wrench:
        """Return the wrenches on the second member of a pair, by the forces in the equations."""
        own = slice(place.link, place.link + 3)
        by = self.pair_columns[own, place.rows] / self.chart.scales[own, None]
        x, y, turn = place.sense * (by @ pressed[place.rows])
        force = x + 1j * y
        origin = self.values[place.link] + 1j * self.values[place.link + 1]
        return Wrench(force, turn + cross(origin, force))

    @cached_property
    def _geared(self) -> tuple[_GearedPair, ...]:
        """The gears and belts here."""
        return tuple(self._geared_pair(pair, rows) for pair, rows in self.chart.geared)

    def _geared_pair(self, pair: TransmittingPair, rows: slice) -> _GearedPair:
        ends, poses = self.chart.ends_of(pair), tuple(self.world[link].trimmed(0) for link in pair.members)
        written = self.chart.mechanism.pretensions.get(pair.name)
        tension = None if written is None else self.loaded.fitted(written.force, f"pretensions.{pair.name}")
        beside = tuple(pair.accompanying(ends, poses, one, tension) for one in (-1.0, 0.0, 1.0))
        return _GearedPair(pair, _ContactRows(rows, *_told_by(self.chart, pair)), ends, poses, beside)

    def _transmitted(self, geared: _GearedPair, pressed: Number) -> Number:
        return geared.pair.transmitted(geared.ends, geared.poses, self._wrench(pressed, geared.place))

    def _normal(self, affine: _AffineMotion, flanks: Number) -> Number:
        """Return the normal forces (normal forces, 1 + frictions) with what teeth and strands add, by their flanks.

        It grows with what is transmitted toward either flank.
        """
        columns = affine.pressed.shape[1]
        more, beside = np.zeros((columns, len(self.values) + 3)), dict[str, Wrench]()
        for geared, flank, transmitted in zip(self._geared, flanks.tolist(), affine.transmitted, strict=True):
            back, still, ahead = geared.beside
            grown = (ahead if flank > 0.0 else back) - still
            alone = np.eye(columns)[0]
            beside[geared.pair.name] = grown.times(flank * transmitted) + still.times(alone)
            for row, one, size in zip(more, alone.tolist(), (flank * transmitted).tolist(), strict=True):
                self._add(row, geared.pair, grown.times(size) + still.times(one))
        pressed = affine.pressed
        if self._geared:
            pressed = pressed - self._to_pairs @ (self.chart.scales[:, None] * more[:, :-3].T)
        return self._normal_forces(pressed, beside)

    @cached_property
    def _slides(self) -> Number:
        return self.chart.modes.senses != 0.0

    @cached_property
    def freedoms(self) -> int:
        """The number of freedoms that contacts that stick and rigid stops leave."""
        rows, _ = self._held(self.chart.modes.stuck)
        if not len(rows):
            return int(self.free_motion.shape[1])
        return int(self.free_motion.shape[1]) - _rank(rows @ self.free_motion)

    @cached_property
    def solution(self) -> FrictionSolution:
        """The motion under friction. Raises NotUniqueMotion where it is not."""
        slides, senses = self._slides, self.chart.modes.senses
        stuck = self.chart.modes.stuck
        affine = self._affine(stuck, slides)
        sizes, normal = self._sizes(affine, slides, senses)
        with_one = np.array([1.0, *sizes])
        whole, holds, count = np.zeros(len(slides)), affine.holds @ with_one, int(np.count_nonzero(stuck))
        whole[slides], whole[stuck] = sizes, holds[:count]
        limits = np.bincount(self.chart.layout.owners, np.abs(normal), len(slides))
        return FrictionSolution(
            self._led + self.free_motion @ (affine.motion @ with_one),
            whole,
            limits,
            holds[count:],
            self.chart.layout.split(normal),
            affine.constraint @ with_one,
        )

    def _sizes(self, affine: _AffineMotion, slides: Number, senses: Number) -> tuple[Number, Number]:
        """Return the frictions of contacts that slide, and the normal forces of all."""
        flanks = np.sign(affine.transmitted[:, 0])
        for _ in range(FLANKS):
            normal = self._normal(affine, flanks)
            sizes = self._by_coulomb(normal, slides, senses) if slides.any() else np.zeros(0)
            with_one = np.array([1.0, *sizes])
            before, flanks = flanks, np.sign(affine.transmitted @ with_one)
            if np.all(flanks == before):
                break
        return sizes, normal @ with_one

    def _by_coulomb(self, normal: Number, slides: Number, senses: Number) -> Number:
        """Return the frictions of contacts that slide. Raises NotUniqueMotion where they are not."""
        own, part = self.chart.sliding_part(slides)
        sides, signs = self.chart.modes.sides, senses[slides]
        held = None if sides is None else np.concatenate([sides[own], np.zeros(len(part.vectors))])
        frictionless, by = normal[own, 0], normal[own, 1:].T
        here = PoseInfluence(part, part.split(frictionless), part.split(by), signs, held)
        found = here.solution(here.weights)
        if found is not None and found.is_regular:
            return found.sizes
        starts = np.searchsorted(part.owners, np.arange(len(signs)))
        several = regular_solution(FrictionInfluence(frictionless[:, None], by[..., None], starts), signs[:, None], 0)
        if several.sizes is None:
            raise NotUniqueMotion(self.time)
        return several.sizes

    @cached_property
    def accelerations(self) -> Number:
        """The accelerations of all coordinates, with friction."""
        return self.solution.accelerations

    @property
    def constraint(self) -> Number:
        """The forces in the pairs along all coordinates."""
        return self.solution.constraint

    @property
    def rates(self) -> Rates:
        """The rates of the state. The power is that of loads without a potential, of friction and of laws."""
        found = self.solution
        power = float(self.forces[1] @ self.speeds) + float(found.sizes[self._slides] @ self.sliding[self._slides])
        if self.chart.laws:
            power += float(self.speeds @ found.constraint)
        for one in self.chart.closed:
            if one.stop.is_elastic and one.elastic.is_damped:
                power += one.push(self) * one.at(self).rate
        return Rates(found.accelerations, power)

    @cached_property
    def margin(self) -> float:
        """How far it is until friction changes: negative where a contact has passed rest, its limit, or its side."""
        return float(min(np.min(self._margins, initial=1.0), np.min(self._side_margins, initial=1.0)))

    @cached_property
    def _margins(self) -> Number:
        """The margin of each contact: its sliding, or what its limit leaves where it sticks."""
        slides, found = self._slides, np.ones(len(self._slides))
        pace = np.maximum(self.chart.pace, np.abs(self.sliding))
        found[slides] = (self.chart.modes.senses * self.sliding / np.maximum(pace, TINY))[slides]
        stuck = self.chart.modes.stuck
        if stuck.any():
            found[stuck] = np.clip(1.0 + EXCEEDS - self._shares(stuck), -1.0, 1.0)
        return found

    def _shares(self, stuck: Number) -> Number:
        """Return the parts of their limits that contacts that stick need."""
        sizes, limits = self.solution.sizes[stuck], self.solution.limits[stuck]
        unique = np.abs(sizes) / np.maximum(limits, TINY)
        unique[sizes == 0.0] = 0.0
        rows = self.along[stuck] @ self.free_motion
        if np.max(unique, initial=0.0) < 1.0 - NEARLY or _rank(rows) == len(rows):
            return unique
        # others of the forces that hold the same may be less
        return np.full(len(sizes), _least_share(rows, sizes @ rows, limits))

    @cached_property
    def _side_margins(self) -> Number:
        """The normal forces by the signs with which they count, as parts of their limits."""
        sides, layout = self.chart.modes.sides, self.chart.layout
        if sides is None:
            return np.ones(0)
        counted = sides != 0.0
        found = (sides * self.solution.components[: layout.count])[counted]
        limits = self.solution.limits[layout.owners[counted]]
        return found / np.maximum(np.maximum(limits, np.abs(found)), TINY)

    @property
    def leaving(self) -> tuple[Number, Number | None]:
        """The senses in which contacts that stick leave here, and the sides that normal forces change."""
        near = max(MET, self.margin)
        leaves = self.chart.modes.stuck & (self._margins <= near)
        senses = np.where(leaves, -np.sign(self.solution.sizes), 0.0)
        sides = self.chart.modes.sides
        if sides is None:
            return senses, None
        turned = np.zeros(len(sides))
        turned[sides != 0.0] = np.where(self._side_margins > near, 0.0, -sides[sides != 0.0])
        return senses, turned

    def sides(self, turned: Number | None) -> Number:
        """Return the signs by which normal forces count: those that are no vectors, of contacts that slide."""
        layout = self.chart.layout
        found = np.sign(self.solution.components[: layout.count]) * self._slides[layout.owners]
        found[layout.vectors] = 0.0
        return found if turned is None else np.where(turned != 0.0, turned, found)

    def more_at_stops(self, normals: Number) -> Number:
        """Return by how much friction in what rigid stops block could push instead of them."""
        ways, rows = normals @ self.free_motion, self.along[self.chart.modes.blocked] @ self.free_motion
        limits = self.solution.limits[self.chart.modes.blocked]
        sizes = np.maximum(np.sum(np.square(ways), axis=1), TINY)
        found: Number = np.abs(rows @ ways.T / sizes).T @ limits
        return found

    def modes_at_rest(self, resting: Number) -> ContactModes:
        """Return how contacts move, those that are at rest among them.

        Limits and forces within them are computed in turn.
        """
        from scipy.optimize import lsq_linear

        senses = np.where(resting, 0.0, self.chart.modes.senses)
        nothing = np.zeros(len(senses), dtype=bool)
        affine = self._affine(nothing, ~nothing)
        rows = self.along @ self.free_motion
        grown = affine.motion[:, 1:]
        whole = np.linalg.norm(rows, axis=1)
        blocked = resting & (np.linalg.norm(grown, axis=0) <= RANK * whole)
        resting = resting & ~blocked
        gone = (self.along @ self._led)[resting] + np.array([self._bias(k) for k in np.flatnonzero(resting).tolist()])
        sizes = np.zeros(len(senses))
        for _ in range(TURNS):
            before = sizes.copy()
            with_one = np.array([1.0, *sizes])
            normal = self._normal(affine, np.sign(affine.transmitted @ with_one)) @ with_one
            limits = np.bincount(self.chart.layout.owners, np.abs(normal), len(senses))
            sizes[~resting] = (-senses * limits)[~resting]
            known = affine.motion[:, 0] + grown[:, ~resting] @ sizes[~resting]
            if not resting.any():
                break
            ways = grown[:, resting]
            asked = gone + rows[resting] @ known
            apart = np.linalg.lstsq(ways.T, asked, rcond=RANK)[0]
            bound = np.maximum(limits[resting], TINY + SUM_ROUNDING * np.max(limits))
            sizes[resting] = lsq_linear(ways, -apart, (-bound, bound), method="bvls", tol=1e-15).x
            if np.all(np.abs(sizes - before) <= SETTLED * np.max(np.abs(sizes), initial=0.0)):
                break
        if not resting.any():
            return ContactModes(senses, blocked)
        moved = ways.T @ (ways @ sizes[resting] + apart)
        size = np.linalg.norm(ways, axis=0) * (
            np.linalg.norm(known) + np.linalg.norm(apart) + np.linalg.norm(ways @ sizes[resting])
        )
        found = senses.copy()
        found[resting] = np.where(np.abs(moved) > ACCELERATES * size, np.sign(moved), 0.0)
        return ContactModes(found, blocked)


def _rank(rows: Number) -> int:
    sizes = np.linalg.svd(rows, compute_uv=False)
    return int(np.count_nonzero(sizes > RANK * sizes[:1]))


def _least_share(rows: Number, held: Number, limits: Number) -> float:
    """Return the least part of their limits with which forces hold together what several rows repeat."""
    from scipy.optimize import linprog

    k = len(limits)
    weighed = rows * np.maximum(limits, TINY)[:, None]
    scale = float(np.max(np.abs(held), initial=TINY))
    equal = np.column_stack([weighed.T, np.zeros(len(held))]) / scale
    below = np.vstack([np.column_stack([np.eye(k), -np.ones(k)]), np.column_stack([-np.eye(k), -np.ones(k)])])
    cost = np.append(np.zeros(k), 1.0)
    bounds = [(None, None)] * k + [(0.0, None)]
    found = linprog(cost, below, np.zeros(2 * k), equal, held / scale, bounds, method="highs")
    return float(found.fun) if found.status == 0 else 2.0


def _told_by(chart: FrictionChart, pair: Pair) -> tuple[int, float]:
    """Return where the columns of the link begin that tells a pair's wrench, and the sense."""
    first, second = pair.members[:2]
    return (3 * chart.index[second], 1.0) if second != FRAME else (3 * chart.index[first], -1.0)
