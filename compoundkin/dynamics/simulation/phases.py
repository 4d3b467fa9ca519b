"""Phases of a simulation: what a mechanism is without a pair, and the state with which it goes on.

The links, their masses and the loads stay; the pair and a driver of it go, and drivers of the freed coordinates come.
Where speeds cannot go on as they are, they jump by the impulse in the new pairs.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass, replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.errors import CompoundkinError, FewDigits, InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.mass_motion import MovingMass, moving_masses
from compoundkin.dynamics.simulation.body_chart import BodyChart
from compoundkin.dynamics.simulation.coordinate_change import Chart, as_driven, chart_of, integrable
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import KnownState, LinearAngle, pair_named
from compoundkin.dynamics.simulation.stop_contacts import ContactState, StopContact
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.motion import Motion
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode
from compoundkin.model.fields import Item, point_fields
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law, constant_speed
from compoundkin.model.loads.attachments import PairLoad, PairProperty
from compoundkin.model.loads.latch import Release
from compoundkin.model.mechanism import Mechanism, available_outputs
from compoundkin.model.pairs import Pair, pairs_among
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.model.pairs.prismatic import slide
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact
from compoundkin.structure import decompose


@dataclass(frozen=True, eq=False)
class SimulationPhase:
    """A part of a simulation with the same pairs: its first and last time, its mechanism, and its motion in time."""

    first: float
    last: float
    motion: Motion

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism, whose drivers have laws through the motion."""
        return self.motion.mechanism


@dataclass(frozen=True, eq=False)
class PhaseStart:
    """The chart of a phase, its first state, and the energy lost at its beginning."""

    chart: Chart
    state: Number
    lost: float


class _Begun(NamedTuple):
    """The chart of a phase by its drivers, their values and speeds, and the energy lost."""

    chart: DriverChart
    state: Number
    lost: float


@dataclass(frozen=True)
class _Parted:
    """A mechanism that has come apart, without drivers of what is free, its laws, and the poses of its links."""

    mechanism: Mechanism
    laws: Mapping[str, Law]
    poses: Mapping[str, Pose]

    def without(self, pair: Pair, masses: Sequence[MovingMass], driven: str) -> _Parted:
        """Return it without a pair, whose driver is `driven`, if it has one."""
        items = opened_items(self.mechanism, pair)
        items = [item for item in items if not (isinstance(item, Drive) and item.name == driven)]
        laws = {name: law for name, law in self.laws.items() if name != driven}
        poses, floating = self.poses, _floating(self.mechanism, items, pair)
        if floating:
            more, carried = _carriage(self.mechanism, items, masses, floating, poses)
            body = more[0]
            items = [body if isinstance(item, Link) and item.name == carried.name else item for item in items]
            items, poses = [*items, *more[1:]], {**poses, **carried.poses}
        return _Parted(with_items(self.mechanism, items), laws, poses)

    def begun(self, state: KnownState) -> _Begun | None:
        """Return the phase that begins with it at a state; None where no drivers of pairs are coordinates of it."""
        known = _driven_values(state)
        for added in _choices(self.mechanism):
            try:
                items = [*self.mechanism.items, *added]
                return _begun(with_items(self.mechanism, items), state, self.poses, self.laws, known)
            except CompoundkinError:
                continue
        return None


def without_pair(state: KnownState, opened: Release, work: float) -> PhaseStart:
    """Return the phase that follows where a pair comes apart. Raises InvalidInput where it cannot go on.

    Loads along the pair end there, and what its springs have stored is lost.
    """
    chart: Chart = state.chart
    pair = pair_meant(chart, opened.pair)
    driven = chart.start.structure.driven
    dropped = next((name for name, own in driven.items() if own.pair.name == pair.name), "")
    whole = _Parted(chart.mechanism, chart.laws, _poses(state))
    parted = whole.without(pair, moving_masses(chart.start.structure), dropped)
    found = parted.begun(state)
    if found is None:
        what = f"without {pair.name} its links move by coordinates that no driver of a pair can have"
        raise InvalidInput(Problem(opened.where, what, "stop the simulation there"))
    kept = tuple(one for one in chart.stop_contacts if pair_meant(chart, one.stop.pair).name != pair.name)
    opening = OpenPair(pair, opened.restitution_of_landing, chart.mechanism, chart.laws, dropped)
    stored = _stored_along(state, pair)
    begun = _continued(found, state, work - stored, kept, (*chart.open_pairs, opening))
    return replace(begun, lost=stored)


