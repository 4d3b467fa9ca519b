"""Friction in the coordinates of all links: the motion and the normal forces as affine functions of the frictions.

What the pairs' equations push determines the normal forces. A contact that sticks holds its two links like a pair.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_friction import NormalForceComponents
from compoundkin.dynamics.friction.friction_contacts import LoadedContact, friction_contacts_of, undetermined_friction
from compoundkin.dynamics.simulation.body_chart import NO_MASS, BodyChart, BodyState
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import TransmittingPair, as_transmitting_pair

# Equations of contacts at rest that say this part of the others' say nothing new.
RANK = 1e-9
# Derivatives of directions are differences over this part of the size, extrapolated once.
STEP = 1e-3
# Forces that equilibrium leaves open have more than this part of a state of self-stress.
UNDETERMINED = 1e-6


class _ContactRows(NamedTuple):
    """The rows of a contact's pair among the equations, the link whose columns tell its wrench, and the sense."""

    rows: slice
    link: int
    sense: float


class _GearedPair(NamedTuple):
    """A gear or belt at a pose: what accompanies a unit transmitted backward, none, and one forward."""

    pair: TransmittingPair
    place: _ContactRows
    ends: Any
    poses: Any
    beside: tuple[Wrench, ...]


class AffineMotion(NamedTuple):
    """Coordinates in which the mass matrix is unity, as affine functions of frictions: columns are none, each alone."""

    motion: Number  # (freedoms, 1 + frictions)
    holds: Number  # the forces of what is held (held, 1 + frictions)
    constraint: Number  # along all coordinates (coordinates, 1 + frictions)
    pressed: Number  # in the equations (equations, 1 + frictions)
    transmitted: Number  # by gears and belts (gears, 1 + frictions)


@dataclass(eq=False)
class RubbingChart(BodyChart):
    """The chart of all links of a mechanism, with the rows of its equations that press contacts with friction."""

    def __post_init__(self) -> None:
        super().__post_init__()
        first = super().state(0.0, self.first, np.zeros_like(self.first)).loaded
        found = friction_contacts_of(self.start)
        self.contacts = tuple(one for one in found if float(np.ravel(first.fitted(one.friction.factor))[0]) != 0.0)
        geared = (as_transmitting_pair(one.pair) for one in self.pair_equations.others)
        self.geared = tuple((pair, self.pair_equations.rows[pair.name]) for pair in geared if pair is not None)
        self.places = tuple(self._place(one) for one in self.contacts)
        self._lay_out()
        self._check_determined()

    def _place(self, contact: LoadedContact) -> _ContactRows:
        rows = self.pair_equations.rows
        if contact.name not in rows:
            what = f"the forces between the links at {contact.name} are not known in the coordinates of all links"
            raise InvalidInput(Problem(f"frictions.{contact.friction.pair}", what, "leave this friction out"))
        return _ContactRows(rows[contact.name], *self.columns_told_by(contact.pair))

    def columns_told_by(self, pair: Pair) -> tuple[int, float]:
        """Return where the columns of the link begin that tells a pair's wrench, and the sense."""
        first, second = pair.members[:2]
        return (3 * self.index[second], 1.0) if second != FRAME else (3 * self.index[first], -1.0)

    def _lay_out(self) -> None:
        """Find which normal forces belong to each contact, and which of them are vectors."""
        loaded = super().state(0.0, self.first, np.zeros_like(self.first)).loaded
        each = [one.normal_forces(loaded, Wrench(1.0 + 0j, 1.0)) for one in self.contacts]
        owners = [k for k, some in enumerate(each) for _ in some]
        flat = [one for some in each for one in some]
        self.layout = NormalForceComponents(owners, [k for k, one in enumerate(flat) if np.iscomplexobj(one)])
        # friction of a pin is a couple, and what presses in it is the force of its equations
        is_pin = [one.pair.is_simple and one.pair.free_is_angle for one in self.contacts]
        rows = RubbingState(self, 0.0, self.first, np.zeros_like(self.first)).rows_along(range(len(self.contacts)))
        self.couples = np.where(np.array(is_pin)[:, None], rows, 0.0)
        self.pin_forces = np.array([k for k, own in enumerate(owners) if is_pin[own]], dtype=int)
        self.pin_rows = np.array([self.places[own].rows.start for own in owners if is_pin[own]], dtype=int)
        self.others = [k for k, pin in enumerate(is_pin) if not pin]
        self.other_forces = np.array([k for k, own in enumerate(owners) if not is_pin[own]], dtype=int)

    def _check_determined(self) -> None:
        """Raise InvalidInput where equilibrium does not determine the normal force of a friction."""
        here = self.state(0.0, self.first, np.zeros_like(self.first))
        equations = here.pair_columns
        _, s, v = np.linalg.svd(equations)
        free = v[np.count_nonzero(s > RANK * s[0]) :]
        for contact, place in zip(self.contacts, self.places, strict=True):
            if free.size and np.max(np.abs(free[:, place.rows])) > UNDETERMINED:
                raise undetermined_friction(contact)

    def state(self, time: float, values: Number, speeds: Number) -> RubbingState:
        """Return the state at the coordinates of all links and their rates."""
        return RubbingState(self, time, values, speeds)


@dataclass(frozen=True, eq=False)
class RubbingState(BodyState):
    """A pose of all links with their velocities, and its motion by the frictions."""

    chart: RubbingChart

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

    @cached_property
    def pair_columns(self) -> Number:
        """The forces along all scaled coordinates by the unit forces in the equations.

        Those of gears and belts are where teeth and strands are, which their equations do not tell.
        """
        found = self.equations.jacobian.T.copy()
        for pair, rows in self.chart.geared:
            ends, poses = self.chart.pair_equations.ends_of(pair), tuple(self.world[link] for link in pair.members)
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

    def _affine(self, stuck: Number, sliding: Number) -> AffineMotion:
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
        transmitted = [
            one.pair.transmitted(one.ends, one.poses, self._wrench(pressed, one.place)) for one in self._geared
        ]
        return AffineMotion(motion, holds, constraint, pressed, np.reshape(transmitted, (-1, pressed.shape[1])))

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
        ends = self.chart.pair_equations.ends_of(pair)
        poses = tuple(self.world[link].trimmed(0) for link in pair.members)
        written = self.chart.mechanism.pretensions.get(pair.name)
        tension = None if written is None else self.loaded.fitted(written.force, f"pretensions.{pair.name}")
        beside = tuple(pair.accompanying(ends, poses, one, tension) for one in (-1.0, 0.0, 1.0))
        return _GearedPair(pair, _ContactRows(rows, *self.chart.columns_told_by(pair)), ends, poses, beside)

    def _normal(self, affine: AffineMotion, flanks: Number) -> Number:
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


def rank(rows: Number) -> int:
    """Return how many rows are independent."""
    sizes = np.linalg.svd(rows, compute_uv=False)
    return int(np.count_nonzero(sizes > RANK * sizes[:1]))
