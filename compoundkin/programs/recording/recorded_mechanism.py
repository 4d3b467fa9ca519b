"""A mechanism recorded: its groups closed once, in solving order, on numbers that note what is done with them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number, Series
from compoundkin.kinematics.block import rates
from compoundkin.kinematics.limits import noted_root
from compoundkin.kinematics.solving_order import SolvingOrder, run
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.graph.input_kinds import DRIVE
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_block import RecordedBlock
from compoundkin.programs.recording.recorded_dimensions import recorded_ends, recorded_geometry
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.seeded_order import SeededChoice, seeded_order


@dataclass(frozen=True)
class Recording:
    """A mechanism in a configuration, and which of its numbers are inputs.

    `signs` are those of the groups by index. `free` are the dimensions that are inputs, `still` the drivers' rates,
    (driver, order), that are zero and cost nothing. `ends` are the sides of pairs in its
    own motion. Where states of groups are only predicted, so many `steps` correct them before the last.
    """

    solving_order: SolvingOrder
    signs: Mapping[int, int]
    free: tuple[FreeDimension, ...] = ()
    order: int = 2
    still: Collection[tuple[str, int]] = ()
    ends: Mapping[str, Ends] | None = None
    steps: int = 0


@dataclass(frozen=True, repr=False)
class RecordedMechanism(PrintsShort):
    """A mechanism whose links' poses are nodes of a graph.

    `order` is the solving order that was run, on recorded ends.
    """

    recording: Recording
    graph: OperationGraph
    geometry: Geometry
    drives: Mapping[str, Series]
    order: SolvingOrder
    block: RecordedBlock
    notes: Mapping[int, list[Series]]  # the discriminants of closed forms, in parts of their scale, by group

    def number(self, value: Number) -> RecordedNumber:
        """Return a number as one recorded in its graph."""
        return RecordedNumber(self.graph, self.graph.constant(0.0)).like(value)


def recorded(recording: Recording) -> RecordedMechanism:
    """Return a mechanism recorded."""
    graph, order = OperationGraph(), recording.solving_order
    geometry = recorded_geometry(graph, order.structure.mechanism.geometry, recording.free)
    ends = recorded_ends(graph, order, geometry, recording.free, recording.ends or order.ends)
    bound = seeded_order(order, ends, graph, recording.order, recording.steps)
    drives = {drive.name: _driver(graph, drive.name, recording) for drive in order.structure.mechanism.drives}
    notes: dict[int, list[Series]] = {solver.index: [] for solver in order.solvers if solver.modes_may_meet}
    block = RecordedBlock.of(bound.start(bound.ends, drives, recording.order, (1, 1)))
    block.roots = {k: noted_root(found) for k, found in notes.items()}
    run(bound, block, SeededChoice(graph, recording.signs))
    return RecordedMechanism(recording, graph, geometry, drives, bound, block, notes)


def _driver(graph: OperationGraph, name: str, recording: Recording) -> Series:
    """Return a driver's value and rates as inputs; rates that are zero are no inputs."""
    values = [
        0.0 if k and (name, k) in recording.still else RecordedNumber.given(graph, InputNumber(DRIVE, name, str(k)))
        for k in range(recording.order + 1)
    ]
    return rates(tuple(values), recording.order)