def _poses(state: KnownState) -> dict[str, Pose]:
    """Return the poses of all links with their true rates."""
    return {name: _true(pose) for name, pose in state.block.world.items()}


def _stored_along(state: KnownState, pair: Pair) -> float:
    """Return the energy that springs along a pair have stored."""
    mechanism, total = state.chart.mechanism, 0.0
    for load in mechanism.loads.values():
        energy = load.energy(state.loaded) if _is_of(mechanism, load, pair) else None
        total += 0.0 if energy is None else float(np.ravel(energy)[0])
    return total


# A contact lands where its gap is below minus this part of the size: at the lift-off it is zero but for rounding.
LANDED = 1e-12


@dataclass(frozen=True, eq=False)
class OpenPair:
    """A pair that has come apart, and the mechanism before with its laws, and the driver that it had.

    A contact closes again, after rebounds with the part `restitution` of the speed.
    """

    pair: Pair
    restitution: float
    mechanism: Mechanism
    laws: Mapping[str, Law]
    driven: str

    @property
    def contact(self) -> ProfileContact | None:
        """It as a contact that may close again, or None."""
        return as_profile_contact(self.pair)

    def at(self, state: KnownState) -> ContactState:
        """Return the gap of the contact, its rate, and the rate at unit speed of each free coordinate."""
        chart, n = state.chart, len(state.chart.free)
        values, none = state.values[:n], np.zeros(n)
        gap, rate = self.gap(state)
        rest = self.gap(chart.state(state.time, values, none))[1]
        normal = np.zeros(len(state.speeds))
        for k in range(n):
            unit = none.copy()
            unit[k] = 1.0
            normal[k] = self.gap(chart.state(state.time, values, unit))[1] - rest
        return ContactState(gap, rate, normal, 0.0)

    def gap(self, state: KnownState) -> tuple[float, float]:
        """Return the distance of its two links, and its rate."""
        assert self.contact is not None
        poses = tuple(_true(state.block.world[name]) for name in self.pair.members)
        gap = self.contact.touch(self.pair.ends(self.mechanism.geometry), poses).gap
        return float(np.ravel(gap.c[0])[0]), float(np.ravel(gap.c[1])[0]) if len(gap.c) > 1 else 0.0


def landed(state: KnownState, landing: OpenPair, work: float) -> PhaseStart:
    """Return the phase that follows where a contact closes again, while what came apart after it stays open.

    Raises InvalidInput where it cannot go on.
    """
    chart: Chart = state.chart
    at = chart.open_pairs.index(landing)
    before, after = chart.open_pairs[:at], chart.open_pairs[at + 1 :]
    parted, opened = _Parted(landing.mechanism, landing.laws, _poses(state)), list[OpenPair]()
    for one in after:
        opened.append(replace(one, mechanism=parted.mechanism, laws=parted.laws))
        parted = parted.without(one.pair, moving_masses(chart.start.structure), one.driven)
    found = parted.begun(state)
    if found is None:
        what = f"when {landing.pair.name} closes its links move by coordinates that no driver of a pair can have"
        raise InvalidInput(Problem(landing.pair.name, what, "stop the simulation there"))
    return _continued(found, state, work, chart.stop_contacts, (*before, *opened))


def _driven_values(state: KnownState) -> dict[tuple[str, str], float]:
    """Return the values of all drivers at a state, with their turns, by their names and those of their pairs."""
    driven, given = state.chart.start.structure.driven, state.motion.inputs.drives
    return {(name, own.pair.name): float(np.ravel(given[name][0])[0]) for name, own in driven.items()}


