"""Force polygons: the forces on a link head to tail, which close where it is in equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.acting_forces import ShownForce
from compoundkin.view.sketch.force_arrows import force_scale, named, written
from compoundkin.view.sketch.force_sketch import ForcesAtPose, forces_at_pose
from compoundkin.view.sketch.label_places import WIDE, Label, placed, text_half
from compoundkin.view.sketch.picture import MARGIN, Picture, checked_size
from compoundkin.view.sketch.picture_rows import PicturePart, in_rows
from compoundkin.view.sketch.shapes import CircleShape, Shape, ShapeGroup, Text, arrow, direction, moved, sheet
from compoundkin.view.sketch.shown_pose import Wishes, pose_notes
from compoundkin.view.sketch.sketch_labels import SIDE, below, lines_of_text
from compoundkin.view.sketch.sketch_style import LETTER, LINE, REACTION, SMALL
from compoundkin.view.sketch.vectors import VectorScale

# The greatest distance between two corners of a polygon, picture units: of several, of a single one.
LENGTH, LENGTH_ALONE = 170.0, 380.0
HEADING, BELOW = 30.0, 14.0
# Forces that lie on each other are drawn beside their line.
ASIDE = 4.0
# Labels are tried at these parts of a force, so far beside it.
ALONG, BESIDE = (0.5, 0.35, 0.65, 0.22, 0.78), (4.0, 12.0, 22.0)


def force_polygons(forces: Forces, wishes: Wishes) -> Picture:
    """Draw the polygon of all forces on every link, or on one.

    Each has its own scale. Loads come first, then weight and inertia, then reactions, which close it.

    Raises InvalidInput where no link has forces. Source: P. Varignon, Nouvelle mécanique, 1725.
    """
    known = forces_at_pose(forces, wishes)
    links = [wishes.link] if wishes.link is not None else [name for name in known.scene.legend if name != FRAME]
    longest = LENGTH_ALONE if len(links) == 1 else LENGTH
    parts = [part for link in links for part in _part(known, link, longest)]
    if not parts:
        raise InvalidInput(Problem("forces", "no force acts on these links", "choose another pose or link"))
    shapes, width, height = in_rows(parts)
    notes = [
        *pose_notes(known.scene),
        f"forces in {forces.units.force}",
        *(f"{number} {name}" for name, number in known.scene.legend.items()),
    ]
    texts, height = below(lines_of_text(notes, width - 2.0 * SIDE), height)
    title = f"{known.scene.mechanism.title}: force polygon{'' if len(links) == 1 else 's'}"
    return Picture((sheet(width, height), *shapes, *texts), width, height, title, "", checked_size(wishes.size))


def _part(known: ForcesAtPose, link: str, longest: float) -> list[PicturePart]:
    """The polygon of a link; nothing for one without forces."""
    forces = sorted((one for one in known.on[link] if one.force), key=lambda one: one.kind == REACTION)
    ends = np.cumsum([0j, *(complex(np.conjugate(one.force)) for one in forces)])
    spread = max((abs(a - b) for a in ends for b in ends), default=0.0)
    scale = force_scale(forces, 1.0, known.forces.units.force) if spread else None
    if scale is None:
        return []
    scale = VectorScale(scale.kind, longest / spread, scale.amount, scale.text)
    corner = [complex(end * scale.per_unit) for end in ends]
    return [_panel(known, link, forces, corner, scale)]


def _panel(
    known: ForcesAtPose, link: str, forces: Sequence[ShownForce], corner: Sequence[complex], scale: VectorScale
) -> PicturePart:
    shapes, labels, texts = _sides(forces, corner)
    points = np.array([*corner, *(place for label in labels for place in (label.places[0] - label.half,
                                                                           label.places[0] + label.half))])  # fmt: skip
    low = complex(points.real.min(), points.imag.min()) - MARGIN * (1 + 1j)
    size = complex(points.real.max(), points.imag.max()) + MARGIN * (1 + 1j) - low
    title = f"{known.scene.numbers[link]} {link}"
    told = Text(0j, scale.text, "note", "start")
    ruler = scale.amount * scale.per_unit
    wide = max(size.real, len(title) * LETTER * WIDE, ruler + (len(scale.text) + 4) * SMALL * WIDE)
    low -= (wide - size.real) / 2.0
    shapes = moved(shapes, -low)
    every = [Label(label.key, label.half, tuple(p - low for p in label.places), label.costs) for label in labels]
    found = placed(every, shapes, wide, size.imag)
    names = [part for label, (text, kind) in zip(every, texts, strict=True)
             for part in named(label.key, text, found[label.key], kind)]  # fmt: skip
    heading = Text(complex(wide / 2.0, HEADING / 2.0), title, "heading")
    foot = complex((wide - ruler) / 2.0 - SIDE, HEADING + size.imag + BELOW / 2.0)
    line = [*arrow(foot, foot + ruler, "drive"), *moved([told], foot + ruler + 0.5 * SIDE)]
    group = ShapeGroup((heading, *moved([*shapes, *names], HEADING * 1j), *line), links=(link,))
    return PicturePart((group,), wide, size.imag + HEADING + BELOW + LINE)


def _sides(
    forces: Sequence[ShownForce], corner: Sequence[complex]
) -> tuple[list[Shape], list[Label], list[tuple[str, str]]]:
    """The arrows of a polygon, their labels outside of it, and what these say."""
    middle = complex(np.mean(corner))
    shapes: list[Shape] = [CircleShape(corner[0], 2.0, "dot")]
    labels, texts = [], []
    flat = _is_flat(corner)
    for k, one in enumerate(forces):
        start, stop = corner[k], corner[k + 1]
        across = 1j * direction(stop - start)
        if flat:
            start, stop = (place - across * ASIDE for place in (start, stop))
        shapes.append(ShapeGroup(arrow(start, stop, one.kind), title=f"{one.told}: {written(abs(one.force))}"))
        text = f"{one.name} {written(abs(one.force))}"
        labels.append(_beside(f"side {k}", text, start, stop, middle))
        texts.append((text, one.kind))
    return shapes, labels, texts


def _is_flat(corner: Sequence[complex]) -> bool:
    """Whether all forces lie on one line."""
    longest = max((end - corner[0] for end in corner), key=abs)
    e = direction(longest)
    return bool(max(abs((np.conjugate(e) * (end - corner[0])).imag) for end in corner) < ASIDE)


def _beside(key: str, text: str, start: complex, stop: complex, middle: complex) -> Label:
    """A label beside a force, rather outside of the polygon."""
    half, across = text_half(text, SMALL), 1j * direction(stop - start)
    outside = 1.0 if (np.conjugate(across) * ((start + stop) / 2.0 - middle)).real >= 0 else -1.0
    reach = abs(across.real) * half.real + abs(across.imag) * half.imag
    tried = [(share, side, off) for share in ALONG for off in BESIDE for side in (outside, -outside)]
    places = tuple(start + (stop - start) * share + across * side * (reach + off) for share, side, off in tried)
    costs = tuple(20.0 * abs(share - 0.5) + off + (6.0 if side != outside else 0.0) for share, side, off in tried)
    return Label(key, half, places, costs)
