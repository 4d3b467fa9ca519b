"""Events of a simulation: limit positions, travel limits of guides, lift-off, and a user's own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from typing import Any, ClassVar, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.undetermined import pressing_force
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.driver_state import KnownState, LoadedState, SimulatedState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable, tabulated_pressing
from compoundkin.dynamics.simulation.load_breaks import BreakPassed, LoadBreak, LoadPlace, first_break, load_places
from compoundkin.dynamics.simulation.phases import LANDED, OpenPair, pair_meant
from compoundkin.dynamics.simulation.stop_contacts import StopContact, contacts_of, holding, impact, margins
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.kinematics.solving_order import AT_END
from compoundkin.model.loads.attachments import effort
from compoundkin.model.loads.latch import Latch, Release, as_latch, as_release
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.pairs.travel_limits import as_travel_limited

# Each watched function is sampled at so many places of a step, so that double zeros are found as well.
EVENT_SAMPLES = 4
# A function that starts below zero is sampled at these parts of a step too: a bounce may be far shorter.
EARLY = 2.0 ** np.arange(-44.0, -2.0)
# An impact slower than this part of the fastest, or of the drivers' speeds, each by its scale, is the last one.
SLOW = 1e-6
# The name of the event at a travel limit.
END = "end"
# The name of the event at which a driver comes to rest, where friction changes its direction.
REST = "rest"
# The name of the event at which a pair slides the other way; it is not told.
REVERSES = "reverses"
# The names of the events at which a contact at a stop is hit, is closed for some time, and is left.
STOP, RESTS, LEAVES = "stop", "rests", "leaves"
# The names of the events of latches, the last one at the end.
CATCHES, OPENS, TOOTH, IDLE = "catches", "opens", "tooth", "idle"
# The names of the events at which a contact that has let go closes, or is left again at once.
LANDS, REBOUNDS = "lands", "rebounds"
# The name of the event where a load jumps.
JUMP = "jump"
# The name of the event where friction or a load holds a mechanism.
STICKS = "sticks"
Function = Callable[[SimulatedState], Any]


@dataclass(frozen=True)
class SimulationEvent:
    """An event: its time, its name, whether the simulation stopped there, and the energy `lost` in it."""

    time: float
    name: str
    text: str
    stops: bool
    lost: float = 0.0  # the energy lost in it
    loser: str = ""  # the stop or the pair that takes it

    def __repr__(self) -> str:
        return f"SimulationEvent({self.name!r} at {self.time:.6g} s: {self.text})"


@dataclass(frozen=True, eq=False)
class Watch:
    """A function of the state whose zeros are events.

    If it `falls`, only downward zeros count, or a negative value at the start. A user's own is `asked`.
    """

    name: str
    function: Function
    text: str
    stops: bool
    falls: bool = False
    asked: bool = False

    # so many places of a step are looked at
    samples: ClassVar[int] = EVENT_SAMPLES
    # and whether it may dip below zero between them
    has_dips: ClassVar[bool] = False

    def is_idle(self, chart: Chart) -> bool:
        """Return whether there is no zero in the last step of a chart for sure."""
        return False

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the function at a state. Raises InvalidInput where it returns no number."""
        n = len(chart.free)
        here = SimulatedState(chart.state(time, state[:n], state[n : 2 * n]), chart.order)
        try:
            returned = np.ravel(self.function(here))
            if self.asked and returned.size != 1:
                raise ValueError(f"it returns {returned.size} numbers")
            result = returned[0]
            if self.asked and (np.iscomplexobj(result) or np.isnan(result)):
                raise ValueError(f"it returns {result}")
            found = float(result)
        except CompoundkinError:
            raise
        except Exception as error:  # whatever a user's function does
            remedy = 'give a function of the state that passes through zero: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{self.name}", f"its function fails: {error}", remedy)) from error
        return found


