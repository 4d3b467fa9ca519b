"""The XML of GeoGebra files: objects, styles, shapes and the window."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from compoundkin.files.exchange.geogebra.dragged_construction import Construction, ConstructionStep, Look, number
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair

# The window in pixels, and how much of it is kept free on each side.
_WIDTH, _HEIGHT, _MARGIN = 900, 600, 80


# The desktop program has its list of objects beside it, its menus above and below.
_LIST, _MENUS = 280, 200


# Sliders are put one below the other, in pixels.
_SLIDER_WIDTH, _SLIDER_LEFT, _SLIDER_TOP, _SLIDER_EVERY = 300, 30, 40, 45


_TURN = 360.0


class Style(NamedTuple):
    """How objects look: colour, whether seen and named, size, line, filling."""

    colour: tuple[int, int, int]
    is_seen: bool = True
    is_named: bool = False
    size: int = 0
    dash: int = 0
    filled: float = 0.0


_STYLES: Mapping[Look, Style] = {
    "slider": Style((176, 58, 46), is_named=True, size=8, filled=0.1),
    "dimension": Style((97, 97, 97), is_seen=False),
    "helper": Style((97, 97, 97), is_seen=False),
    "fixed": Style((33, 33, 33), is_named=True, size=6),
    "pin": Style((21, 101, 192), is_named=True, size=4),
    "guide": Style((158, 158, 158), size=2, dash=15),
    "link": Style((21, 101, 192), size=6, filled=0.15),
    "wheel": Style((158, 158, 158), size=2, dash=10),
    "curve": Style((176, 58, 46), size=3),
}


class ViewWindow(NamedTuple):
    """The corners of what is to be seen."""

    low: complex
    high: complex


def xml_of(build: Construction, title: str, window: ViewWindow) -> bytes:
    """Return the text of the file."""
    root = Element("geogebra", {"format": "5.0", "version": "5.0.609.0", "app": "classic", "platform": "w"})
    around = {"width": str(_WIDTH + _LIST), "height": str(_HEIGHT + _MENUS)}
    SubElement(SubElement(root, "gui"), "window", around)
    _add_view(root, window)
    kernel = SubElement(root, "kernel")
    for name, value in (("continuous", "false"), ("decimals", "2"), ("angleUnit", "degree"), ("coordStyle", "0")):
        SubElement(kernel, name, {"val": value})
    inside = SubElement(root, "construction", {"title": title, "author": "", "date": ""})
    sliders = 0
    for step in build.steps:
        _add_step(inside, step, sliders)
        sliders += step.slider is not None
    indent(root)
    text: str = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode()


def _add_view(root: Element, window: ViewWindow) -> None:
    """Add the window, as large as the motion lets it be."""
    wide, high = (window.high - window.low).real, (window.high - window.low).imag
    scale = min((_WIDTH - 2 * _MARGIN) / (wide or high or 1.0), (_HEIGHT - 2 * _MARGIN) / (high or wide or 1.0))
    middle = (window.low + window.high) / 2.0
    view = SubElement(root, "euclidianView")
    SubElement(view, "viewNumber", {"viewNo": "1"})
    SubElement(view, "size", {"width": str(_WIDTH), "height": str(_HEIGHT)})
    zero = {"xZero": _WIDTH / 2 - middle.real * scale, "yZero": _HEIGHT / 2 + middle.imag * scale}
    places = {name: number(value) for name, value in (*zero.items(), ("scale", scale), ("yscale", scale))}
    SubElement(view, "coordSystem", places)
    SubElement(view, "evSettings", {"axes": "false", "grid": "false", "pointCapturing": "0"})
    for axis in ("0", "1"):
        SubElement(
            view,
            "axis",
            {"id": axis, "show": "false", "showNumbers": "false", "tickStyle": "1", "label": "", "unitLabel": ""},
        )


def _add_step(inside: Element, step: ConstructionStep, sliders: int) -> None:
    """Add a step: what it is made of, where it is not free, and how it looks."""
    if step.command:
        command = SubElement(inside, "command", {"name": step.command})
        SubElement(command, "input", {f"a{k}": text for k, text in enumerate(step.arguments)})
        SubElement(command, "output", {"a0": step.name})
    elif not step.is_free:
        kind = {"type": step.kind} if step.kind != "numeric" else {}
        SubElement(inside, "expression", {"label": step.name, "exp": step.text, **kind})
    element = SubElement(inside, "element", {"type": step.kind, "label": step.name})
    _add_value(element, step)
    _add_style(element, _STYLES[step.look])
    if step.slider:
        _add_slider(element, step, sliders)
    if step.caption:
        SubElement(element, "caption", {"val": step.caption})


def _add_value(element: Element, step: ConstructionStep) -> None:
    if step.kind == "numeric" and step.is_free:
        SubElement(element, "value", {"val": number(step.slider.value if step.slider else step.numbers[0])})
    elif step.numbers:
        x, y = step.numbers
        SubElement(element, "coords", {"x": number(x), "y": number(y), "z": "1"})


def _add_style(element: Element, style: Style) -> None:
    SubElement(element, "show", {"object": _word(style.is_seen), "label": _word(style.is_named)})
    red, green, blue = map(str, style.colour)
    SubElement(element, "objColor", {"r": red, "g": green, "b": blue, "alpha": number(style.filled)})
    SubElement(element, "labelMode", {"val": "1" if element.get("type") == "numeric" else "0"})
    if element.get("type") == "point":
        SubElement(element, "pointSize", {"val": str(style.size or 3)})
    elif style.size:
        SubElement(element, "lineStyle", {"thickness": str(style.size), "type": str(style.dash)})


def _add_slider(element: Element, step: ConstructionStep, sliders: int) -> None:
    assert step.slider is not None
    low, high, every = step.slider.low, step.slider.high, step.slider.step
    place = {"x": str(_SLIDER_LEFT), "y": str(_SLIDER_TOP + _SLIDER_EVERY * sliders)}
    kind = "1" if high - low == _TURN else "0"  # round and round, or there and back
    fixed = {"absoluteScreenLocation": "true", "width": str(_SLIDER_WIDTH), "fixed": "true", "horizontal": "true"}
    SubElement(element, "slider", {"min": number(low), "max": number(high), **fixed, **place})
    SubElement(element, "animation", {"step": number(every), "speed": "1", "type": kind, "playing": "false"})


def _word(value: bool) -> str:
    return "true" if value else "false"


def add_shapes(
    build: Construction, shown: PosedMechanism, points: Mapping[str, str], sliders: Mapping[str, str]
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


def _add_pair(build: Construction, shown: PosedMechanism, pair: Pair, points: Mapping[str, str]) -> None:
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


def window_of(motion: Motion) -> ViewWindow:
    """Return the box of all points over the motion."""
    known = np.ravel(motion.failed) == 0
    rows = [np.ravel(motion.points[letter].position) for letter in motion.mechanism.carriers]
    places = np.concatenate([row[known] if row.size > 1 else row for row in rows])
    low, high = (complex(pick(places.real), pick(places.imag)) for pick in (np.min, np.max))
    return ViewWindow(low, high)


def traced(shown: PosedMechanism) -> list[str]:
    """Return the points that the mechanism's outputs are about, those of moving links alone."""
    mechanism = shown.mechanism
    asked = dict.fromkeys(name.split(".")[0] for name in mechanism.outputs)
    fixed = shown.points.get(FRAME, {})
    return [letter for letter in asked if letter in mechanism.carriers and letter not in fixed]


def _moves(build: Construction, point: str, slider: str) -> bool:
    """Return whether a point depends on a slider."""
    return slider in build.needs(point)
