"""Normal forces over one driver, tabulated like its equation of motion, and the motion under friction by them.

They are affine in the acceleration, in the squared speed and in the frictions at a given pose.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_friction import (
    FrictionInfluence,
    NormalForceComponents,
    PoseInfluence,
    Regular,
    normal_forces_by,
    normal_forces_of,
    regular_solution,
)
from compoundkin.dynamics.friction.friction_contacts import AT_REST, LoadedContact, in_one_row, speed_of_fastest
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.reverse_pass import (
    LeftOut,
    parts_left_out,
    reverse_pass,
    reverse_passes,
    stressed_blocks,
)
from compoundkin.dynamics.reactions.undetermined import spare_force
from compoundkin.dynamics.simulation.drive_table import (
    DRIVE_SCALES,
    POINTS,
    DriveTable,
    TablePiece,
    accurate_pieces,
    drive_terms,
    piece_at,
)
from compoundkin.dynamics.simulation.driver_state import PushedState, unit_motion
from compoundkin.dynamics.simulation.stop_contacts import holding
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.friction import Friction
from compoundkin.model.pairs.contact import as_friction_pair
from compoundkin.model.pairs.profile_contact import as_profile_contact

# Reversals of sliding are looked for at so many places of each piece, and found by so many halvings.
PLACES, HALVINGS = 64, 50
# Frictions are mild where their influences stay below this sum, which is checked at so many places of a piece.
MILD, CHECKED = 0.8, 16
# At the start of a course a second motion is sought among all solutions where up to so many normal forces act.
GROWN = 6


class FreeMotion(NamedTuple):
    """The acceleration at which the driver has no effort, the frictions, and the normal forces if they are known."""

    acceleration: float
    sizes: Number
    components: Number | None = None


# not frozen: one is made at every state
@dataclass(eq=False)
class NormalForceState:
    """A state of the driver: its normal forces and its effort by the acceleration and by the frictions.

    Normal forces, in components, are `own` at no acceleration, `second` more for a unit of it, and `by` for a unit of
    each friction; `senses` are those of sliding. The effort is inertia times acceleration less `push`, less `along` for
    a unit of each friction. `is_mild` says that there is one solution, by the plain norm of the influences.
    """

    layout: NormalForceComponents
    own: Number
    second: Number
    by: Number
    senses: Number
    inertia: float
    push: float
    along: Number
    is_mild: bool = False

    @cached_property
    def grown(self) -> Number:
        """The influences of frictions that accelerate the driver as well."""
        found: Number = self.by + (self.along / self.inertia)[:, None] * self.second
        return found

    def free(self, held: Number | None = None, near: Number | None = None) -> FreeMotion | None:
        """Return the motion at which the driver has no effort; None where there is no regular one.

        Normal forces of which a sign is `held` count by it. Frictions `near` are those of a state nearby.
        """
        if not (self.inertia and np.isfinite(self.push)):
            # nothing is known at speeds that are no numbers
            return FreeMotion(np.nan, np.full(len(self.senses), np.nan))
        joint = self._joint(held)
        # several motions are sought where a step ends
        found = joint.solution(None if self.is_mild else joint.weights)
        if near is not None and (found is None or not found.is_regular):
            found = joint.solution(None, near)
        if found is not None and found.is_regular:
            return FreeMotion(self._accelerated(found.sizes), found.sizes, found.components)
        sizes = self._searched(joint, 0).sizes
        return None if sizes is None else FreeMotion(self._accelerated(sizes), sizes)

    def solutions(self, grown: int) -> Regular | None:
        """Return the regular motion among all if up to so many normal forces act, None where there is one for sure."""
        joint = self._joint(None)
        return None if self.is_mild or joint.weights is not None else self._searched(joint, grown)

    def _joint(self, held: Number | None) -> PoseInfluence:
        """Return the influence of frictions at the acceleration without effort."""
        own = self.own + self.push / self.inertia * self.second
        return PoseInfluence(self.layout, own, self.grown, self.senses, held)

    def _accelerated(self, sizes: Number) -> float:
        """Return the acceleration under frictions."""
        return (self.push + float(self.along.dot(sizes))) / self.inertia

    @property
    def effort_at_rest(self) -> float | None:
        """The driver's effort without acceleration, None where there is no regular one."""
        here = PoseInfluence(self.layout, self.own, self.by, self.senses)
        found = None if here.weights is None else here.solution(here.weights)
        sizes = self._searched(here, GROWN).sizes if found is None else found.sizes
        return None if sizes is None else -self.push - float(self.along.dot(sizes))

    def _searched(self, here: PoseInfluence, grown: int) -> Regular:
        """Return the frictions where their influences do not contract."""
        own, by = self.layout.joined(here.own), self.layout.joined(here.by)
        starts = np.searchsorted(self.layout.owners, np.arange(len(self.senses)))
        return regular_solution(FrictionInfluence(own[:, None], by[..., None], starts), self.senses[:, None], grown)


