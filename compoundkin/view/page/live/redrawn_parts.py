"""What a page needs to draw its sketch anew: where each vertex is, by the dimensions and by how far slides go."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from compoundkin.base.arrays import cross
from compoundkin.base.series import Number
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import CONSTANT
from compoundkin.programs.tables.operation_table import operation_table
from compoundkin.view.page.live.noted_scene import POSE, noted_scene
from compoundkin.view.page.live.table_data import table_data
from compoundkin.view.sketch.link_shapes import ON_LINE, SAME
from compoundkin.view.sketch.moving_sketch import MovingPart, MovingSketch, carried_parts, carried_shapes
from compoundkin.view.sketch.noted_numbers import LEAST, Noted, plain
from compoundkin.view.sketch.shapes import (
    ArcShape,
    Band,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    Strokes,
    direction,
    leaves,
)
from compoundkin.view.sketch.slide_shapes import Painter

# What a shape is drawn anew as; the numbers that it takes follow in the order of `_kind`.
LINES, OUTLINE, ROW, ROUND, BOW = "lines", "outline", "row", "round", "bow"
# Points of a link that are less than this off a line, in parts of its length, are a bar.
FLAT = 0.02


def redrawn_parts(sketch: MovingSketch, names: Sequence[str]) -> dict[str, Any]:
    """Return what draws the parts of a sketch anew. `names` are those of the dimensions that change."""
    motion = motion_of_design(sketch.motion, sketch.design)
    known = StatedDimensions(motion.mechanism, motion.inputs.ends).known
    free = tuple(known[name] for name in names)
    scene, graph = noted_scene(sketch.scene, motion, free)
    painter = Painter(scene, sketch.window)
    parts = [*carried_parts(painter, carried_shapes(painter))]
    labels = [_label(painter, part) for part in sketch.parts if part.is_label]
    return RedrawnParts(graph, (*parts, *labels), tuple(given for one in free for given in one.inputs)).data


def _label(painter: Painter, part: MovingPart) -> MovingPart:
    """A label at the point that it is seen from; a number keeps its place on its bar or plate."""
    own = painter.scene.points[part.link]
    at = own[part.letter] if part.letter else _among([*own.values()], part.at) if own else part.at
    return MovingPart(part.link, at, (), False)


def _among(points: Sequence[Any], at: complex) -> Any:
    """A place by the points of its link: by three of a plate, else along and beside the line of two."""
    one, other = max(((p, q) for p in points for q in points), key=lambda ends: abs(plain(ends[1] - ends[0])))
    line, off = plain(other - one), at - plain(one)
    if not abs(line) > 0:
        return one + off
    third = max(points, key=lambda p: abs(cross(line, plain(p - one))))
    area = cross(line, plain(third - one))
    if abs(area) > FLAT * abs(line) ** 2:
        return one + (other - one) * (cross(off, plain(third - one)) / area) + (third - one) * (cross(line, off) / area)
    share = off / line
    return one + (other - one) * share.real + direction(other - one) * (share.imag * abs(line) * 1j)


@dataclass(frozen=True, eq=False)
class RedrawnParts:
    """Parts in numbers with notes. `graph` is that of the notes, `fixed` the dimensions among its inputs."""

    graph: OperationGraph
    parts: tuple[MovingPart, ...]
    fixed: tuple[InputNumber, ...]

    def nodes(self, value: Number) -> tuple[int, int]:
        """Return the nodes of both coordinates of a place."""
        if isinstance(value, Noted):
            return value.note.part(0), value.note.part(1)
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
        """All nodes that are asked for."""
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
    """What a shape is drawn anew as, and its numbers line by line."""
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
