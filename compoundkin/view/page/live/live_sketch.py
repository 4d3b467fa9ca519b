"""The sketch of a live page: how each vertex follows from the dimensions, and which points and drivers can be dragged.

The scene is drawn with traced numbers; the graph of their operations is what the page evaluates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.model.geometry import FRAME
from compoundkin.model.outline_shapes import outline_shapes
from compoundkin.model.pairs.contract import Ends, guided_point
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions
from compoundkin.programs.graph.operation_graph import CONSTANT, InputNumber, OperationGraph
from compoundkin.programs.page_program import operation_table
from compoundkin.programs.recording.recorded_mechanism import recorded_ends, recorded_geometry
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.view.page.live.compact_data import table_data
from compoundkin.view.page.live.live_data import live_data
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.kinematic_sketch import MovingPart, MovingSketch, carried_parts, carried_shapes
from compoundkin.view.sketch.painter import ON_LINE, SAME, Painter
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import (
    ArcShape,
    Band,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    Strokes,
    leaves,
    unit_direction,
)
from compoundkin.view.sketch.traced_numbers import LEAST, Traced, traced, untraced

if TYPE_CHECKING:
    from compoundkin.view.page.force_data import DrawnForces

# How a page draws a shape; its numbers follow in the order of `_kind`.
LINES, OUTLINE, ROW, ROUND, BOW = "lines", "outline", "row", "round", "bow"
# Points of a link that are less than this off a line, in parts of its length, are a bar.
FLAT = 0.02
# The inputs of a link's pose: the place of its origin, the unit vector of its angle.
POSE = "pose"
PLACE, TURN = ("x", "y"), ("cos", "sin")


def live_sketch(
    sample: Sample,
    chosen: Any,
    links: Sequence[str],
    outputs: Sequence[str],
    sketch: MovingSketch,
    forces: DrawnForces | None = None,
) -> dict[str, Any] | None:
    """Return the data of a live sketch, or why it cannot be live; None for a single pose."""
    live = live_data(sample, chosen, links, outputs, forces)
    if live is None or "why" in live:
        return live
    redraw = redrawn_parts(sketch, [one["name"] for one in live["dimensions"]])
    return {**live, "redraw": redraw, "handles": handle_data(sketch.scene, {name: k for k, name in enumerate(links)})}


def redrawn_parts(sketch: MovingSketch, names: Sequence[str]) -> dict[str, Any]:
    """Return what a page needs to draw a sketch for other dimensions; `names` are those that change."""
    motion = motion_of_design(sketch.motion, sketch.design)
    known = StatedDimensions(motion.mechanism, motion.inputs.ends).known
    free = tuple(known[name] for name in names)
    scene, graph = traced_scene(sketch.scene, motion, free)
    painter = Painter(scene, sketch.window)
    parts = [*carried_parts(painter, carried_shapes(painter))]
    labels = [_label_part(painter, part) for part in sketch.parts if part.is_label]
    return RedrawnParts(graph, (*parts, *labels), tuple(given for one in free for given in one.inputs)).data


def _label_part(painter: Painter, part: MovingPart) -> MovingPart:
    """Return a label at its point; a number keeps its place on its bar or plate."""
    own = painter.scene.points[part.link]
    at = own[part.letter] if part.letter else _place_by_points([*own.values()], part.at) if own else part.at
    return MovingPart(part.link, at, (), False)


def _place_by_points(points: Sequence[Any], at: complex) -> Any:
    """Return a place by the points of its link: by three of a plate, else along and beside the line of two."""
    one, other = max(((p, q) for p in points for q in points), key=lambda ends: abs(untraced(ends[1] - ends[0])))
    line, off = untraced(other - one), at - untraced(one)
    if not abs(line) > 0:
        return one + off
    third = max(points, key=lambda p: abs(cross(line, untraced(p - one))))
    area = cross(line, untraced(third - one))
    if abs(area) > FLAT * abs(line) ** 2:
        return (
            one + (other - one) * (cross(off, untraced(third - one)) / area) + (third - one) * (cross(line, off) / area)
        )
    share = off / line
    return one + (other - one) * share.real + unit_direction(other - one) * (share.imag * abs(line) * 1j)


@dataclass(frozen=True, eq=False)
class RedrawnParts:
    """Parts in numbers with notes. `graph` is that of the notes, `fixed` the dimensions among its inputs."""

    graph: OperationGraph
    parts: tuple[MovingPart, ...]
    fixed: tuple[InputNumber, ...]

    def nodes(self, value: Number) -> tuple[int, int]:
        """Return the nodes of both coordinates of a place."""
        if isinstance(value, Traced):
            return value.node.part(0), value.node.part(1)
        return self.graph.constant(float(value.real)), self.graph.constant(float(value.imag))

    @cached_property
    def drawn(self) -> tuple[tuple[tuple[int, int], tuple[tuple[int, str, Any], ...]], ...]:
        """The nodes of each part: of its point, and of its shapes that change. These have an index and a kind."""
        return tuple((self.nodes(part.at), tuple(self._shapes(part))) for part in self.parts)

    def _shapes(self, part: MovingPart) -> Iterator[tuple[int, str, Any]]:
        for index, shape in enumerate(leaves(part.shapes)):
            kind, numbers = _kind(shape)
            nodes = [[node for value in line for node in self.nodes(value)] for line in numbers]
            if not all(self.graph.nodes[node].operation == CONSTANT for line in nodes for node in line):
                yield index, kind, nodes

    @cached_property
    def wanted(self) -> tuple[int, ...]:
        """All nodes that the page evaluates."""
        shapes = [node for _, found in self.drawn for *_, lines in found for line in lines for node in line]
        return (*dict.fromkeys([*(node for at, _ in self.drawn for node in at), *shapes]),)

    @cached_property
    def least(self) -> tuple[InputNumber, ...]:
        """The least numbers over the poses that are needed."""
        inputs = (self.graph.nodes[k].given for k in self.graph.inputs(self.wanted))
        return tuple(one for one in inputs if one is not None and one.kind == LEAST)

    @property
    def data(self) -> dict[str, Any]:
        """All of it for a script."""
        courses = [int(one.name) for one in self.least]
        poses = [one for k in self.graph.inputs(courses) if (one := self.graph.nodes[k].given) and one.kind == POSE]
        along = operation_table(self.graph, [courses], self.fixed, poses)
        table = operation_table(self.graph, [self.wanted], (*self.fixed, *self.least), [])
        places = {node: -1 - place for node, place in table.places.items()}
        parts = [
            [
                [places[node] for node in at],
                [[k, kind, [[places[node] for node in line] for line in lines]] for k, kind, lines in shapes],
            ]
            for at, shapes in self.drawn
        ]
        return {
            "courses": table_data(along),
            "poses": [[one.name, one.part] for one in poses],
            "outline": {"same": SAME, "line": ON_LINE},
            "least": [along.places[node] for node in courses],
            "program": table_data(table),
            "parts": parts,
        }


def _kind(shape: Shape) -> tuple[str, Sequence[Sequence[Number]]]:
    """Return how a page draws a shape, and its numbers line by line."""
    if isinstance(shape, CircleShape):
        return ROUND, [[shape.centre, shape.radius]]
    if isinstance(shape, ArcShape):
        return BOW, [[shape.start, shape.stop, shape.radius]]
    if isinstance(shape, Strokes) and shape.row is not None:
        return ROW, [[shape.row.first, shape.row.step, shape.row.stroke, shape.row.number]]
    if isinstance(shape, Strokes):
        return LINES, shape.lines
    if isinstance(shape, Polyline | Polygon) and shape.among:
        return OUTLINE, [shape.among]
    if isinstance(shape, Polyline | Polygon | Band):
        return LINES, [shape.points]
    return LINES, []


def traced_scene(scene: Scene, motion: Motion, free: Sequence[FreeDimension]) -> tuple[Scene, OperationGraph]:
    """Return a scene with traced numbers, and the graph of their operations.

    Inputs are the free dimensions, and the poses of the links along the motion, which is of one design.
    """
    graph = OperationGraph()
    geometry = recorded_geometry(graph, motion.mechanism.geometry, free)
    ends = recorded_ends(graph, motion.solving_order, geometry, free, motion.inputs.ends)
    points = {
        link: {letter: _traced(graph, p, geometry.points[link][letter]) for letter, p in own.items()}
        for link, own in scene.points.items()
    }
    sides = {name: _traced_ends(graph, own, ends.get(name, own)) for name, own in scene.ends.items()}
    whole = {name: _traced_poses(graph, name, pose) for name, pose in scene.whole.items()}
    own = outline_shapes(motion.mechanism, points, motion.shape)
    return replace(scene, points=points, ends=sides, whole=whole, outlines=own), graph


def _traced(graph: OperationGraph, value: Number, recorded: Any) -> Any:
    """Return a traced number; the mechanism's own number where it cannot change."""
    if value is None or np.ndim(value):
        return value
    note = recorded.c[0] if isinstance(recorded, Series) else recorded
    if not isinstance(note, RecordedNumber):
        note = RecordedNumber(graph, graph.constant(0.0)).like(value)
    return traced(value, note)