class SlidingStretch(NamedTuple):
    """A range of the driver in which all pairs slide in the same senses as it grows; None where they are unknown."""

    low: float
    high: float
    senses: Number | None


class TabulatedState(NamedTuple):
    """The normal forces of a state by the table, and what loads with a potential and the bias push."""

    normal: NormalForceState
    stored: float


@dataclass(frozen=True, eq=False)
class ForceLayout:
    """The rows of a table of normal forces: those of the equation of motion, frictions along the driver, normal forces.

    Normal forces, those in the `pressed` contacts, have rows under loads alone, for a unit acceleration, for a unit
    squared speed, for a unit of each friction, for a unit force along x, along y and a unit moment on each of the
    `touched` links, for a unit effort along each of the `efforts`' pairs, and in each state of self-stress.
    """

    contacts: tuple[LoadedContact, ...]
    loads: Sequence[Sequence[Load]]
    touched: tuple[str, ...]
    components: NormalForceComponents
    pressed: tuple[LoadedContact, ...]
    efforts: tuple[str, ...]
    left_out: tuple[LeftOut, ...] = ()
    states: int = 0

    @cached_property
    def none(self) -> Number:
        """The forces of no load that depends on time or speed."""
        return np.zeros(2 + 3 * len(self.touched) + len(self.efforts))

    @cached_property
    def scales(self) -> tuple[int, ...]:
        """The scales of rows by number: frictions along the driver have one each, normal forces one for each cause."""
        n, wide = len(self.contacts), len(self.components.together)
        first = max(DRIVE_SCALES) + 1
        alone = len(self.efforts) + self.states
        causes = [0, 1, 1, *[2] * n, *(3 + k for _ in self.touched for k in (0, 0, 1)), *(5 + k for k in range(alone))]
        return (*DRIVE_SCALES, *range(first, first + n), *(first + n + k for k in causes for _ in range(wide)))

    def state(self, rows: Number, speed: float, sliding: Number, others: Number, is_mild: bool) -> TabulatedState:
        """Return the state of a driver, by the rows at its value."""
        n = len(self.contacts)
        inertia, bias, stored, other = rows[:4].tolist()
        causes = rows[4 + n :].reshape(-1, len(self.components.together))
        own = causes[0] + speed * speed * causes[2]
        if len(others) > 2:
            stored, other = stored + float(others[0]), other + float(others[1])
            own = own + others[2:].dot(causes[3 + n : 3 + n + len(others) - 2])
        kept = stored - bias * speed * speed
        found = NormalForceState(self.components, own, causes[1], causes[3 : 3 + n], sliding, inertia, kept + other,
                                 rows[4 : 4 + n], is_mild)  # fmt: skip
        return TabulatedState(found, kept)

    def is_mild(self, piece: TablePiece) -> bool:
        """Return whether frictions contract by the plain norm throughout a piece, at any acceleration and without."""
        return all(self._gain(piece, value) < MILD for value in np.linspace(piece.low, piece.high, CHECKED).tolist())

    def _gain(self, piece: TablePiece, value: float) -> float:
        """Return the greatest sum of what units of all frictions add to the normal forces of one."""
        one = self.state(piece.terms @ piece.basis(value), 0.0, np.ones(len(self.contacts)), self.none, False).normal
        return max(float(self.components.gains(by).sum(axis=1).max()) for by in (one.by, one.grown))

    def terms(self, motion: Motion) -> Number:
        """Return all rows at the poses of a motion at unit speed."""
        parts = [drive_terms(motion, self.loads)]
        blocks = [np.array(list(self._of(at))) for at in loaded_blocks(motion)]
        return np.concatenate([*parts, np.concatenate(blocks, axis=1)])

    def _of(self, at: LoadedBlock) -> Iterator[Number]:
        """Yield the rows of a block beyond those of the equation of motion."""
        units = [contact.unit(at) for contact in self.contacts]
        for contact, unit in zip(self.contacts, units, strict=True):
            _, poses = contact.sides(at)
            yield in_one_row(unit.power(poses[1]) - unit.power(poses[0]), at)
        order = at.motion.solving_order
        for reactions in reverse_passes(order, at.block, list(self._causes(at, units))):
            forces = normal_forces_of(at, self.pressed, reactions)
            yield from self.components.split(np.transpose(forces)).T
        for _, _, wrenches in stressed_blocks(at, self.left_out):
            yield from self.components.split(np.transpose(normal_forces_by(at, self.pressed, wrenches))).T

    def _causes(self, at: LoadedBlock, units: Sequence[Wrench]) -> Iterator[dict[str, Wrench]]:
        """Yield the loads of each cause of normal forces."""
        mechanism, ones = at.motion.mechanism, np.ones(at.block.shape)
        wrenches = [one for loads in self.loads for load in loads for one in load.wrenches(at)]
        if mechanism.gravity != 0:
            wrenches += [(mass.link, at.weight(mass)) for mass in mechanism.masses.values()]
        yield _summed(wrenches)
        for block in (replace(at.block, world=_accelerated(at.block.world)), at.block):
            moved = replace(at, block=block)
            yield _summed([(mass.link, moved.inertia(mass)) for mass in mechanism.masses.values()])
        yield from (contact.on_links(unit) for contact, unit in zip(self.contacts, units, strict=True))
        for link in self.touched:
            yield from ({link: Wrench(force * ones, moment * ones)} for force, moment in UNITS)
        yield from (_summed(list(at.unit_effort(pair))) for pair in self.efforts)


