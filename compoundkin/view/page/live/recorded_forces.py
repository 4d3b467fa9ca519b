"""The forces of a live page in its program: what the sketch draws, and what plots and tables tell of it.

Loads are recorded as motions are, of one pose. Tables of loads become chains of selected polynomials. What one pose
does not know is given at the poses of the page, and between them in proportion: the time, and the angles of pairs,
which tell how many turns an angle that is computed has made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple, cast

import numpy as np

from compoundkin.base.arrays import Number, cross, is_number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.dynamics.reactions.force_figures import ABOUT, force_figure, frame_point, shaking_moment
from compoundkin.dynamics.reactions.link_wrench import DRIVER, INERTIA, PAIR, WEIGHT
from compoundkin.dynamics.reactions.pair_forces import ForceComponents, force_component
from compoundkin.dynamics.reactions.reverse_pass import Reactions, all_reactions
from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import fit
from compoundkin.kinematics.quantities import owner_and_part, quantity
from compoundkin.model.attributes import (
    EFFORT,
    FORCE,
    FORCES,
    MOMENT,
    PARTS,
    POWER,
    SHAKING_FORCE,
    TIME,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.amounts import SLACK, LoadFunction, LoadTable
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.mass import IN_LINE, Mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.page_program import PageProgram
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.structure.mobility_count import DrivenPair
from compoundkin.view.page.force_data import DrawnForces
from compoundkin.view.page.markup import packed_doubles
from compoundkin.view.sketch.force_arrows import described_wrench

# In parts of the largest value of a kind: the program and the analysis agree.
AGREES = 1e-9
# What is a force, and no moment or power, by the last word of its name.
OF_SIZE_ONE = tuple(word for word, one in ({**FORCES["pairs"], **FORCES["links"]}).items() if one.dimension == "force")
# The kind of the rows that are given, and the name of the time among them.
GIVEN = "load"
# A uniform plate of so many corners has no other ones, whatever its dimensions are.
CORNERS = 3


def why_not_recorded(drawn: DrawnForces) -> str:
    """Return why a page's program cannot have these forces, in words; "" where it can."""
    forces, mechanism = drawn.forces, drawn.forces.motion.mechanism
    if forces.friction_forces is not None:
        return "friction is found at each pose by steps"
    if forces.relaxed:
        return "equilibrium does not determine all of them"
    points = mechanism.geometry.points
    if wide := [mass.link for mass in _left_out(mechanism) if len(points[mass.link]) > CORNERS]:
        return f"the uniform plate of {', '.join(wide)} may have other corners with other dimensions"
    for load in mechanism.loads.values():
        if any(isinstance(part, LoadFunction) for one in load.amounts_held for part in _parts(one)):
            return f"{load.name} is a function in Python"
    return ""


def _left_out(mechanism: Mechanism) -> Iterator[Mass]:
    """Yield the masses of which something is left out, as they are written."""
    yield from (item for item in mechanism.items if isinstance(item, Mass) and not item.is_complete)


def _parts(amount: Any) -> tuple[Any, ...]:
    return amount if isinstance(amount, tuple) else (amount,)


class RecordedTable(LoadTable):
    """The table of a load over a coordinate that is recorded."""

    def value(self, where: str, places: Number) -> Number:
        """Return its amount at a recorded place; of other places that of the table."""
        if not isinstance(places, RecordedNumber):
            return super().value(where, places)
        at, values = self._entries
        x: Number = places if self.period is None else at[0] + np.remainder(places - at[0], self.period)
        if self.smooth:
            terms = self._spline.c[::-1]
        else:
            terms = np.stack([values[:-1], np.diff(values) / np.diff(at)])
        start, *higher = (_selected(x, at, row) for row in (at[:-1], *terms))
        constant, *slopes = higher
        step, found = x - start, slopes[-1]
        for term in (*slopes[-2::-1], constant):
            found = found * step + term
        slack = SLACK * (at[-1] - at[0])
        inside = (x >= at[0] - slack) & (x <= at[-1] + slack)
        return np.where(inside, found, np.nan)


def _selected(x: Number, at: Number, row: Number) -> Number:
    """Return the entry of the interval in which a place lies."""
    found: Number = float(row[0])
    for low, entry in zip(at[1:-1], row[1:], strict=True):
        found = np.where(x >= float(low), float(entry), found)
    return found


