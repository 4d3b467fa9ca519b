"""Normal force, shear or bending moment drawn on the links of a sketch: at the pose, and the envelope of all poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.strength import BENDING, NORMAL, SHEAR, BarForces, pose_text, strength
from compoundkin.view.sketch.force_arrows import force_text, forces_in
from compoundkin.view.sketch.kinematic_sketch import in_layers, window_on
from compoundkin.view.sketch.labels import Label, label_around, label_shapes, labels_of, placed, text_half
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import SIDE, Picture, checked_size, lines_below, lines_of_text
from compoundkin.view.sketch.picture_options import PictureOptions, label_kinds, pose_notes, scene_of
from compoundkin.view.sketch.scene import MARGIN, Scene, Window, fitted_window
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape, Strokes, Text, arrow_shapes, sheet
from compoundkin.view.sketch.sketch_style import LINE, SMALL, style_of
from compoundkin.view.sketch.vectors import VectorScale, round_below

# The longest ordinate is this part of the picture's diagonal.
LONGEST = 0.13
# Ordinates stand so far apart on the bar at most, picture units, and shorter ones than this are left out.
APART, SHORTEST = 9.0, 1.0
# A longer one has its value beside it.
READABLE = 5.0


@dataclass(frozen=True, eq=False)
class BarDiagram:
    """A quantity along a bar: at the pose of a scene, and the least and greatest of all poses, in the same places."""

    name: str
    bar: BarForces
    places: Number
    here: Number
    least: Number
    greatest: Number

    @property
    def largest(self) -> float:
        """The greatest magnitude of all poses."""
        return float(np.nanmax(np.abs([self.here, self.least, self.greatest]), initial=0.0))

    def corners(self, scene: Scene, window: Window, ordinates: Number, per_unit: float) -> tuple[complex, ...]:
        """Return the tips of ordinates on the picture, positive ones 90 degrees counterclockwise of the bar."""
        start, end = (scene.at(self.bar.link, scene.points[self.bar.link][one]) for one in self._ends)
        way = (end - start) / abs(end - start)
        # the axis upwards on the picture is down on paper
        foot = np.asarray(window.at(start + way * self.places))
        aside = np.asarray(window.at(start + 1j * way)) - complex(window.at(start))
        return tuple((foot + aside / abs(aside) * ordinates * per_unit).tolist())

    @property
    def _ends(self) -> tuple[str, str]:
        return self.bar.letters[0], self.bar.letters[-1]


def normal_force_picture(forces: Forces, options: PictureOptions) -> Picture:
    """Draw the normal force on the bars of a sketch, tension on the side of the positive ordinates."""
    return _picture(forces, options, NORMAL)


def shear_picture(forces: Forces, options: PictureOptions) -> Picture:
    """Draw the shear on the bars of a sketch."""
    return _picture(forces, options, SHEAR)


def bending_moment_picture(forces: Forces, options: PictureOptions) -> Picture:
    """Draw the bending moment on the bars of a sketch."""
    return _picture(forces, options, BENDING)


def _picture(forces: Forces, options: PictureOptions, what: str) -> Picture:
    scene, kinds = scene_of(forces.motion, options.at, options.pose, options.design), label_kinds(options.labels)
    links = (options.link,) if options.link is not None else ()
    shown, missing = _diagrams(forces, scene, links, what, options.design)
    largest = max((one.largest for one in shown), default=0.0)
    if not shown or not largest > 0.0:
        why = "; ".join(f"{link}: {reason}" for link, reason in missing.items()) or f"there is no {what}"
        raise InvalidInput(Problem("bars", why, "choose another link, or another quantity"))
    window = window_on(scene)
    unit = forces.units.moment if what == BENDING else forces.units.force
    amount = round_below(largest)
    scale = VectorScale("drive", LONGEST * window.diagonal / largest, amount, f"{force_text(amount)} {unit}")
    window = _with_room(scene, window, shown, scale)
    shapes, values = _shapes(scene, window, shown, scale)
    laid = in_layers(Painter(scene, window))
    behind = [one.shape for one in laid]
    own = labels_of(Painter(scene, window), laid, kinds)
    labels = [label for label, _ in values] if kinds else []
    found = placed([*own, *labels], [*behind, *shapes], window.width, window.height)
    texts = [*label_shapes(scene, {label.key: found[label.key] for label in own})]
    texts += [Text(found[label.key], text, "number", "middle") for label, text in values if kinds]
    notes = [*_notes(forces, scene, shown, missing, options, what, unit)]
    below, height = lines_below(lines_of_text(notes, window.width - 2.0 * SIDE), window.height)
    below += _scale_bar(scale, height)
    title = f"{scene.mechanism.title}: {what}"
    told = "; ".join(f"{one.name} {one.largest:.4g} {unit}" for one in shown)
    drawn = (sheet(window.width, height + LINE), *shapes, *behind, *texts, *below)
    return Picture(drawn, window.width, height + LINE, title, told, checked_size(options.size), window)


def _diagrams(
    forces: Forces, scene: Scene, links: Sequence[str], what: str, design: int
) -> tuple[list[BarDiagram], dict[str, str]]:
    """Return the diagrams of bars, and the links without one with the reason."""
    every = strength(forces, *links)
    here = strength(forces_in(forces, scene), *links).bars
    found, (own, pose) = [], scene.pose
    for name, bar in every.bars.items():
        places, least, greatest = bar.envelope(what, design)
        found.append(BarDiagram(name, bar, places, here[name].along(what, places, own)[pose], least, greatest))
    return [one for one in found if np.isfinite(one.here).all()], dict(every.undefined)


def _with_room(scene: Scene, window: Window, shown: Sequence[BarDiagram], scale: VectorScale) -> Window:
    """Return the window made large enough for the diagrams."""
    tips = [tip for one in shown for values in (one.least, one.greatest, one.here)
            for tip in one.corners(scene, window, np.nan_to_num(values), scale.per_unit)]  # fmt: skip
    inner = [MARGIN * (1 + 1j), complex(window.width, window.height) - MARGIN * (1 + 1j)]
    return fitted_window(window, np.array([*inner, *tips]))


def _shapes(
    scene: Scene, window: Window, shown: Sequence[BarDiagram], scale: VectorScale
) -> tuple[list[Shape], list[tuple[Label, str]]]:
    """Return envelopes, diagrams and ordinates, and the labels of the greatest values at the pose."""
    envelopes, lines, values = list[Shape](), list[Shape](), list[tuple[Label, str]]()
    for one in shown:
        group = scene.groups.get(one.bar.link, 0)
        feet, low, high, tips = (one.corners(scene, window, np.nan_to_num(ordinates), scale.per_unit)
                                 for ordinates in (0.0 * one.here, one.least, one.greatest, one.here))  # fmt: skip
        envelopes.append(Polygon((*high, *low[::-1]), style_of("area", group)))
        lines.append(Polyline((feet[0], *tips, feet[-1]), style_of("line", group)))
        lines.append(Strokes(tuple(_ordinates(feet, tips)), style_of("thin", group)))
        k = int(np.argmax(np.abs(one.here)))
        if abs(tips[k] - feet[k]) >= READABLE:
            text = force_text(float(one.here[k])).replace("-", "−")
            half, aside = text_half(text, SMALL), tips[k] - feet[k]
            values.append((label_around(f"value {one.name}", tips[k], half, 3.0, aside), text))
    return [*envelopes, *lines], values


def _ordinates(feet: Sequence[complex], tips: Sequence[complex]) -> Iterator[tuple[complex, complex]]:
    """Yield ordinates at about equal distances."""
    count = max(int(abs(feet[-1] - feet[0]) / APART), 1)
    for k in np.unique(np.linspace(0, len(feet) - 1, count + 1).round().astype(int)).tolist():
        if abs(tips[k] - feet[k]) >= SHORTEST:
            yield feet[k], tips[k]


def _notes(
    forces: Forces,
    scene: Scene,
    shown: Sequence[BarDiagram],
    missing: dict[str, str],
    options: PictureOptions,
    what: str,
    unit: str,
) -> Iterator[str]:
    yield from pose_notes(scene)
    yield from (f"{number} {name}" for name, number in scene.legend.items())
    yield f"{what} in {unit}, tension positive" if what == NORMAL else f"{what} in {unit}"
    if forces.motion.inputs.poses > 1:
        yield "pale: from the least to the greatest of all poses"
        for one in shown:
            end = max(one.bar.extremes(what, options.design), key=lambda found: abs(found.value))
            where = pose_text(one.bar.motion, options.design, end.pose)
            yield f"{one.name} {force_text(end.value).replace('-', '−')} at {where}"
    if not forces.inertia:
        yield "statics"
    if missing:
        yield f"no bar: {', '.join(missing)}"


def _scale_bar(scale: VectorScale, height: float) -> list[Shape]:
    """Return the length of a round amount, below the notes."""
    start, length = complex(SIDE, height), scale.amount * scale.per_unit
    return [*arrow_shapes(start, start + length, scale.kind),
            Text(start + length + 0.5 * SIDE, scale.text, "note", "start")]  # fmt: skip
