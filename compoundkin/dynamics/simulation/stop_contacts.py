"""Contacts at stops and in latches: the force that holds a coordinate, the push of an elastic end, and impacts.

Source: F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996, sections 5 and 8.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.simulation.driver_state import KnownState, PushedState, Rates, SeenState
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.latch import Latch, as_latch, as_release
from compoundkin.model.loads.stop import HIGH, LOW, Stop, as_stop

# A rigid end holds a coordinate while it pushes more than minus this part of what acts there: rounding does not decide.
ROUNDING = 1e-11


class ContactState(NamedTuple):
    """The gap of a contact, its rate, its derivatives by the drivers, and its acceleration at none of theirs."""

    gap: float
    rate: float
    normal: Number
    bias: float


@dataclass(frozen=True)
class StopContact:
    """One end of a stop, or a latch: its side, LOW or HIGH, and its coordinate. A latch holds to `both` sides."""

    stop: Stop | Latch
    side: float
    end: float
    both: bool = False

    @property
    def text(self) -> str:
        """The coordinate and its end, in words."""
        return f"{self.stop.pair} at its {'low' if self.side == LOW else 'high'} end {self.stop.place_text(self.end)}"

    @property
    def restitution(self) -> float:
        """The part of the speed with which it is left."""
        stop = as_stop(self.stop)
        return 0.0 if stop is None or stop.restitution is None else float(np.ravel(stop.restitution)[0])

    @property
    def elastic(self) -> Stop:
        """Its stop, which is elastic."""
        found = as_stop(self.stop)
        assert found is not None
        return found

    def at(self, state: SeenState) -> ContactState:
        """Return its gap and the derivatives of that at a state."""
        slopes, bias = state.loaded.rates_of(self.stop.pair)
        gap = self.side * (float(np.ravel(state.loaded.coordinate(self.stop.pair).c[0])[0]) - self.end)
        normal = self.side * slopes
        return ContactState(gap, float(normal @ state.speeds), normal, self.side * bias)

    def push(self, state: SeenState) -> float:
        """Return the force of an elastic end at a state, negative where it would have to pull."""
        series = state.loaded.coordinate(self.stop.pair)
        depth = self.elastic.depth(self.side, self.end, series, state.loaded)
        return float(np.ravel(self.elastic.push(self.side, depth, series, state.loaded))[0])

    def indentation(self, state: SeenState) -> float:
        """Return the depth in an elastic end, negative where it does not push."""
        stiffness = float(np.ravel(state.loaded.fitted(self.elastic.stiffness))[0])
        return min(-self.at(state).gap, self.push(state) / stiffness)

    def stored(self, state: KnownState) -> float:
        """Return the energy of an elastic end by its depth."""
        gap = self.at(state).gap
        return float(np.ravel(state.loaded.fitted(self.elastic.stiffness))[0]) * gap * gap / 2.0

    def damping_power(self, state: KnownState) -> float:
        """Return the power that the damping of an elastic end takes."""
        rate = self.at(state).rate
        return float(np.ravel(state.loaded.fitted(self.elastic.damping))[0]) * rate * rate


def is_no_contact(load: Load) -> bool:
    """Return whether a load is neither a stop nor a latch nor a release."""
    return as_stop(load) is None and as_latch(load) is None and as_release(load) is None


def contacts_of(loads: Iterable[Load], state: KnownState) -> tuple[StopContact, ...]:
    """Return the contacts at stops and in latches, with their coordinates for a design.

    A latch that does not catch, and a ratchet, hold where they are.
    """
    found: list[StopContact] = []

    def number(value: Number | None, where: str) -> float:
        return float(np.ravel(state.loaded.fitted(value, where))[0])

    for load in loads:
        stop, latch = as_stop(load), as_latch(load)
        if stop is not None:
            found += [StopContact(stop, side, number(end, stop.where)) for side, end in stop.ends]
        elif latch is not None:
            here = float(np.ravel(state.loaded.coordinate(latch.pair).c[0])[0])
            side = LOW if latch.teeth is None or number(latch.teeth, latch.where) > 0.0 else HIGH
            # one that catches at a time does so where it is then
            start = here if latch.since is None else np.nan
            end = start if latch.at is None else number(latch.at, latch.where)
            found.append(StopContact(latch, side, end, latch.teeth is None))
    return tuple(found)


def rates_under(contacts: Sequence[StopContact], state: PushedState, free: Rates) -> Rates:
    """Return the rates under contacts at stops, from `free`, those without them."""
    found = sprung(contacts, state, free)
    rigid = [one.at(state) for one in contacts if not one.stop.is_elastic]
    if rigid:
        normals = np.array([one.normal for one in rigid])
        found = _pushed(state, found, holding(rigid, state, found) @ normals, 0.0)
        if normals.shape == (1, 1) and normals[0, 0] != 0.0:
            # what is held exactly stays so
            found = found._replace(accelerations=np.array([0.0 - rigid[0].bias / normals[0, 0]]))
    return found


def sprung(contacts: Sequence[StopContact], state: PushedState, free: Rates) -> Rates:
    """Return the rates under the elastic contacts alone."""
    found = free
    for one in (one for one in contacts if one.stop.is_elastic):
        here, push = one.at(state), one.push(state)
        found = _pushed(state, found, here.normal * push, push * here.rate if one.elastic.is_damped else 0.0)
    return found


def _pushed(state: PushedState, free: Rates, push: Number, power: float) -> Rates:
    """Return the rates with a further force along the drivers' coordinates, and its power."""
    more = state.response(push)
    # prescribed drivers take their part
    driven = float(state.speeds @ (state.terms.matrix @ more - push))
    return Rates(free.accelerations + more[: len(free.accelerations)], free.power + power + driven)