@dataclass(frozen=True)
class RecordedLoads(LoadedBlock):
    """The loads of a recorded mechanism. What one pose does not know is in `rows`, (designs, poses)."""

    program: PageProgram = field(kw_only=True)
    own: Motion = field(kw_only=True)
    rows: dict[InputNumber, Number] = field(default_factory=dict, kw_only=True)

    @property
    def time(self) -> Number | None:
        """The time, which is given; None for a motion that is not in time."""
        return None if self.own.time is None else self._row(TIME, "", self.own.time)

    def _row(self, name: str, part: str, values: Number) -> Number:
        given = InputNumber(GIVEN, name, part)
        self.rows[given] = np.broadcast_to(fit(self.own.shape)(values), self.own.failed.shape)
        return RecordedNumber.given(self.program.mechanism.graph, given)

    def place(self, link: str, point: str | complex) -> Series:
        """Return the position of a point of a link."""
        own = self.program.mechanism.geometry.points[link][point] if isinstance(point, str) else point
        return as_series(self.block.world[link].at(own))

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a pair or a driver; turns of other angles are counted as in the own motion."""
        if name in self.program.mechanism.drives:
            return self.program.mechanism.drives[name]
        pair, sign = self._meant(name)
        found = pair.coordinate(self._ends(pair), self._poses(pair))
        value = found.c[0]
        if pair.free_is_angle:
            counted = self._row(pair.name, "turns", self._own_angle(pair))
            value = value + 2.0 * np.pi * np.rint((counted - value) / (2.0 * np.pi))
        return Series((value * sign, *(one * sign for one in found.c[1:])))

    def _own_angle(self, pair: Pair) -> Number:
        """Return the angle of a pair along the own motion, its turns counted."""
        return LoadedBlock(self.own, self.block, slice(None), slice(None)).counted_angle(pair)

    def fitted(self, value: Any, where: str = "load") -> Number:
        """Return a value that is one number. Raises InvalidInput for others."""
        if isinstance(value, RecordedNumber):
            return value
        if np.size(value) != 1:
            raise InvalidInput(Problem(where, "it is one number for each pose"))
        return np.ravel(value)[0].item()

    @cached_property
    def masses(self) -> tuple[Mass, ...]:
        """The masses, of what is left out as uniform bodies through recorded points."""
        found = dict(self.own.mechanism.masses)
        for item in _left_out(self.own.mechanism):
            mass, points = found[item.link], self.own.mechanism.geometry.points[item.link]
            # what a rotor adds stays
            more = mass.inertia - item.completed(points).inertia
            extent, centre, inertia = _uniform([*self.program.mechanism.geometry.points[item.link].values()])
            weight = item.mass if item.density is None else item.density * extent
            turning = weight * inertia if item.inertia is None else item.inertia
            found[item.link] = replace(
                mass, mass=weight, at=centre if item.at is None else mass.at, inertia=turning + more
            )
        return tuple(found.values())

    def named_loads(self) -> Iterator[tuple[Load | Mass, str, Wrench]]:
        """Yield each load and each weight, with a link and its wrench there."""
        mechanism = self.own.mechanism
        for load in mechanism.loads.values():
            changes = {key: _recordable(getattr(load, key)) for key in load.amounts}
            for link, wrench in replace(load, **changes).wrenches(self):
                yield load, link, wrench
        for mass in self.masses if mechanism.gravity != 0 else ():
            yield mass, mass.link, self.weight(mass)


def _uniform(points: Sequence[Number]) -> tuple[Number, Number, Number]:
    """Return extent, centre and inertia for each mass of a uniform body through up to three points, as `uniform_body`.

    Source: the triangle's about its centroid is a 36th of the sum of the squares of its sides, any table of inertias.
    """
    if len(points) == 1:
        return 0.0, points[0], 0.0
    long, centre = abs(points[1] - points[0]), (points[0] + points[1]) / 2.0
    for one, other in [*combinations(points, 2)][1:]:
        gap = abs(other - one)
        centre, long = np.where(gap > long, (one + other) / 2.0, centre), np.where(gap > long, gap, long)
    if len(points) < CORNERS:
        return long, centre, long * long / 12.0
    a, b, c = points
    area = abs(cross(b - a, c - a)) / 2.0
    sides = sum(abs(other - one) ** 2 for one, other in combinations(points, 2))
    flat = area <= IN_LINE * (long * long)
    return area, np.where(flat, centre, (a + b + c) / 3.0), np.where(flat, long * long / 12.0, sides / 36.0)


def _recordable(amount: Any) -> Any:
    """Return an amount whose tables take recorded places."""
    if isinstance(amount, tuple):
        return tuple(map(_recordable, amount))
    if isinstance(amount, LoadTable):
        return RecordedTable(amount.over, amount.at, amount.values, amount.period, amount.smooth)
    return amount


@dataclass(frozen=True, eq=False)
class RecordedPairForce(ForceComponents):
    """The force in a pair on its second link, recorded. `forces` are those of the own dimensions."""

    forces: ForceResult
    pair: Pair
    recorded: RecordedAnalysis

    @property
    def ends(self) -> Ends:
        """The pair's sides on its members."""
        return self.recorded.at.pair(self.pair.name)[1]

    @property
    def poses(self) -> tuple[Pose, ...]:
        """The poses of its members."""
        return tuple(self.recorded.at.block.world[link] for link in self.pair.members)

    @property
    def own(self) -> Wrench:
        """The wrench on the second link."""
        return self.recorded.reactions.pairs[self.pair.name]

    def part(self, word: str) -> Number:
        """Return a part by its word."""
        return force_component(self, word)

    @property
    def force(self) -> Number:
        """The force on the second link."""
        return self.own.force

    @property
    def moment(self) -> Number:
        """Its moment about the pair's point."""
        return self.own.about(self.pair.acting_place(self.ends, self.poses))


