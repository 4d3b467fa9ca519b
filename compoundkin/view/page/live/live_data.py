"""The program of a live page: dimensions, drivers at its poses, outputs, words for gaps.

Where the program reproduces the solved values of the mechanism's own dimensions, the page need not hold them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np

from compoundkin.analysis.characteristics.outputs import chosen_outputs, outputs_of
from compoundkin.analysis.characteristics.transmission import coriolis_names, index_names
from compoundkin.base.arrays import Number, is_number, unwrapped
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.link_wrench import DRIVER, INERTIA, PAIR, WEIGHT
from compoundkin.dynamics.reactions.reverse_pass import all_reactions
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import (
    LENGTH,
    OF_LINKS,
    RADIANS,
    TIME,
    coordinate_dimension,
    derivative_order,
    motion_figure,
    unit_of,
)
from compoundkin.model.loads.amounts import planar_value_of, tables_of
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.mass import Mass
from compoundkin.programs.dimensions import FreeDimension
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.page_program import PageProgram, RecordedReason
from compoundkin.programs.recording.recorded_motion import ProgramOutput, RecordedMotion, output_of
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.solved_designs import seed_values
from compoundkin.view.page.live.compact_data import table_data
from compoundkin.view.page.live.panel_data import panel_data, template_data
from compoundkin.view.page.markup import packed_doubles
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.force_arrows import ForceCourse, described_wrench

# In parts of the largest value: what is packed with seven digits agrees.
AGREES = 1e-9


def live_data(
    sample: Sample, chosen: Any, links: Sequence[str], outputs: Sequence[str], forces: DrawnForces | None = None
) -> dict[str, Any] | None:
    """Return what a page needs to be live, or why it cannot be; None for a single pose or without drivers."""
    if len(chosen) < 2 or not sample.motion.mechanism.drives:
        return None
    try:
        return LiveData(motion_of_design(sample.motion, sample.design), chosen, links, outputs, forces).data
    except CompoundkinError as error:
        return {"why": f"This mechanism cannot be changed here: {error.problems[0].what}."}


@dataclass(frozen=True, eq=False)
class LiveData:
    """One design of a motion at the poses of a page. `links` and `outputs` are those of the page."""

    motion: Motion
    chosen: Any
    links: Sequence[str]
    names: Sequence[str]
    drawn: DrawnForces | None = None

    @cached_property
    def program(self) -> PageProgram:
        """What computes it, forces too where it can."""
        return self._without_forces if self.forces is None else self.forces.program

    @cached_property
    def _without_forces(self) -> PageProgram:
        return PageProgram.of(self.motion, [*self._told()])

    @cached_property
    def forces(self) -> RecordedForces | None:
        """The drawn forces as the program has them; None where it does not reproduce them."""
        if self.drawn is None or self.drawn.forces.friction_forces is not None or self.drawn.forces.relaxed:
            return None
        try:
            found = RecordedForces.of(self._without_forces, self.drawn, self.motion)
        except (CompoundkinError, TypeError, ValueError, AttributeError):
            # loads that are no straight-line arithmetic of one pose
            return None
        return found if found.agrees(self.chosen) else None

    def _told(self) -> Iterator[ProgramOutput]:
        """Yield the page's outputs, and what its figures are made of."""
        followed = followed_quantities(self.motion, self.names) if self.names else ()
        for name in dict.fromkeys((*self.names, *followed)):
            try:
                yield output_of(self.motion, name)
            except CompoundkinError:
                # forces, and figures of whole motions, are no outputs of a program
                continue

    @cached_property
    def places(self) -> Mapping[int, int]:
        """The places of nodes."""
        return self.program.table.places

    @property
    def data(self) -> dict[str, Any]:
        """All of it for a script: lengths in the user's unit, angles in radians."""
        program, table = self.program, self.program.table
        if not program.dimensions:
            what = "it is overconstrained, and moves by its special dimensions only"
            raise InvalidInput(Problem(self.motion.mechanism.title, what, "take out what is redundant"))
        names = [one.name for one in program.dimensions]
        return {
            "dimensions": [self._dimension(one) for one in program.dimensions],
            "drives": [self._drive(name) for name in program.mechanism.drives],
            "size": self.motion.size,
            "states": list(self._states()),
            "sides": [self.places[one.now.x] for one in program.carried[1]],
            "groups": list(self._groups()),
            "panel": panel_data(program.stated, names),
            "toml": template_data(program.stated, names, self.motion),
            "program": {
                **table_data(table),
                "ends": list(table.ends),
                "goods": [[index, self.places[node]] for index, node in program.goods],
                "links": [self._link(name) for name in self.links],
                "outputs": list(self._outputs()),
            },
            **({} if self.forces is None else {"forces": self.forces.data(self.places, self.chosen)}),
        }

    def _groups(self) -> Iterator[dict[str, Any]]:
        """Yield what may keep a pose from being assembled: groups, guides with ends, pairs that do not fit; and why."""
        order, groups = self.program.mechanism.order, self.motion.structure.groups
        pairs = (*order.guide_ends.pairs, *(order.fits.pairs if order.fits.asked else ()))
        named = [*((group.name, group.links) for group in groups), *((pair.name, pair.members) for pair in pairs)]
        for k, ((name, links), reasons) in enumerate(zip(named, self.program.reasons, strict=True)):
            texts = [self._reason(one) for one in reasons]
            yield {"name": name, "links": list(links), "guide": k >= len(groups), "reasons": texts}

    def _reason(self, one: RecordedReason) -> dict[str, Any]:
        holds = None if one.holds is None else self.places[one.holds]
        return {"holds": holds, "words": [word if isinstance(word, str) else self.places[word] for word in one.words]}

    def _states(self) -> Iterator[dict[str, Any]]:
        """Yield what is carried from design to design: its row, what becomes of it, what it is in the own motion."""
        program = self.program
        own = seed_values(program.seeds, self.motion)
        for row, (given, state) in enumerate(zip(program.seeds, program.carried[0], strict=True), len(program.drives)):
            values = packed_doubles(own[given][0][self.chosen])
            kinds: dict[str, Any] = {"angle": state.is_angle, "corrected": state.is_corrected}
            if given in program.signs:
                kinds["sign"] = program.signs[given]
            yield {"row": row, "now": self.places[state.now.x], "own": values, **kinds}

    def _dimension(self, one: FreeDimension) -> dict[str, Any]:
        unit = self.program.stated.unit(one)
        kind = "point" if one.is_of_link else "angle" if unit == RADIANS else "length" if unit else "ratio"
        value = float(np.ravel(self.program.stated.own(one))[0])
        return {
            "name": one.name,
            "owner": one.owner,
            "word": one.word,
            "part": one.part,
            "kind": kind,
            "unit": unit,
            "value": value,
            **({"keeps": self.program.keeps_change_points(one)} if self.program.signs else {}),
        }

    def _drive(self, name: str) -> dict[str, Any]:
        values = [
            np.broadcast_to(v, self.motion.failed.shape)[0][self.chosen] for v in self.motion.inputs.drives[name][:3]
        ]
        dimension = coordinate_dimension(self.motion.structure.driven_angles[name])
        unit = unit_of(self.motion.mechanism.unit, dimension)
        return {
            "name": name,
            "unit": unit,
            "value": packed_doubles(values[0]),
            "rates": [packed_doubles(v) for v in values[1:]],
        }

    def _link(self, name: str) -> dict[str, Any]:
        at = [[self.places[node] for node in nodes] for nodes in self.program.links[name]]
        wrapped = self.program.mechanism.block.world[name].theta is None
        return {"at": at, "wrapped": wrapped, "own": self._own.has_link(name)}

    @cached_property
    def _own(self) -> ReproducedValues:
        return ReproducedValues(self.program, self.chosen)

    def _outputs(self) -> Iterator[dict[str, Any]]:
        for output, number in zip(self.program.outputs, self.program.recorded, strict=True):
            nodes = {"": number.x} if number.y is None else {"x": number.x, "y": number.y}
            parts = {part: self.places[node] for part, node in nodes.items()}
            own = self._own.has_output(output, [*nodes.values()])
            yield {"name": output.name, "parts": parts, "wrapped": output.is_wrapped, "own": own}


