"""`circuits`: all circuits of a mechanism that one driver moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, suggestion
from compoundkin.base.linear import one_thread
from compoundkin.configurations.circuit import (
    Branch,
    Circuit,
    CircuitPlace,
    Limit,
    Toggle,
    circuits_of_chains,
    toggles_of,
)
from compoundkin.configurations.closed_form_segments import cut_at_ends, lifted_by_closed_form
from compoundkin.configurations.driver_range import driver_range, starting_values
from compoundkin.configurations.enumeration import AllModes, closed_redundant
from compoundkin.configurations.general_segments import lifted_by_continuation
from compoundkin.configurations.routes import Route, place_of, required_place, route
from compoundkin.configurations.segment_poses import SegmentPoses, Sweep
from compoundkin.configurations.segments import Segments, segment_chains
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.driver_values import Inputs, inputs
from compoundkin.kinematics.solution import solving_order_of, starting_configuration
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure

# Driver values, spread by the golden ratio, at which the configurations are counted independently.
FRESH = 48
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
# Nobody can read more segments, and each further group doubles them.
MOST_SEGMENTS = 8192
# Angles along a segment at which redundant pairs must be closed.
INSIDE = (0.7, 1.3, 2.1)
# Where the counts differ, the segments are traced again with slices so many times as dense.
FINENESS = (1, 3, 9)


@dataclass(frozen=True, eq=False)
class Circuits(DisplaysHtml):
    """All circuits of a mechanism, moved by one driver while the others stand still.

    `fixed` are the values of the others. The real configurations were counted at `checked` further driver values;
    `consistent` is whether as many branches cross each of them. `start` is the place where `solve` and the drawing
    begin.
    """

    structure: Structure
    driver: str
    fixed: Mapping[str, float]
    circuits: tuple[Circuit, ...]
    checked: int
    consistent: bool
    start: CircuitPlace | None
    period: float = field(repr=False)
    placing: SegmentPoses = field(repr=False)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The branches of all circuits; branch n is the n-th."""
        return tuple(branch for circuit in self.circuits for branch in circuit.branches)

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limit positions of all circuits."""
        return tuple(limit for circuit in self.circuits for limit in circuit.limits)

    @cached_property
    def toggles(self) -> tuple[Toggle, ...]:
        """The toggle positions, where links on the frame turn back while the driver goes on."""
        return toggles_of(self.placing, self.circuits)

    def at(self, configuration: Configuration) -> CircuitPlace:
        """Return the circuit and branch of a configuration.

        Raises InvalidInput for a configuration that is of another mechanism or at other values of the other drivers.
        """
        return required_place(self.placing, self.circuits, self.period, configuration)

    def path(self, start: Configuration | int, end: Configuration | int, poses: int = 200) -> Route:
        """Return the shorter route along a circuit between configurations, which may start in the middle of a branch.

        Raises InvalidInput where they lie on different circuits.
        """
        first, last = self._place(start), self._place(end)
        if first.circuit != last.circuit:
            what = f"circuit {first.circuit} and circuit {last.circuit} are not connected"
            raise InvalidInput(Problem("path", what, "the mechanism must be taken apart to get from one to the other"))
        return route(self.placing, self.circuits[first.circuit - 1], self.period, first, last, poses)

    def _place(self, what: Configuration | int) -> CircuitPlace:
        if isinstance(what, Configuration):
            return self.at(what)
        if not 1 <= what <= len(self.branches):
            raise InvalidInput(Problem("path", f"there is no branch {what}", f"they are 1 to {len(self.branches)}"))
        return self.at(self.branches[what - 1].configuration)

    def __repr__(self) -> str:
        branches = count_phrase(len(self.branches), "branch", "branches")
        return f"Circuits({count_phrase(len(self.circuits), 'circuit')}, {branches} of the driver {self.driver!r})"


@checked
@one_thread
def circuits(
    mechanism: Mechanism | Structure,
    driver: str | None = None,
    values: Mapping[str, Any] | None = None,
    *,
    between: Sequence[float] | None = None,
    design: int = 0,
) -> Circuits:
    """Return all circuits of a mechanism over all values of one driver.

    `values` are those of the other drivers (radians or lengths; by default as drawn, or the first of their own),
    `between` is the range of the driver, by default a full turn, or all lengths within reach. Of dimensions that are
    arrays one `design` is taken, at its first pose.

    Raises NotDetermined where the structure cannot be solved, InvalidInput for drivers and values that do not fit and
    where there are thousands of branches, NotAssembled where the mechanism cannot be assembled at all.

    >>> from compoundkin.model.elements import drive, link
    >>> triple_rocker = Mechanism(
    ...     "Triple rocker", link("frame", A=(0, 0), D=(7, 0)), link("crank", A=(0, 0), B=(4, 0)),
    ...     link("coupler", B=(0, 0), C=(5, 0)), link("rocker", D=(0, 0), C=(3, 0)), drive("crank"))
    >>> found = circuits(triple_rocker)
    >>> [len(circuit.branches) for circuit in found.circuits], [round(limit.value, 6) for limit in found.limits]
    ([2], [1.552938, -1.552938])
    """
    solving_order = solving_order_of(mechanism)
    name = _driver(solving_order, driver)
    with np.errstate(all="ignore"):
        known = starting_values(solving_order, values or {})
        given = _of_design(inputs(solving_order, known, None, None, None), design)
        fixed = {other: value for other, value in known.items() if other != name}
        sweep = Sweep(solving_order, given.ends, fixed, name)
        segments, period, lost, good = _traced(sweep, between, known[name])
        if not segments.rows:
            raise NotAssembled(Problem("circuits", f"the mechanism cannot be assembled at any value of {name!r}"))
        placing = SegmentPoses(sweep, segments, design)
        found = circuits_of_chains(placing, segment_chains(segments), period)
        start = starting_configuration(solving_order, known, design)
        place = None if start is None else place_of(placing, found, period, start)
    consistent = good and not lost
    return Circuits(solving_order.structure, name, fixed, found, FRESH, consistent, place, period, placing)


def _of_design(given: Inputs, design: int) -> Inputs:
    """Return the inputs of one design at its first pose. Raises InvalidInput for an unknown design."""
    if not 0 <= design < given.designs:
        what = f"there is no design {design}"
        raise InvalidInput(Problem("design", what, f"they are 0 to {given.designs - 1}"))
    return given.cut(slice(design, design + 1), slice(0, 1))


def _driver(solving_order: SolvingOrder, driver: str | None) -> str:
    names = list(solving_order.structure.driven)
    if driver is None and len(names) == 1:
        return names[0]
    if not names:
        raise InvalidInput(Problem("driver", "the mechanism has no driver"))
    if driver is None:
        raise InvalidInput(Problem("driver", f"there are {len(names)} drivers", f"name one: {', '.join(names)}"))
    if driver not in names:
        raise InvalidInput(Problem(f"driver {driver}", f"there is no driver {driver!r}", suggestion(driver, names)))
    return driver


def _traced(sweep: Sweep, between: Sequence[float] | None, value: float) -> tuple[Segments, float, int, bool]:
    """Return all segments, the driver's period, the number of lost arcs, and whether the counts agree."""
    start, period = driver_range(sweep, between, value)
    turns = max(1, round(period / TURN))
    for fineness in FINENESS:
        segments, lost = _lifted(sweep, start, fineness * turns)
        good = _counts_agree(sweep, segments, float(start.low[0]), float(start.high[0]))
        if good and not lost:
            break
    return segments, period, lost, good


