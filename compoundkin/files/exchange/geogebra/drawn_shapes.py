"""What is to be seen of a construction besides its points: links, wheels, and the curves of traced points."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2

import numpy as np

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.geogebra_xml import ShownWindow
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair


def add_shapes(
    build: Construction, shown: ShownMechanism, points: Mapping[str, str], sliders: Mapping[str, str]
) -> None:
    """Add segments and polygons for links, circles for wheels, loci of traced points."""
    for name, own in shown.points.items():
        if name != FRAME:
            _add_link(build, name, own, points)
    for pair in shown.pairs:
        _add_pair(build, shown, pair, points)
    for letter in traced(shown):
        for name, slider in sliders.items():
            if build.is_slider(slider) and _moves(build, points[letter], slider):
                index = letter if len(sliders) == 1 else f"{letter}-{name}"
                build.shape("locus", ("c", index), "curve", "Locus", (points[letter], slider))


def _add_link(build: Construction, name: str, own: Mapping[str, complex], points: Mapping[str, str]) -> None:
    """Add a link of two points as a segment, one of more as a polygon, its points in a round."""
    places: dict[complex, str] = {}
    for letter, place in own.items():
        places.setdefault(place, points[letter])
    if len(places) == 2:
        build.shape("segment", ("f", name), "link", "Segment", tuple(places.values()))
    elif len(places) > 2:
        middle = sum(places) / len(places)
        order = sorted(places, key=lambda p: (round(atan2((p - middle).imag, (p - middle).real), 9), abs(p - middle)))
        build.shape("polygon", ("f", name), "link", "Polygon", tuple(places[p] for p in order))


def _add_pair(build: Construction, shown: ShownMechanism, pair: Pair, points: Mapping[str, str]) -> None:
    """Add the way along a slide or slot, the pitch circles of gears, the circle of a wheel on a line."""
    one, two = (*(points[letter] for letter in pair.letters[:2] if letter in points), "", "")[:2]
    sizes = build.sizes.get(pair.name, ())
    if pair.table in ("slides", "slots") and one and two and one != two:
        build.shape("segment", ("g", f"{pair.name}-0"), "guide", "Segment", (two, one))
    elif pair.table == "gears" and len(sizes) == 2:
        ring = shown.ends[pair.name][0].measure * shown.ends[pair.name][1].measure < 0
        whole = f"abs({sizes[1]} - {sizes[0]})" if ring else f"({sizes[0]} + {sizes[1]})"
        for k, own in enumerate((one, two)):
            radius = f"Distance({one}, {two}) * {sizes[k]} / {whole}"
            build.shape("conic", ("w", f"{pair.name}-{k + 1}"), "wheel", "Circle", (own, radius))
    elif len(sizes) == 1:
        build.shape("conic", ("w", pair.name), "wheel", "Circle", (one, f"abs({sizes[0]})"))


def window_of(motion: Motion) -> ShownWindow:
    """Return the box of all points over the motion."""
    known = np.ravel(motion.failed) == 0
    rows = [np.ravel(motion.points[letter].position) for letter in motion.mechanism.carriers]
    places = np.concatenate([row[known] if row.size > 1 else row for row in rows])
    low, high = (complex(pick(places.real), pick(places.imag)) for pick in (np.min, np.max))
    return ShownWindow(low, high)


def traced(shown: ShownMechanism) -> list[str]:
    """Return the points that the mechanism's outputs are about, those of moving links alone."""
    mechanism = shown.mechanism
    asked = dict.fromkeys(name.split(".")[0] for name in mechanism.outputs)
    fixed = shown.points.get(FRAME, {})
    return [letter for letter in asked if letter in mechanism.carriers and letter not in fixed]


def _moves(build: Construction, point: str, slider: str) -> bool:
    """Return whether a point depends on a slider."""
    return slider in build.needs(point)
