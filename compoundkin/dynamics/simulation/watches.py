"""What is watched in a simulation: friction, travel limits of guides, lift-off, jumps of loads, and a user's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.simulation.contact_watches import SLOW, pressing
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.driver_state import KnownState, SimulatedState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.load_breaks import load_places
from compoundkin.dynamics.simulation.simulation_events import BreakWatch, FunctionWatch, PlaceWatch, Watch, ZeroWatch
from compoundkin.kinematics.solving_order import AT_END
from compoundkin.model.loads.latch import as_release
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.pairs.travel_limits import as_travel_limited

# The name of the event at a travel limit.
END = "end"
# The name of the event at which a driver comes to rest, where friction changes its direction.
REST = "rest"
# The name of the event at which a pair slides the other way; it is not told.
REVERSES = "reverses"
# The name of the event where a load jumps.
JUMP = "jump"
# The name of the event where friction or a load holds a mechanism.
STICKS = "sticks"


class RestWatch(ZeroWatch):
    """The rest of a single driver."""

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return its speed, with several drivers a number that is never zero."""
        return float(state[1]) if isinstance(chart, FrictionTable) else 1.0


class SlidingWatch(ZeroWatch):
    """Changes of friction: a pair slides in the other sense, or is pressed the other way."""

    samples = 8
    has_dips = True

    def is_idle(self, chart: Chart) -> bool:
        """Return whether no such state was met in the last step."""
        return not (isinstance(chart, FrictionTable) and chart.has_left)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return how far ahead the next one is."""
        return chart.smooth_margin(time, *state[:2].tolist()) if isinstance(chart, FrictionTable) else 1.0


# A normal force below this part of the loads and of the inertia forces is none.
NO_FORCE = 1e-9


@dataclass(frozen=True, eq=False)
class LiftOffWatch(ZeroWatch):
    """A contact that lets go where nothing presses it any more."""

    pair: str = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the force that presses it."""
        return pressing(self.pair, chart, time, state)

    def reason(self, states: Sequence[KnownState]) -> str:
        """Return why it lets go, by states of the step in which it does; nothing where it just comes to that."""
        normals = [float(np.ravel(force_analysis(one.motion).pairs[self.pair].normal)[0]) for one in states]
        acting = max(_greatest_force(one) for one in states)
        if max(map(abs, normals)) <= NO_FORCE * acting:
            return ": what it pushes has neither inertia nor load, so that nothing presses there"
        if normals[0] < -NO_FORCE * acting:
            return f": it would have to pull with {-normals[0]:.4g}"
        return ""


def _greatest_force(state: KnownState) -> float:
    """Return the greatest force of loads and inertia on a link."""
    loaded = state.loaded
    wrenches = [*loaded.applied().values(), *map(loaded.inertia, state.chart.mechanism.masses.values())]
    return max((float(np.max(np.abs(one.force))) for one in wrenches), default=0.0)


class StickWatch(SlidingWatch):
    """Changes of friction of several drivers: a pair comes to rest, slips, or is pressed the other way."""

    def is_idle(self, chart: Chart) -> bool:
        """Return whether no such state was nearly met in the last step."""
        return not (isinstance(chart, FrictionChart) and chart.has_left)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return how far ahead the next one is."""
        return chart.margin_at(time, state) if isinstance(chart, FrictionChart) else 1.0


def watches(mechanism: Mechanism, events: Mapping[str, Any], stop: tuple[str, ...]) -> tuple[Watch, ...]:
    """Return what is watched: friction, travel limits, one-sided contacts, a user's own functions, jumps of loads.

    Raises InvalidInput for an event that is no function, and where `stop` names none.
    """
    for name, function in events.items():
        if not callable(function):
            remedy = 'give a function of the state: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{name}", f"{function!r} is no function", remedy))
    for name in stop:
        if name not in events:
            raise InvalidInput(Problem("stop", f"there is no event {name!r}", f"known: {', '.join(events) or 'none'}"))
    own = [FunctionWatch(name, "as asked for", name in stop, asked=True, function=function)
           for name, function in events.items()]  # fmt: skip
    places = load_places(mechanism.loads.values())
    text = "the loads jump"
    breaks = [
        BreakWatch(JUMP, text, False),
        *(PlaceWatch(JUMP, text, False, place=one) for one in places),
    ]
    return (*(FRICTIONS if mechanism.frictions else ()), *_of_pairs(mechanism), *own, *(breaks if places else ()))


# What is watched with friction.
FRICTIONS = (
    RestWatch(REST, "it comes to rest", False),
    SlidingWatch(REVERSES, "friction acts the other way", False),
    StickWatch(REVERSES, "friction changes", False, True),
)


def _of_pairs(mechanism: Mechanism) -> Iterator[Watch]:
    if any(as_travel_limited(pair) is not None for pair in mechanism.written_pairs):
        yield FunctionWatch(END, "a guide ends", True, True, function=_to_end)
    released = {one.pair for item in mechanism.loads.values() if (one := as_release(item)) is not None}
    for pair in (one for one in mechanism.written_pairs if one.name not in released):
        contact = as_profile_contact(pair)
        # in a groove the roller changes to the other flank
        if contact is not None and not contact.has_ends:
            text = f"the contact at {pair.name} lets go"
            yield LiftOffWatch(f"{pair.name} lift-off", text, True, True, pair=pair.name)


def _to_end(state: SimulatedState) -> float:
    # the margin is zero where the limit is just reached
    return float(np.ravel(state.order.guide_ends.margin(state.block))[-1]) - AT_END


def ended_pair(state: SimulatedState) -> Pair:
    """Return the pair nearest to a travel limit."""
    ends = state.order.guide_ends
    return ends.pairs[int(np.ravel(ends.nearest(state.block))[-1])]


class Impact(NamedTuple):
    """An impact at a travel limit: the approach speed, all coordinates' speeds afterwards, the lost energy."""

    approach: float
    speeds: Number
    lost: float


def after_impact(here: SimulatedState, restitution: float, fastest: float) -> Impact | None:
    """Return the result of an impact; None where the approach is slow against `fastest`, that of the fastest before.

    The impulse acts along the limited coordinate,
    M (v+ - v-) = n p with n . v+ = -e n . v-.

    Source: Newton's law of impact in generalized coordinates, D. T. Greenwood, Principles of Dynamics, section 4.8.
    """
    state, pair = here.state, ended_pair(here)
    along, speeds = state.slopes(pair), state.speeds
    approach = float(along @ speeds)
    if abs(approach) <= SLOW * max(fastest, float(np.abs(along) @ np.abs(speeds))):
        return None
    push, matrix = state.response(along), state.terms.matrix
    after = speeds - (1.0 + restitution) * approach / float(along @ push) * push
    return Impact(abs(approach), after, float(speeds @ matrix @ speeds - after @ matrix @ after) / 2.0)