@dataclass(frozen=True, eq=False)
class ReproducedValues:
    """The values that a program computes at the poses of a page for the mechanism's own dimensions."""

    program: PageProgram
    chosen: Number

    @cached_property
    def failed(self) -> Number:
        """Where the motion is not assembled."""
        return self.program.motion.failed[0, self.chosen] != 0

    @cached_property
    def closes(self) -> bool:
        """Whether it is assembled where the motion is."""
        goods = (self._values[node] for _, node in self.program.goods)
        every = [np.broadcast_to(good, self.failed.shape).astype(bool) for good in goods]
        return bool(np.array_equal(np.logical_and.reduce([np.ones(self.failed.shape, bool), *every]), ~self.failed))

    @cached_property
    def _values(self) -> dict[int, Number]:
        """The values of all results by their nodes: computed in one run, for most share most of their operations."""
        program = self.program
        moved = (node for links in program.links.values() for nodes in links for node in nodes)
        told = (node for one in program.recorded for node in (one.x, one.y) if node is not None)
        nodes = list(dict.fromkeys((*(node for _, node in program.goods), *moved, *told)))
        return dict(zip(nodes, program.own(nodes, self.chosen), strict=True))

    def has_link(self, name: str) -> bool:
        """Return whether it reproduces a link's pose, velocities and accelerations."""
        link, order = self.program.motion.links[name], self.program.order
        wrapped = self.program.mechanism.block.world[name].theta is None
        nodes = [node for moved in self.program.links[name] for node in moved]
        found = [self._values[node] for node in nodes] if self.closes else []
        known = [
            part
            for k in range(order + 1)
            for part in self._moved(link.origin.derivative(k), getattr(link, OF_LINKS[k]))
        ]
        return self.closes and all(
            self._agrees(one, other, wrapped and k == 2)
            for k, (one, other) in enumerate(zip(found, known, strict=True))
        )

    def has_output(self, output: ProgramOutput, nodes: Sequence[int]) -> bool:
        """Return whether it reproduces an output."""
        values = np.broadcast_to(quantity(self.program.motion, output.name).values, self.program.motion.shape)
        parts = (values,) if len(nodes) == 1 else (values.real, values.imag)
        found = [self._values[node] for node in nodes] if self.closes else []
        return self.closes and all(
            self._agrees(one, self._of(part), output.is_wrapped) for one, part in zip(found, parts, strict=True)
        )

    def _moved(self, z: Number, turned: Number) -> tuple[Number, Number, Number]:
        return self._of(np.real(z)), self._of(np.imag(z)), self._of(turned)

    def _of(self, values: Number) -> Number:
        return np.broadcast_to(values, self.program.motion.shape)[..., self.chosen]

    def _agrees(self, found: Number, known: Number, wrapped: bool) -> bool:
        values = np.where(self.failed, np.nan, found)
        if wrapped:
            values = unwrapped(np.where(values == -np.pi, np.pi, values))
        largest = np.nanmax(np.abs(np.where(np.isfinite(known), known, 0.0)), initial=1e-300)
        return bool(np.allclose(values, known, rtol=0.0, atol=AGREES * largest + 1e-12, equal_nan=True))