# A unit force along x, one along y, and a unit moment about the origin.
UNITS = ((1.0 + 0j, 0.0), (1j, 0.0), (0j, 1.0))


def _summed(wrenches: Sequence[tuple[str, Wrench]]) -> dict[str, Wrench]:
    found: dict[str, Wrench] = {}
    for link, wrench in wrenches:
        found[link] = found.get(link, Wrench()) + wrench
    return found


def _accelerated(world: Mapping[str, Pose]) -> dict[str, Pose]:
    """Return poses at rest that accelerate as they moved: what a unit acceleration of the driver adds."""

    def pushed(series: Series) -> Series:
        return Series((series.c[0], 0.0 * series.c[1], 0.5 * series.c[1]) if len(series.c) > 1 else series.c)

    return {link: pose if pose is FIXED else pose.mapped(pushed) for link, pose in world.items()}


@dataclass(frozen=True, eq=False)
class NormalForceTable:
    """A table of normal forces: its pieces in order, and the stretches between reversals of sliding."""

    layout: ForceLayout
    pieces: Sequence[TablePiece]
    starts: Sequence[float]
    edges: Sequence[float]
    senses: Sequence[Number | None]
    mild: Mapping[int, bool]

    def stretch(self, value: float) -> SlidingStretch:
        """Return the stretch at a value."""
        k = min(max(bisect_right(self.edges, value) - 1, 0), len(self.senses) - 1)
        return SlidingStretch(self.edges[k], self.edges[k + 1], self.senses[k])


def usual_sizes(layout: ForceLayout, motion: Motion) -> dict[int, float]:
    """Return the usual sizes of the scales of rows: in dwells some are rounding alone."""
    rows, scales = np.abs(layout.terms(motion)), np.array(layout.scales)
    found = {}
    for scale in set(layout.scales):
        known = np.max(rows[scales == scale], axis=0)
        known = known[np.isfinite(known) & (known > 0.0)]
        found[scale] = float(np.median(known)) if known.size else 0.0
    return found


def normal_force_table(chart: TabulatedChart) -> NormalForceTable | None:
    """Return the table of normal forces in contacts with friction of a chart; None where they are nowhere accurate."""
    table = chart.table
    assert table is not None
    layout = force_layout(chart, table.motion)
    sizes = usual_sizes(layout, table.motion) | _sizes_of_scales(layout, table.motion) | dict(table.least)
    pieces = accurate_pieces(table.course, layout.terms, layout.scales, chart.candidates, sizes)
    if not pieces:
        return None
    edges, found = _stretches(layout, pieces, table)
    mild = {id(piece): layout.is_mild(piece) for piece in pieces}
    return NormalForceTable(layout, pieces, [piece.low for piece in pieces], edges, found, mild)