class RestWatch(Watch):
    """The rest of a single driver."""

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return its speed, with several drivers a number that is never zero."""
        return float(state[1]) if isinstance(chart, FrictionTable) else 1.0


class SlidingWatch(Watch):
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
class LiftOffWatch(Watch):
    """A contact that lets go where nothing presses it any more."""

    pair: str = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the force that presses it."""
        return _pressing(self.pair, chart, time, state)

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


class BreakWatch(Watch):
    """Places of the driver at which loads in its table jump, wake or have corners."""

    def is_idle(self, chart: Chart) -> bool:
        """Return whether there are none."""
        return not (isinstance(chart, TabulatedChart) and chart.table is not None and chart.table.breaks)

    def passed(
        self, chart: Chart, times: tuple[float, float], between: Callable[[Number], Number]
    ) -> BreakPassed | None:
        """Return the first one that is passed in a step."""
        assert isinstance(chart, TabulatedChart)
        samples = np.linspace(*times, EVENT_SAMPLES + 1)
        return first_break(samples.tolist(), between(samples)[0].tolist(), lambda t: float(between(np.array(t))[0]),
                           chart.breaks)  # fmt: skip


@dataclass(frozen=True, eq=False)
class PlaceWatch(BreakWatch):
    """Places of a coordinate at which a load that is in no table jumps, wakes or has corners."""

    place: LoadPlace = field(kw_only=True)

    def is_idle(self, chart: Chart) -> bool:
        """Return whether the load acts no more."""
        return self.place.load.name not in chart.mechanism.loads

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the coordinate."""
        n = len(chart.free)
        return float(np.ravel(self.place.value(chart.seen(time, state[:n], state[n : 2 * n]).loaded))[0])

    def passed(
        self, chart: Chart, times: tuple[float, float], between: Callable[[Number], Number]
    ) -> BreakPassed | None:
        """Return the first one that is passed in a step."""
        n, samples = len(chart.free), np.linspace(*times, EVENT_SAMPLES + 1)
        states = between(samples)
        if isinstance(chart, TabulatedChart) and chart.has_in_table(self.place.load, states[0]):
            return None
        slope, offset = chart.straight(self.place) if isinstance(chart, TabulatedChart) else (0.0, 0.0)
        if slope:
            places = (slope * states[0] + offset).tolist()
        else:
            places = [self.value(chart, t, y) for t, y in zip(samples.tolist(), states.T, strict=True)]

        def place(time: float) -> float:
            y = between(np.array(time))
            return slope * float(y[0]) + offset if slope else self.value(chart, time, y)

        def begun() -> LoadedState:
            return chart.seen(times[0], states[:n, 0], states[n : 2 * n, 0]).loaded

        def breaks(low: float, high: float) -> Sequence[LoadBreak]:
            return self.place.breaks(low, high, chart.order.size, begun)

        return first_break(samples.tolist(), places, place, breaks)


class StopPassage(NamedTuple):
    """What happens at a stop or a latch: the event, the state behind it, and the speed of an impact."""

    event: SimulationEvent
    state: Number
    approach: float = 0.0
    released: Release | None = None  # the pair that comes apart
    landing: OpenPair | None = None  # the contact that closes


@dataclass(frozen=True, eq=False)
class StopWatch(Watch):
    """A contact at a stop, whose function falls to zero where it closes or, closed, where it opens."""

    contact: StopContact = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the gap of an open contact, the depth or the force of a closed one."""
        n, one = len(chart.free), self.contact
        if one.stop.is_elastic:
            seen = chart.seen(time, state[:n], state[n : 2 * n])
            return one.indentation(seen) * (1.0 if one in chart.closed else -1.0)
        if one not in chart.closed:
            return one.at(chart.seen(time, state[:n], state[n : 2 * n])).gap
        here = chart.state(time, state[:n], state[n : 2 * n])
        found = margins(chart.rigid, here, chart.pressing_rates(time, state[:n], state[n : 2 * n]))
        return float(found[chart.rigid.index(one)])

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Close or open the contact; return what happens there."""
        one, n = self.contact, len(chart.free)
        name = one.stop.name
        if one in chart.closed:
            chart.closed = tuple(other for other in chart.closed if other != one)
            return StopPassage(SimulationEvent(time, LEAVES, f"{name} is left", False, loser=name), state)
        if one.stop.is_elastic:
            chart.closed = (*chart.closed, one)
            return StopPassage(SimulationEvent(time, STOP, f"{name}: {one.text}", False, loser=name), state)
        here = one.at(chart.state(time, state[:n], state[n : 2 * n]))
        slow = SLOW * max(fastest, float(np.abs(here.normal[:n]) @ np.abs(state[n : 2 * n])))
        restitution = one.restitution if -here.rate > slow else 0.0
        after, lost = _met(chart, time, state, one, restitution)
        stays = one in chart.closed
        text = f"{name}: {one.text}" + (", where it stays" if stays else "")
        return StopPassage(
            SimulationEvent(time, RESTS if stays else STOP, text, False, lost, name), after, abs(here.rate)
        )


def _met(chart: Chart, time: float, state: Number, one: StopContact, restitution: float) -> tuple[Number, float]:
    """Close a rigid contact by an impact, unless it is left again; return the state after it and the lost energy."""
    n = len(chart.free)
    hit = impact(one, restitution, chart.rigid, chart.state(time, state[:n], state[n : 2 * n]))
    after = np.array([*state[:n], *hit.speeds, state[-1] - hit.lost])
    elastic = [other for other in chart.closed if other.stop.is_elastic]
    chart.closed = (*elastic, *hit.staying, *(() if restitution else (one,)))
    free = chart.pressing_rates(time, after[:n], after[n : 2 * n])
    here = chart.state(time, after[:n], after[n : 2 * n])
    while chart.rigid and np.min(found := margins(chart.rigid, here, free)) < 0.0:
        left = chart.rigid[int(np.argmin(found))]
        chart.closed = tuple(other for other in chart.closed if other != left)
    return after, hit.lost


@dataclass(frozen=True, eq=False)
class CatchWatch(Watch):
    """A latch that catches where its coordinate comes to a value."""

    contact: StopContact = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the distance of the coordinate."""
        n = len(chart.free)
        return self.contact.at(chart.state(time, state[:n], state[n : 2 * n])).gap

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Close the latch by an impact."""
        return self._caught(chart, time, state)

    def _caught(self, chart: Chart, time: float, state: Number) -> StopPassage:
        one, name = self.contact, self.contact.stop.name
        after, lost = _met(chart, time, state, one, 0.0)
        text = f"{name} catches {one.stop.pair} at {one.end:.6g}"
        return StopPassage(SimulationEvent(time, CATCHES, text, False, lost, name), after)


@dataclass(frozen=True, eq=False)
class ClutchWatch(CatchWatch):
    """A latch that catches at a time, wherever it is."""

    since: float = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the time that is left."""
        return self.since - time

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Close the latch where it is."""
        n = len(chart.free)
        here = chart.state(time, state[:n], state[n : 2 * n]).loaded.coordinate(self.contact.stop.pair)
        one = replace(self.contact, end=float(np.ravel(here.c[0])[0]))
        chart.stop_contacts = tuple(one if other is self.contact else other for other in chart.stop_contacts)
        return replace(self, contact=one)._caught(chart, time, state)


@dataclass(frozen=True, eq=False)
class ToothWatch(CatchWatch):
    """A ratchet whose coordinate passes the next tooth."""

    pitch: float = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the distance of the next tooth."""
        return abs(self.pitch) - super().value(chart, time, state)

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Let the ratchet hold at this tooth from now on."""
        one = self.contact
        tooth = replace(one, end=one.end + self.pitch)
        chart.stop_contacts = tuple(tooth if other == one else other for other in chart.stop_contacts)
        text = f"{one.stop.name} passes a tooth at {tooth.end:.6g}"
        return StopPassage(SimulationEvent(time, TOOTH, text, False), state)


Margin = Callable[[Chart, KnownState, Number], float]


@dataclass(frozen=True, eq=False)
class OpenWatch(Watch):
    """A closed latch or a pair, and a condition that opens it where it falls to zero or changes its sign."""

    item: Latch | Release = field(kw_only=True)
    margin: Margin = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the condition."""
        n = len(chart.free)
        return self.margin(chart, chart.state(time, state[:n], state[n : 2 * n]), state)

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Open the latch for good, or release the pair."""
        item = self.item
        chart.closed = tuple(one for one in chart.closed if one.stop is not item)
        chart.stop_contacts = tuple(one for one in chart.stop_contacts if one.stop is not item)
        event = SimulationEvent(time, OPENS, f"{item.name} opens: {self.text}", False)
        return StopPassage(event, state, released=as_release(item))


@dataclass(frozen=True, eq=False)
class LiftWatch(OpenWatch):
    """A contact that may let go and go on without it."""

    pair: str = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the force that presses it."""
        return _pressing(self.pair, chart, time, state)