def _continued(
    begun: _Begun,
    state: KnownState,
    work: float,
    stop_contacts: tuple[StopContact, ...],
    open_pairs: tuple[OpenPair, ...],
) -> PhaseStart:
    """Return the start of a phase in the coordinates in which it is integrated, with what goes on from the last."""
    chart = begun.chart
    chart.phase, chart.open_pairs = state.chart.phase + 1, open_pairs
    chart.stop_contacts = stop_contacts
    chart.closed = tuple(one for one in state.chart.closed if one in stop_contacts)
    driven = [own.pair.name for own in state.chart.start.structure.driven.values() if own.pair.free_is_angle]
    angles = {name: _angle(state, chart, name) for name in (*state.chart.turned, *driven) if name in chart.order.pairs}
    none = np.zeros(len(chart.names))
    chart.turned |= {name: LinearAngle(angle, None, none) for name, angle in angles.items()}
    found, first = integrable(chart, state.time, np.append(begun.state, work - begun.lost))
    if isinstance(found, BodyChart):
        found.turned |= angles
    return PhaseStart(found, first, begun.lost)


def _angle(state: KnownState, chart: DriverChart, name: str) -> float:
    """Return an angle of a pair with its turns, in the sense of the pair in another chart."""
    here, there = pair_named(state.chart.start, name), pair_named(chart.start, name)
    angle, _ = state.loaded.counted_angle(here)
    return angle if here.members == there.members else -angle


def pair_meant(chart: Chart, name: str) -> Pair:
    """Return the pair of a structure that a name means."""
    meant = chart.mechanism.names.coordinate(name)
    assert meant is not None
    for own in chart.start.structure.pairs:
        if own.letters == meant.letters and set(own.members) == set(meant.members) and own.title == meant.title:
            return own
    return meant


def opened_items(mechanism: Mechanism, pair: Pair) -> list[Item]:
    """Return the items without a pair: a written one is left out, at a pin the second link gets a point of its own."""
    gone = (Mode, Expectation)
    items = [item for item in mechanism.items if not isinstance(item, gone) and not _is_of(mechanism, item, pair)]
    written = [one for one in pairs_among(items) if one.name == pair.name]
    if written:
        return [item for item in items if item not in written]
    leaver = next(name for name in reversed(pair.members) if name != FRAME)
    old, new = pair.letters[0], f"{pair.letters[0]} on {leaver}"
    return [_renamed_point(item, leaver, old, new) for item in items]


def _is_of(mechanism: Mechanism, item: Item, pair: Pair) -> bool:
    """Whether an item is a load or property of a pair that opens."""
    if not isinstance(item, PairLoad | PairProperty):
        return False
    meant = mechanism.names.coordinate(item.pair)
    return meant is not None and meant.letters == pair.letters and set(meant.members) == set(pair.members)


def _renamed_point(item: Item, link: str, old: str, new: str) -> Item:
    """Return an item with another letter for a point of a link."""
    if isinstance(item, Link):
        points = {new if letter == old else letter: place for letter, place in item.points.items()}
        return replace(item, points=points) if item.name == link else item
    if isinstance(item, Drawn):
        return replace(item, points={**item.points, new: item.points[old]}) if old in item.points else item
    if not is_dataclass(item):
        return item
    owners = {key: getattr(item, of) for key, of in point_fields(type(item)).items()}
    found: dict[str, Any] = {key: new for key, owner in owners.items()
                             if isinstance(at := getattr(item, key), str) and (at, owner) == (old, link)}  # fmt: skip
    changed: Item = replace(item, **found)
    return changed


def with_items(mechanism: Mechanism, items: Sequence[Item]) -> Mechanism:
    """Return a mechanism of other items."""
    outputs = available_outputs(mechanism, [item.name for item in items if isinstance(item, Drive)])
    kept = {pair.name for pair in pairs_among(items)}
    gone = {pair.name for pair in mechanism.written_pairs} - kept
    known = {letter for item in items if isinstance(item, Link) for letter in item.points}
    outputs = [name for name in outputs if name.split(".")[0] in known or "." in name]
    outputs = [name for name in outputs if name.split("(")[0].split(".")[0] not in gone]
    return Mechanism(mechanism.title, *items, **mechanism.unit_words, outputs=outputs, source=mechanism.source)


def _floating(mechanism: Mechanism, items: Sequence[Item], opened: Pair) -> list[str]:
    """Return the links that no pair joins to the frame any more."""
    letters = {item.name: set(item.points) for item in items if isinstance(item, Link)}
    pairs = [set(pair.members) for pair in mechanism.written_pairs if pair.name != opened.name]
    pins = [{one, two} for one, two in combinations(letters, 2) if letters[one] & letters[two]]
    reached = {FRAME}
    while more := {name for pair in (*pairs, *pins) if reached & pair for name in pair} - reached:
        reached |= more
    return [name for name in mechanism.links if name not in reached]