def _traced_ends(graph: OperationGraph, own: Ends, recorded: Ends) -> Ends:
    both = zip(own, recorded, strict=True)
    return tuple(End(*(_traced(graph, *parts) for parts in zip(one, other, strict=True))) for one, other in both)


def _traced_poses(graph: OperationGraph, link: str, pose: Pose) -> Pose:
    """Return the poses of a link along the motion as inputs; those of the frame are constant."""
    if link == FRAME:
        return FIXED
    z, u = (
        constant(traced(one.c[0], RecordedNumber.given(graph, *(InputNumber(POSE, link, part) for part in parts))))
        for one, parts in ((pose.z, PLACE), (pose.u, TURN))
    )
    return Pose(z, u, pose.theta)


def handle_data(scene: Scene, numbers: Mapping[str, int]) -> dict[str, Any]:
    """Return the points and drivers that a pointer can drag; `numbers` are the indices of links on the page.

    A point has a name and `links`, those with another point too: its coordinates change on these, the others follow it.
    `on` is the link along whose guide it stays. A driver has a name, two links, a point, and whether it turns.
    """
    points = [found for letter in scene.letters if (found := _point(scene, numbers, letter)) is not None]
    drivers = [
        {
            "name": one.drive.name,
            "link": numbers[one.drive.link],
            "on": numbers[one.drive.on],
            "at": one.pair.letters[0],
            "turns": one.pair.free_is_angle,
        }
        for one in scene.driven
        if not one.is_passive and {one.drive.link, one.drive.on} <= numbers.keys()
    ]
    return {"points": points, "drivers": drivers}


