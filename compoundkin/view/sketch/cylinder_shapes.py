"""Cylinders: a barrel from its foot, and the rod with its piston."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import Polygon, Polyline, box
from compoundkin.view.sketch.sketch_style import BLOCK
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

CYLINDER = 17.0
# A cylinder ends at this part of the shortest length, and its piston keeps this distance from both ends.
BARREL = 0.92
PISTON = 7.0


def cylinder(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a cylinder from its foot, and the rod with its piston."""
    barrel, rod = seen.members
    foot, eye, e = painter.place(barrel, mark.at), painter.place(rod, mark.block), painter.along(barrel, mark.along)
    scale = painter.window.scale
    shortest, longest = sorted((abs(mark.low) * scale, abs(mark.high) * scale))
    out = e if (np.conjugate(e) * (eye - foot)).real >= 0 else -e
    length = BARREL * shortest if shortest > 2.0 * BLOCK[0] else max(0.6 * longest, BLOCK[0])
    here = float((np.conjugate(out) * (eye - foot)).real)
    piston = min(max(PISTON + here - shortest, PISTON), length - PISTON)
    rim = box(foot + out * length / 2.0, out, length, CYLINDER)
    yield Laid(Layer.BAR, Polygon(rim, painter.style("plate", barrel)), barrel)
    style = painter.style("bar", rod)
    yield Laid(Layer.BAR, Polyline((foot + out * piston, eye), style), rod)
    across = 1j * out * (CYLINDER / 2.0 - 1.5)
    yield Laid(Layer.BAR, Polyline((foot + out * piston - across, foot + out * piston + across), style), rod)
