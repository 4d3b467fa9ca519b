"""A mechanism taken apart where it has no pose to be drawn in: its parts cut out of the kinematic graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure import Structure
from compoundkin.view.sketch.graph_picture import APART, NODE, node, spread
from compoundkin.view.sketch.label_places import WIDE
from compoundkin.view.sketch.picture import MARGIN, Picture, checked_size
from compoundkin.view.sketch.picture_rows import PAPER_WIDTH, PicturePart, in_rows, legible_size
from compoundkin.view.sketch.scene import groups_of, numbers_of
from compoundkin.view.sketch.shapes import Polyline, Shape, ShapeGroup, Text, moved, sheet
from compoundkin.view.sketch.sketch_labels import below, lines_of_text
from compoundkin.view.sketch.sketch_style import LETTER, LINE
from compoundkin.view.sketch.structure_pictures import HEADING, heading

# An outer pair is drawn this part of the way to the link that it attaches to.
STUB = 0.45


def groups_in_graph(structure: Structure, size: float | None) -> Picture:
    """Draw all parts as graphs: links as circles, outer pairs as loose ends."""
    numbers, groups = numbers_of(structure), groups_of(structure)
    names = list(numbers)
    places = dict(zip(names, np.conjugate(spread(names, structure.pairs)), strict=True))
    ground = [name for name in names if name == FRAME or name in structure.ground.links]
    driven = {step.pair.name for step in structure.driven.values()}
    inside = [pair for pair in structure.pairs if pair.name in driven and set(pair.members[:2]) <= set(ground)]
    titles = ["frame and driver" if len(driven) == 1 else "frame and drivers", *map(heading, structure.groups)]
    links = [ground, *(list(group.links) for group in structure.groups)]
    inner, outer = [inside, *(g.inner for g in structure.groups)], [(), *(g.outer for g in structure.groups)]
    parts = []
    for title, own, joined, attached in zip(titles, links, inner, outer, strict=True):
        nodes = [node(name, complex(places[name]), numbers[name], groups[name]) for name in own]
        edges = [*_edges(joined, places, driven), *_stubs(attached, places, own)]
        parts.append(_part(title, [*edges, *nodes], [complex(places[name]) for name in own], own))
    shapes, width, height = in_rows(parts, "+", PAPER_WIDTH)
    notes = [f"{number} {name}" for name, number in numbers.items()]
    notes += ["loose ends: outer pairs"] if structure.groups else []
    texts, height = below(lines_of_text(notes, width - 32.0), height + LINE)
    title = f"{structure.mechanism.title}, taken apart"
    described = "; ".join(map(heading, structure.groups))
    return Picture(
        (sheet(width, height), *shapes, *texts),
        width,
        height,
        title,
        described,
        legible_size(width, height, checked_size(size)),
    )


def _edges(pairs: Sequence[Pair], places: Mapping[str, complex], driven: set[str]) -> list[Shape]:
    return [
        ShapeGroup(
            (Polyline((complex(places[p.members[0]]), complex(places[p.members[1]])), _style(p, driven)),),
            title=f"{p.name}, {p.title}",
        )
        for p in pairs
    ]


def _style(pair: Pair, driven: set[str]) -> str:
    return "bold" if pair.name in driven else "edge"


def _stubs(pairs: Sequence[Pair], places: Mapping[str, complex], own: Sequence[str]) -> list[Shape]:
    """The outer pairs: a line toward the link before it, with the pair's letter at its end."""
    shapes: list[Shape] = []
    for pair in pairs:
        here, there = sorted(pair.members[:2], key=lambda name: name not in own)
        start, end = complex(places[here]), complex(places[there])
        end = start + (end - start) * STUB
        beyond = end + (end - start) / (abs(end - start) or 1.0) * NODE
        shapes += [
            Polyline((start, end), "edge"),
            Text(beyond, pair.letters[0], "code"),
        ]
    return shapes


def _part(title: str, shapes: list[Shape], spots: Sequence[complex], links: Sequence[str]) -> PicturePart:
    """A part with its heading, moved to its upper left corner; stubs reach half a step beyond its links."""
    reach = APART * STUB + 2.0 * NODE
    low = complex(min(z.real for z in spots), min(z.imag for z in spots)) - (reach + MARGIN / 4.0) * (1 + 1j)
    high = complex(max(z.real for z in spots), max(z.imag for z in spots)) + (reach + MARGIN / 4.0) * (1 + 1j)
    wide, tall = max((high - low).real, len(title) * LETTER * WIDE), (high - low).imag
    low -= (wide - (high - low).real) / 2.0
    named = Text(complex(wide / 2.0, HEADING / 2.0), title, "heading")
    return PicturePart(
        (ShapeGroup((named, *moved(shapes, HEADING * 1j - low)), links=tuple(links)),), wide, tall + HEADING
    )
