"""The circle diagram of instant centres: links on a circle, centres as the lines between them, and how they follow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.analysis.centres import DerivationStep
from compoundkin.analysis.centres.circle_diagram import diagram_of
from compoundkin.analysis.centres.derivation import derive
from compoundkin.structure import Structure
from compoundkin.view.sketch.picture import Picture, checked_size
from compoundkin.view.sketch.shapes import CircleShape, Polyline, Shape, ShapeGroup, Text
from compoundkin.view.sketch.sketch_style import LINE, NUMBER, SMALL
from compoundkin.view.sketch.strokes import sheet

RADIUS, MIDDLE = 130.0, 165.0 + 165.0j
# The list beside the circle has at most so many lines in a column, and so many columns.
ROWS, COLUMNS = 18, 3
NARROW = 0.56


def circle_diagram(structure: Structure, numbers: Mapping[str, int], size: float | None) -> Picture:
    """The picture of the circle diagram: primary centres full, secondary ones dashed, the steps beside it in order.

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
