"""Motions as SVG that moves by itself, in every browser since 2020 and in pages as an image.

Movements are keyframes: straight lines between few values over time, as attributes of SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.model.geometry import FRAME
from compoundkin.view.animation.overlays import Arrows, Caption, Gauge, Marked, point_places
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.kinematic_sketch import MovingPart, MovingSketch
from compoundkin.view.sketch.scene import BETWEEN, MOST_PLACES, smooth
from compoundkin.view.sketch.shapes import Polygon, Shape, Text, arrow_shapes, leaves, moved_shapes, shape_corners
from compoundkin.view.sketch.svg import elements, svg_document

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
    timeline: Timeline,
    caption: Caption,
    arrows: Sequence[Arrows],
    marks: Sequence[Marked],
    scale: float,
) -> str:
    """Write an animation as SVG, `scale` pixels for a picture unit. Where it cannot move, its first pose is shown."""
    sketch = caption.sketch
    gauges, texts, height = caption.gauges()
    letters = [point_places(sketch, letter)[timeline.poses] for letter in sketch.scene.letters]
    writer = Writer(timeline, bool(letters) and are_far_apart(timeline, np.stack(letters, axis=1)))
    still: list[Shape] = [caption.paper(height), *sketch.still[1:]]
    moving = _moving(writer, sketch, arrows, marks)
    lines = [*elements(still), *moving, *_gauges(writer, gauges), *elements(texts)]
    styled = [*still, *_styled(sketch, arrows, marks), *texts]
    styled += [shape for gauge in gauges for shape in (*gauge.shapes, gauge.dot)]
    title = sketch.scene.mechanism.title
    size = scale * max(sketch.window.width, height)
    return svg_document(lines, styled, sketch.window.width, height, size, title, caption.description)


def _moving(writer: Writer, sketch: MovingSketch, arrows: Sequence[Arrows], marks: Sequence[Marked]) -> Iterator[str]:
    """All that moves: bodies and pins, then arrows, centres and names, then letters and numbers."""
    for part in (part for part in sketch.parts if not part.is_label):
        yield from part_lines(writer, sketch, part)
    for vectors in arrows:
        yield from _arrows(writer, vectors)
    for mark in marks:
        yield from _mark(writer, mark)
    for part in (part for part in sketch.parts if part.is_label):
        yield from part_lines(writer, sketch, part)


def _gauges(writer: Writer, gauges: Sequence[Gauge]) -> Iterator[str]:
    """Lines with dots for drivers and the time, which leap where a turn begins anew."""
    leaping = replace(writer, one_by_one=writer.one_by_one or writer.timeline.has_seam)
    for gauge in gauges:
        yield from elements(gauge.shapes)
        yield from leaping.translated(gauge.places[writer.timeline.poses], list(elements([gauge.dot])))


def _styled(sketch: MovingSketch, arrows: Sequence[Arrows], marks: Sequence[Marked]) -> Iterator[Shape]:
    """Shapes of every class that is needed for what moves."""
    yield from (shape for part in sketch.parts for shape in part.shapes)
    yield from (shape for mark in marks for shape in mark.marks)
    yield from (shape for one in arrows for shape in arrow_shapes(0j, 1 + 0j, one.scale.kind))


def _arrows(writer: Writer, arrows: Arrows) -> Iterator[str]:
    """The arrows of vectors, whose outlines change; a vector that is not known is a point."""
    timeline, scale = writer.timeline, arrows.scale
    signs = np.where(timeline.directions > 0, 1, arrows.sign(-1))
    for letter, rates in arrows.rates.items():
        start = arrows.places[letter][timeline.poses]
        rate = np.where(np.isfinite(rates), rates, 0.0)[timeline.poses] * signs
        keys = writer.keys(np.stack([start, start + np.conjugate(rate) * scale.per_unit], axis=1))
        drawn = [arrow_shapes(complex(a), complex(b), scale.kind) for a, b in keys.values]
        for n, shape in enumerate(drawn[0]):
            lines = [one[n] for one in drawn]
            ways = replace(keys, values=np.array([line.points for line in lines]))  # type: ignore[union-attr]
            written = _closed_outline if isinstance(shape, Polygon) else _outline
            yield f'<path class="ck-{scale.kind}{"-head" * n}" d="{written(ways.values[0])}">'
            yield f'<animate attributeName="d" {writer.timing(ways, written)}/></path>'


def _mark(writer: Writer, mark: Marked) -> list[str]:
    """What goes along with a place; it waits elsewhere while it is not shown."""
    shown = mark.shown[writer.timeline.poses]
    places = np.where(shown, mark.places[writer.timeline.poses], AWAY)
    return writer.translated(places, list(elements(mark.marks)), shown)


def _outline(points: Number) -> str:
    return "M" + "L".join(f"{short_number(float(p.real), 1)} {short_number(float(p.imag), 1)}" for p in points)


def _closed_outline(points: Number) -> str:
    return f"{_outline(points)}Z"


def part_lines(writer: Writer, sketch: MovingSketch, part: MovingPart) -> list[str]:
    """Write a part that moves and turns with its point. It does so in the shortest of several ways."""
    if part.link == FRAME:
        return list(elements(moved_shapes(part.shapes, complex(sketch.places(part)[0]))))
    if part.turns:
        part = _about_calm_point(sketch, part)
    inside, angles = list(elements(part.shapes)), _turned_angles(sketch, part.link) if part.turns else None
    turned = inside if angles is None else writer.turned(angles, DEVIATION / _reach(part), inside)
    straight = writer.translated(sketch.places(part)[writer.timeline.poses], turned)
    if writer.one_by_one or sum(map(len, straight)) - sum(map(len, turned)) < SHORT:
        return straight
    return min(
        [straight, *_carried_round_fixed_points(writer, sketch, part, angles, inside)],
        key=lambda lines: sum(map(len, lines)),
    )


def _carried_round_fixed_points(
    writer: Writer, sketch: MovingSketch, part: MovingPart, angles: Number | None, inside: list[str]
) -> Iterator[list[str]]:
    """The same part carried round pivots by links that turn about these, as a coupler by a crank, and turned back."""
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
    return replace(part, at=at, shapes=tuple(moved_shapes(part.shapes, -complex(off))))


def _reach(part: MovingPart) -> float:
    """How far the farthest corner of a part is from its point, picture units."""
    texts = [shape.at for shape in leaves(part.shapes) if isinstance(shape, Text)]
    return max([1.0, *(abs(corner) for corner in (*shape_corners(part.shapes), *texts))])


def _turned_angles(sketch: MovingSketch, link: str) -> Number:
    """The angles of a link on the picture from the pose shown, clockwise, unwrapped, (poses,)."""
    whole, here = sketch.scene.whole[link].theta, sketch.scene.here[link].theta
    if whole is None or here is None:
        return np.unwrap(np.angle(sketch.turns(link)))
    return np.broadcast_to(here.c[0] - whole.c[0], (sketch.scene.count,)).astype(float)


def are_far_apart(timeline: Timeline, values: Number) -> bool:
    """Return whether a smooth line through values is much off between poses. The values are (poses, columns)."""
    return any(_off(values[leg]) > FAR_APART for leg in timeline.slices if leg.stop - leg.start > 1)


def _off(values: Number) -> float:
    """The deviation of a smooth line through values between them, without the worst places.

    Each value is compared with the line through every second one of its neighbours, which is sixteen times as far off
    as that through all. At a limit position any line is off.
    """
    if len(values) < 7:
        return float(np.max(np.abs(np.diff(values, axis=0)), initial=0.0))
    a, b, middle, c, d = values[:-6], values[2:-4], values[3:-3], values[4:-2], values[6:]
    off = np.abs(middle - (9.0 * (b + c) - a - d) / 16.0) / 16.0
    return float(np.quantile(np.max(off, axis=1), MOST_OF_THEM))


# What is between keyframes may be off by this much, picture units: with two of them and rounding less than 0.2.
DEVIATION = 0.09
# So many intervals of even length are tried; an even key is written in half the letters, for it needs no time.
EVEN = tuple(n for n in range(2, 721) if 720 % n == 0 or (n > 90 and n % 12 == 0))
CHEAPER = 1.6
# Times that differ by less are one.
SAME_TIME = 1e-6
# Digits after the point: of times in parts of the whole, of places, of degrees.
OF_TIMES, OF_PLACES, OF_DEGREES = 5, 2, 2
# What is not on the picture waits here.
AWAY = -1000.0 - 1000.0j


@dataclass(frozen=True, eq=False)
class Keyframes:
    """Times from 0 to 1 and the values there, (times, columns). Two equal times where the values leap.

    `is_even` where the times are as far apart as they can be, `is_steady` where values stay until the next time.
    """

    times: Number
    values: Number
    is_even: bool = False
    is_steady: bool = False


def keyframes_of(
    timeline: Timeline,
    values: Number,
    deviation: float,
    one_by_one: bool = False,
    shown: Number | None = None,
    away: complex = 0j,
) -> Keyframes:
    """Return the keyframes of values at the poses of a timeline.

    They are (poses,) or (poses, columns), complex or real.

    Where they are not `shown` they are `away`; poses may be shown `one_by_one`.
    """
    columns = np.asarray(values).reshape(len(values), -1)
    seen = np.ones(len(columns), dtype=bool) if shown is None else np.asarray(shown)
    if one_by_one:
        return _one_by_one(timeline, np.where(seen[:, None], columns, away) if shown is not None else columns)
    parts = [part for leg in timeline.slices for part in _parted(leg, seen)]
    runs = [_run(timeline.times[part], columns[part], bool(seen[part].all()), away) for part in parts]
    thin = [(t[keep], v[keep]) for t, v in runs for keep in [_needed(t, v, deviation)]]
    found = _distinct(*_joined(thin))
    even = _even(*_joined(runs), deviation, CHEAPER * len(found.times))
    return found if even is None or len(found.times) < 3 else even


def _joined(runs: list[tuple[Number, Number]]) -> tuple[Number, Number]:
    return np.concatenate([times for times, _ in runs]), np.concatenate([values for _, values in runs])


def _run(times: Number, values: Number, seen: bool, away: complex) -> tuple[Number, Number]:
    """Times and values with those between them; of hidden values the first and the last time."""
    return _smoothed(times, values) if seen else (times[[0, -1]], np.full((2, values.shape[1]), away))


def _even(times: Number, values: Number, deviation: float, most: float) -> Keyframes | None:
    """As few values as will do at even times, which need not be written; None where too many are needed."""
    for count in (count for count in EVEN if count < most):
        even = np.linspace(0.0, 1.0, count + 1)
        found = np.stack([np.interp(even, times, column) for column in values.T], axis=1)
        lines = np.stack([np.interp(times, even, column) for column in found.T], axis=1)
        if np.max(np.abs(lines - values)) <= deviation:
            return Keyframes(even, found, is_even=True)
    return None


def _parted(leg: slice, seen: Number) -> list[slice]:
    """A leg in parts that are shown throughout, and those between them."""
    cuts = leg.start + 1 + np.flatnonzero(np.diff(seen[leg].astype(int)))
    parts = pairwise([leg.start, *(int(cut) for cut in cuts), leg.stop])
    # what is not shown lasts from the last pose that is to the next one
    return [slice(a, b) if seen[a] else slice(max(a - 1, leg.start), min(b + 1, leg.stop)) for a, b in parts]


def _smoothed(times: Number, values: Number) -> tuple[Number, Number]:
    """Times and values with those between them, on a smooth line, where they are few."""
    if not 3 <= len(values) <= MOST_PLACES:
        return times, values
    between = np.linspace(0.0, 1.0, BETWEEN + 1)[:-1]
    full = np.append((times[:-1, None] + np.diff(times)[:, None] * between).ravel(), times[-1])
    return full, np.stack([_line(values[:, k]) for k in range(values.shape[1])], axis=1)


def _line(values: Number) -> Number:
    if np.ptp(np.real(values)) + np.ptp(np.imag(values)) == 0.0:
        return np.full((len(values) - 1) * BETWEEN + 1, values[0])
    line = smooth(np.asarray(values, dtype=complex))
    return line if np.iscomplexobj(values) else line.real


def _needed(times: Number, values: Number, deviation: float) -> Number:
    """Which values are needed so that lines between them in time are nowhere off by more than a deviation.

    Source: the division of D. Douglas and T. Peucker, 1973, with deviations at the same time.
    """
    keep = np.zeros(len(times), dtype=bool)
    keep[[0, -1]] = True
    first, last = np.array([0]), np.array([len(times) - 1])
    while len(open_parts := np.flatnonzero(last - first > 1)):
        # the places between the ends of all parts at once, one part after another
        first, last = first[open_parts], last[open_parts]
        count = last - first - 1
        part, begins = np.repeat(np.arange(len(first)), count), np.cumsum(count) - count
        at = np.arange(len(part)) + (first + 1 - begins)[part]
        start, whole = times[first], times[last] - times[first]
        share = np.divide(times[at] - start[part], whole[part], out=np.zeros(len(at)), where=whole[part] > 0)
        line = values[first][part] + share[:, None] * (values[last] - values[first])[part]
        off = np.max(np.abs(values[at] - line), axis=1)
        most = np.maximum.reduceat(off, begins)
        worst = np.flatnonzero((off == most[part]) & (most > deviation)[part])
        parted, foremost = np.unique(part[worst], return_index=True)
        middle = at[worst[foremost]]
        keep[middle] = True
        first, last = np.concatenate([first[parted], middle]), np.concatenate([middle, last[parted]])
    return keep


def _one_by_one(timeline: Timeline, values: Number) -> Keyframes:
    """Every pose until the next one; the end of what returns is its beginning."""
    times = timeline.times
    kept = times < 1.0 if timeline.returns else np.ones(len(times), dtype=bool)
    if not timeline.returns and len(times) > 1:
        # the last pose is shown as long as the others
        times = times * (1.0 - 1.0 / len(times))
    keys = _distinct(times[kept], values[kept])
    even = np.arange(len(keys.times)) / len(keys.times)
    if len(even) > 1 and np.max(np.abs(keys.times - even)) < SAME_TIME:
        return replace(keys, is_even=True, is_steady=True)
    return _distinct(times[kept], values[kept], steady=True)


def _distinct(times: Number, values: Number, steady: bool = False) -> Keyframes:
    """Keys without those that repeat the one before; a single one where nothing changes."""
    if np.all(values == values[:1]):
        return Keyframes(times[:1], values[:1], is_steady=steady)
    same = (np.diff(times) == 0.0) & np.all(np.diff(values, axis=0) == 0.0, axis=1)
    if steady:
        same |= np.all(np.diff(values, axis=0) == 0.0, axis=1)
    kept = np.concatenate([[True], ~same])
    return Keyframes(times[kept], values[kept], is_steady=steady)


def short_number(value: float, digits: int) -> str:
    """Return a number as a short text.

    >>> short_number(0.25, 2), short_number(10.0, 2), short_number(-0.001, 2), short_number(-0.5, 1)
    ('.25', '10', '0', '-.5')
    """
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    if text in ("-0", "0", ""):
        return "0"
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


@dataclass(frozen=True, eq=False)
class Writer:
    """Writes keyframes of a timeline; `one_by_one` where poses are shown so."""

    timeline: Timeline
    one_by_one: bool

    def keys(self, values: Number, deviation: float = DEVIATION, shown: Number | None = None) -> Keyframes:
        """Return the keyframes of values at the poses of the timeline."""
        return keyframes_of(self.timeline, values, deviation, self.one_by_one, shown, AWAY)

    def timing(self, keys: Keyframes, written: Callable[[Number], str]) -> str:
        """Return the attributes that say which values there are when."""
        words = [f'dur="{short_number(self.timeline.seconds, 3)}s" repeatCount="indefinite"']
        words += ['calcMode="discrete"'] if keys.is_steady else []
        words += (
            [] if keys.is_even else [f'keyTimes="{";".join(short_number(float(t), OF_TIMES) for t in keys.times)}"']
        )
        return " ".join([*words, f'values="{";".join(map(written, keys.values))}"'])

    def moving(self, kind: str, keys: Keyframes, written: Callable[[Number], str], inside: list[str]) -> list[str]:
        """Return elements in a group that is moved ("translate") or turned ("rotate") by keyframes."""
        first = written(keys.values[0])
        if len(keys.times) == 1:
            return [f'<g transform="{kind}({first})">', *inside, "</g>"] if first.strip("0 ") else inside
        how = f'<animateTransform attributeName="transform" type="{kind}" {self.timing(keys, written)}/>'
        return [f'<g transform="{kind}({first})">', how, *inside, "</g>"]

    def translated(self, places: Number, inside: list[str], shown: Number | None = None) -> list[str]:
        """Return elements moved along places at the poses of the timeline."""
        return self.moving("translate", self.keys(places, shown=shown), svg_place, inside)

    def turned(self, angles: Number, deviation: float, inside: list[str]) -> list[str]:
        """Return elements turned by angles over the assembled poses, radians, clockwise on the picture."""
        return self.moving("rotate", self.turns(angles, deviation), _degrees, inside)

    def turns(self, angles: Number, deviation: float) -> Keyframes:
        """Return the keyframes of those angles, in degrees."""
        shown = np.rad2deg(self.timeline.turning(angles))
        return self.keys(shown - whole_turns(shown[0], 360.0), np.rad2deg(deviation))


def svg_place(value: Number) -> str:
    """Return a place as the specification of SVG has it."""
    return f"{short_number(float(value[0].real), OF_PLACES)} {short_number(float(value[0].imag), OF_PLACES)}"


def _degrees(value: Number) -> str:
    return short_number(float(value[0].real), OF_DEGREES)
