"""All dimensions of a sketch as shapes, out of the way of each other, of labels and of what is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.view.sketch.dimension_places import placed_dimensions, written
from compoundkin.view.sketch.frame_dimensions import guide_dimensions
from compoundkin.view.sketch.label_obstacles import lines_of
from compoundkin.view.sketch.label_places import Label
from compoundkin.view.sketch.link_dimensions import link_dimensions
from compoundkin.view.sketch.shapes import Shape, Strokes
from compoundkin.view.sketch.slide_shapes import Painter


def dimension_shapes(
    painter: Painter, drawn: Sequence[Shape], labels: Sequence[Label], found: Mapping[str, complex]
) -> list[Shape]:
    """Draw the dimensions of links and guides. They are beside what is drawn and beside the labels."""
    solid = [shape for shape in drawn if not isinstance(shape, Strokes)]
    lines = np.array(list(lines_of(solid)), dtype=complex).reshape(-1, 2)
    boxes = [(found[label.key], label.half) for label in labels]
    wanted = [*guide_dimensions(painter), *link_dimensions(painter)]
    places = placed_dimensions(wanted, lines, boxes, painter.window)
    return [shape for one, at in zip(wanted, places, strict=True) for shape in written(one.text, at)]
