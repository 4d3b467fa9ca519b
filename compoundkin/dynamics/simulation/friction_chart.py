"""Coulomb friction in the coordinates of all links: any number of drivers, gears and belts, stops and latches.

What the pairs' equations push determines the normal forces, which are affine in the frictions. A contact slides in a
sense, or sticks: then it holds its two links like a pair, as long as the force for that is below the limit of friction.
Where contacts come to rest at the same time, each force is the one of Gauss's principle of least constraint within the
limits of friction, which are those under these forces.

Source: F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, chapters 5 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
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
)
from compoundkin.dynamics.simulation.affine_friction import RANK, AffineMotion, RubbingChart, RubbingState, rank
from compoundkin.dynamics.simulation.driver_state import Rates, needs_time
from compoundkin.dynamics.simulation.friction_table import RELEASE_SAMPLES, released_between
from compoundkin.model.loads.attachments import Effort

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
# Modes that change so often at one time never settle.
MOST_CHANGES = 40
# Flanks of teeth are those of the solution after so many tries at most.
FLANKS = 4


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


@dataclass(eq=False)
class FrictionChart(RubbingChart):
    """The chart of all links of a mechanism whose pairs have friction."""

    modes: ContactModes = field(init=False)
    has_left: bool = field(init=False, default=False)
    told: list[tuple[str, str]] = field(init=False, default_factory=list)
    parts: dict[tuple[bool, ...], tuple[Number, NormalForceComponents]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.contacts)
        self.modes = ContactModes(np.zeros(count), np.zeros(count, dtype=bool))
        self.pace, self.fastest, self.changes = np.zeros(count), 0.0, (-np.inf, 0)
        self.begun = False

    def sliding_part(self, slides: Number) -> tuple[Number, NormalForceComponents]:
        """Return the normal forces of the contacts that slide, and their components."""
        key = tuple(slides.tolist())
        if key not in self.parts:
            own = np.flatnonzero(slides[self.layout.owners])
            vectors = np.flatnonzero(np.isin(own, self.layout.vectors)).tolist()
            owners = (np.cumsum(slides) - 1)[self.layout.owners[own]].tolist()
            self.parts[key] = own, NormalForceComponents(owners, vectors)
        return self.parts[key]

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
class FrictionState(RubbingState):
    """A pose of all links with their velocities, and its motion under friction by the chart's modes."""

    chart: FrictionChart

    @property
    def again(self) -> FrictionState:
        """The same state by the chart's present modes."""
        return FrictionState(self.chart, self.time, self.values, self.speeds)

    @property
    def at_rest(self) -> Number:
        """Which contacts do not slide."""
        found: Number = np.abs(self.sliding) <= AT_REST * self.chart.fastest * (np.abs(self.along) @ self.chart.scales)
        return found

    @cached_property
    def _slides(self) -> Number:
        return self.chart.modes.senses != 0.0

    @cached_property
    def freedoms(self) -> int:
        """The number of freedoms that contacts that stick and rigid stops leave."""
        rows, _ = self._held(self.chart.modes.stuck)
        if not len(rows):
            return int(self.free_motion.shape[1])
        return int(self.free_motion.shape[1]) - rank(rows @ self.free_motion)

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

    def _sizes(self, affine: AffineMotion, slides: Number, senses: Number) -> tuple[Number, Number]:
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
        if np.max(unique, initial=0.0) < 1.0 - NEARLY or rank(rows) == len(rows):
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
        """Return how contacts move, those that are at rest among them."""
        senses = np.where(resting, 0.0, self.chart.modes.senses)
        nothing = np.zeros(len(senses), dtype=bool)
        affine = self._affine(nothing, ~nothing)
        grown = affine.motion[:, 1:]
        whole = np.linalg.norm(self.along @ self.free_motion, axis=1)
        blocked = resting & (np.linalg.norm(grown, axis=0) <= RANK * whole)
        resting = resting & ~blocked
        if not resting.any():
            return ContactModes(senses, blocked)
        ways = grown[:, resting]
        known, apart, sizes = self._forces_at_rest(affine, senses, resting)
        moved = ways.T @ (ways @ sizes + apart)
        size = np.linalg.norm(ways, axis=0) * (
            np.linalg.norm(known) + np.linalg.norm(apart) + np.linalg.norm(ways @ sizes)
        )
        senses[resting] = np.where(np.abs(moved) > ACCELERATES * size, np.sign(moved), 0.0)
        return ContactModes(senses, blocked)

    def _forces_at_rest(self, affine: AffineMotion, senses: Number, resting: Number) -> tuple[Number, Number, Number]:
        """Return the forces of contacts at rest, within their limits, by Gauss's principle of least constraint.

        Before them come the motion by all else, and the one by which it is short of what they would need to stay.
        Limits and forces within them are computed in turn.
        """
        from scipy.optimize import lsq_linear

        grown = affine.motion[:, 1:]
        ways, rows = grown[:, resting], (self.along @ self.free_motion)[resting]
        gone = (self.along @ self._led)[resting] + np.array([self._bias(k) for k in np.flatnonzero(resting).tolist()])
        sizes = np.zeros(len(senses))
        for _ in range(TURNS):
            before = sizes.copy()
            with_one = np.array([1.0, *sizes])
            normal = self._normal(affine, np.sign(affine.transmitted @ with_one)) @ with_one
            limits = np.bincount(self.chart.layout.owners, np.abs(normal), len(senses))
            sizes[~resting] = (-senses * limits)[~resting]
            known = affine.motion[:, 0] + grown[:, ~resting] @ sizes[~resting]
            apart = np.linalg.lstsq(ways.T, gone + rows @ known, rcond=RANK)[0]
            bound = np.maximum(limits[resting], TINY + SUM_ROUNDING * np.max(limits))
            sizes[resting] = lsq_linear(ways, -apart, (-bound, bound), method="bvls", tol=1e-15).x
            if np.all(np.abs(sizes - before) <= SETTLED * np.max(np.abs(sizes), initial=0.0)):
                break
        return known, apart, sizes[resting]


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