def holding(contacts: Sequence[ContactState], state: PushedState, free: Rates) -> Number:
    """Return the forces that hold gaps at rest."""
    normals = np.array([one.normal for one in contacts])
    return -np.linalg.lstsq(_compliance(normals, state), _closing(contacts, state, free), rcond=None)[0]


def _closing(contacts: Sequence[ContactState], state: PushedState, free: Rates) -> Number:
    """Return the accelerations of gaps."""
    whole = np.concatenate([free.accelerations, state.prescribed])
    return np.array([float(one.normal @ whole) + one.bias for one in contacts])


def _compliance(normals: Number, state: PushedState) -> Number:
    """Return the accelerations of gaps by unit forces at them."""
    found: Number = normals @ np.array([state.response(one) for one in normals]).T
    return found


def margins(contacts: Sequence[StopContact], state: KnownState, free: Rates) -> Number:
    """Return by how much each rigid contact is pressed, negative where it is left; a latch never is."""
    here = [one.at(state) for one in contacts]
    forces = holding(here, state, free)
    n = len(free.accelerations)
    size = np.abs(np.array([one.normal for one in here])[:, :n]) @ np.abs(free.accelerations)
    # at rest without loads nothing presses and nothing parts them
    sizes = size / np.maximum(np.diag(_compliance(np.array([one.normal for one in here]), state)), 1e-300)
    return np.where([one.both for one in contacts], np.inf, forces + ROUNDING * sizes)


class StopImpact(NamedTuple):
    """The speeds of the free drivers after an impact, the lost energy, and the rigid contacts that stay."""

    speeds: Number
    lost: float
    staying: tuple[StopContact, ...]


class MeetingGap(Protocol):
    """A contact at a stop, or of a pair, with a gap."""

    def at(self, state: KnownState) -> ContactState:
        """Return the gap at a state."""


def impact(hit: MeetingGap, restitution: float, staying: Sequence[StopContact], state: KnownState) -> StopImpact:
    """Return the result of an impact at one contact while others are closed.

    M (v+ - v-) = N p with n . v+ = -e n . v- at the one, n . v+ = 0 and p > 0 at those that stay.

    Source: Newton's law of impact in generalized coordinates, D. T. Greenwood, Principles of Dynamics, section 4.8.
    """
    n, matrix, before = len(state.chart.free), state.terms.matrix, state.speeds
    kept = list(staying)
    while True:
        here = [hit.at(state), *(one.at(state) for one in kept)]
        normals = np.array([one.normal for one in here])
        change = np.array([(1.0 + restitution) * here[0].rate, *(one.rate for one in here[1:])])
        impulses = -np.linalg.lstsq(_compliance(normals, state), change, rcond=None)[0]
        parted = [one for one, impulse in zip(kept, impulses[1:], strict=True)
                  if not one.both and impulse < -ROUNDING * abs(impulses[0])]  # fmt: skip
        if not parted:
            break
        kept.remove(parted[0])
    after = before + state.response(normals.T @ impulses)
    return StopImpact(after[:n], float(before @ matrix @ before - after @ matrix @ after) / 2.0, tuple(kept))
