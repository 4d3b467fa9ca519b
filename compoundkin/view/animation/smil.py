"""Motions as SVG that moves by itself, in every browser since 2020 and in pages as an image."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.animation.frame_caption import Caption, Gauge
from compoundkin.view.animation.keyframes import are_far_apart, short
from compoundkin.view.animation.overlays import Arrows, MovingCentre, places_of
from compoundkin.view.animation.svg_keyframes import AWAY, Writer
from compoundkin.view.animation.svg_parts import part_lines
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.shapes import Polygon, Shape
from compoundkin.view.sketch.strokes import arrow
from compoundkin.view.sketch.svg import document, elements


def smil(
    timeline: Timeline, caption: Caption, arrows: Sequence[Arrows], centres: Sequence[MovingCentre], scale: float
) -> str:
    """Write an animation as SVG, `scale` pixels for a picture unit; where it cannot move, its first pose is shown."""
    sketch = caption.sketch
    gauges, texts, height = caption.gauges()
    letters = [places_of(sketch, letter)[timeline.poses] for letter in sketch.scene.letters]
    writer = Writer(timeline, bool(letters) and are_far_apart(timeline, np.stack(letters, axis=1)))
    still: list[Shape] = [caption.paper(height), *sketch.still[1:]]
    moving = _moving(writer, sketch, arrows, centres)
    lines = [*elements(still), *moving, *_gauges(writer, gauges), *elements(texts)]
    styled = [*still, *_styled(sketch, arrows, centres), *texts]
    styled += [shape for gauge in gauges for shape in (*gauge.shapes, gauge.dot)]
    title = sketch.scene.mechanism.title
    size = scale * max(sketch.window.width, height)
    return document(lines, styled, sketch.window.width, height, size, title, caption.description)


def _moving(
    writer: Writer, sketch: MovingSketch, arrows: Sequence[Arrows], centres: Sequence[MovingCentre]
) -> Iterator[str]:
    """All that moves: bodies and pins, then arrows and centres, then letters and numbers."""
    for part in (part for part in sketch.parts if not part.is_label):
        yield from part_lines(writer, sketch, part)
    for vectors in arrows:
        yield from _arrows(writer, vectors)
    for centre in centres:
        yield from _centre(writer, centre)
    for part in (part for part in sketch.parts if part.is_label):
        yield from part_lines(writer, sketch, part)


def _gauges(writer: Writer, gauges: Sequence[Gauge]) -> Iterator[str]:
    """Lines with dots for drivers and the time, which leap where a turn begins anew."""
    leaping = replace(writer, one_by_one=writer.one_by_one or writer.timeline.has_seam)
    for gauge in gauges:
        yield from elements(gauge.shapes)
        yield from leaping.translated(gauge.places[writer.timeline.poses], list(elements([gauge.dot])))


def _styled(sketch: MovingSketch, arrows: Sequence[Arrows], centres: Sequence[MovingCentre]) -> Iterator[Shape]:
    """Shapes of every class that is needed for what moves."""
    yield from (shape for part in sketch.parts for shape in part.shapes)
    yield from (shape for centre in centres for shape in centre.marks)
    yield from (shape for one in arrows for shape in arrow(0j, 1 + 0j, one.scale.kind))


def _arrows(writer: Writer, arrows: Arrows) -> Iterator[str]:
    """The arrows of vectors, whose outlines change; a vector that is not known is a point."""
    timeline, scale = writer.timeline, arrows.scale
    signs = np.where(timeline.ways > 0, 1, arrows.sign(-1))
    for letter, rates in arrows.rates.items():
        start = arrows.places[letter][timeline.poses]
        rate = np.where(np.isfinite(rates), rates, 0.0)[timeline.poses] * signs
        keys = writer.keys(np.stack([start, start + np.conjugate(rate) * scale.per_unit], axis=1))
        drawn = [arrow(complex(a), complex(b), scale.kind) for a, b in keys.values]
        for n, shape in enumerate(drawn[0]):
            lines = [one[n] for one in drawn]
            ways = replace(keys, values=np.array([line.points for line in lines]))  # type: ignore[union-attr]
            written = _closed_outline if isinstance(shape, Polygon) else _outline
            yield f'<path class="ck-{scale.kind}{"-head" * n}" d="{written(ways.values[0])}">'
            yield f'<animate attributeName="d" {writer.timing(ways, written)}/></path>'


def _centre(writer: Writer, centre: MovingCentre) -> list[str]:
    """An instant centre, which waits elsewhere while it is not on the picture."""
    shown = centre.shown[writer.timeline.poses]
    places = np.where(shown, centre.places[writer.timeline.poses], AWAY)
    return writer.translated(places, list(elements(centre.marks)), shown)


def _outline(points: Number) -> str:
    return "M" + "L".join(f"{short(float(p.real), 1)} {short(float(p.imag), 1)}" for p in points)


def _closed_outline(points: Number) -> str:
    return f"{_outline(points)}Z"
