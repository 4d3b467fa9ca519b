"""Instant centres: on a sketch with the lines that give them, and as a circle diagram."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.centres import Centres, DerivationStep, instant_centres
from compoundkin.analysis.centres.circle_diagram import diagram_of
from compoundkin.analysis.centres.derivation import derive
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.structure import Structure
from compoundkin.view.sketch.labels import Label, label_around, names_at_places, text_half
from compoundkin.view.sketch.picture import Picture, checked_size
from compoundkin.view.sketch.scene import Scene, Window
from compoundkin.view.sketch.shapes import CircleShape, Polyline, Shape, ShapeGroup, Text, sheet
from compoundkin.view.sketch.sketch_style import LINE, NUMBER, SMALL

# Centres nearer to each other than this, in picture units, are named together.
TOGETHER = 3.0
DOT = 3.2
RADIUS, MIDDLE = 130.0, 165.0 + 165.0j
# The list beside the circle has at most so many lines in a column, and so many columns.
ROWS, COLUMNS = 18, 3
NARROW = 0.56


@dataclass(frozen=True)
class VisibleCentres:
    """The centres on the picture, by their names, and the lines that give them.

    It also has what is said of the others.
    """

    places: dict[str, complex]
    lines: tuple[tuple[complex, complex], ...]
    notes: list[str]


def visible_centres(scene: Scene, window: Window) -> VisibleCentres:
    """Return the instant centres of the pose shown. Raises InvalidInput for a mechanism without a motion."""
    if scene.shown is None:
        what = "a mechanism that is shown as drawn has no motion"
        raise InvalidInput(Problem("centres", what, "give it drivers"))
    centres = instant_centres(scene.shown)
    near: dict[str, complex] = {}
    far: list[str] = []
    infinite: list[str] = []
    for pair in centres:
        name, centre = centre_number(scene, *pair), centres[pair]
        homogeneous = _at(scene, centre.homogeneous)
        if not _at(scene, centre.found):
            continue
        if _at(scene, centre.at_infinity):
            infinite.append(name)
            continue
        place = complex(window.at(complex(homogeneous[0], homogeneous[1]) / homogeneous[2]))
        if window.holds(place, 2.0):
            near[name] = place
        else:
            far.append(name)
    notes = [f"at infinity: {', '.join(infinite)}"] if infinite else []
    notes += [f"outside: {', '.join(far)}"] if far else []
    return VisibleCentres(near, tuple(_lines(scene, centres, near)), notes)


def centre_places(scene: Scene) -> list[complex]:
    """Return where the instant centres are, those that are not at infinity."""
    if scene.shown is None:
        return []
    centres = instant_centres(scene.shown)
    found = [complex(_at(scene, centres[pair].point)) for pair in centres]
    return [place for place in found if np.isfinite(place)]


def centre_number(scene: Scene, one: str, two: str) -> str:
    """Return the name of a centre by the numbers of its links. It is 13, or 3,12."""
    return _name((one, two), scene.numbers)


def _at(scene: Scene, values: Number) -> Number:
    """The entry at the pose of an array over the motion."""
    assert scene.shown is not None
    inputs = scene.shown.inputs
    full = np.asarray(values)
    rest = full.shape[len(scene.shown.shape) :]
    return np.asarray(full.reshape(inputs.designs, inputs.poses, *rest)[scene.pose])


def _lines(scene: Scene, centres: Centres, near: dict[str, complex]) -> Iterator[tuple[complex, complex]]:
    """For each secondary centre on the picture, from it to the known centres on the two lines that give it."""
    # a step names centres by their links: (crank frame)
    names = {f"({a} {b})": centre_number(scene, a, b) for one, two in centres for a, b in ((one, two), (two, one))}
    drawn: set[tuple[str, ...]] = set()
    for step in centres.derivation():
        own = centre_number(scene, *step.centre)
        if own not in near or step.kind == "primary":
            continue
        for line in step.lines:
            known = [near[names[text]] for text in line if names.get(text) in near]
            points = [near[own], *known]
            key = tuple(sorted(f"{p:.0f}" for p in points))
            if len(points) > 1 and key not in drawn:
                drawn.add(key)
                yield _span(points)


def _span(points: list[complex]) -> tuple[complex, complex]:
    """The two ends of points on a line."""
    first = max(points, key=lambda p: abs(p - points[0]))
    return first, max(points, key=lambda p: abs(p - first))


def centre_shapes(found: VisibleCentres) -> list[Shape]:
    """Return the lines and a dot for each centre."""
    dots = {(round(p.real), round(p.imag)): p for p in found.places.values()}
    return [*(Polyline(line, "ray") for line in found.lines), *(CircleShape(p, DOT, "centre") for p in dots.values())]


def centre_labels(found: VisibleCentres) -> list[Label]:
    """Return the names of the centres, those at one place together."""
    joined = [(" ".join(names), place) for names, place in names_at_places(found.places.items(), TOGETHER)]
    return [label_around(f"centre {text}", place, text_half(text, SMALL), 5.0, 1 + 1j) for text, place in joined]


def circle_diagram(structure: Structure, numbers: Mapping[str, int], size: float | None) -> Picture:
    """Draw the circle diagram: primary centres full, secondary ones dashed, the steps beside it.

    Source: e.g. J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, section 3.15.
    """
    steps = derive(diagram_of(structure)).steps
    count = len(numbers)
    places = {name: MIDDLE - 1j * RADIUS * complex(np.exp(2j * np.pi * k / count)) for k, name in enumerate(numbers)}
    # secondary ones first, so that full lines are not hidden
    ordered = sorted(steps, key=lambda step: step.kind == "primary")
    chords = [_chord(step, places, numbers) for step in ordered]
    nodes = [_node(name, places[name], number) for name, number in numbers.items()]
    texts, width = _list(steps, numbers)
    height = 2.0 * MIDDLE.imag
    paper = sheet(width, height)
    title = f"{structure.mechanism.title}: circle diagram of the instant centres"
    return Picture((paper, *chords, *nodes, *texts), width, height, title, _counted(steps), checked_size(size))


def _chord(step: DerivationStep, places: Mapping[str, complex], numbers: Mapping[str, int]) -> Shape:
    line = Polyline(tuple(places[name] for name in step.centre), "ink" if step.kind == "primary" else "ray")
    return ShapeGroup((line,), title=_name(step.centre, numbers))


def _node(name: str, at: complex, number: int) -> Shape:
    return ShapeGroup(
        (CircleShape(at, NUMBER + 1.5, "pin ink"), Text(at, str(number), "number")), title=name, links=(name,)
    )


def _list(steps: Sequence[DerivationStep], numbers: Mapping[str, int]) -> tuple[list[Shape], float]:
    """The steps as lines of text beside the circle, and the width with them."""
    lines = [_line(step, numbers) for step in steps if step.kind != "primary"]
    first = [_name(step.centre, numbers) for step in steps if step.kind == "primary"]
    lines = [f"primary: {' '.join(first)}"[:60], *lines]
    if len(lines) > ROWS * COLUMNS:
        lines = [*lines[: ROWS * COLUMNS - 1], f"and {len(lines) - ROWS * COLUMNS + 1} more"]
    shapes: list[Shape] = []
    x = 2.0 * MIDDLE.real
    for k in range(0, len(lines), ROWS):
        column = lines[k : k + ROWS]
        shapes += [Text(complex(x, 28.0 + LINE * j), line, "note", "start") for j, line in enumerate(column)]
        x += max(len(line) for line in column) * SMALL * NARROW + 20.0
    return shapes, round(x, 1)


def _line(step: DerivationStep, numbers: Mapping[str, int]) -> str:
    """A step in short: 13 = 12 23 x 14 34."""
    if step.kind != "crossing":
        return f"{_name(step.centre, numbers)}: {step.kind}"
    names = {f"({a} {b})": _name((a, b), numbers) for a in numbers for b in numbers}
    crossed = " × ".join(" ".join(names.get(text, text) for text in line) for line in step.lines)
    return f"{_name(step.centre, numbers)} = {crossed}"


def _name(links: tuple[str, str], numbers: Mapping[str, int]) -> str:
    first, second = sorted(numbers[name] for name in links)
    return f"{first}{second}" if second < 10 else f"{first},{second}"


def _counted(steps: Sequence[DerivationStep]) -> str:
    primary = sum(step.kind == "primary" for step in steps)
    return f"{primary} primary centres, {len(steps) - primary} secondary ones"