@dataclass(frozen=True)
class _FreeLink:
    """A free link, and the poses of the two links that carry it."""

    name: str
    poses: Mapping[str, Pose]


def _carriage(
    mechanism: Mechanism,
    items: Sequence[Item],
    masses: Sequence[MovingMass],
    floating: Sequence[str],
    poses: Mapping[str, Pose],
) -> tuple[list[Item], _FreeLink]:
    """Return two slides and a pin at the mass centre for a free link, and their drivers: x, y and the angle.

    The heaviest of the links is carried.
    """
    own = max((mass for mass in masses if mass.link in floating), key=lambda mass: mass.mass, default=None)
    if own is None:
        what = f"{', '.join(floating)} flies freely, without a mass"
        raise InvalidInput(Problem("masses", what, "give it a mass"))
    name = own.link
    across, upward, foot, centre = f"{name} along x", f"{name} along y", f"{name} foot", f"{name} centre"
    origin = next(iter(mechanism.links[FRAME].points))
    place = poses[name].at(own.centre)
    start = complex(mechanism.geometry.points[FRAME][origin])
    foot_pose = Series((place.c[0].real + 1j * start.imag, place.c[1].real + 0j))
    one, still = 1.0 + 0j, Series((1.0 + 0j, 0j))
    carried = {across: Pose(foot_pose, still), upward: Pose(place, still)}
    body = next(item for item in items if isinstance(item, Link) and item.name == name)
    angle = name if name not in {item.name for item in items if isinstance(item, Drive)} else f"{name} angle"
    more: list[Item] = [
        replace(body, points={**body.points, centre: own.centre}),
        Link(across, {foot: 0.0 * one}),
        Link(upward, {centre: 0.0 * one}),
        slide(across, on=FRAME, at=foot, through=origin, angle=0.0, offset=0.0, turn=0.0),
        slide(upward, on=across, at=centre, through=foot, angle=np.pi / 2, offset=0.0, turn=-np.pi / 2),
        Drive(across, across),
        Drive(upward, upward, across),
        Drive(angle, name, upward),
    ]
    return more, _FreeLink(name, carried)


# Pairs of which drivers are chosen, at the most, and choices that are tried.
MOST_PAIRS, MOST_CHOICES = 12, 200


def _choices(mechanism: Mechanism) -> Iterator[list[Drive]]:
    """Yield the drivers by which a mechanism with freed coordinates may be driven."""
    structure = decompose(mechanism)
    count = structure.mobility.freedoms - len(mechanism.drives)
    taken = {drive.name for drive in mechanism.drives}
    driven = {own.pair.name for own in structure.driven.values()}
    able = [pair for pair in structure.pairs if as_drivable(pair) and pair.name not in driven][:MOST_PAIRS]
    for some in list(combinations(able, count))[:MOST_CHOICES] if count >= 0 else ():
        names, added = set(taken), list[Drive]()
        for pair in some:
            added.append(_driver(pair, names))
            names.add(added[-1].name)
        yield added


def _driver(pair: Pair, taken: set[str]) -> Drive:
    first, second = pair.members
    name = next(one for one in (second, f"{second} on {first}", f"{pair.name} driven") if one not in taken)
    return Drive(name, second, first)


