"""What happens in a simulation: limit positions, ends of guides, lift-off, and what a user asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import SimulatedState
from compoundkin.kinematics.passed_ends import AT_END
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.pairs.travel_limits import as_travel_limited

# Within a step what is watched is looked at in so many places, so that what comes and goes is found as well.
EVENT_SAMPLES = 4
# What begins below zero is looked at these parts of a step as well: a bounce may be far shorter than the step.
EARLY = 2.0 ** np.arange(-44.0, -2.0)
# An impact slower than this part of the fastest, or of the drivers' speeds, each by its scale, is the last one.
SLOW = 1e-6
# What coming to an end of a guide is called.
END = "end"
# What a driver that comes to rest is called, where friction changes its direction.
REST = "rest"
Function = Callable[[SimulatedState], Any]


@dataclass(frozen=True)
class SimulationEvent:
    """Something that happened. When, what it is called, and whether the simulation stopped there."""

    time: float
    name: str
    text: str
    stops: bool

    def __repr__(self) -> str:
        return f"SimulationEvent({self.name!r} at {self.time:.6g} s: {self.text})"


@dataclass(frozen=True, eq=False)
class Watch:
    """A function of the state that passes through zero, and what that means.

    Where it `falls` only passing downwards counts, or being below from the start. A user's own is `asked` for.
    """

    name: str
    function: Function
    text: str
    stops: bool
    falls: bool = False
    asked: bool = False

    def value(self, chart: DriverChart, time: float, state: Number) -> float:
        """Return the function at a state. Raises InvalidInput where it returns no number."""
        n = len(chart.free)
        here = SimulatedState(chart.state(time, state[:n], state[n : 2 * n]))
        try:
            told = np.ravel(self.function(here))[0]
            if self.asked and (np.iscomplexobj(told) or np.isnan(told)):
                raise ValueError(f"it returns {told}")
            found = float(told)
        except CompoundkinError:
            raise
        except Exception as error:  # whatever a user's function does
            remedy = 'give a function of the state that passes through zero: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{self.name}", f"its function fails: {error}", remedy)) from error
        return found


@dataclass(frozen=True, eq=False)
class Passed:
    """Something watched that passes through zero at a time, and the state there."""

    watch: Watch
    time: float
    state: Number


def watches(mechanism: Mechanism, events: Mapping[str, Any], stop: tuple[str, ...]) -> tuple[Watch, ...]:
    """Return what is watched. Ends of guides, contacts that are not held, and a user's own events."""
    for name, function in events.items():
        if not callable(function):
            remedy = 'give a function of the state: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{name}", f"{function!r} is no function", remedy))
    for name in stop:
        if name not in events:
            raise InvalidInput(Problem("stop", f"there is no event {name!r}", f"known: {', '.join(events) or 'none'}"))
    own = [Watch(name, function, "as asked for", name in stop, asked=True) for name, function in events.items()]
    rest = [Watch(REST, _speed, "it comes to rest", False)] if mechanism.frictions else []
    return (*rest, *_of_pairs(mechanism), *own)


def _speed(state: SimulatedState) -> float:
    return float(state.state.speeds[0])


def _of_pairs(mechanism: Mechanism) -> Iterator[Watch]:
    if any(as_travel_limited(pair) is not None for pair in mechanism.written_pairs):
        yield Watch(END, _to_end, "a guide ends", True, True)
    for pair in mechanism.written_pairs:
        contact = as_profile_contact(pair)
        # in a groove the roller goes over to the other flank
        if contact is not None and not contact.has_ends:
            text = f"the contact at {pair.name} lets go"
            yield Watch(f"{pair.name} lift-off", _pressing(pair.name), text, True, True)


def _to_end(state: SimulatedState) -> float:
    # where it is reached, no pose is beyond it yet
    return float(np.ravel(state.order.guide_ends.margin(state.block))[-1]) - AT_END


def ended_pair(state: SimulatedState) -> Pair:
    """Return the pair that is nearest to an end of its guide."""
    ends = state.order.guide_ends
    return ends.pairs[int(np.ravel(ends.nearest(state.block))[-1])]


def _pressing(name: str) -> Function:
    return lambda state: force_analysis(state.motion).pairs[name].normal


def first_passed(
    watched: tuple[Watch, ...], chart: DriverChart, times: tuple[float, float], between: Callable[[float], Number]
) -> list[Passed]:
    """Return what passes through zero in a step, in the order of time."""
    found = [Passed(one, time, between(time)) for one in watched for time in _zeros(one, chart, times, between)]
    return sorted(found, key=lambda one: one.time)


def _zeros(
    watch: Watch, chart: DriverChart, times: tuple[float, float], between: Callable[[float], Number]
) -> Iterator[float]:
    """Yield the times at which a function passes through zero; the first where it is below all the time."""

    def value(time: float) -> float:
        return watch.value(chart, time, between(time))

    looks = np.linspace(*times, EVENT_SAMPLES + 1)
    known = [value(float(time)) for time in looks]
    if watch.falls and known[0] <= 0.0:
        early = times[0] + (times[1] - times[0]) * EARLY
        looks = np.concatenate([looks[:1], early, looks[1:]])
        known = [known[0], *(value(float(time)) for time in early), *known[1:]]
        if max(known) <= 0.0 > min(known):
            yield times[0]
    for low, high, first, last in zip(looks[:-1], looks[1:], known[:-1], known[1:], strict=True):
        if first > 0.0 >= last or (not watch.falls and first < 0.0 <= last):
            yield _zero(value, float(low), float(high))


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    fine = 1e-14 * max(abs(high), 1e-300)
    found, is_above = float(brentq(function, low, high, xtol=fine, rtol=1e-14)), function(low) > 0.0
    # the far side of a zero that is met: what is done there must not meet it again
    while found < high and (function(found) > 0.0) is is_above:
        found, fine = min(found + fine, high), 2.0 * fine
    return found


class Impact(NamedTuple):
    """An impact at an end of a guide. How fast it was met, the free drivers' speeds afterwards, the lost energy."""

    approach: float
    speeds: Number
    lost: float


def after_impact(here: SimulatedState, restitution: float, fastest: float) -> Impact | None:
    """Return what follows from an impact, `fastest` being the approach of the fastest before.

    None where what comes to the end hardly moves. The impulse acts along the coordinate that ends,
    M (v+ - v-) = n p with n . v+ = -e n . v-.

    Source: Newton's law of impact in generalized coordinates, D. T. Greenwood, Principles of Dynamics, section 4.8.
    """
    state, pair = here.state, ended_pair(here)
    n = len(state.chart.free)
    along, speeds = state.slopes(pair), state.speeds
    approach = float(along @ speeds)
    if abs(approach) <= SLOW * max(fastest, float(np.abs(along) @ np.abs(speeds))):
        return None
    push = np.linalg.solve(state.terms.matrix[:n, :n], along[:n])
    after = speeds.copy()
    after[:n] -= (1.0 + restitution) * approach / float(along[:n] @ push) * push
    matrix = state.terms.matrix
    return Impact(abs(approach), after[:n], float(speeds @ matrix @ speeds - after @ matrix @ after) / 2.0)
