"""The sketch of a mechanism at one pose with the forces that act on its links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces
from compoundkin.view.sketch.acting_forces import ShownForce, acting_forces, is_shown_once
from compoundkin.view.sketch.asked_values import asked_labels
from compoundkin.view.sketch.force_arrows import (
    AROUND_DRIVER,
    SHORTEST,
    DrawnForce,
    drawn,
    force_scale,
    moments,
    named,
    written,
)
from compoundkin.view.sketch.label_places import Label, placed
from compoundkin.view.sketch.picture import MARGIN, Picture, Window, checked_size, fitted
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Shape, Text, arrow, sheet
from compoundkin.view.sketch.shown_pose import Wishes, pose_notes, scene_of
from compoundkin.view.sketch.sketch_labels import NARROW, SIDE, below, label_shapes, labels_of, lines_of_text
from compoundkin.view.sketch.sketch_style import INERTIA, LINE, LOAD, REACTION, SMALL
from compoundkin.view.sketch.sketches import in_layers, window_on
from compoundkin.view.sketch.slide_shapes import Painter
from compoundkin.view.sketch.vectors import VectorScale

# The longest force is this part of the picture's diagonal.
LONGEST = 0.2
# What is smaller than this part of the largest force or moment is left out of a sketch, which has little room.
SMALL_PART = 0.03
# An arrow that tells a colour is so long.
KEY = 22.0
# The kinds of arrows, as they are told below a picture.
KINDS = {REACTION: "reactions and drivers", LOAD: "loads and weights", INERTIA: "inertia"}


@dataclass(frozen=True, eq=False)
class ForcesAtPose:
    """What acts on the links at a pose, and what is drawn of it."""

    forces: Forces
    scene: Scene
    on: Mapping[str, tuple[ShownForce, ...]]

    def shown(self, link: str | None) -> list[ShownForce]:
        """Return what is drawn in a sketch. All that acts on a link, or each pair's force on its second one."""
        if link is not None:
            return list(self.on[link])
        found = [one for own in self.on.values() for one in own if is_shown_once(one, self.scene.legend)]
        force, moment = (max(map(abs, sizes), default=0.0) * SMALL_PART
                         for sizes in ([one.force for one in found], [one.moment for one in found]))  # fmt: skip
        kept = (replace(one, force=one.force if abs(one.force) >= force else 0j,
                        moment=one.moment if abs(one.moment) >= moment else 0.0) for one in found)  # fmt: skip
        return [one for one in kept if one.force or one.moment or one.is_open]

    def middle(self, one: ShownForce) -> complex:
        """Return the middle of the link on which a force acts, in the plane."""
        points = self.scene.points[one.link].values()
        return complex(np.mean([self.scene.at(one.link, p) for p in points])) if points else one.at


def forces_at_pose(forces: Forces, wishes: Wishes) -> ForcesAtPose:
    """Return what acts at the pose that is asked for. Raises UnknownName for a link that there is not."""
    scene = scene_of(forces.motion, wishes.at, wishes.pose, wishes.design)
    if wishes.link is not None:
        scene.mechanism.link(wishes.link)
    return ForcesAtPose(forces, scene, acting_forces(forces, scene))


def force_sketch(forces: Forces, wishes: Wishes) -> Picture:
    """Draw the sketch with the forces at one pose."""
    known, asked = forces_at_pose(forces, wishes), asked_labels(wishes.labels)
    scene, shown = known.scene, known.shown(wishes.link)
    window = window_on(scene)
    scale = force_scale(shown, LONGEST * window.diagonal, forces.units.force)
    if scale is None and not any(one.moment for one in shown):
        raise InvalidInput(Problem("forces", "no force acts at this pose", "choose another pose"))
    window = _with_room(known, window, shown, scale)
    painter = Painter(scene, window)
    shapes, names = _acting(known, painter, shown, scale)
    laid = in_layers(painter)
    own = labels_of(painter, laid, asked)
    labels = [label for label, _, _ in names] if asked else []
    behind = [one.shape for one in laid]
    found = placed([*own, *labels], [*behind, *shapes], window.width, window.height)
    texts = [*label_shapes(scene, {label.key: found[label.key] for label in own})]
    texts += [part for label, text, kind in names if asked for part in named(label.key, text, found[label.key], kind)]
    return framed(known, window, [*behind, *shapes, *texts], scale, shown, "forces", wishes.size)