def _begun(
    mechanism: Mechanism,
    state: KnownState,
    poses: Mapping[str, Pose],
    laws: Mapping[str, Law],
    known: Mapping[tuple[str, str], float],
) -> _Begun:
    """Return the chart of the next mechanism in the poses of a state, and its speeds."""
    structure = decompose(mechanism)
    if structure.faults:
        raise InvalidInput(Problem("drives", structure.faults[0].text))
    values, rates = dict[str, float](), dict[str, float]()
    for name, own in structure.driven.items():
        series = own.pair.coordinate(own.pair.ends(mechanism.geometry), tuple(poses[one] for one in own.pair.members))
        sense = float(as_driven(own.pair).driven_by(own.drive.link))
        values[name] = known.get((name, own.pair.name), float(np.ravel(series.c[0])[0]) * sense)
        rates[name] = float(np.ravel(series.c[1])[0]) * sense if len(series.c) > 1 else 0.0
    here = Configuration(structure, values, placed_at(poses, (0, 0)), {}, {}, dimensions_at(structure, 0, 0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FewDigits)
        start = solve(mechanism, {one: [value] for one, value in values.items()}, order=1, modes=here)
    if start.failed.any() or not start.regular.all() or not _has_poses(start, poses):
        raise InvalidInput(Problem("start", "it cannot be assembled there"))
    free = tuple(name for name in values if name not in laws)
    idle = _without_mass(DriverChart(start, free, laws), [values[name] for name in free], state.time)
    even = {name: constant_speed(rates[name], start=values[name] - rates[name] * state.time) for name in idle}
    free = tuple(name for name in free if name not in idle)
    chart = chart_of(start, free, {**laws, **even})
    own_values = np.array([values[name] for name in free])
    speeds, lost = carried_speeds(state, chart, own_values)
    return _Begun(chart, np.concatenate([own_values, speeds]), lost)


# Poses before and behind a change of pairs agree within this part of the size: what closes has a gap that is far below.
SAME_POSE = 1e-6


def _has_poses(start: Motion, poses: Mapping[str, Pose]) -> bool:
    """Return whether a motion of one pose has the given poses."""
    here = placed_at(start.poses, (0, 0))
    return all(
        abs(_last(one.z.c[0]) - _last(poses[link].z.c[0])) < SAME_POSE * start.size
        and abs(_last(one.u.c[0]) - _last(poses[link].u.c[0])) < SAME_POSE
        for link, one in here.items()
    )


# A driver that moves less than this part of the greatest inertia moves no mass: rounding squared.
NO_MASS = 1e-20


def _without_mass(chart: DriverChart, values: Sequence[float], time: float) -> list[str]:
    """Return the free drivers that move no mass, such as those of free rollers: nothing tells how they move."""
    matrix = chart.state(time, np.array(values), np.zeros(len(values))).terms.matrix
    sizes = np.diag(matrix)[: len(values)] / chart.scales**2
    return [name for name, size in zip(chart.free, sizes, strict=True) if not size > NO_MASS * np.max(sizes)]


def carried_speeds(before: KnownState, chart: DriverChart, values: Number) -> tuple[Number, float]:
    """Return the speeds of another mechanism's free drivers with the momenta of a state, and the lost energy.

    The impulses in the new pairs do no work on the new motion: M v = sum m v_i . v- + J w_i w-.

    Source: D. T. Greenwood, Principles of Dynamics, 2nd ed., Prentice-Hall 1988, section 4.8.
    """
    n = len(values)
    rest = chart.state(before.time, values, np.zeros(n))
    matrix, momentum = rest.terms.matrix, np.zeros(len(rest.values))
    for own in chart.masses:
        new, old = rest.block.world[own.link], before.block.world[own.link]
        centre, turning = _rates(new.at(own.centre)), _turnings(new)
        was, turned = _rates(old.at(own.centre))[-1], _turnings(old)[-1]
        momentum += own.mass * (np.conj(centre) * was).real[: len(momentum)]
        momentum += own.inertia * turning[: len(momentum)] * turned
    driven = rest.speeds[n:]
    speeds = np.linalg.solve(matrix[:n, :n], momentum[:n] - matrix[:n, n:] @ driven)
    whole = np.concatenate([speeds, driven])
    return speeds, before.kinetic - float(whole @ matrix @ whole) / 2.0


def _rates(place: Series) -> Number:
    return np.ravel(place.c[1]) if len(place.c) > 1 else np.zeros(1)


def _turnings(pose: Pose) -> Number:
    return np.ravel(cross(pose.u.c[0], pose.u.c[1])) if len(pose.u.c) > 1 else np.zeros(1)


def _true(pose: Pose) -> Pose:
    """Return a pose with its true rate alone."""
    if pose is FIXED:
        return pose
    return Pose(*(Series((_last(one.c[0]), _last(one.c[1]) if len(one.c) > 1 else 0j)) for one in (pose.z, pose.u)))


def _last(value: Any) -> complex:
    return complex(np.ravel(value)[-1])