@dataclass(frozen=True, eq=False)
class RecordedEffort:
    """The effort and the power of a driver, recorded."""

    effort: Number
    power: Number


@dataclass(frozen=True, eq=False)
class RecordedShaking:
    """The shaking force, recorded."""

    whole: Wrench

    @property
    def force(self) -> Number:
        """The force on the frame."""
        return self.whole.force

    def moment_about(self, point: Number) -> Number:
        """Return the moment about a place of the world."""
        return self.whole.about(point)


class RecordedAction(NamedTuple):
    """A wrench that acts on a link at a place; on a `pin` it is a part of what acts there."""

    description: str
    link: str
    place: Number
    wrench: Wrench
    pin: str = ""


@dataclass(frozen=True, eq=False)
class RecordedAnalysis:
    """All forces of one recorded pose, by the names of `Forces`."""

    at: RecordedLoads
    own: Forces

    @cached_property
    def known(self) -> Mapping[str, Wrench]:
        """The loads, weights and inertia on each link."""
        found: dict[str, Wrench] = {}
        for _, link, wrench in self._applied:
            found[link] = found.get(link, Wrench()) + wrench
        for mass in self.at.masses if self.own.inertia else ():
            found[mass.link] = found.get(mass.link, Wrench()) + self.at.inertia(mass)
        return found

    @cached_property
    def _applied(self) -> tuple[tuple[Load | Mass, str, Wrench], ...]:
        return tuple(self.at.named_loads())

    @cached_property
    def reactions(self) -> Reactions:
        """The wrenches in all pairs, and that on the frame."""
        return all_reactions(self.at, self.known)

    @cached_property
    def pairs(self) -> Mapping[str, RecordedPairForce]:
        """The force in each pair by its name."""
        return {name: RecordedPairForce(self.own, self.at.pair(name)[0], self) for name in self.reactions.pairs}

    @cached_property
    def drives(self) -> Mapping[str, RecordedEffort]:
        """The effort of each driver by its name."""
        return {name: self._drive(driven) for name, driven in self.own.motion.structure.driven.items()}

    def _drive(self, driven: DrivenPair) -> RecordedEffort:
        one = self.pairs[driven.pair.name]
        effort = driven.pair.effort(one.ends, one.poses, one.own) * driven.pair.driven_by(driven.drive.link)
        course = self.at.program.mechanism.drives[driven.drive.name].c
        return RecordedEffort(effort, effort * (course[1] if len(course) > 1 else 0.0))

    @cached_property
    def shaking(self) -> RecordedShaking:
        """The force of the mechanism on its frame: without loads on the frame that come from no link."""
        external = Wrench()
        for what, link, wrench in self._applied:
            if link == FRAME and not isinstance(what, Mass) and all(name == link for name in what.links):
                external = external + wrench
        return RecordedShaking(self.reactions.on_frame - external)

    def acting(self) -> Iterator[tuple[str, tuple[Number, Wrench]]]:
        """Yield the place and the wrench of all that acts on links, by what describes it."""
        pins = dict[tuple[str, str], Wrench]()
        for one in (*self._loading(), *self._inertial(), *self._of_pairs()):
            yield one.description, (one.place, one.wrench)
            if one.pin:
                pins[one.pin, one.link] = pins.get((one.pin, one.link), Wrench()) + one.wrench
        for (letter, link), wrench in pins.items():
            place = self.at.place(self.own.motion.mechanism.real_pins[letter][0], letter).c[0]
            yield described_wrench(PAIR, letter, link, letter), (place, wrench)

    def _loading(self) -> Iterator[RecordedAction]:
        """Yield loads and weights."""
        for what, link, wrench in self._applied:
            if isinstance(what, Mass):
                point, by, title, pin = what.at, "", WEIGHT, ""
            else:
                by = next((name for name in what.links if name != link), "")
                point, title, pin = what.attack(link), what.title, what.pin
            place = self.at.place(link, point).c[0] if point is not None else _line(self.at, link, wrench)
            yield RecordedAction(described_wrench(title, what.name, link, by), link, place, wrench, pin)

    def _inertial(self) -> Iterator[RecordedAction]:
        """Yield what masses oppose to their accelerations."""
        for mass in self.at.masses if self.own.inertia else ():
            place = self.at.place(mass.link, mass.at).c[0]
            description = described_wrench(INERTIA, mass.name, mass.link, "")
            yield RecordedAction(description, mass.link, place, self.at.inertia(mass))

    def _of_pairs(self) -> Iterator[RecordedAction]:
        """Yield what pairs do to both their links; of a driven one the driver's effort by itself."""
        driven = {one.pair.name: one for one in self.own.motion.structure.driven.values()}
        written = {pair.name for pair in self.own.motion.mechanism.written_pairs}
        for name, one in self.pairs.items():
            pair, place = one.pair, one.pair.acting_place(one.ends, one.poses)
            unit, pin = pair.wrenches(one.ends, one.poses)[-1], "" if name in written else pair.letters[0]
            for link, by, sign in ((pair.members[1], pair.members[0], 1.0), (pair.members[0], pair.members[1], -1.0)):
                wrench = one.own.times(sign)
                if name in driven:
                    held = unit.times(driven[name].pair.effort(one.ends, one.poses, one.own) * sign)
                    yield RecordedAction(described_wrench(DRIVER, driven[name].drive.name, link, by), link, place, held)
                    wrench = wrench - held
                yield RecordedAction(described_wrench(PAIR, name, link, by), link, place, wrench, pin)

    def figure(self, name: str) -> Number:
        """Return a quantity of forces, and the shaking moment about a point of the frame."""
        whole, _, letter = name.partition(ABOUT)
        if letter:
            return self.shaking.moment_about(self.at.place(FRAME, letter).c[0])
        owner, word, part = owner_and_part(self.own.motion, whole)
        values = force_figure(owner.kind, word).values(cast("Any", self), owner.name)
        return PARTS[part](values) if part else values