@dataclass(frozen=True, eq=False)
class LandWatch(Watch):
    """A contact that has let go, and closes where both links meet."""

    landing: OpenPair = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the gap; while its links part it is above zero, also where rounding is as large."""
        n, least = len(chart.free), LANDED * chart.order.size
        gap, rate = self.landing.gap(chart.state(time, state[:n], state[n : 2 * n]))
        return max(gap + least, least) if rate > 0.0 else gap + least

    def passage(self, chart: Chart, time: float, state: Number, fastest: float) -> StopPassage:
        """Let the contact rebound, or close it where it is slow or has no restitution."""
        one, n, name = self.landing, len(chart.free), self.landing.pair.name
        here = chart.state(time, state[:n], state[n : 2 * n])
        at = one.at(here) if one.restitution else None
        if at is not None and -at.rate > SLOW * max(fastest, float(np.abs(at.normal) @ np.abs(here.speeds))):
            hit = impact(one, one.restitution, chart.rigid, here)
            after = np.array([*state[:n], *hit.speeds, state[-1] - hit.lost])
            elastic = [other for other in chart.closed if other.stop.is_elastic]
            chart.closed = (*elastic, *hit.staying)
            event = SimulationEvent(time, REBOUNDS, f"the contact at {name} rebounds", False, hit.lost, name)
            return StopPassage(event, after, abs(at.rate))
        event = SimulationEvent(time, LANDS, f"the contact at {name} closes", False, loser=name)
        return StopPassage(event, state, landing=one)


def stop_watches(chart: Chart) -> Iterator[ContactWatch]:
    """Yield the contacts at stops and in latches as watched functions."""
    for one in chart.stop_contacts:
        latch = as_latch(one.stop)
        if latch is None or latch.teeth is not None:
            yield StopWatch(STOP, _speed, one.text, False, True, contact=one)
        elif one not in chart.closed and latch.since is not None:
            since = float(np.ravel(latch.since)[0])
            yield ClutchWatch(CATCHES, _speed, one.text, False, True, contact=one, since=since)
        elif one not in chart.closed:
            yield CatchWatch(CATCHES, _speed, one.text, False, contact=one)
        else:
            yield from _opening(latch, partial(_latched, one))
        if latch is not None and latch.teeth is not None:
            pitch = float(np.ravel(latch.teeth)[0])
            yield ToothWatch(TOOTH, _speed, one.text, False, True, contact=one, pitch=pitch)
    for load in chart.mechanism.loads.values():
        release = as_release(load)
        if release is not None and release.opens:
            yield from _opening(release, partial(_joining, release))
        elif release is not None:
            name = pair_meant(chart, release.pair).name
            text = f"the contact at {name} lets go"
            yield LiftWatch(OPENS, _speed, text, False, True, item=release, margin=partial(_pressed, name), pair=name)
    for landing in (one for one in chart.open_pairs if one.contact is not None):
        yield LandWatch(LANDS, _speed, landing.pair.name, False, True, landing=landing)


def _latched(one: StopContact, chart: Chart, here: KnownState, state: Number) -> float:
    """Return the force with which a latch holds."""
    n = len(chart.free)
    free = chart.unheld_rates(here.time, state[:n], state[n : 2 * n])
    return abs(float(holding([other.at(here) for other in chart.rigid], here, free)[chart.rigid.index(one)]))


def _pressed(name: str, chart: Chart, here: KnownState, state: Number) -> float:
    """Return the normal force in a contact."""
    return pressing_force(_forces(chart, here, state), name)


def _forces(chart: Chart, here: KnownState, state: Number) -> Forces:
    """Return the forces at a state, with what stops and latches hold."""
    if not chart.closed:
        return force_analysis(here.motion)
    n, rigid = len(chart.free), chart.rigid
    motion = here.moved(chart.followed_rates(here.time, state[:n], state[n : 2 * n]).accelerations)
    if rigid:
        free = chart.unheld_rates(here.time, state[:n], state[n : 2 * n])
        forces = holding([one.at(here) for one in rigid], here, free)
        held = (effort(one.stop.pair, one.side * force, name=f"hold {k}")
                for k, (one, force) in enumerate(zip(rigid, forces.tolist(), strict=True)))  # fmt: skip
        mechanism = motion.mechanism.replace(*held)
        motion = replace(motion, structure=replace(motion.structure, mechanism=mechanism))
    return force_analysis(motion)


def _pressing(name: str, chart: Chart, time: float, state: Number) -> float:
    """Return the normal force in a contact, from a table where there is one."""
    n = len(chart.free)
    if isinstance(chart, TabulatedChart):
        found = tabulated_pressing(chart, name, time, *state[:2].tolist())
    else:
        found = chart.pressing(name, time, state[:n], state[n : 2 * n])
    if found is not None:
        return found
    return _pressed(name, chart, chart.state(time, state[:n], state[n : 2 * n]), state)


def _joining(release: Release, chart: Chart, here: KnownState, state: Number) -> float:
    """Return the force in a pair."""
    forces = _forces(chart, here, state)
    return float(np.abs(np.ravel(forces.pairs[pair_meant(chart, release.pair).name].wrench.force)[0]))


def _opening(item: Latch | Release, force: Margin) -> Iterator[OpenWatch]:
    """Yield the conditions under which a closed latch or a pair opens."""

    def number(value: Any) -> float:
        return float(np.ravel(value)[0])

    def until(chart: Chart, here: KnownState, state: Number) -> float:
        return number(item.until) - here.time

    def over(chart: Chart, here: KnownState, state: Number) -> float:
        return float(np.ravel(here.loaded.coordinate(item.over).c[0])[0]) - number(item.value)

    def holds(chart: Chart, here: KnownState, state: Number) -> float:
        return number(item.strength) - force(chart, here, state)

    if item.strength is not None:
        text = f"its force exceeds {number(item.strength):.6g}"
        yield OpenWatch(OPENS, _speed, text, False, True, item=item, margin=holds)
    if item.until is not None:
        yield OpenWatch(OPENS, _speed, "its time has come", False, True, item=item, margin=until)
    if item.over:
        text = f"{item.over} comes to {number(item.value):.6g}"
        yield OpenWatch(OPENS, _speed, text, False, item=item, margin=over)


ContactWatch = StopWatch | CatchWatch | OpenWatch | LandWatch


# A start beyond a rigid end by less than this part of the size, or of a radian, is at the end.
AT_STOP = 1e-9


def begin_at_stops(chart: Chart, state: Number) -> None:
    """Find the contacts at stops and in latches at the start, and close those that are.

    Raises InvalidInput for a start beyond a rigid stop, and for a latch that holds what moves.
    """
    n = len(chart.free)
    here = chart.state(0.0, state[:n], state[n : 2 * n])
    chart.stop_contacts = contacts_of(chart.mechanism.loads.values(), here)
    near = AT_STOP * max(chart.order.size, 1.0)
    for one in chart.stop_contacts:
        at = one.at(here)
        if one.stop.is_elastic:
            chart.closed += (one,) if one.indentation(here) > 0.0 else ()
        elif one.both and abs(at.gap) < near:
            if abs(at.rate) > SLOW * float(np.abs(at.normal) @ np.abs(here.speeds)):
                what = f"{one.stop.name} holds {one.stop.pair}, which starts with the speed {at.rate:.6g}"
                raise InvalidInput(Problem("start", what, "let it start at rest, or say where the latch catches"))
            chart.closed += (one,)
        elif not one.both and at.gap < -near:
            what = f"it is {one.stop.place_text(-at.gap)} beyond {one.stop.name}, {one.text}"
            raise InvalidInput(Problem("start", what, "start inside, or move the stop"))


def idle_latches(chart: Chart, time: float) -> Iterator[SimulationEvent]:
    """Yield what latches have not done until the end: not caught, or not opened."""
    for one in chart.stop_contacts:
        latch = as_latch(one.stop)
        if latch is None or latch.teeth is not None:
            continue
        if one not in chart.closed:
            missed = f"never is at {latch.place_text(one.end)}" if np.isfinite(one.end) else "goes on until the end"
            yield SimulationEvent(time, IDLE, f"{latch.name} has not caught: {latch.pair} {missed}", False)
        elif latch.opens:
            yield SimulationEvent(time, IDLE, f"{latch.name} has not opened", False)
    for load in chart.mechanism.loads.values():
        release = as_release(load)
        if release is not None and release.opens:
            yield SimulationEvent(time, IDLE, f"{load.name} has not opened", False)


@dataclass(frozen=True, eq=False)
class Passed:
    """A zero of a watched function, or a break of a load: its time, and the state there."""

    watch: Watch
    time: float
    state: Number
    at: LoadBreak | None = None


def watches(mechanism: Mechanism, events: Mapping[str, Any], stop: tuple[str, ...]) -> tuple[Watch, ...]:
    """Return the watched functions: travel limits, one-sided contacts, and a user's own."""
    for name, function in events.items():
        if not callable(function):
            remedy = 'give a function of the state: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{name}", f"{function!r} is no function", remedy))
    for name in stop:
        if name not in events:
            raise InvalidInput(Problem("stop", f"there is no event {name!r}", f"known: {', '.join(events) or 'none'}"))
    own = [Watch(name, function, "as asked for", name in stop, asked=True) for name, function in events.items()]
    places = load_places(mechanism.loads.values())
    text = "the loads jump"
    breaks = [
        BreakWatch(JUMP, _speed, text, False),
        *(PlaceWatch(JUMP, _speed, text, False, place=one) for one in places),
    ]
    return (*(FRICTIONS if mechanism.frictions else ()), *_of_pairs(mechanism), *own, *(breaks if places else ()))


