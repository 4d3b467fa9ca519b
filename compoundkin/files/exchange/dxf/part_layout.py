"""Parts side by side, as a laser cuts them: each on a layer of its own, contours and holes at true size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.dxf.dxf_pen import DxfPen
from compoundkin.files.exchange.dxf.legal_names import RESERVED, LegalNames
from compoundkin.files.exchange.dxf.link_parts import LinkPart
from compoundkin.files.exchange.dxf.pose_layers import CENTRES, LETTER, NAMES, draw_centre_lines, draw_part
from compoundkin.files.exchange.dxf.profile_splines import ProfileSpline

# Room between parts, and how wide a row of them is, in parts of the mechanism's size.
ROOM, ROW = 0.05, 2.0


def draw_parts(document: Any, parts: Sequence[LinkPart], splines: Mapping[int, ProfileSpline], size: float) -> None:
    """Draw all parts that have a contour, in rows. Raises InvalidInput where none has."""
    cut = [part for part in parts if part.is_cut]
    if not cut:
        what = "no link has an outline, and there is no cam to cut"
        raise InvalidInput(Problem("parts", what, 'write outlines: outline("crank", 8, pin=5)'))
    model, names = document.modelspace(), LegalNames(NAMES, CENTRES, *RESERVED)
    corner, tallest = 0j, 0.0
    for part in cut:
        layers: list[int | None] = [sheet.layer for sheet in part.sheets]
        for layer in layers or [None]:
            low, high = _box(part, splines, layer)
            if corner.real > 0 and corner.real + (high - low).real > ROW * size:
                corner, tallest = complex(0.0, corner.imag - tallest - (2 * ROOM + LETTER) * size), 0.0
            by = corner - complex(low.real, high.imag)
            several = len(part.sheets) > 1
            name = names.of(f"{part.link} layer {layer}" if several else part.link)
            document.layers.add(name, color=7)
            draw_part(DxfPen(model, name, by), part, splines, layer)
            draw_centre_lines(DxfPen(model, CENTRES, by), part, splines)
            under = by + complex(low.real, low.imag - 1.4 * LETTER * size)
            DxfPen(model, NAMES).text(name, under, LETTER * size)
            corner += (high - low).real + ROOM * size
            tallest = max(tallest, (high - low).imag)


def _box(part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None) -> tuple[complex, complex]:
    """The corners of the box around a part's sheet."""
    places = list(_extremes(part, splines, layer))
    xs, ys = [p.real for p in places], [p.imag for p in places]
    return complex(min(xs), min(ys)), complex(max(xs), max(ys))


def _extremes(part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None) -> Iterator[complex]:
    for sheet in part.sheets:
        for contour in sheet.contours if layer in (None, sheet.layer) else ():
            for edge in contour:
                yield from (edge.start, edge.stop)
                if edge.centre is not None and edge.turn > 0:
                    ways = [edge.centre + edge.radius * way for way in (1, 1j, -1, -1j)]
                    yield from (place for place in ways if 0.0 <= edge.share_of(place) <= 1.0)
    for curve in part.profiles:
        yield from splines[id(curve)].control_points.tolist()
