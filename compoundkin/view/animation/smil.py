"""Motions as SVG that moves by itself, in every browser since 2020 and in pages as an image."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.animation.frame_caption import Gauge
from compoundkin.view.animation.keyframes import are_far_apart, short
from compoundkin.view.animation.overlays import Arrows, MovingCentre, places_of
from compoundkin.view.animation.svg_keyframes import AWAY, Writer
from compoundkin.view.animation.svg_parts import part_lines
from compoundkin.view.sketch.shapes import Polygon, Shape
from compoundkin.view.sketch.strokes import arrow
from compoundkin.view.sketch.svg import document, elements

if TYPE_CHECKING:
    from compoundkin.view.animation.animation import Animation


def smil(animation: Animation) -> str:
    """The source of an animation as SVG; where animations are not shown, its first pose is."""
    sketch, course = animation.sketch, animation.course
    gauges, texts, height = animation.caption.gauges()
    letters = [places_of(sketch, letter)[course.poses] for letter in sketch.scene.letters]
    writer = Writer(course, bool(letters) and are_far_apart(course, np.stack(letters, axis=1)))
    still: list[Shape] = [animation.caption.paper(height), *sketch.still[1:]]
    lines = [*elements(still), *_moving(writer, animation), *_gauges(writer, gauges), *elements(texts)]
    size = animation.shown_size * max(sketch.window.width, height) / animation.longer
    styled = [*still, *_styled(animation), *(shape for gauge in gauges for shape in (*gauge.shapes, gauge.dot)), *texts]
    title = sketch.scene.mechanism.title
    return document(lines, styled, sketch.window.width, height, size, title, animation.description)


def _moving(writer: Writer, animation: Animation) -> Iterator[str]:
    """All that moves: bodies and pins, then arrows and centres, then letters and numbers."""
    sketch = animation.sketch
    for part in (part for part in sketch.parts if not part.is_label):
        yield from part_lines(writer, sketch, part)
    for arrows in animation.arrows:
        yield from _arrows(writer, arrows)
    for centre in animation.centres:
        yield from _centre(writer, centre)
    for part in (part for part in sketch.parts if part.is_label):
        yield from part_lines(writer, sketch, part)


def _gauges(writer: Writer, gauges: Sequence[Gauge]) -> Iterator[str]:
    """Lines with dots for drivers and the time, which leap where a turn begins anew."""
    leaping = replace(writer, one_by_one=writer.one_by_one or writer.course.has_seam)
    for gauge in gauges:
        yield from elements(gauge.shapes)
        yield from leaping.translated(gauge.places[writer.course.poses], list(elements([gauge.dot])))


def _styled(animation: Animation) -> Iterator[Shape]:
    """Shapes of every class that is needed for what moves."""
    yield from (shape for part in animation.sketch.parts for shape in part.shapes)
    yield from (shape for centre in animation.centres for shape in centre.marks)
    yield from (shape for arrows in animation.arrows for shape in arrow(0j, 1 + 0j, arrows.scale.kind))


def _arrows(writer: Writer, arrows: Arrows) -> Iterator[str]:
    """The arrows of vectors, whose outlines change; a vector that is not known is a point."""
    course, scale = writer.course, arrows.scale
    signs = np.where(course.ways > 0, 1, arrows.sign(-1))
    for letter, rates in arrows.rates.items():
        start = arrows.places[letter][course.poses]
        rate = np.where(np.isfinite(rates), rates, 0.0)[course.poses] * signs
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
    shown = centre.shown[writer.course.poses]
    places = np.where(shown, centre.places[writer.course.poses], AWAY)
    return writer.translated(places, list(elements(centre.marks)), shown)


def _outline(points: Number) -> str:
    return "M" + "L".join(f"{short(float(p.real), 1)} {short(float(p.imag), 1)}" for p in points)


def _closed_outline(points: Number) -> str:
    return f"{_outline(points)}Z"