def _point(scene: Scene, numbers: Mapping[str, int], letter: str) -> dict[str, Any] | None:
    """Return a point that can be dragged; None where a driver or two guides hold it."""
    carriers = scene.mechanism.carriers[letter]
    guides = list(_guides(scene, letter))
    led = any(letter == lead.point for lead in scene.mechanism.prescribed_motions.values())
    if led or len(guides) > 1 or any(link not in numbers for link in carriers):
        return None
    if any(on == link for on, link in guides):
        return None
    links = [numbers[link] for link in carriers if link == FRAME or len(scene.points[link]) > 1]
    return {"name": letter, "links": links, **({"on": numbers[guides[0][0]]} if guides else {})}


def _guides(scene: Scene, letter: str) -> Iterator[tuple[str, str]]:
    """Yield the links along whose guides a point stays: those solved before the links that slide on them."""
    driven = {step.pair.name: step.link for step in scene.driven}
    for pair in scene.structure.pairs:
        on, link = pair.members[0], pair.members[1]
        point = guided_point(pair, scene.ends[pair.name])
        if point is None or letter not in scene.points[link] or not np.all(point == scene.points[link][letter]):
            continue
        if pair.name in driven:
            yield link, link
        elif scene.groups[on] < scene.groups[link]:
            yield on, link