def figure_names(forces: Forces, outputs: Sequence[str]) -> tuple[str, ...]:
    """Return the quantities of forces of a page: its outputs, and those of the report's tables."""
    motion = forces.motion
    told = [name for name in outputs if _is_of_forces(motion, name)]
    pairs = [f"{name}.{word}" for name in forces.wrenches for word in (FORCE, MOMENT)]
    drives = [f"{name}.{word}" for name in forces.drives for word in (EFFORT, POWER)]
    shaking = [f"{FRAME}.{SHAKING_FORCE}", shaking_moment(frame_point(forces))]
    return tuple(dict.fromkeys((*told, *pairs, *drives, *shaking)))


def _is_of_forces(motion: Motion, name: str) -> bool:
    try:
        owner, word, _ = owner_and_part(motion, name)
    except CompoundkinError:
        return False
    return word in FORCES[owner.kind]


def figure_values(forces: Forces, name: str) -> Number:
    """Return the values of a quantity of forces of the own dimensions, of the motion's shape."""
    _, _, letter = name.partition(ABOUT)
    values = forces.shaking.moment_about(letter) if letter else quantity(forces.motion, name).values
    return np.broadcast_to(values, forces.shape)


@dataclass(frozen=True, eq=False)
class RecordedForces:
    """The forces of a mechanism in its program, by nodes.

    Of what is drawn they are those of place, force and moment, by course; of `figures` one, or two of a vector. `rows`
    are what is given at the poses.
    """

    program: PageProgram
    drawn: DrawnForces
    nodes: tuple[tuple[int, ...], ...]
    figures: Mapping[str, tuple[int, ...]]
    rows: Mapping[InputNumber, Number]

    @classmethod
    def of(cls, program: PageProgram, drawn: DrawnForces, motion: Motion, names: Sequence[str]) -> RecordedForces:
        """Record them, with quantities of forces by their names. Raises InvalidInput for what no pose tells."""
        mechanism, whole = program.mechanism, slice(None)
        recorded = cast("Motion", RecordedMotion(mechanism))
        at = RecordedLoads(recorded, mechanism.block, whole, whole, program=program, own=motion)
        analysis = RecordedAnalysis(at, drawn.forces)
        acting = dict(analysis.acting())
        nodes = list[tuple[int, ...]]()
        for course in (*drawn.arrows, *drawn.arcs):
            place, wrench = acting[course.shown.description]
            one = mechanism.number(place), mechanism.number(wrench.force), mechanism.number(wrench.about(place))
            nodes.append((one[0].real.x, one[0].imag.x, one[1].real.x, one[1].imag.x, one[2].x))
        figures = {}
        for name in names:
            number = mechanism.number(analysis.figure(name))
            figures[name] = (number.x,) if number.y is None else (number.x, number.y)
        wanted = [k for one in (*nodes, *figures.values()) for k in one]
        return cls(program.with_more(wanted, at.rows), drawn, tuple(nodes), figures, at.rows)

    def agreeing(self, chosen: Number, design: int = 0) -> RecordedForces | None:
        """Return it with those figures that the program reproduces; None where it does not reproduce what is drawn."""
        every = [k for one in (*self.nodes, *self.figures.values()) for k in one]
        with np.errstate(all="ignore"):
            values = dict(zip(every, self.program.own(every, chosen, self.rows), strict=True))
        courses = (*self.drawn.arrows, *self.drawn.arcs)
        known = [(one.at[chosen], one.force[chosen], one.moment[chosen]) for one in courses]
        sizes = [max((float(np.nanmax(np.abs(rows[k]), initial=0.0)) for rows in known), default=0.0) for k in range(3)]
        sizes[2] = max(sizes[2], sizes[1] * self.program.motion.size)
        for (place, force, moment), nodes in zip(known, self.nodes, strict=True):
            parts = zip((place.real, place.imag, force.real, force.imag, moment), nodes, (0, 0, 1, 1, 2), strict=True)
            if not all(_agrees(values[node], own, sizes[k]) for own, node, k in parts):
                return None
        figures = {name: nodes for name, nodes in self.figures.items()
                   if self._has(name, [values[node] for node in nodes], chosen, design)}  # fmt: skip
        wanted = [k for one in (*self.nodes, *figures.values()) for k in one]
        return replace(self, figures=figures, program=self.program.with_more(wanted, self.rows))

    def _has(self, name: str, found: Sequence[Number], chosen: Number, design: int) -> bool:
        forces = self.drawn.forces
        own = figure_values(forces, name).reshape(forces.motion.inputs.designs, -1)[design, chosen]
        scale = float(np.max(np.abs(own), initial=0.0, where=np.isfinite(own)))
        largest = forces.largest * (1.0 if name.rpartition(".")[2] in OF_SIZE_ONE else forces.motion.size)
        parts = (own,) if len(found) == 1 else (own.real, own.imag)
        return len(found) == 1 + np.iscomplexobj(own) and all(
            _agrees(one, part, max(scale, largest)) for one, part in zip(found, parts, strict=True)
        )

    def data(self, places: Mapping[int, int], chosen: Number) -> dict[str, Any]:
        """Return where they are found by a script, and the given rows."""
        at = [[places[node] for node in one] for one in self.nodes]
        count = len(self.drawn.arrows)
        rows = [packed_doubles(one[0][chosen]) for one in self.rows.values()]
        times = [k for k, one in enumerate(self.rows) if one.name == TIME and not one.part]
        return {
            "arrows": at[:count],
            "arcs": at[count:],
            "rows": rows,
            "time": times[0] if times else -1,
            "outputs": [{"name": name, "parts": _parts_of(nodes, places), "wrapped": False, "own": False}
                        for name, nodes in self.figures.items()],
            "pairs": [f"{name}.{FORCE}" for name in self.drawn.forces.wrenches],
        }  # fmt: skip


def _parts_of(nodes: Sequence[int], places: Mapping[int, int]) -> dict[str, int]:
    return {part: places[node] for part, node in zip(("",) if len(nodes) == 1 else ("x", "y"), nodes, strict=True)}


def _agrees(value: Number, own: Number, size: float) -> bool:
    """Return whether the program reproduces a row, wherever it has finite numbers, which is at most poses."""
    value = np.broadcast_to(value, np.shape(own))
    both = np.isfinite(value) & np.isfinite(own)
    if np.count_nonzero(both) < np.count_nonzero(np.isfinite(own)) / 2.0:
        return False
    return bool(np.allclose(value[both], own[both], rtol=0.0, atol=AGREES * max(size, 1e-300)))


def _line(at: RecordedLoads, link: str, wrench: Wrench) -> Number:
    """Return the point of a line of action nearest to a link's origin."""
    origin, force = at.block.world[link].z.c[0], wrench.force
    if is_number(force, 0):
        return origin
    size = np.abs(force) ** 2
    return np.where(size > 0.0, origin - 1j * force * wrench.about(origin) / size, origin)
