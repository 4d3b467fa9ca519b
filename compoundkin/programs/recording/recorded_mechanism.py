"""A recorded mechanism: its groups closed once, in solving order, on recorded numbers.

Free dimensions are inputs; those read off a drawing stay as they are.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.base.copies import unchecked
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block, rates, recorded_root
from compoundkin.kinematics.solving_order import SolvingOrder, rooms_of, run
from compoundkin.model.fields import changed_fields
from compoundkin.model.geometry import FRAME, Geometry
from compoundkin.model.pairs.contract import Ends, Pair
from compoundkin.model.pairs.travel_limits import bounds_name
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions
from compoundkin.programs.graph.operation_graph import DRIVE, InputNumber, OperationGraph
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
class RecordedMechanism(ShortRepr):
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


def record_mechanism(recording: Recording) -> RecordedMechanism:
    """Return a mechanism recorded."""
    graph, order = OperationGraph(), recording.solving_order
    geometry = recorded_geometry(graph, order.structure.mechanism.geometry, recording.free)
    ends = recorded_ends(graph, order, geometry, recording.free, recording.ends or order.ends)
    bound = seeded_order(order, ends, graph, recording.order, recording.steps)
    drives = {drive.name: _recorded_driver(graph, drive.name, recording) for drive in order.structure.mechanism.drives}
    notes: dict[int, list[Series]] = {solver.index: [] for solver in order.solvers if solver.modes_may_meet}
    block = RecordedBlock.of(bound.start(bound.ends, drives, recording.order, (1, 1)))
    block.roots = {k: recorded_root(found) for k, found in notes.items()}
    run(bound, block, SeededChoice(graph, recording.signs))
    return RecordedMechanism(recording, graph, geometry, drives, bound, block, notes)


def _recorded_driver(graph: OperationGraph, name: str, recording: Recording) -> Series:
    """Return a driver's value and rates as inputs; rates that are zero are no inputs."""
    values = [
        0.0 if k and (name, k) in recording.still else RecordedNumber.given(graph, InputNumber(DRIVE, name, str(k)))
        for k in range(recording.order + 1)
    ]
    return rates(tuple(values), recording.order)


@dataclass
class RecordedBlock(Block):
    """A block that notes the truths on which its groups hang.

    `goods` are (index, truth) in the order in which they are met.
    """

    goods: list[tuple[int, Number]] = field(default_factory=list)

    @classmethod
    def of(cls, block: Block) -> RecordedBlock:
        """Return a block as one that notes truths."""
        return cls(**{one.name: getattr(block, one.name) for one in fields(block)})

    def fail(self, good: Number, index: int) -> None:
        """Note that a group does not close where `good` is false."""
        self.goods.append((index, good))


def recorded_geometry(graph: OperationGraph, geometry: Geometry, free: Sequence[FreeDimension]) -> Geometry:
    """Return the points of links with the free ones as inputs. Nothing is read off the drawing any more."""
    points = {name: dict(own) for name, own in geometry.points.items()}
    for one in free:
        if one.is_vector:
            points[one.owner][one.word] = RecordedNumber.given(graph, *one.inputs)
        elif one.is_of_link:
            own, coordinate = points[one.owner][one.word], RecordedNumber.given(graph, *one.inputs)
            x, y = (coordinate, own.imag) if one.part == "x" else (own.real, coordinate)
            points[one.owner][one.word] = x + 1j * y
    return replace(geometry, points=points, drawn={}, as_drawn=frozenset())


def recorded_ends(
    graph: OperationGraph,
    order: SolvingOrder,
    geometry: Geometry,
    free: Sequence[FreeDimension],
    ends: Mapping[str, Ends],
) -> dict[str, Ends]:
    """Return the sides of all pairs with free numbers as inputs.

    So are the ends of guides, and what must fit. `ends` are those of the mechanism's own motion.
    """
    pairs = _recorded_pairs(graph, StatedDimensions(order.structure.mechanism, ends), free)
    sides = {name: _with_recorded(pair, pairs).ends(geometry) for name, pair in order.pairs.items()}
    for guide in order.guide_ends.pairs:
        sides[bounds_name(guide)] = tuple(End(value) for value in pairs[guide.name].bounds(geometry))
    shown = _with_drawing(geometry, order.structure.mechanism.geometry, free)
    for pair in order.fits.pairs:
        sides.update(rooms_of(pairs[pair.name], shown))
    return sides


def _with_drawing(geometry: Geometry, own: Geometry, free: Sequence[FreeDimension]) -> Geometry:
    """Return the recorded points with the drawing of those links whose points are not free."""
    freed = {one.owner for one in free if one.is_of_link} - {FRAME}
    drawn = {name: pose for name, pose in own.drawn.items() if name not in freed}
    return replace(geometry, drawn=drawn, as_drawn=own.as_drawn - freed)


def _recorded_pairs(graph: OperationGraph, stated: StatedDimensions, free: Sequence[FreeDimension]) -> dict[str, Any]:
    """Return the written pairs, with inputs for free numbers."""
    numbers: dict[str, dict[str, Any]] = {}
    for one in free:
        if not one.is_of_link:
            numbers.setdefault(one.owner, {})[one.number] = RecordedNumber.given(graph, *one.inputs)
    pairs: dict[str, Any] = {}
    mechanism = stated.mechanism
    for pair in mechanism.written_pairs:
        own = numbers.get(pair.name, {})
        if pair.name in mechanism.cylinders:
            cylinder = mechanism.cylinders[pair.name]
            pairs[pair.name] = unchecked(cylinder, **changed_fields(cylinder, own)).slide
        else:
            pairs[pair.name] = unchecked(pair, **{**stated.read_off.get(pair.name, {}), **changed_fields(pair, own)})
    return pairs


def _with_recorded(pair: Pair, pairs: Mapping[str, Pair]) -> Pair:
    """Return a pair as it is recorded, or one that stands for such a pair with it inside."""
    if pair.name in pairs:
        return pairs[pair.name]
    inner = {field.name: getattr(pair, field.name) for field in fields(pair)}
    found = {name: pairs[own.name] for name, own in inner.items() if getattr(own, "name", None) in pairs}
    return unchecked(pair, **found) if found else pair