def force_layout(
    chart: TabulatedChart, motion: Motion, pressed: tuple[LoadedContact, ...] | None = None
) -> ForceLayout:
    """Return the layout of the rows, whose number the first block shows.

    They are those of the contacts with friction, or of others that are `pressed`, with what stops and
    self-stress do.
    """
    at = next(iter(loaded_blocks(motion)))
    contacts = chart.contacts if pressed is None else pressed
    nothing = reverse_pass(motion.solving_order, at.block, {})
    each = [normal_forces_of(at, (contact,), nothing) for contact in contacts]
    rows = [row for own in each for row in own]
    owners = [k for k, own in enumerate(each) for _ in own]
    vectors = [k for k, row in enumerate(rows) if np.iscomplexobj(row)]
    components = NormalForceComponents(owners, vectors)
    found = ForceLayout(chart.contacts, chart.timeless, chart.touched, components, contacts, chart.pushing)
    if pressed is None:
        return found
    left_out = parts_left_out(motion.structure)
    stops = dict.fromkeys(one.stop.pair for one in chart.stop_contacts)
    efforts = (*chart.pushing, *stops)
    return replace(found, efforts=efforts, left_out=left_out, states=len(list(stressed_blocks(at, left_out))))


def _stretches(
    layout: ForceLayout, pieces: Sequence[TablePiece], table: DriveTable
) -> tuple[list[float], list[Number | None]]:
    """Return the edges of the stretches between reversals of sliding, and the senses in each; None in gaps."""
    first, least = len(DRIVE_SCALES), AT_REST * fastest_powers(layout, table.motion)
    own = slice(first, first + len(layout.contacts))
    runs = [_SlidingRates(piece, piece.terms[own], least) for piece in pieces]
    edges = {table.low, pieces[0].low, pieces[-1].high, table.high}
    for left, right in pairwise(runs):
        if left.piece.high < right.piece.low or np.any(left.rests != right.rests):
            edges |= {left.piece.high, right.piece.low}
    for run in runs:
        edges |= set(run.reversals())
    whole = sorted(edges)
    starts, found = [piece.low for piece in pieces], list[Number | None]()
    for low, high in pairwise(whole):
        middle = 0.5 * (low + high)
        here = runs[max(bisect_right(starts, middle) - 1, 0)]
        found.append(here.senses(middle) if here.piece.low <= middle <= here.piece.high else None)
    return whole, found


def _sizes_of_scales(layout: ForceLayout, motion: Motion) -> dict[int, float]:
    """Return the sizes of the scales of a table's rows: much smaller ones are rounding alone."""
    first = max(DRIVE_SCALES) + 1
    causes = first + len(layout.contacts)
    found = dict(zip(range(first, causes), fastest_powers(layout, motion).tolist(), strict=True))
    found[causes + 2] = float(np.max(_units(layout, motion)))
    # by unit forces and moments
    return found | ({causes + 3: 1.0, causes + 4: 1.0 / motion.size} if layout.touched else {})


def _units(layout: ForceLayout, motion: Motion) -> Number:
    """Return the size of each friction as a force for a unit normal force, that of a couple at the mechanism's size."""
    at = next(iter(loaded_blocks(motion)))
    arms = [float(np.ravel(one.arm(at))[0]) if one.pair.is_couple else at.motion.size for one in layout.contacts]
    coefficients = [float(np.ravel(at.fitted(one.friction.factor))[0]) for one in layout.contacts]
    return np.array(coefficients) * np.array(arms) / at.motion.size


def fastest_powers(layout: ForceLayout, motion: Motion) -> Number:
    """Return the size of each friction's power, for a unit normal force at unit rate of the driver."""
    found: Number = max(float(np.nanmax(speed_of_fastest(one))) for one in loaded_blocks(motion)) * _units(
        layout, motion
    )
    return found


# Places in a piece, none of them at an edge, where reversals may be.
_PLACES = (np.arange(PLACES) + 0.5) * (2.0 / PLACES) - 1.0
_BASES = np.polynomial.chebyshev.chebvander(_PLACES, POINTS - 1).T


class _SlidingRates:
    """The powers of unit frictions in a piece, by whose signs pairs slide; those that rest in it are zero."""

    def __init__(self, piece: TablePiece, rows: Number, least: Number) -> None:
        self.piece, self.rows = piece, rows
        self.known = rows @ _BASES
        self.rests = np.max(np.abs(self.known), axis=1) <= least

    def senses(self, value: float) -> Number:
        """Return the senses of sliding at a value."""
        return np.where(self.rests, 0.0, np.sign(self.rows @ self.piece.basis(value)))

    def reversals(self) -> Iterator[float]:
        """Yield the values at which a pair that does not rest slides in the other sense."""
        middle, reach = 0.5 * (self.piece.low + self.piece.high), 0.5 * (self.piece.high - self.piece.low)
        places = middle + reach * np.array([-1.0, *_PLACES, 1.0])
        ends = [self.rows @ self.piece.basis(end) for end in (self.piece.low, self.piece.high)]
        known = np.column_stack([ends[0], self.known, ends[1]])
        for row, values in zip(self.rows[~self.rests], known[~self.rests], strict=True):
            for k in np.flatnonzero(values[:-1] * values[1:] <= 0.0).tolist():
                yield self._zero(row, float(places[k]), float(places[k + 1]))

    def _zero(self, row: Number, low: float, high: float) -> float:
        rises = float(row @ self.piece.basis(high)) > 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if (float(row @ self.piece.basis(middle)) > 0.0) is rises else (middle, high)
        return high


