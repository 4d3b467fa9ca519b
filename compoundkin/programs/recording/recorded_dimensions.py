"""The dimensions of a recorded mechanism: free ones are inputs, those read off a drawing stay as they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from compoundkin.base.copies import unchecked
from compoundkin.base.poses import End
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.field_numbers import fields_with
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair
from compoundkin.model.pairs.guide_ends import bounds_name
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.recording.recorded_number import RecordedNumber


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

    So are the ends of guides. `ends` are those of the mechanism's own motion.
    """
    pairs = _recorded_pairs(graph, StatedDimensions(order.structure.mechanism, ends), free)
    sides = {name: _with_recorded(pair, pairs).ends(geometry) for name, pair in order.pairs.items()}
    for guide in order.guide_ends.pairs:
        sides[bounds_name(guide)] = tuple(End(value) for value in pairs[guide.name].bounds(geometry))
    return sides


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
            pairs[pair.name] = unchecked(cylinder, **fields_with(cylinder, own)).slide
        else:
            pairs[pair.name] = unchecked(pair, **{**stated.read_off.get(pair.name, {}), **fields_with(pair, own)})
    return pairs


def _with_recorded(pair: Pair, pairs: Mapping[str, Pair]) -> Pair:
    """Return a pair as it is recorded, or one that stands for such a pair with it inside."""
    if pair.name in pairs:
        return pairs[pair.name]
    inner = {field.name: getattr(pair, field.name) for field in fields(pair)}
    found = {name: pairs[own.name] for name, own in inner.items() if getattr(own, "name", None) in pairs}
    return unchecked(pair, **found) if found else pair