def _lifted(sweep: Sweep, segments: Segments, fineness: int) -> tuple[Segments, int]:
    """Return the segments lifted over all groups, one after another, and the number of lost arcs."""
    lost = 0
    for k, solver in enumerate(sweep.solving_order.solvers):
        if not segments.rows:
            break
        if solver.is_numbered:
            segments, missing = lifted_by_continuation(sweep, segments, k, fineness)
            lost += missing
        elif solver.has_limits:
            segments = lifted_by_closed_form(sweep, segments, k, fineness)
        if segments.rows > MOST_SEGMENTS:
            what = f"the circuits are in more than {MOST_SEGMENTS:,} pieces: the groups multiply them"
            raise InvalidInput(Problem("circuits", what, "ask for a part of the mechanism"))
    return cut_at_ends(sweep, _with_redundant(sweep, segments), fineness), lost


def _with_redundant(sweep: Sweep, segments: Segments) -> Segments:
    """Return the segments on which redundant pairs are closed."""
    if not sweep.solving_order.structure.redundant or not segments.rows:
        return segments
    rows = np.arange(segments.rows)
    block = sweep.run(segments, rows, segments.at(rows, np.array(INSIDE)))
    closed = np.broadcast_to(closed_redundant(sweep.solving_order, block), (len(rows), len(INSIDE)))
    return segments.selected(closed.all(axis=1))


def _counts_agree(sweep: Sweep, segments: Segments, low: float, high: float) -> bool:
    """Return whether the number of segments agrees with that of real configurations at further driver values."""
    values = low + (high - low) * np.mod(GOLDEN * np.arange(1, FRESH + 1), 1.0)
    drives: dict[str, tuple[Number, ...]] = {name: (value,) for name, value in sweep.fixed.items()}
    given = Inputs((FRESH,), sweep.ends, {**drives, sweep.driver: (values[None],)})
    counted = AllModes.of(sweep.solving_order, given).real[:, 0].sum(axis=0)
    crossed = ((segments.low[:, None] < values) & (values < segments.high[:, None])).sum(axis=0)
    return bool(np.all(counted == crossed))
