"""One free driver with Coulomb friction: accelerations at which the driver has no effort, and where it sticks.

Normal forces are affine in the acceleration, in the squared speed and in the frictions at a given pose; friction
follows from the normal forces by Coulomb's law, and the acceleration is the one at which no effort is left to the
driver. What normal forces are by each of these is tabulated over the coordinate (`normal_force_table`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.dynamics.friction.coulomb_friction import (
    TINY,
    NotUniqueMotion,
)
from compoundkin.dynamics.friction.friction_contacts import (
    AT_REST,
    LoadedContact,
    friction_contacts_of,
    undetermined_friction,
)
from compoundkin.dynamics.reactions.reverse_pass import (
    self_stress,
)
from compoundkin.dynamics.simulation.drive_table import (
    DRIVE_SCALES,
    piece_at,
)
from compoundkin.dynamics.simulation.driver_state import DriverState, Rates, needs_time, unit_motion
from compoundkin.dynamics.simulation.normal_force_table import (
    GROWN,
    ForceLayout,
    FreeMotion,
    NormalForceState,
    NormalForceTable,
    SlidingStretch,
    TabulatedState,
    fastest_powers,
    force_layout,
    normal_force_table,
)
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart

# The release of a driver is searched at so many times, and found to this part of the time.
RELEASE_SAMPLES, RELEASED = 200, 1e-12
# A normal force below this part of its largest may change sign within a step, and a reversal so near be met.
NEARLY = 0.01
# A course begins so far ahead in its stretch, as a part of the table: it has just left the reversal behind it.
AHEAD = 1e-10


def released_between(moves: Callable[[float], bool], early: float, late: float, until: float) -> float:
    """Return the time at which a mechanism that rests early and moves late is released."""
    while late - early > RELEASED * until:
        middle = (early + late) / 2.0
        early, late = (early, middle) if moves(middle) else (middle, late)
    return late


class FrictionTable(TabulatedChart):
    """The chart of one free driver whose pairs have friction. It moves in one `direction` until it comes to rest.

    A step of the integration is smooth: senses of sliding are those of one `stretch`, which ends at a value `ahead`,
    and normal forces count by the signs, `sides`, that they had when it was entered. Where either changes is an event.
    It `has_left` once a state beyond, or nearly so, has been met; it `rests` where friction holds it.
    """

    direction: float = 1.0
    # friction asks for the forces of all loads
    adds_stops = False
    pressed: NormalForceTable | None = None
    stretch: SlidingStretch | None = None
    ahead: float | None = None
    sides: Number | None = None
    has_left: bool = False
    rests: bool = False
    near_sizes: Number | None = None  # the frictions of the last state

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check_determined()

    def _check_determined(self) -> None:
        """Raise InvalidInput where equilibrium does not determine the normal force of a friction."""
        if self.start.structure.relaxation is None:
            return
        stress, ends, poses = self_stress(self.start), self.start.inputs.ends, self.start.poses
        for contact in self.contacts:
            place = poses[contact.pair.members[1]].at(ends[contact.name][1].point).c[0]
            found = stress.open([(contact.name, 1.0)], place)
            is_open = found.force | found.moment if contact.friction.length is not None else found.force
            if np.any(is_open) and np.any(np.asarray(contact.friction.factor) > 0.0):
                raise undetermined_friction(contact)

    @cached_property
    def largest(self) -> list[float]:
        """The largest components of normal forces up to now."""
        assert self.pressed is not None
        return [TINY] * len(self.pressed.layout.components.together)

    @cached_property
    def contacts(self) -> tuple[LoadedContact, ...]:
        """The pairs with friction."""
        return friction_contacts_of(self.start)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state. The work is that of loads without a potential, and of friction."""
        value, speed = float(values[0]), float(speeds[0])
        found = self._in_table(time, value, speed, self.direction)
        if self._ahead(value) < 0.0:
            self.has_left = True
        if found is None:
            state = self.state(time, values, speeds)
            gained = state.terms.matrix[0, 0] * state.accelerations[0] + state.terms.bias[0] - state.forces[0][0]
            return Rates(state.accelerations, float(gained * speed))
        free = self._free(found.normal, time, self.sides)
        a = free.acceleration
        if self._pressed_least(free, True) < NEARLY:
            self.has_left = True
        return Rates(np.array([a]), (found.normal.inertia * a - found.stored) * speed)

    def _ahead(self, value: float) -> float:
        """Return how far it is until a pair slides in the other sense, against the reach of the driver."""
        return 1.0 if self.ahead is None else self.direction * (self.ahead - value) / self.reach

    def _pressed_least(self, free: FreeMotion | None, is_new: bool = False) -> float:
        """Return the least normal force that counts by a sign, against the largest it was up to now; 1 without any."""
        least = 1.0
        if self.sides is None or free is None or free.components is None:
            return least
        for k, (side, one) in enumerate(zip(self.sides.tolist(), free.components.tolist(), strict=True)):
            if side:
                if is_new and abs(one) > self.largest[k]:
                    self.largest[k] = abs(one)
                least = min(least, side * one / self.largest[k])
        return least

    def accelerations_at(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the acceleration at a state of the solution; zero where friction holds it."""
        way = 0.0 if self.rests else float(np.sign(speeds[0])) or self.direction_from_rest(time, values)
        if way == 0.0:
            return np.zeros(1)
        before, self.direction = self.direction, way
        try:
            return self.rates(time, values, speeds).accelerations
        finally:
            self.direction = before

    def accelerated(self, state: DriverState) -> Number:
        """Return the acceleration at a state, at which the driver has no effort."""
        return np.array([self._freed(state).acceleration])

    def free_motion(self, time: float, values: Number, speeds: Number) -> FreeMotion:
        """Return the motion at which the driver has no effort, with the frictions."""
        found = self._in_table(time, float(values[0]), float(speeds[0]), self.direction)
        if found is not None:
            return self._free(found.normal, time, self.sides)
        return self._freed(self.state(time, values, speeds))

    def acceleration_and_frictions(self, time: float, values: Number, speeds: Number) -> tuple[float, Number]:
        """Return both; frictions that act while a rigid stop holds the driver are not known."""
        if self.rigid:
            return super().acceleration_and_frictions(time, values, speeds)
        found = self.free_motion(time, values, speeds)
        return found.acceleration, found.sizes

    def _freed(self, state: DriverState) -> FreeMotion:
        """Return this motion at a solved state."""
        found = self._in_table(state.time, float(state.values[0]), float(state.speeds[0]), self.direction)
        if found is not None:
            return self._free(found.normal, state.time, self.sides)
        return self._free(self._solved(state, self.direction), state.time)

    def friction_powers(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the powers of all frictions, never positive."""
        value, speed = float(values[0]), float(speeds[0])
        if speed == 0.0:
            return np.zeros(len(self.contacts))
        way = float(np.sign(speed))
        found = self._in_table(time, value, speed, way)
        if found is None:
            state = self.state(time, values, speeds)
            normal = self._solved(state, way)
            return normal.along * self._free(normal, time).sizes * speed
        return found.normal.along * self._free(found.normal, time).sizes * speed

    def _free(self, normal: NormalForceState, time: float, held: Number | None = None) -> FreeMotion:
        """Return the motion without effort. Raises NotUniqueMotion where it is not."""
        found = normal.free(held, self.near_sizes)
        if found is None:
            raise NotUniqueMotion(time)
        self.near_sizes = found.sizes
        return found

    def begin(self, time: float, values: Number, speeds: Number) -> bool:
        """Set the direction of motion; return whether it moves, which friction may prevent."""
        way = float(np.sign(speeds[0])) or self.direction_from_rest(time, values)
        self.direction, self.rests = way or self.direction, way == 0.0
        if way:
            self.has_second_motion(time, values, speeds, GROWN)
        self._enter(time, values, speeds)
        return way != 0.0

    def has_second_motion(self, time: float, values: Number, speeds: Number, grown: int = 0) -> bool:
        """Return whether Coulomb's law has a second motion. Raises NotUniqueMotion where it has no regular one.

        It is sought among all solutions if up to so many normal forces act, `grown`.
        """
        here = self._in_table(time, float(values[0]), float(speeds[0]), self.direction)
        found = None if here is None else here.normal.solutions(grown)
        if found is None:
            return False
        if found.sizes is None:
            raise NotUniqueMotion(time)
        return found.solutions > 1

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Update the configuration at an accepted state."""
        super().accept(time, values, speeds)
        if self.ahead is None or self.has_left:
            self._enter(time, values, speeds)

    def smooth_margin(self, time: float, value: float, speed: float) -> float:
        """Return how far it is until friction changes, negative beyond."""
        far = self._ahead(value)
        found = None if self.sides is None else self._in_table(time, value, speed, self.direction)
        return far if found is None else min(far, self._pressed_least(found.normal.free(self.sides)))

    def direction_from_rest(self, time: float, values: Number) -> float:
        """Return the direction in which the driver starts from rest, zero where friction holds it."""
        for way in (1.0, -1.0):
            here = self._at_rest(time, values, way)
            # the effort that would sustain motion in a direction; None where it is wedged
            effort = here.effort_at_rest
            if effort is not None and effort * way < 0.0:
                # where frictions feed on each other strongly, inertia may press contacts so that it stays
                free = here.free()
                if free is not None and free.acceleration * way > 0.0:
                    return way
        return 0.0

    def released(self, time: float, values: Number, until: float) -> float:
        """Return the time at which loads overcome friction at rest, at the latest the end."""
        if not any(needs_time(self.start, load) for loads in self.others for load in loads):
            return until

        def moves(at: float) -> bool:
            return self.direction_from_rest(at, values) != 0.0

        times = np.linspace(time, until, RELEASE_SAMPLES + 1)[1:]
        late = next((float(at) for at in times if moves(float(at))), None)
        if late is None:
            return until
        return released_between(moves, late - (until - time) / RELEASE_SAMPLES, late, until)

    @property
    def memory(self) -> tuple[Any, ...]:
        """The configuration, with the tables and the stretch of sliding."""
        return (*super().memory, self.pressed, self.stretch, self.sides, self.rests)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Restore a configuration."""
        super().recall(memory[:-4])
        self.pressed, self.stretch, self.sides, self.rests = memory[-4:]

    def _tabulate(self, value: float, poses: Mapping[str, Pose]) -> None:
        super()._tabulate(value, poses)
        self.pressed = None if self.table is None else normal_force_table(self)

    def _enter(self, time: float, values: Number, speeds: Number) -> None:
        """Take the stretch of sliding that lies in the direction of motion."""
        self.stretch = self.ahead = self.sides = None
        self.has_left = False
        if self.table is None or self.pressed is None:
            return
        value, step = float(values[0]), self.direction * AHEAD * (self.table.high - self.table.low)
        if not self.wraps and not self.table.low < value + step < self.table.high:
            super().accept(time, values + step, speeds)
        inside = self.tabulated(value + step)
        found = self.pressed.stretch(inside)
        if found.senses is not None:
            self.stretch = found
            self.ahead = value + step + (found.high if self.direction > 0.0 else found.low) - inside
            self.sides = self._sides(time, value, float(speeds[0]), abs(step))

    def _sides(self, time: float, value: float, speed: float, far: float) -> Number | None:
        """Return the signs of the normal forces so far ahead, zeros for vectors; None where they are not known."""
        here = self._in_table(time, value, speed, self.direction)
        free = None if here is None else here.normal.free(None, self.near_sizes)
        # where a normal force is zero no step of Newton tells its side
        a = 0.0 if free is None or not np.isfinite(free.acceleration) else free.acceleration
        step = 2.0 * far / (abs(speed) + np.sqrt(speed * speed + 2.0 * abs(a) * far) + np.finfo(float).tiny)
        there = self._in_table(time + step, value + self.direction * far, speed + a * step, self.direction)
        free = None if there is None else there.normal.free(None, self.near_sizes)
        if there is None or free is None or free.components is None:
            return None
        layout, slides = there.normal.layout, there.normal.senses
        found = np.zeros(len(free.components))
        scalars = np.setdiff1d(np.arange(layout.count), layout.vectors)
        found[scalars] = np.sign(free.components[scalars]) * np.abs(slides[layout.owners[scalars]])
        return found

    def _in_table(self, time: float, value: float, speed: float, way: float) -> TabulatedState | None:
        """Return a state of the table, None where it is not accurate."""
        inside = self.tabulated(value)
        pressed = self.pressed
        piece = None if pressed is None else piece_at(pressed.pieces, pressed.starts, inside)
        stretch = self.stretch
        if piece is None:
            return None
        assert pressed is not None
        sliding = (stretch or pressed.stretch(inside)).senses
        if sliding is None:
            return None
        basis = piece.basis(inside)
        rows = piece.terms.dot(basis)
        others = pressed.layout.none
        if self.has_others:
            at = self.loaded_at(piece, basis, time, np.array([value]), speed)
            more = self.wrenches_of_others(at, self.touched)
            if more is None:
                return None
            others = more
        return pressed.layout.state(rows, speed, way * sliding, others, pressed.mild[id(piece)])

    def _at_rest(self, time: float, values: Number, way: float) -> NormalForceState:
        found = self._in_table(time, float(values[0]), 0.0, way)
        if found is not None:
            return found.normal
        return self._solved(self.state(time, values, np.zeros(1)), way)

    def _solved(self, state: DriverState, way: float) -> NormalForceState:
        """Return the normal forces and the driver's effort of a solved state: the rows of the table, for its pose."""
        at, motion = state.loaded, unit_motion(state, self.start)
        layout = replace(self._layout, touched=self._touched_by(at))
        rows, first = layout.terms(motion)[:, 0], len(DRIVE_SCALES)
        powers, others = rows[first : first + len(self.contacts)], self.wrenches_of_others(at, layout.touched)
        rests = np.abs(powers) <= AT_REST * fastest_powers(layout, motion)
        senses = np.where(rests, 0.0, np.sign(powers))
        assert others is not None
        return layout.state(rows, float(state.speeds[0]), way * senses, others, False).normal

    @cached_property
    def _layout(self) -> ForceLayout:
        """The layout of the rows."""
        return force_layout(self, self.start)
