"""What accompanies a moving sketch: arrows of velocities, accelerations and forces, instant centres, the caption."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.centres import instant_centres
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.forces import Forces
from compoundkin.model.attributes import unit_suffix
from compoundkin.view.animation.timeline import pose_times
from compoundkin.view.sketch.centre_pictures import DOT, TOGETHER, centre_number
from compoundkin.view.sketch.force_arrows import (
    AROUND_DRIVER,
    ROUND,
    ForceCourse,
    drawn_force_courses,
    drawn_moment_courses,
    force_name,
    force_scales,
    moment_arc,
)
from compoundkin.view.sketch.kinematic_sketch import MovingSketch
from compoundkin.view.sketch.labels import Label, label_around, placed, text_half
from compoundkin.view.sketch.picture import BELOW, lines_below, lines_of_text
from compoundkin.view.sketch.picture_options import pose_notes
from compoundkin.view.sketch.scene import MARGIN, Window
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, Text, leaves, moved_shapes, sheet
from compoundkin.view.sketch.sketch_style import LETTER, LINE, SMALL
from compoundkin.view.sketch.vectors import VectorScale, scale_shapes, vector_shapes

# So near to the edge of a picture a centre is left out.
EDGE = 2.0
# The name of a centre stands so far beside it where no better place is known.
BESIDE = 9.0 - 9.0j
FAR = 22.0


@dataclass(frozen=True, eq=False)
class Arrows:
    """Vectors of one kind at all points over the assembled poses. `places` on the picture."""

    scale: VectorScale
    places: dict[str, Number]
    rates: dict[str, Number]

    def sign(self, way: int) -> int:
        """Return the factor of the vectors where the motion goes back. Velocities turn round, accelerations do not."""
        return int(way**self.scale.order)

    def shapes(self, k: int, way: int) -> list[Shape]:
        """Return the arrows at the k-th assembled pose."""
        rates = {letter: complex(v[k]) * self.sign(way) for letter, v in self.rates.items() if np.isfinite(v[k])}
        return vector_shapes({letter: complex(self.places[letter][k]) for letter in rates}, rates, self.scale)


@dataclass(frozen=True, eq=False)
class MovingMark:
    """Shapes that go along with a place, as seen from there. They are shown at some poses."""

    marks: tuple[Shape, ...]
    places: Number
    shown: Number

    def shapes(self, k: int) -> list[Shape]:
        """Draw them at the k-th assembled pose."""
        return moved_shapes(self.marks, complex(self.places[k])) if self.shown[k] else []


@dataclass(frozen=True, eq=False)
class MovingCentre:
    """An instant centre, or several that are always at one place. It is shown at some poses."""

    name: str
    places: Number
    shown: Number
    beside: complex = BESIDE

    @property
    def marks(self) -> tuple[Shape, ...]:
        """A dot with its name, as seen from the centre."""
        halo, name = (Text(self.beside, self.name, style) for style in ("centre-name halo", "centre-name"))
        return CircleShape(0j, DOT, "centre"), halo, name

    def shapes(self, k: int) -> list[Shape]:
        """Draw it at the k-th assembled pose; nothing where it is off the picture."""
        return moved_shapes(self.marks, complex(self.places[k])) if self.shown[k] else []


Marked: TypeAlias = MovingMark | MovingCentre


def with_arrows(sketch: MovingSketch, kinds: Sequence[str], back: bool) -> tuple[MovingSketch, tuple[Arrows, ...]]:
    """Return arrows of some kinds and the sketch with room for them. With a way `back`, for both senses.

    Raises InvalidInput where the motion was not solved for them.
    """
    made: list[Arrows] = []
    for scale in filter(None, map(sketch.scale, kinds)):
        rates = sketch.rates(scale.kind)
        made.append(Arrows(scale, {letter: point_places(sketch, letter) for letter in rates}, rates))
    tips = [tip for arrows in made for tip in _tips(arrows, back)]
    larger = sketch.holding(np.concatenate(tips), MARGIN / 2.0) if tips else sketch
    return larger, tuple(replace(one, places={k: point_places(larger, k) for k in one.places}) for one in made)


def point_places(sketch: MovingSketch, letter: str) -> Number:
    """Return where a point is on the picture, (poses,)."""
    return np.broadcast_to(sketch.window.at(sketch.scene.places(letter)), (sketch.scene.count,))


def _tips(arrows: Arrows, back: bool) -> list[Number]:
    ways = {1, arrows.sign(-1)} if back else {1}
    found = []
    for letter, rates in arrows.rates.items():
        rate = np.conjugate(np.where(np.isfinite(rates), rates, 0.0)) * arrows.scale.per_unit
        found += [arrows.places[letter] + sign * rate for sign in sorted(ways)]
    return found


def moving_centres(sketch: MovingSketch) -> tuple[MovingCentre, ...]:
    """Return all instant centres that are ever on the picture. Those that are always at one place are together."""
    scene, window = sketch.scene, sketch.window
    centres = instant_centres(sketch.motion)
    apart: list[tuple[list[str], Number]] = []
    for pair in centres:
        rows = np.reshape(centres[pair].point, (sketch.motion.inputs.designs, -1))
        row = np.where(np.isfinite(rows[sketch.design]), rows[sketch.design], np.nan)
        places = np.asarray(window.at(np.broadcast_to(row, sketch.motion.inputs.poses)[scene.known]))
        same = next((names for names, other in apart if _always_together(places, other)), None)
        if same is None:
            apart.append(([centre_number(scene, *pair)], places))
        else:
            same.append(centre_number(scene, *pair))
    found = [MovingCentre(" ".join(names), places, _centre_on_picture(window, places)) for names, places in apart]
    return _beside(sketch, [one for one in found if one.shown.any()])


def _always_together(one: Number, other: Number) -> bool:
    known = np.isfinite(one) & np.isfinite(other)
    return bool(known.any() and np.all(np.abs(one - other)[known] < TOGETHER))


def _centre_on_picture(window: Window, places: Number) -> Number:
    with np.errstate(invalid="ignore"):
        across = (places.real >= EDGE) & (places.real <= window.width - EDGE)
        return np.isfinite(places) & across & (places.imag >= EDGE) & (places.imag <= window.height - EDGE)


def _beside(sketch: MovingSketch, centres: Sequence[MovingCentre]) -> tuple[MovingCentre, ...]:
    """The centres with their names where they cover nothing at the pose shown first."""
    k = int(np.searchsorted(sketch.scene.known, sketch.scene.pose[1]))
    shapes = list(leaves(sketch.shapes(k)))
    taken = [Label(f"text {n}", text_half(s.text, LETTER), (s.at,), (0.0,)) for n, s in enumerate(texts_in(shapes))]
    here = [one for one in centres if one.shown[k]]
    names = [label_around(c.name, complex(c.places[k]), text_half(c.name, SMALL), 5.0, 1 + 1j) for c in here]
    found = placed([*taken, *names], shapes, sketch.window.width, sketch.window.height)
    offs = {c.name: complex(found[c.name] - c.places[k]) for c in here}
    # farther off a name would seem to belong to nothing once the centre has moved on
    return tuple(replace(c, beside=offs[c.name]) if abs(offs.get(c.name, FAR)) < FAR else c for c in centres)


def texts_in(shapes: Sequence[Shape]) -> list[Text]:
    """Return the texts among shapes."""
    return [shape for shape in shapes if isinstance(shape, Text)]


def with_force_arrows(
    sketch: MovingSketch, forces: Forces, others: tuple[Arrows, ...] = (), *, named: bool = True
) -> tuple[MovingSketch, tuple[Arrows, ...], tuple[MovingMark, ...]]:
    """Return the arrows of forces after others, the sketch with room for all, and the marks that go along.

    Marks are the arcs of moments, not to scale, and if `named` the names of forces and moments.
    """
    courses = drawn_force_courses(forces, sketch.scene, sketch.design)
    scales = force_scales(forces, sketch.window.diagonal, courses)
    turning = drawn_moment_courses(forces, sketch.scene, sketch.design)
    known = sketch.scene.known
    tips = [sketch.window.at(one.at[known]) + np.conjugate(_finite(one.force[known])) * scale.per_unit
            for scale in scales[:1] for one in courses]  # fmt: skip
    tips += [sketch.window.at(one.at[known]) + way * AROUND_DRIVER for one in turning for way in (1, -1, 1j, -1j)]
    larger = sketch.holding(np.concatenate(tips), MARGIN) if tips else sketch
    kept = (replace(one, places={k: point_places(larger, k) for k in one.places}) for one in others)
    marks = [mark for one in turning for mark in _moment_marks(larger, one, named)]
    if named:
        for scale in scales[:1]:
            for one in courses:
                marks.append(_name_of_arrow(larger, one, scale, _places_of_names(larger, marks)))
    return larger, (*kept, *(_arrows(larger, scale, courses) for scale in scales)), tuple(marks)


# Half the size of a pin, on which no name stands.
PIN = 6.0 + 6.0j
# Arrows shorter than this have no name in a film, and moments below this part of their greatest no arc.
NAMED, TURNING = 14.0, 0.01


# A name stands ahead of its arrow, turned from there by so much (radians), or beside this part of it.
TURNED, BESIDE_PARTS = (0.0, 0.6, -0.6, 1.2, -1.2), (0.75, 0.5)


def _places_of_names(sketch: MovingSketch, marks: Sequence[MovingMark]) -> list[tuple[Number, complex]]:
    """Return where letters, numbers, names of marks and pins are over the assembled poses, with half their sizes."""
    found = [(sketch.places(part) + text.at, text_half(text.text, LETTER))
             for part in sketch.parts if part.is_label for text in texts_in(list(leaves(part.shapes)))]  # fmt: skip
    found += [(np.where(mark.shown, mark.places + text.at, np.nan), text_half(text.text, SMALL))
              for mark in marks for text in texts_in(mark.marks)]  # fmt: skip
    return [*found, *((point_places(sketch, letter), PIN) for letter in sketch.scene.letters)]


def _clear_places(offered: Sequence[Number], half: complex, taken: Sequence[tuple[Number, complex]]) -> Number:
    """Return at each pose the offered place that covers the fewest names, the first of such."""
    offers = np.array(offered)
    covers = np.zeros(offers.shape, dtype=int)
    for places, other in taken:
        off, room = offers - places, half + other
        covers += (np.abs(off.real) < room.real) & (np.abs(off.imag) < room.imag)
    return np.asarray(np.take_along_axis(offers, np.argmin(covers, axis=0)[None], axis=0)[0])


def _name_of_arrow(
    sketch: MovingSketch, one: ForceCourse, scale: VectorScale, taken: Sequence[tuple[Number, complex]]
) -> MovingMark:
    """The name of a force, which goes ahead of the head of its arrow, or beside it where other names are."""
    known = sketch.scene.known
    way = np.conjugate(_finite(one.force[known])) * scale.per_unit
    length = np.abs(way)
    half = text_half(one.shown.name, SMALL)
    e = way / np.where(length > 0.0, length, 1.0)
    at = np.asarray(sketch.window.at(one.at[known]))

    def clear(along: Number, e: Number) -> Number:
        return at + along + e * (np.abs(e.real) * half.real + np.abs(e.imag) * half.imag + 3.0)

    offered = [clear(way, e * np.exp(1j * turn)) for turn in TURNED]
    offered += [clear(way * part, e * side) for part in BESIDE_PARTS for side in (1j, -1j)]
    shown = length >= NAMED
    places = _clear_places([np.where(shown, place, np.nan) for place in offered], half, taken)
    return MovingMark(force_name(one.shown.name, 0j, one.shown.kind), places, shown)


def _moment_marks(sketch: MovingSketch, one: ForceCourse, named: bool) -> Iterator[MovingMark]:
    """The arcs of a moment, one for each sense, and its name."""
    known = sketch.scene.known
    places = np.asarray(sketch.window.at(one.at[known]))
    moment = _finite(one.moment[known])
    large = np.abs(moment) >= TURNING * float(np.max(np.abs(moment), initial=0.0))
    radius = AROUND_DRIVER if one.shown.is_driver else ROUND
    for sense in (1.0, -1.0):
        shown = large & (np.sign(moment) == sense)
        if shown.any():
            arc = moment_arc(replace(one.shown, moment=sense), 0j, radius, 1j)
            yield MovingMark(tuple(leaves(arc)), places, shown)
    if named:
        beside = 1j * (radius + text_half(one.shown.turning, SMALL).imag + 3.0)
        yield MovingMark(force_name(one.shown.turning, beside, one.shown.kind), places, large)


def _arrows(sketch: MovingSketch, scale: VectorScale, courses: tuple[ForceCourse, ...]) -> Arrows:
    """The arrows of one kind."""
    known = sketch.scene.known
    own = {f"{one.shown.link} {one.shown.name}": one for one in courses if one.shown.kind == scale.kind}
    places = {key: np.asarray(sketch.window.at(one.at[known])) for key, one in own.items()}
    return Arrows(scale, places, {key: one.force[known] for key, one in own.items()})


def _finite(values: Number) -> Number:
    return np.where(np.isfinite(values), values, 0.0)


LEFT = 16.0
# A gauge is so long: this part of the picture's width, but no longer than this.
GAUGE, LONGEST_GAUGE = 0.3, 160.0
# Times are shown with so many digits of the whole.
DIGITS = 3


@dataclass(frozen=True, eq=False)
class Gauge:
    """A line with a dot that shows where a driver is, or the time. Its `values` are those over the assembled poses."""

    text: str
    values: Number
    start: complex
    length: float

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The line and what it stands for."""
        stop = self.start + self.length
        return Polyline((self.start, stop), "edge"), Text(stop + 10.0, self.text, "note", "start")

    @property
    def dot(self) -> CircleShape:
        """The dot, as seen from where it is."""
        return CircleShape(0j, 3.2, "dot")

    @property
    def places(self) -> Number:
        """Where the dot is, (poses,)."""
        low, span = self.values.min(), np.ptp(self.values)
        return self.start + self.length * (self.values - low) / (span or 1.0)


