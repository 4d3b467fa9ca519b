"""Motions as SVG that moves by itself, in every browser since 2020 and in pages as an image."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.view.animation.frame_caption import Caption, Gauge
from compoundkin.view.animation.keyframes import AWAY, DEVIATION, Writer, short
from compoundkin.view.animation.overlays import Arrows, MovingCentre, places_of
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.moving_sketch import MovingPart, MovingSketch
from compoundkin.view.sketch.shapes import Polygon, Shape, Text, arrow, corners, leaves, moved
from compoundkin.view.sketch.svg import document, elements

# A point stands still if it moves no farther, picture units.
STILL = 0.005
# A way of fewer letters than this is short enough.
SHORT = 400
# A link turns evenly if so few keyframes say how; only then is leading round it shorter.
FEW = 12
# Poses are shown one by one where a smooth line through most of them is off by more than this, picture units.
FAR_APART = 0.5
MOST_OF_THEM = 0.8


def smil(
    timeline: Timeline, caption: Caption, arrows: Sequence[Arrows], centres: Sequence[MovingCentre], scale: float
) -> str:
    """Write an animation as SVG, `scale` pixels for a picture unit. Where it cannot move, its first pose is shown."""
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


def part_lines(writer: Writer, sketch: MovingSketch, part: MovingPart) -> list[str]:
    """Write a part that moves and turns with its point. It does so in the shortest of several ways."""
    if part.link == FRAME:
        return list(elements(moved(part.shapes, complex(sketch.places(part)[0]))))
    if part.turns:
        part = _about_calm_point(sketch, part)
    inside, angles = list(elements(part.shapes)), _turned_angles(sketch, part.link) if part.turns else None
    turned = inside if angles is None else writer.turned(angles, DEVIATION / _reach(part), inside)
    straight = writer.translated(sketch.places(part)[writer.timeline.poses], turned)
    if writer.one_by_one or sum(map(len, straight)) - sum(map(len, turned)) < SHORT:
        return straight
    return min([straight, *_led_round(writer, sketch, part, angles, inside)], key=lambda lines: sum(map(len, lines)))


def _led_round(
    writer: Writer, sketch: MovingSketch, part: MovingPart, angles: Number | None, inside: list[str]
) -> Iterator[list[str]]:
    """The same part led round fixed points by links that turn about these, as a coupler by a crank, and turned back."""
    scene, poses = sketch.scene, writer.timeline.poses
    for link, at in _carriers(sketch, part):
        pivot = _about_calm_point(sketch, MovingPart(link, at, ()))
        centres = sketch.places(pivot)
        if link == FRAME or np.max(np.abs(centres - centres[0])) > STILL:
            continue
        arm = complex(sketch.window.at(scene.at(link, at)) - sketch.window.at(scene.at(link, pivot.at)))
        led = _turned_angles(sketch, link)
        # both turns are equally fine, so that what stays upright does so exactly
        fine = DEVIATION / (abs(arm) + _reach(part))
        if len(writer.turns(led, fine).times) > FEW:
            continue
        back = writer.turned(-led if angles is None else angles - led, fine, inside)
        arm_end = writer.translated(np.full(poses.shape, arm), back)
        yield writer.translated(centres[poses], writer.turned(led, fine, arm_end))


def _carriers(sketch: MovingSketch, part: MovingPart) -> list[tuple[str, complex]]:
    """The links that have the point of a part, and where it is on them."""
    own = sketch.scene.points
    letters = [letter for letter, p in own[part.link].items() if p == part.at]
    others = [(link, own[link][k]) for k in letters for link in sketch.scene.mechanism.carriers[k]]
    return list(dict.fromkeys([(part.link, part.at), *others]))


def _about_calm_point(sketch: MovingSketch, part: MovingPart) -> MovingPart:
    """The same part as seen from that point of its link which moves least, as a crank from its pivot."""
    points = [part.at, *sketch.scene.points[part.link].values()]
    ways = [float(np.sum(np.abs(np.diff(sketch.places(replace(part, at=p)))))) for p in points]
    at = points[int(np.argmin(np.round(ways, 3)))]
    off = sketch.window.at(sketch.scene.at(part.link, at)) - sketch.window.at(sketch.scene.at(part.link, part.at))
    return replace(part, at=at, shapes=tuple(moved(part.shapes, -complex(off))))


def _reach(part: MovingPart) -> float:
    """How far the farthest corner of a part is from its point, picture units."""
    texts = [shape.at for shape in leaves(part.shapes) if isinstance(shape, Text)]
    return max([1.0, *(abs(corner) for corner in (*corners(part.shapes), *texts))])


def _turned_angles(sketch: MovingSketch, link: str) -> Number:
    """By how much a link is turned on the picture, clockwise there, radians counted over full turns, (poses,)."""
    whole, here = sketch.scene.whole[link].theta, sketch.scene.here[link].theta
    if whole is None or here is None:
        return np.unwrap(np.angle(sketch.turns(link)))
    return np.broadcast_to(here.c[0] - whole.c[0], (sketch.scene.count,)).astype(float)


def are_far_apart(timeline: Timeline, values: Number) -> bool:
    """Tell whether a smooth line through values is much off between poses. The values are (poses, columns)."""
    return any(_off(values[leg]) > FAR_APART for leg in timeline.slices if leg.stop - leg.start > 1)


def _off(values: Number) -> float:
    """By how much a smooth line through values is off between them, but where that is worst.

    Each value is compared with the line through every second one of its neighbours, which is sixteen times as far off
    as that through all. At a limit position any line is off.
    """
    if len(values) < 7:
        return float(np.max(np.abs(np.diff(values, axis=0)), initial=0.0))
    a, b, middle, c, d = values[:-6], values[2:-4], values[3:-3], values[4:-2], values[6:]
    off = np.abs(middle - (9.0 * (b + c) - a - d) / 16.0) / 16.0
    return float(np.quantile(np.max(off, axis=1), MOST_OF_THEM))