class DrawnForces(NamedTuple):
    """Forces with the courses that are drawn: as arrows, and as arcs."""

    forces: Forces
    arrows: tuple[ForceCourse, ...]
    arcs: tuple[ForceCourse, ...]


@dataclass(frozen=True)
class RecordedLoads(LoadedBlock):
    """The loads of a recorded mechanism. Amounts over drivers or the time are `rows`, known at the poses."""

    program: PageProgram = field(kw_only=True)
    own: Motion = field(kw_only=True)
    rows: dict[InputNumber, Number] = field(default_factory=dict, kw_only=True)

    @property
    def time(self) -> Number | None:
        """The time, which is no number of one pose."""
        return None

    def place(self, link: str, point: str | complex) -> Series:
        """Return the position of a point of a link."""
        own = self.program.mechanism.geometry.points[link][point] if isinstance(point, str) else point
        return as_series(self.block.world[link].at(own))

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a driver, or of a pair that slides. Raises InvalidInput for other angles."""
        if name in self.program.mechanism.drives:
            return self.program.mechanism.drives[name]
        pair, sign = self._meant(name)
        if pair.free_is_angle:
            raise InvalidInput(Problem(name, "the turns of its angle are counted along the motion"))
        return Series(tuple(one * sign for one in pair.coordinate(self._ends(pair), self._poses(pair)).c))

    def fitted(self, value: Any, where: str = "load") -> Number:
        """Return a value that is one number. Raises InvalidInput for others."""
        if isinstance(value, RecordedNumber):
            return value
        if np.size(value) != 1:
            raise InvalidInput(Problem(where, "it is one number for each pose"))
        return np.ravel(value)[0].item()

    def named_loads(self) -> Iterator[tuple[Load | Mass, str, Wrench]]:
        """Yield each load and each weight, with a link and its wrench there."""
        mechanism = self.own.mechanism
        for load in mechanism.loads.values():
            changes = {key: self._amount(load, key, getattr(load, key)) for key in load.amounts}
            for link, wrench in replace(load, **changes).wrenches(self):
                yield load, link, wrench
        for mass in mechanism.masses.values() if mechanism.gravity != 0 else ():
            yield mass, mass.link, self.weight(mass)

    def _amount(self, load: Load, key: str, amount: Any) -> Any:
        """Return an amount, as a row where it is a table over a driver, or over the time."""
        over = [one.over for one in tables_of(amount)]
        if not over or not all(one == TIME or one in self.program.mechanism.drives for one in over):
            return amount
        values = [planar_value_of(load.where, amount, at) for at in loaded_blocks(self.own)]
        whole = np.concatenate([np.broadcast_to(one, (1, np.shape(one)[-1])) for one in values], axis=1)
        parts = {"x": whole.real, "y": whole.imag} if np.iscomplexobj(whole) else {"": whole}
        given = [InputNumber("load", f"{load.name}.{key}", part) for part in parts]
        self.rows.update(zip(given, parts.values(), strict=True))
        return RecordedNumber.given(self.program.mechanism.graph, *given)


@dataclass(frozen=True, eq=False)
class RecordedForces:
    """The drawn forces of a mechanism in its program: nodes of place, force and moment, by course.

    `rows` are the amounts of loads that are given.
    """

    program: PageProgram
    drawn: DrawnForces
    nodes: tuple[tuple[int, ...], ...]
    rows: Mapping[InputNumber, Number]

    @classmethod
    def of(cls, program: PageProgram, drawn: DrawnForces, motion: Motion) -> RecordedForces:
        """Record them. Raises InvalidInput and what Python does for loads that cannot be recorded."""
        mechanism, whole = program.mechanism, slice(None)
        recorded = cast("Motion", RecordedMotion(mechanism))
        at = RecordedLoads(recorded, mechanism.block, whole, whole, program=program, own=motion)
        acting = dict(_acting(at, drawn.forces))
        nodes = list[tuple[int, ...]]()
        for course in (*drawn.arrows, *drawn.arcs):
            place, wrench = acting[course.shown.description]
            one = mechanism.number(place), mechanism.number(wrench.force), mechanism.number(wrench.about(place))
            nodes.append((one[0].real.x, one[0].imag.x, one[1].real.x, one[1].imag.x, one[2].x))
        return cls(program.with_more([k for one in nodes for k in one], at.rows), drawn, tuple(nodes), at.rows)

    def agrees(self, chosen: Number) -> bool:
        """Return whether the program reproduces them, wherever it has finite numbers."""
        every = [k for one in self.nodes for k in one]
        with np.errstate(all="ignore"):
            found = iter(self.program.own(every, chosen, self.rows))
        courses = (*self.drawn.arrows, *self.drawn.arcs)
        known = [(one.at[chosen], one.force[chosen], one.moment[chosen]) for one in courses]
        sizes = [max((float(np.nanmax(np.abs(rows[k]), initial=0.0)) for rows in known), default=0.0) for k in range(3)]
        sizes[2] = max(sizes[2], sizes[1] * self.program.motion.size)
        for place, force, moment in known:
            pairs = zip((place.real, place.imag, force.real, force.imag, moment), (0, 0, 1, 1, 2), strict=True)
            for own, k in pairs:
                value = np.broadcast_to(next(found), np.shape(own))
                both = np.isfinite(value) & np.isfinite(own)
                if np.count_nonzero(both) < np.count_nonzero(np.isfinite(own)) / 2.0:
                    return False
                if not np.allclose(value[both], own[both], rtol=0.0, atol=AGREES * max(sizes[k], 1e-300)):
                    return False
        return True

    def data(self, places: Mapping[int, int], chosen: Number) -> dict[str, Any]:
        """Return where they are found by a script, and the given rows."""
        at = [[places[node] for node in one] for one in self.nodes]
        count = len(self.drawn.arrows)
        rows = [packed_doubles(np.broadcast_to(one, self.program.motion.failed.shape)[0][chosen])
                for one in self.rows.values()]  # fmt: skip
        return {"arrows": at[:count], "arcs": at[count:], "rows": rows}


def _acting(at: RecordedLoads, forces: Forces) -> Iterator[tuple[str, tuple[Number, Wrench]]]:
    """Yield the place and the wrench of all that acts on links, by what describes it."""
    order, mechanism = at.program.mechanism.order, at.own.mechanism
    known: dict[str, Wrench] = {}
    pins = dict[tuple[str, str], Wrench]()
    for what, link, wrench in at.named_loads():
        known[link] = known.get(link, Wrench()) + wrench
        point = what.at if isinstance(what, Mass) else what.attack(link)
        by = "" if isinstance(what, Mass) else next((name for name in what.links if name != link), "")
        place = at.place(link, point).c[0] if point is not None else _line(at, link, wrench)
        yield described_wrench(WEIGHT if isinstance(what, Mass) else what.title, what.name, link, by), (place, wrench)
        if not isinstance(what, Mass) and what.pin:
            pins[what.pin, link] = pins.get((what.pin, link), Wrench()) + wrench
    for mass in mechanism.masses.values() if forces.inertia else ():
        wrench = at.inertia(mass)
        known[mass.link] = known.get(mass.link, Wrench()) + wrench
        place = at.place(mass.link, mass.at).c[0]
        yield described_wrench(INERTIA, mass.name, mass.link, ""), (place, wrench)
    driven = {one.pair.name: one for one in order.structure.driven.values()}
    written = {pair.name for pair in mechanism.written_pairs}
    for name, wrench in all_reactions(at, known).pairs.items():
        pair, ends = at.pair(name)
        poses = tuple(at.block.world[link] for link in pair.members)
        place = pair.acting_place(ends, poses)
        unit = pair.wrenches(ends, poses)[-1]
        for link, by, sign in ((pair.members[1], pair.members[0], 1.0), (pair.members[0], pair.members[1], -1.0)):
            whole = wrench.times(sign)
            if name in driven:
                held = unit.times(driven[name].pair.effort(ends, poses, wrench) * sign)
                yield described_wrench(DRIVER, driven[name].drive.name, link, by), (place, held)
                whole = whole - held
            if name not in written:
                pins[pair.letters[0], link] = pins.get((pair.letters[0], link), Wrench()) + whole
            yield described_wrench(PAIR, name, link, by), (place, whole)
    for (letter, link), wrench in pins.items():
        place = at.place(forces.mechanism.real_pins[letter][0], letter).c[0]
        yield described_wrench(PAIR, letter, link, letter), (place, wrench)


def _line(at: RecordedLoads, link: str, wrench: Wrench) -> Number:
    """Return the point of a line of action nearest to a link's origin."""
    origin, force = at.block.world[link].z.c[0], wrench.force
    if is_number(force, 0):
        return origin
    return origin - 1j * force * wrench.about(origin) / np.abs(force) ** 2


def followed_quantities(motion: Motion, outputs: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the names of the quantities from which a page computes the figures of a report.

    They are its outputs, their rates, transmission indices and Coriolis accelerations, as far as a program computes
    them; of a vector the whole vector.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> followed_quantities(solve(load("jansen-leg")))[:3]
    ('foot.position', 'foot.velocity', 'foot.acceleration')
    """
    names = dict.fromkeys(name.removesuffix(f".{LENGTH}") for name in _quantity_names(motion, outputs))
    return tuple(name for name in names if derivative_order(name) <= motion.order and _is_recorded(motion, name))


def _quantity_names(motion: Motion, outputs: Sequence[str]) -> Iterator[str]:
    chosen = [name for name in chosen_outputs(motion, outputs) if not motion_figure(name)[1]]
    yield from chosen
    for one in outputs_of(motion, chosen):
        yield from one.names
    yield from index_names(motion)
    yield from coriolis_names(motion)


def _is_recorded(motion: Motion, name: str) -> bool:
    """Return whether a quantity is arithmetic of one pose."""
    try:
        output_of(motion, name)
    except CompoundkinError:
        return False
    return True