def _with_room(known: ForcesAtPose, window: Window, shown: Sequence[ShownForce], scale: VectorScale | None) -> Window:
    """The window made large enough for the arrows."""
    arrows = _arrows(known, window, shown, scale)
    if not arrows:
        return window
    tips = [end for one in arrows for end in (one.start, one.stop)]
    inner = [MARGIN * (1 + 1j), complex(window.width, window.height) - MARGIN * (1 + 1j)]
    return fitted(window, np.array([*inner, *tips]))


def _acting(
    known: ForcesAtPose, painter: Painter, shown: Sequence[ShownForce], scale: VectorScale | None
) -> tuple[list[Shape], list[tuple[Label, str, str]]]:
    """The arrows and arcs, and their labels with texts and kinds."""
    window = painter.window
    arrows = _arrows(known, window, shown, scale)
    shapes = [shape for one in arrows for shape in one.shapes]
    names = [(one.label(one.force.name, f"force {k}"), one.force.name, one.force.kind)
             for k, one in enumerate(arrows) if one.is_seen]  # fmt: skip
    for one, arc, label in moments(shown, lambda at: complex(window.at(at)), painter.middle, AROUND_DRIVER):
        shapes += arc
        names.append((label, one.turning, one.kind))
    return shapes, names


def _arrows(
    known: ForcesAtPose, window: Window, shown: Sequence[ShownForce], scale: VectorScale | None
) -> list[DrawnForce]:
    """The arrows; forces that press on their link come from outside, so that its bars stay to be seen."""
    if scale is None:
        return []
    return [drawn(one, complex(window.at(one.at)), scale, complex(window.at(known.middle(one)))) for one in shown]


def framed(
    known: ForcesAtPose,
    window: Window,
    shapes: Sequence[Shape],
    scale: VectorScale | None,
    shown: Sequence[ShownForce],
    what: str,
    size: float | None,
) -> Picture:
    """Return a picture of forces with what stands below it.

    That is the pose, the links' numbers, units, the scale.
    """
    scene = known.scene
    texts, height = notes_below(known, shown, scale, window.width, window.height)
    paper = sheet(window.width, height)
    title = f"{scene.mechanism.title}: {what}"
    told = "; ".join(f"{one.told} {abs(one.force):.4g}" for one in shown if one.force)
    return Picture((paper, *shapes, *texts), window.width, height, title, told, checked_size(size), window)


def notes_below(
    known: ForcesAtPose, shown: Sequence[ShownForce], scale: VectorScale | None, width: float, height: float
) -> tuple[list[Shape], float]:
    """Return what stands below a picture of forces, and the height with it."""
    scene = known.scene
    notes = [*pose_notes(scene), *(f"{number} {name}" for name, number in scene.legend.items())]
    notes += list(_units(known, shown, scale))
    texts, height = below(lines_of_text(notes, width - 2.0 * SIDE), height)
    if scale is None:
        return texts, height
    seen = (one for one in shown if one.moment or abs(one.force) * scale.per_unit >= SHORTEST)
    kinds = dict.fromkeys(one.kind for one in seen)
    keys = [(scale.amount * scale.per_unit, "drive", scale.text), *((KEY, kind, KINDS[kind]) for kind in kinds)]
    x = SIDE
    for length, kind, words in keys:
        far = length + 0.5 * SIDE + len(words) * SMALL * NARROW
        if x > SIDE and x + far > width - SIDE:
            x, height = SIDE, height + LINE
        texts += [*arrow(complex(x, height), complex(x + length, height), kind),
                  Text(complex(x + length + 0.5 * SIDE, height), words, "note", "start")]  # fmt: skip
        x += far + 1.5 * SIDE
    return texts, height + LINE


def _units(known: ForcesAtPose, shown: Sequence[ShownForce], scale: VectorScale | None) -> Iterator[str]:
    """What there is to say of units, of statics, of arcs, of forces too small to be drawn."""
    units = known.forces.units
    yield f"forces in {units.force}"
    if not known.forces.inertia:
        yield "statics"
    if any(one.moment for one in shown):
        yield f"moments in {units.moment}, arcs not to scale"
    unknown = dict.fromkeys(one.name for one in shown if one.is_open)
    if unknown:
        yield f"not determined by equilibrium: {', '.join(unknown)}"
    small = [one for one in shown if one.force and scale is not None and abs(one.force) * scale.per_unit < SHORTEST]
    if small:
        yield f"not drawn: {', '.join(f'{one.name} {written(abs(one.force))}' for one in small)}"