def _speed(state: SimulatedState) -> float:
    return float(state.state.speeds[0])


# What is watched with friction.
FRICTIONS = (
    RestWatch(REST, _speed, "it comes to rest", False),
    SlidingWatch(REVERSES, _speed, "friction acts the other way", False),
    StickWatch(REVERSES, _speed, "friction changes", False, True),
)


def _of_pairs(mechanism: Mechanism) -> Iterator[Watch]:
    if any(as_travel_limited(pair) is not None for pair in mechanism.written_pairs):
        yield Watch(END, _to_end, "a guide ends", True, True)
    released = {one.pair for item in mechanism.loads.values() if (one := as_release(item)) is not None}
    for pair in (one for one in mechanism.written_pairs if one.name not in released):
        contact = as_profile_contact(pair)
        # in a groove the roller changes to the other flank
        if contact is not None and not contact.has_ends:
            text = f"the contact at {pair.name} lets go"
            yield LiftOffWatch(f"{pair.name} lift-off", _speed, text, True, True, pair=pair.name)


def _to_end(state: SimulatedState) -> float:
    # the margin is zero where the limit is just reached
    return float(np.ravel(state.order.guide_ends.margin(state.block))[-1]) - AT_END


def ended_pair(state: SimulatedState) -> Pair:
    """Return the pair nearest to a travel limit."""
    ends = state.order.guide_ends
    return ends.pairs[int(np.ravel(ends.nearest(state.block))[-1])]


