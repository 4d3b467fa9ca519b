"""Contacts at stops and in latches, and pairs that come apart, as watched functions: how each closes and opens."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.undetermined import pressing_force
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.driver_state import KnownState
from compoundkin.dynamics.simulation.normal_force_table import tabulated_pressing
from compoundkin.dynamics.simulation.phases import LANDED, OpenPair, pair_meant
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent, ZeroWatch
from compoundkin.dynamics.simulation.stop_contacts import StopContact, contacts_of, holding, impact, margins
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.model.loads.attachments import effort
from compoundkin.model.loads.latch import Latch, Release, as_latch, as_release

# An impact slower than this part of the fastest, or of the drivers' speeds, each by its scale, is the last one.
SLOW = 1e-6
# The names of the events at which a contact at a stop is hit, is closed for some time, and is left.
STOP, RESTS, LEAVES = "stop", "rests", "leaves"
# The names of the events of latches, the last one at the end.
CATCHES, OPENS, TOOTH, IDLE = "catches", "opens", "tooth", "idle"
# The names of the events at which a contact that has let go closes, or is left again at once.
LANDS, REBOUNDS = "lands", "rebounds"


class StopPassage(NamedTuple):
    """What happens at a stop or a latch: the event, the state behind it, and the speed of an impact."""

    event: SimulationEvent
    state: Number
    approach: float = 0.0
    released: Release | None = None  # the pair that comes apart
    landing: OpenPair | None = None  # the contact that closes


@dataclass(frozen=True, eq=False)
class StopWatch(ZeroWatch):
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
class CatchWatch(ZeroWatch):
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
class OpenWatch(ZeroWatch):
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
        return pressing(self.pair, chart, time, state)


@dataclass(frozen=True, eq=False)
class LandWatch(ZeroWatch):
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
            yield StopWatch(STOP, one.text, False, True, contact=one)
        elif one not in chart.closed and latch.since is not None:
            since = float(np.ravel(latch.since)[0])
            yield ClutchWatch(CATCHES, one.text, False, True, contact=one, since=since)
        elif one not in chart.closed:
            yield CatchWatch(CATCHES, one.text, False, contact=one)
        else:
            yield from _opening(latch, partial(_latched, one))
        if latch is not None and latch.teeth is not None:
            pitch = float(np.ravel(latch.teeth)[0])
            yield ToothWatch(TOOTH, one.text, False, True, contact=one, pitch=pitch)
    for load in chart.mechanism.loads.values():
        release = as_release(load)
        if release is not None and release.opens:
            yield from _opening(release, partial(_joining, release))
        elif release is not None:
            name = pair_meant(chart, release.pair).name
            text = f"the contact at {name} lets go"
            yield LiftWatch(OPENS, text, False, True, item=release, margin=partial(solved_pressing, name), pair=name)
    for landing in (one for one in chart.open_pairs if one.contact is not None):
        yield LandWatch(LANDS, landing.pair.name, False, True, landing=landing)


def _latched(one: StopContact, chart: Chart, here: KnownState, state: Number) -> float:
    """Return the force with which a latch holds."""
    n = len(chart.free)
    free = chart.unheld_rates(here.time, state[:n], state[n : 2 * n])
    return abs(float(holding([other.at(here) for other in chart.rigid], here, free)[chart.rigid.index(one)]))


def solved_pressing(name: str, chart: Chart, here: KnownState, state: Number) -> float:
    """Return the normal force in a contact, by the forces at the state."""
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


def pressing(name: str, chart: Chart, time: float, state: Number) -> float:
    """Return the normal force in a contact, from a table where there is one."""
    n = len(chart.free)
    if isinstance(chart, TabulatedChart):
        found = tabulated_pressing(chart, name, time, *state[:2].tolist())
    else:
        found = chart.pressing(name, time, state[:n], state[n : 2 * n])
    if found is not None:
        return found
    return solved_pressing(name, chart, chart.state(time, state[:n], state[n : 2 * n]), state)


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
        yield OpenWatch(OPENS, text, False, True, item=item, margin=holds)
    if item.until is not None:
        yield OpenWatch(OPENS, "its time has come", False, True, item=item, margin=until)
    if item.over:
        text = f"{item.over} comes to {number(item.value):.6g}"
        yield OpenWatch(OPENS, text, False, item=item, margin=over)


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