@dataclass(frozen=True, eq=False, repr=False)
class Caption(ShortRepr):
    """The lines below a moving sketch; the first of them change with the pose."""

    sketch: MovingSketch
    poses: Number  # those that are ever shown as frames
    names: tuple[str, ...]
    scales: tuple[VectorScale, ...]
    has_notes: bool = True  # else there are scales only

    @property
    def window(self) -> Window:
        """The window of the sketch."""
        return self.sketch.window

    @property
    def description(self) -> str:
        """A sentence that describes the animation."""
        mechanism = self.sketch.scene.mechanism
        return f"Motion of {mechanism.title}: {mechanism.in_numbers}"

    def notes(self, k: int) -> list[str]:
        """Return the time and the drivers' values at the k-th assembled pose."""
        if not self.has_notes:
            return []
        scene, motion = self.sketch.scene, self.sketch.motion
        here = replace(scene, pose=(scene.pose[0], int(scene.known[k])))
        times = [] if motion.time is None else [f"at {self._times[k]:.{self._decimals}f} s"]
        return [*times, *pose_notes(here)]

    def shapes(self, k: int) -> tuple[list[Shape], float]:
        """Return the texts at the k-th assembled pose, and the picture's height. The height is that with them."""
        lines = lines_of_text(self.notes(k), self._room)
        lines += [""] * (self._changing - len(lines)) + lines_of_text(self.names, self._room)
        found, height = lines_below(lines, self.window.height)
        return self._scaled([shape for shape in found if not isinstance(shape, Text) or shape.text], height)

    def gauges(self) -> tuple[list[Gauge], list[Shape], float]:
        """Return lines with dots in the place of texts that change. What else stands there, and the height with all."""
        gauged = list(self._gauged()) if self.has_notes else []
        moving = [(text, values) for text, values in gauged if np.ptp(values) > 0]
        start = complex(LEFT, self.window.height + BELOW)
        length = min(GAUGE * self.window.width, LONGEST_GAUGE)
        found = [Gauge(text, v, start + 1j * LINE * n, length) for n, (text, v) in enumerate(moving)]
        lines = ["" for _ in moving] + lines_of_text([*self._still(gauged), *self.names], self._room)
        texts, height = lines_below(lines, self.window.height)
        texts = [shape for shape in texts if not isinstance(shape, Text) or shape.text]
        return found, *self._scaled(texts, height)

    @property
    def _room(self) -> float:
        return self.window.width - 2.0 * LEFT

    @cached_property
    def _changing(self) -> int:
        """How many lines the notes take at most, so that pictures are equally high."""
        return max((len(lines_of_text(self.notes(int(k)), self._room)) for k in self.poses), default=0)

    @cached_property
    def _times(self) -> Number:
        """The times of the assembled poses, seconds."""
        return pose_times(self.sketch.motion, self.sketch.design)[self.sketch.scene.known]

    @cached_property
    def _decimals(self) -> int:
        span = float(np.max(np.abs(self._times))) or 1.0
        return int(max(0, DIGITS - 1 - np.floor(np.log10(span))))

    def _gauged(self) -> Iterator[tuple[str, Number]]:
        """The texts of gauges with their values over the assembled poses."""
        scene, motion = self.sketch.scene, self.sketch.motion
        if motion.time is not None:
            low, high = self._times.min(), self._times.max()
            yield f"time, {low:.6g} to {high:.6g} s", self._times
        shape = motion.inputs.designs, motion.inputs.poses
        for step in scene.driven:
            name = step.drive.name
            values = np.broadcast_to(motion.inputs.drives[name][0], shape)[scene.pose[0]][scene.known]
            shown = np.rad2deg(values) if step.pair.free_is_angle else values
            unit = unit_suffix(step.pair.free_is_angle, scene.mechanism.unit)
            yield f"{name}, {shown.min():.5g} to {shown.max():.5g}{unit}", np.asarray(values, dtype=float)

    def _still(self, gauged: Sequence[tuple[str, Number]]) -> list[str]:
        """The notes that do not change."""
        notes = self.notes(0)
        return [note for note, (_, values) in zip(notes, gauged, strict=True) if np.ptp(values) == 0]

    def _scaled(self, texts: list[Shape], height: float) -> tuple[list[Shape], float]:
        for scale in self.scales:
            texts += scale_shapes(scale, height)
            height += LINE
        return texts, height

    def paper(self, height: float) -> Polygon:
        """Return the paper of a picture so high."""
        wide = self.window.width
        return sheet(wide, height)
