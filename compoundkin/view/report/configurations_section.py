"""Reports on all configurations of a mechanism, and on its circuits, branches and limit positions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import prod
from typing import TYPE_CHECKING

from compoundkin.analysis.singularity import Singularities
from compoundkin.base.arrays import degrees, first_entry
from compoundkin.base.errors import CompoundkinError, InvalidInput
from compoundkin.kinematics import Motion
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.solution import first_configuration
from compoundkin.model.attributes import DEGREES, with_unit
from compoundkin.structure import Group, Structure
from compoundkin.view.report.report_data import (
    NOT_SOLVED,
    Alert,
    Block,
    Cell,
    Column,
    Outcome,
    Paragraph,
    Section,
    TableBlock,
)
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import counted, listed, number_text

if TYPE_CHECKING:
    from compoundkin.configurations.circuit import Branch, Circuit, CircuitPlace, Limit
    from compoundkin.configurations.circuit_search import Circuits

# A reader needs no more rows than this of a table; the JSON report has all.
MOST_ROWS = 40
# A report follows all circuits of mechanisms with at most so many combinations of modes: a fraction of a second.
MOST_MODES = 64
TRIAD_MODES, TRIAD_BODIES = 6, 4
# Angles below this (degrees) are rounding.
FLOOR = 1e-9
CHANGES = "Where two modes of a group meet and the motion goes on: it may change from one circuit to the other."
CURVE = "At these dimensions there is a curve of configurations too: {} can move though no driver does."
SINGULAR = (
    "Found by the equations of all pairs in the poses of all links. Branches are given by the angular velocities of the"
    " links for a driver that moves at 1 (rad/s, or length/s), and by the speeds of links that do not turn."
)
MISSING = "The numbers of configurations and of branches do not agree everywhere, so that a circuit may be missing."


def configurations_report(found: Configurations) -> Report:
    """Return all configurations at the first driver values."""
    outcome = Outcome(True, 1, int(any(True for _ in found)))
    return Report(found.structure.mechanism.title, (configurations_section(found),), outcome, found.structure)


def configurations_section(found: Configurations) -> Section:
    """Tell how many configurations there are, their names, and their angles.

    The angles are those of the links that are solved.
    """
    ones, structure = list(found), found.structure
    links = [link for group in structure.groups for link in group.links]
    heads = (Column("no.", style="each"), Column("configuration"))
    columns = (*heads, *(Column(link, "deg", "fixed", FLOOR) for link in links))
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (i, one.name, *(float(degrees(one.angles[link])) for link in links)) for i, one in enumerate(ones, start=1)
    )
    at = {name: float(first_entry(value)) for name, value in found.values.items()}
    angles = "The angles are those of the links from the frame's x axis."
    text = f"{_drivers_text(structure, at)}: {found.count_in_words} {angles}"
    curve = [Paragraph(CURVE.format(listed(found.curve.links)))] if found.curve else []
    return Section("configurations", "Configurations", (Paragraph(text), *curve, _table(columns, rows, keys=2)))


def _drivers_text(structure: Structure, values: Mapping[str, float]) -> str:
    shown = (
        f"{name} = {_value_text(structure.driven_angles.get(name, False), value)}" for name, value in values.items()
    )
    return ", ".join(shown) or "Without a driver"


def _value_text(angle: bool, value: float) -> str:
    return with_unit(number_text(float(degrees(value))), DEGREES) if angle else number_text(value)


def circuits_report(found: Circuits) -> Report:
    """Report circuits, branches, limit positions, change points and toggle positions of one driver."""
    page = _CircuitSections(found)
    sections = (page.circuits(), page.branches(), *page.limits(), *page.changes(), *page.toggles())
    return Report(found.structure.mechanism.title, sections, NOT_SOLVED, found.structure)


def assembly_sections(motion: Motion) -> tuple[Section, ...]:
    """Return the sections on circuits and limits of one design, where they are computed quickly.

    With several drivers the first one moves, the others keep their first values.
    """
    structure, drives = motion.structure, motion.mechanism.drives
    modes = prod(solver.modes or _estimated_modes(solver.group) for solver in motion.solving_order.solvers)
    if not drives or motion.inputs.designs > 1 or modes > MOST_MODES:
        return ()
    first = {name: float(first_entry(values[0])) for name, values in motion.inputs.drives.items()}
    others = {name: value for name, value in first.items() if name != drives[0].name}
    # late: of many groups no circuits are looked for
    from compoundkin.configurations.circuit_search import circuits

    try:
        found = circuits(structure, drives[0].name, others)
    except CompoundkinError:
        return ()
    page = _CircuitSections(replace(found, start=_start_on_circuits(found, motion)))
    return page.circuits(), *page.limits()


def _start_on_circuits(found: Circuits, motion: Motion) -> CircuitPlace | None:
    """Return where on the circuits the motion begins, in the modes in which it was solved."""
    first = first_configuration(motion, 0)
    try:
        return None if first is None else found.at(first)
    except InvalidInput:
        return None


def _estimated_modes(group: Group) -> int:
    """Return the number of modes of a group without signs, to estimate the work: six of a triad of pins, else many."""
    pins = all(pair.is_simple and pair.free_is_angle for pair in (*group.inner, *group.outer))
    return TRIAD_MODES if pins and len(group.bodies) <= TRIAD_BODIES else MOST_MODES + 1


class _CircuitSections:
    """The sections of a report on circuits."""

    def __init__(self, found: Circuits) -> None:
        self.found = found
        self.angle = found.structure.driven_angles.get(found.driver, False)
        self.value = Column(found.driver, "deg" if self.angle else "", "fixed", FLOOR)

    def circuits(self) -> Section:
        """Return the circuits, and whether all of them are found."""
        heads = (Column("circuit", style="each"), Column("branches", style="each"), Column("limits", style="each"))
        rows = tuple((c.number, len(c.branches), len(c.limits), self._range(c)) for c in self.found.circuits)
        blocks = [Paragraph(" ".join(self._said()))]
        table = _table((*heads, Column(f"driver {self.found.driver}")), rows)
        alerts = [] if self.found.consistent else [Alert(MISSING, "give a narrower range of the driver")]
        return Section("circuits", "Circuits", (*blocks, *alerts, table))

    def _said(self) -> Iterator[str]:
        found = self.found
        branches = f"{len(found.branches)} {'branch' if len(found.branches) == 1 else 'branches'}"
        others = f", with {_drivers_text(found.structure, found.fixed)}" if found.fixed else ""
        limits = counted(len(found.limits), "limit position")
        yield f"{counted(len(found.circuits), 'circuit')}, {branches}, {limits} of the driver {found.driver}{others}."
        if found.consistent:
            yield f"At {found.checked} further driver values there are as many configurations as branches."
        if found.start:
            yield f"Solving begins on circuit {found.start.circuit}, branch {found.start.branch}."

    def _range(self, circuit: Circuit) -> str:
        if circuit.turns_fully:
            turns = abs(circuit.winding)
            text = "turns fully" if turns == 1 else f"turns fully, {turns} turns to come back"
            return f"{text}; turns back on the way" if circuit.limits else text
        return f"from {self._number(circuit.low)} to {with_unit(self._number(circuit.high), self.value.unit)}"

    def _number(self, value: float) -> str:
        return number_text(self._in_unit(value))

    def _in_unit(self, value: float) -> float:
        return float(degrees(value)) if self.angle else value

    def branches(self) -> Section:
        """Return the branches with the driver's interval and what ends them."""
        unit = self.value.unit
        columns = (
            Column("branch", style="each"),
            Column("circuit", style="each"),
            Column("from", unit, "fixed", FLOOR),
            Column("to", unit, "fixed", FLOOR, follows=True),
            Column("ended by"),
            Column("configuration in the middle"),
        )
        rows = tuple(self._branch(branch) for branch in self.found.branches)
        return Section("branches", "Branches", (_table(columns, rows),))

    def _branch(self, branch: Branch) -> tuple[Cell, ...]:
        groups = dict.fromkeys([*(self._group(end) for end in branch.ends if end), *branch.open_ends])
        ends = listed(groups) if groups else "-"
        low, high = self._in_unit(branch.low), self._in_unit(branch.high)
        return branch.number, branch.circuit, low, high, ends, branch.name

    def _group(self, limit: Limit) -> str:
        return f"{self.found.structure.groups[limit.group].name} ({', '.join(limit.links)})"

    def limits(self) -> Iterator[Section]:
        """Return the limit positions, each with the group responsible."""
        if self.found.limits:
            circuit = Column("circuit", style="each")
            columns = self.value, Column("which is"), circuit, Column("branches"), Column("group")
            rows = tuple(
                (self._in_unit(one.value), "greatest" if one.greatest else "least", one.circuit,
                 f"{one.branches[0]} and {one.branches[1]}", self._group(one))
                for one in self.found.limits
            )  # fmt: skip
            text = "Where the driver turns back, for a group comes to the end of its reach there."
            yield Section("limits", "Limit positions", (Paragraph(text), _table(columns, rows)))

    def changes(self) -> Iterator[Section]:
        """Return the change points."""
        found = [change for circuit in self.found.circuits for change in circuit.changes]
        if found:
            columns = (self.value, Column("circuit", style="each"), Column("branch", style="each"), Column("links"))
            rows = tuple((self._in_unit(c.value), c.circuit, c.branch, ", ".join(c.links)) for c in found)
            yield Section("changes", "Change points", (Paragraph(CHANGES), _table(columns, rows)))

    def toggles(self) -> Iterator[Section]:
        """Return the toggle positions."""
        if self.found.toggles:
            columns = (Column("link"), self.value, Column("circuit", style="each"), Column("branch", style="each"))
            rows = tuple((t.link, self._in_unit(t.value), t.circuit, t.branch) for t in self.found.toggles)
            text = "Where a link on the frame stands still and turns back while the driver goes on."
            yield Section("toggles", "Toggle positions", (Paragraph(text), _table(columns, rows)))