def first_passed(
    watched: tuple[Watch, ...], chart: Chart, times: tuple[float, float], between: Callable[[Number], Number],
    by_ends: Callable[[Number], Number],
) -> list[Passed]:  # fmt: skip
    """Return the zeros and the breaks in a step, in the order of time.

    `between` are the states in the step, and `by_ends` those by both ends alone: a pulse that the step has not met may
    be in the former.
    """
    asked = [one for one in watched if not one.is_idle(chart)]
    found = list[Passed]()
    for one in asked:
        if isinstance(one, BreakWatch):
            if (passed := one.passed(chart, times, by_ends)) is not None:
                found.append(Passed(one, passed.time, between(np.array(passed.time)), passed.at))
        else:
            zeros = _zeros(one, chart, times, between)
            # all but a user's own interrupt the step, so that later zeros are none
            wanted = zeros if one.asked else islice(zeros, 1)
            found += [Passed(one, time, between(np.array(time))) for time in wanted]
    return sorted(found, key=lambda one: one.time)


def _zeros(
    watch: Watch, chart: Chart, times: tuple[float, float], between: Callable[[Number], Number]
) -> Iterator[float]:
    """Yield the times of zeros; the first time where the function is negative throughout."""

    def value(time: float) -> float:
        return watch.value(chart, time, between(np.array(time)))

    samples = np.linspace(*times, watch.samples + 1)
    known = [value(float(time)) for time in samples]
    if watch.falls and known[0] <= 0.0:
        early = times[0] + (times[1] - times[0]) * EARLY
        samples = np.concatenate([samples[:1], early, samples[1:]])
        known = [known[0], *(value(float(time)) for time in early), *known[1:]]
        if max(known) <= 0.0 > min(known):
            yield times[0]
    if watch.has_dips:
        for time in list(_dips(samples, known)):
            at = int(np.searchsorted(samples, time))
            samples, known = np.insert(samples, at, time), [*known[:at], value(time), *known[at:]]
    for low, high, first, last in zip(samples[:-1], samples[1:], known[:-1], known[1:], strict=True):
        if first > 0.0 >= last or (not watch.falls and first < 0.0 <= last):
            yield _zero(value, float(low), float(high))


def _dips(samples: Number, known: Sequence[float]) -> Iterator[float]:
    """Yield the vertices of the parabolas through three values whose middle one is the least."""
    for k in range(1, len(known) - 1):
        fall, rise = known[k - 1] - known[k], known[k + 1] - known[k]
        if known[k] > 0.0 and fall > 0.0 and rise > 0.0:
            yield float(samples[k] + 0.5 * (samples[k + 1] - samples[k]) * (fall - rise) / (fall + rise))


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    fine = 1e-14 * max(abs(high), 1e-300)
    found, is_above = float(brentq(function, low, high, xtol=fine, rtol=1e-14)), function(low) > 0.0
    # the far side of the zero, so that the continuation does not meet it again
    while found < high and (function(found) > 0.0) is is_above:
        found, fine = min(found + fine, high), 2.0 * fine
    return found


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
