"""The program of a live page: dimensions, drivers at its poses, outputs, words for gaps.

Where the program reproduces the solved values of the mechanism's own dimensions, the page need not hold them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.analysis.characteristics.outputs import chosen_outputs, outputs_of
from compoundkin.analysis.characteristics.transmission import coriolis_names, index_names
from compoundkin.base.arrays import Number, unwrapped
from compoundkin.base.curves import Curve
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import (
    LENGTH,
    OF_LINKS,
    RADIANS,
    coordinate_dimension,
    derivative_order,
    motion_figure,
    unit_of,
)
from compoundkin.model.pairs.profile_contact import THINNED
from compoundkin.programs.dimensions import FreeDimension
from compoundkin.programs.follower_contacts import DEGREE, CurvePolynomials
from compoundkin.programs.graph.operation_graph import PARAMETER, SEED, InputNumber, group_seed
from compoundkin.programs.page_program import PageProgram, RecordedReason, SearchedContact
from compoundkin.programs.recording.recorded_motion import ProgramOutput, output_of
from compoundkin.programs.recording.seeded_order import whole_curve
from compoundkin.programs.solved_designs import seed_values
from compoundkin.view.page.live.compact_data import table_data
from compoundkin.view.page.live.panel_data import panel_data, template_data
from compoundkin.view.page.markup import packed_doubles
from compoundkin.view.report.pose_sample import Sample

if TYPE_CHECKING:
    from compoundkin.view.page.force_data import DrawnForces
    from compoundkin.view.page.live.recorded_forces import RecordedForces

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
        """The forces as the program has them; None where it cannot, or does not reproduce what is drawn."""
        if self.drawn is None:
            return None
        from compoundkin.view.page.live.recorded_forces import RecordedForces, figure_names, why_not_recorded

        if why_not_recorded(self.drawn):
            return None
        names = figure_names(self.drawn.forces, self.names)
        try:
            found = RecordedForces.of(self._without_forces, self.drawn, self.motion, names)
        except CompoundkinError:
            # amounts that are no numbers of one pose
            return None
        return found.agreeing(self.chosen)

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
            "contacts": list(self._contacts()),
            "seeds": len(program.seeds),
            "sides": [self.places[one.now.x] for one in program.carried[1] if one.given.name not in self._searched],
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
            **self._forces(),
        }

    def _forces(self) -> dict[str, Any]:
        """Return the forces, or why they do not follow changed dimensions."""
        if self.drawn is None:
            return {}
        if self.forces is not None:
            return {"forces": self.forces.data(self.places, self.chosen)}
        from compoundkin.view.page.live.recorded_forces import why_not_recorded

        why = why_not_recorded(self.drawn) or "a load is not a number of one pose"
        return {"noForces": why}

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
        own, rows = seed_values(program.seeds, self.motion), self._rows
        for state in program.carried[0]:
            given, row = state.given, rows[state.given]
            values = packed_doubles(own[given][0][self.chosen])
            kinds: dict[str, Any] = {"angle": state.is_angle, "corrected": state.is_corrected}
            if given in program.signs:
                kinds["sign"] = program.signs[given]
            if given.name in self._searched:
                kinds |= {"corrected": False, "searched": True}
            yield {"row": row, "now": self.places[state.now.x], "own": values, **kinds}

    @cached_property
    def _searched(self) -> frozenset[str]:
        """The groups whose states are found anew at each pose."""
        return frozenset(group_seed(one.index) for one in self.program.followers)

    @cached_property
    def _rows(self) -> Mapping[InputNumber, int]:
        """The rows of what the program is given besides dimensions and drivers."""
        return {one: row for row, one in enumerate(self.program.seeds, len(self.program.drives))}

    def _contacts(self) -> Iterator[dict[str, Any]]:
        """Yield the contacts with profiles: by what they are searched, the rows that are given, and the profile."""
        seeds, rows = self.program.seeds, self._rows
        for one in self.program.contacts:
            mine = {given.part: given for given in seeds if given.name == one.name}
            aim = [self.places[part.x] for part in (one.aim.real, one.aim.imag)]
            own = {InputNumber(SEED, one.name, PARAMETER): None}
            values = seed_values(own, self.motion)[next(iter(own))][0][self.chosen]
            yield {
                "flat": one.pair.is_flat,
                "aim": aim,
                "own": packed_doubles(values),
                "row": rows[mine[PARAMETER]] if PARAMETER in mine else -1,
                "rows": [[rows[given], part[0], int(part[1:])] for part, given in mine.items() if part != PARAMETER],
                "profile": profile_data(whole_curve(one.pair)),
                **self._follower(one),
            }

    def _follower(self, contact: SearchedContact) -> dict[str, Any]:
        """Return how the contact of a follower is searched anew, and which state its coordinate is."""
        states = [state.given.name for state in self.program.carried[0]]
        for one in self.program.followers:
            if one.contact is contact:
                curve = whole_curve(contact.pair)
                found = {
                    "state": states.index(group_seed(one.index)),
                    "path": [self.places[node] for node in one.nodes],
                    "straight": one.straight,
                    "sense": one.sense,
                    "greatest": one.is_greatest,
                    "turns": contact.pair.turns,
                    "outward": contact.pair.outward,
                    "samples": len(curve.samples.s[::THINNED]) - (0 if curve.closed else 1),
                }
                return {"follower": found}
        return {}

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
        return {"at": at, "wrapped": wrapped, "own": self._own.links[name]}

    @cached_property
    def _own(self) -> ReproducedValues:
        return ReproducedValues(self.program, self.chosen)

    def _outputs(self) -> Iterator[dict[str, Any]]:
        for output, number in zip(self.program.outputs, self.program.recorded, strict=True):
            nodes = {"": number.x} if number.y is None else {"x": number.x, "y": number.y}
            parts = {part: self.places[node] for part, node in nodes.items()}
            own = self._own.has_output(output, [*nodes.values()])
            yield {"name": output.name, "parts": parts, "wrapped": output.is_wrapped, "own": own}


# The polynomials of a profile reproduce its Taylor coefficients 0 .. 3 to such parts of the size (by the parameter as
# an angle).
REPRODUCED = np.array([4e-14, 4e-13, 4e-11, 4e-9])


def profile_data(curve: Curve) -> dict[str, Any]:
    """Return a profile as polynomials for a script, between the breaks of its derivatives.

    >>> from compoundkin.base.curves import Analytic
    >>> from compoundkin.base.series import Series
    >>> profile_data(Analytic(Series.turn, 0.0, 2.0 * np.pi, closed=True))["closed"]
    True
    """
    edges, coefficients, _ = CurvePolynomials.of(curve, REPRODUCED)
    known = coefficients.T.ravel()
    return {
        "low": curve.low,
        "high": curve.high,
        "closed": curve.closed,
        "degree": DEGREE,
        "edges": packed_doubles(edges),
        "x": packed_doubles(known.real),
        "y": packed_doubles(known.imag),
    }


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

    @cached_property
    def links(self) -> Mapping[str, bool]:
        """Whether it reproduces the pose, the velocities and accelerations of each link."""
        program, names, orders = self.program, [*self.program.links], range(self.program.order + 1)
        if not self.closes:
            return dict.fromkeys(names, False)
        good = np.ones(len(names), dtype=bool)
        for k in orders:
            nodes = [program.links[name][k] for name in names]
            found = [np.array([self._row(self._values[node[part]]) for node in nodes]) for part in range(3)]
            moved = [program.motion.links[name] for name in names]
            origins = np.array([self._of(link.origin.derivative(k)) for link in moved])
            turned = np.array([self._of(getattr(link, OF_LINKS[k])) for link in moved])
            wrapped = np.array([k == 0 and program.mechanism.block.world[name].theta is None for name in names])
            good &= self._agree(found[0], origins.real) & self._agree(found[1], origins.imag)
            good[wrapped] &= self._agree(_continuous(found[2][wrapped]), turned[wrapped])
            good[~wrapped] &= self._agree(found[2][~wrapped], turned[~wrapped])
        return dict(zip(names, good.tolist(), strict=True))

    def has_output(self, output: ProgramOutput, nodes: Sequence[int]) -> bool:
        """Return whether it reproduces an output."""
        values = np.broadcast_to(quantity(self.program.motion, output.name).values, self.program.motion.shape)
        parts = (values,) if len(nodes) == 1 else (values.real, values.imag)
        if not self.closes:
            return False
        found = np.array([self._row(self._values[node]) for node in nodes])
        known = np.array([self._of(part) for part in parts])
        return bool(self._agree(_continuous(found) if output.is_wrapped else found, known).all())

    def _row(self, found: Number) -> Number:
        """Return values of a node at all poses; where the motion is not assembled there are none."""
        return np.where(self.failed, np.nan, found)

    def _of(self, values: Number) -> Number:
        return np.broadcast_to(values, self.program.motion.shape)[..., self.chosen]

    def _agree(self, found: Number, known: Number) -> Number:
        """Return which rows (count, poses) agree."""
        size = np.abs(np.where(np.isfinite(known), known, 0.0)).max(axis=1, keepdims=True, initial=1e-300)
        near: Number = np.isclose(found, known, rtol=0.0, atol=AGREES * size + 1e-12, equal_nan=True)
        every: Number = near.all(axis=1)
        return every


def _continuous(angles: Number) -> Number:
    """Return angles (count, poses) continuous along each row."""
    return unwrapped(np.where(angles == -np.pi, np.pi, angles))


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
