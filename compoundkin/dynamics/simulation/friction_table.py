"""One free driver with Coulomb friction: accelerations at which the driver has no effort, and where it sticks.

Normal forces are affine in the acceleration at a given pose and speed, so that two of them determine all; friction
follows from the normal forces by Coulomb's law, and the acceleration is the one at which no effort is left to the
driver.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.friction.coulomb_friction import ONE, FrictionInfluence, block_with_friction, solve_coulomb
from compoundkin.dynamics.friction.friction_contacts import LoadedContact, friction_contacts_of, senses
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.simulation.driver_state import DriverState, Rates, accelerated_motion
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart

# Iterations for the acceleration: secant steps, each from two efforts that are nearly affine in it.
STEPS = 30
# Iterations end where a step changes the acceleration by this part.
STEP_TOLERANCE = 1e-13
# The release of a driver is searched at so many times, and found to this part of the time.
RELEASE_SAMPLES, RELEASED = 200, 1e-12


@dataclass(frozen=True, eq=False)
class NormalForceState:
    """Normal forces at the accelerations 0 and 1, senses of sliding, and the driver's effort.

    The effort is `own` without friction at both accelerations, and changes by `by` for each unit of friction.
    """

    influence: FrictionInfluence
    senses: Number
    own: Number
    by: Number

    def effort(self, a: float) -> float | None:
        """Return the driver's effort at an acceleration, None where it is not unique."""
        own = self.influence.own
        pressed = replace(self.influence.of(np.array([0])), own=own[:, :1] + (own[:, 1:] - own[:, :1]) * a)
        found = solve_coulomb(pressed, self.senses[:, None])
        if found.state[0] != ONE:
            return None
        return float(self.own[0] + (self.own[1] - self.own[0]) * a + found.sizes[:, 0] @ self.by)


class FrictionTable(TabulatedChart):
    """The chart of one free driver whose pairs have friction. It moves in one `direction` until it comes to rest."""

    direction: float = 1.0
    # friction asks for the forces of all loads
    adds_stops = False

    @cached_property
    def contacts(self) -> tuple[LoadedContact, ...]:
        """The pairs with friction."""
        return friction_contacts_of(self.start)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state. The work is that of loads without a potential, and of friction."""
        state = self.state(time, values, speeds)
        gained = state.terms.matrix[0, 0] * state.accelerations[0] + state.terms.bias[0] - state.forces[0][0]
        return Rates(state.accelerations, float(gained * speeds[0]))

    def accelerations_at(self, time: float, values: Number, speeds: Number) -> Number:
        """Return the acceleration at a state of the solution; zero where friction holds it."""
        if speeds[0] == 0.0:
            way = self.direction_from_rest(self.state(time, values, speeds))
            if way == 0.0:
                return np.zeros(1)
        else:
            way = float(np.sign(speeds[0]))
        before, self.direction = self.direction, way
        try:
            return self.state(time, values, speeds).accelerations
        finally:
            self.direction = before

    def accelerated(self, state: DriverState) -> Number:
        """Return the acceleration at a state, at which the driver has no effort."""
        pressed = self._pressed(state, state.speeds, np.array([[0.0, 1.0]]), self.direction)
        a, last, step = float(state.dry[0]), 0.0, 0.0
        for k in range(STEPS):
            effort = pressed.effort(a)
            if effort is None:
                what = f"friction has no or several solutions at {state.time:g} s: the mechanism wedges or jumps"
                raise InvalidInput(Problem("frictions", what, "less friction, or another start"))
            # without friction the effort grows by the inertia
            slope = (effort - last) / step if k else state.terms.matrix[0, 0]
            last, step = effort, -effort / slope if effort else 0.0
            a += step
            if abs(step) <= STEP_TOLERANCE * abs(a):
                break
        return np.array([a])

    def begin(self, time: float, values: Number, speeds: Number) -> bool:
        """Set the direction of motion; return whether it moves, which friction may prevent."""
        way = float(np.sign(speeds[0])) or self.direction_from_rest(self.state(time, values, speeds))
        self.direction = way or self.direction
        return way != 0.0

    def direction_from_rest(self, state: DriverState) -> float:
        """Return the direction in which the driver starts from rest, zero where friction holds it."""
        # the effort that would sustain motion in each direction; None where it is wedged
        efforts = [self._pressed(state, np.zeros(1), np.zeros((1, 2)), way).effort(0.0) for way in (-1.0, 1.0)]
        if efforts[1] is not None and efforts[1] < 0.0:
            return 1.0
        return -1.0 if efforts[0] is not None and efforts[0] > 0.0 else 0.0

    def released(self, time: float, values: Number, until: float) -> float:
        """Return the time at which loads overcome friction at rest, at the latest the end."""
        if not self.has_others:
            return until

        def moves(at: float) -> bool:
            return self.direction_from_rest(self.state(at, values, np.zeros(1))) != 0.0

        times = np.linspace(time, until, RELEASE_SAMPLES + 1)[1:]
        late = next((float(at) for at in times if moves(float(at))), None)
        if late is None:
            return until
        early = late - (until - time) / RELEASE_SAMPLES
        while late - early > RELEASED * until:
            middle = (early + late) / 2.0
            early, late = (early, middle) if moves(middle) else (middle, late)
        return late

    def _pressed(self, state: DriverState, speeds: Number, second: Number, way: float) -> NormalForceState:
        """Return the normal forces at two accelerations, and the driver's effort."""
        at = self._loaded(state, speeds, second)
        block = block_with_friction(at, self.contacts, at.known(True))
        none = np.zeros((len(self.contacts), 2))
        own = block.effort(self.free[0], none)
        each = np.eye(len(self.contacts))
        by = np.array([(block.effort(self.free[0], none + one[:, None]) - own)[0] for one in each])
        return NormalForceState(block.influence, way * self._senses(state), own, by)

    def _senses(self, state: DriverState) -> Number:
        """Return the sense in which each pair slides as the driver's coordinate grows."""
        return senses(self.contacts, self._loaded(state, np.ones(1), np.zeros((1, 1))))[:, 0]

    def _loaded(self, state: DriverState, speeds: Number, second: Number) -> LoadedBlock:
        motion = accelerated_motion(state, self.start, speeds, second)
        return next(iter(loaded_blocks(motion)))