class ContactForces:
    """The forces that press contacts which may let go: a table over a driver, as of normal forces.

    Where it is not accurate, its rows are those of the solved pose.
    """

    def __init__(self, chart: TabulatedChart, contacts: tuple[LoadedContact, ...]) -> None:
        assert chart.table is not None
        table, motion = chart.table, chart.table.motion
        self.layout = force_layout(chart, motion, contacts)
        sizes = usual_sizes(self.layout, motion) | dict(table.least)
        self.pieces = accurate_pieces(table.course, self.layout.terms, self.layout.scales, chart.candidates, sizes)
        self.starts = [piece.low for piece in self.pieces]
        self.index = {contact.name: k for k, contact in enumerate(contacts)}

    def pressing(self, name: str, chart: TabulatedChart, time: float, value: float, speed: float) -> float | None:
        """Return the force that presses a contact at a state of a chart, None where it is not known."""
        if name not in self.index:
            return None
        values, speeds = np.array([value]), np.array([speed])
        causes = self._causes(chart, value)
        second, sizes = chart.acceleration_and_frictions(time, values, speeds)
        known = [1.0, second, speed * speed, *sizes]
        if chart.has_others or chart.closed:
            seen = chart.seen(time, values, speeds)
            others = chart.wrenches_of_others(seen.loaded, self.layout.touched)
            if others is None:
                return None
            known += [*others[2:], *self._at_stops(chart, seen, time, values, speeds)]
        normals = np.array(known) @ causes[: len(known)]
        return spare_force(self.index[name], normals, causes[len(causes) - self.layout.states :])

    def _causes(self, chart: TabulatedChart, value: float) -> Number:
        """Return the normal forces in all contacts by each cause, (causes, contacts)."""
        inside, first = chart.tabulated(value), len(DRIVE_SCALES) + len(self.layout.contacts)
        piece = piece_at(self.pieces, self.starts, inside)
        if piece is not None:
            rows = piece.terms[first:].dot(piece.basis(inside))
        else:
            state = chart.state(0.0, np.array([value]), np.ones(1))
            rows = self.layout.terms(unit_motion(state, chart.start))[first:, 0]
        found: Number = rows.reshape(-1, len(self.index))
        return found

    def _at_stops(
        self, chart: TabulatedChart, seen: PushedState, time: float, values: Number, speeds: Number
    ) -> Number:
        """Return the efforts along the pairs with stops: those of elastic ones may be among the other loads."""
        efforts = dict.fromkeys(self.layout.efforts[len(chart.pushing) :], 0.0)
        rigid = chart.rigid
        if rigid:
            free = chart.unheld_rates(time, values, speeds)
            for one, force in zip(rigid, holding([one.at(seen) for one in rigid], seen, free).tolist(), strict=True):
                efforts[one.stop.pair] += one.side * force
        for one in chart.closed if chart.adds_stops else ():
            if one.stop.is_elastic:
                efforts[one.stop.pair] += one.side * one.push(seen)
        return np.array([*efforts.values()])


def tabulated_pressing(chart: TabulatedChart, name: str, time: float, value: float, speed: float) -> float | None:
    """Return the force that presses a contact, from a table made once; None where it is to be found from the state.

    That is so where the effort of a motor depends on the acceleration, and while a load holds a speed.
    """
    table = chart.table
    if table is None or chart.laws or chart.held is not None or chart.rotors_that_lose:
        return None
    if chart.contact_forces is None or chart.contact_forces[0] is not table:
        pairs = (pair for pair in chart.order.pairs.values()
                 if (own := as_profile_contact(pair)) is not None and not own.has_ends)  # fmt: skip
        contacts = (LoadedContact(one, Friction(one.name, 0.0)) for one in map(as_friction_pair, pairs) if one)
        chart.contact_forces = table, ContactForces(chart, tuple(contacts))
    forces: ContactForces = chart.contact_forces[1]
    return forces.pressing(name, chart, time, value, speed)