def singularities_report(found: Singularities) -> Report:
    """Report the singular poses of a motion, and the branches that meet there."""
    motion = found.motion
    outcome = Outcome(True, motion.failed.size, int((motion.failed == 0).sum()))
    return Report(motion.mechanism.title, (singularities_section(found),), outcome, motion)


def singularities_section(found: Singularities) -> Section:
    """List singular poses, and their branches."""
    motion = found.motion
    if not found:
        return Section("singularities", "Singular poses", (Paragraph("No pose along the motion is singular."),))
    values = tuple(Column(name, "deg" if one.is_angle else "", "fixed", FLOOR) for name, one in motion.drives.items())
    columns = (Column("no.", style="each"), Column("pose", style="each"), *values, Column("kind"), Column("links"),
               Column("opens", style="each"), Column("branches"))  # fmt: skip
    angles = {name: one.is_angle for name, one in motion.drives.items()}
    rows = list[tuple[Cell, ...]]()
    for one in found:
        shown = (float(degrees(value)) if angles[name] else value for name, value in one.drivers.items())
        rows.append((one.number, one.place, *shown, one.kind, ", ".join(one.links), len(one.openings), one.meeting))
    blocks: list[Block] = [Paragraph(SINGULAR), _table(columns, tuple(rows), keys=1)]
    branches: tuple[tuple[Cell, ...], ...] = tuple(
        (one.number, branch.number, "followed" if branch.followed else "", branch.in_words)
        for one in found for branch in one.branches if not one.output
    )  # fmt: skip
    if branches:
        heads = Column("no.", style="each"), Column("branch", style="each"), Column("motion"), Column("links")
        blocks.append(_table(heads, branches, keys=2))
    return Section("singularities", "Singular poses", tuple(blocks))


def _table(columns: tuple[Column, ...], rows: tuple[tuple[Cell, ...], ...], keys: int = 0) -> TableBlock:
    return TableBlock(columns, rows, keys, tuple(range(MOST_ROWS)) if len(rows) > MOST_ROWS else None)
