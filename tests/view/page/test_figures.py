"""Tables of a page that follow changed dimensions: what the browser tells is what Python tells of such a mechanism."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import extremes
from compoundkin.model.attributes import LENGTH
from compoundkin.view.report import report
from compoundkin.view.report.report_data import Cell, TableBlock

# What is changed of each: enough to be seen, and it still goes round.
CHANGED: dict[str, dict[str, float]] = {
    "six-bar": {"plate.C.x": 0.4, "frame.E.y": 0.3},
    "whitworth-quick-return": {"crank.A.x": 3.0, "rod.R.x": 7.0},
    # a searched profile
    "oscillating-roller-follower": {"follower/cam.radius": 2.0, "frame.H.x": 1.5},
    # forces: a table over a slide that acts one way, uniform bars and a plate as masses
    "geared-press": {"crank.A.x": -4.0, "rod.B.x": -3.0},
    "jaw-crusher-loaded": {"pitman.B.x": 8.0, "jaw.D.y": -5.0},
}
# All rows of figures, and of the outputs at poses: texts of cells, with all digits where these are more.
CELLS = """() => [...document.querySelectorAll("tr[data-figure], #outputs tr[data-pose]")].filter((row) => !row.hidden)
    .map((row) => [row.dataset.figure ?? "", [...row.cells].map((cell) => cell.dataset.sort ?? cell.textContent)])"""
# What no program of a page tells.
BEHIND = {"oscillating-roller-follower": ['["varied", "follower/cam.pressure_angle"]']}
STAYS = '["stays"]'
# Extremes beside a pose are put on it: so much of a degree they may be off.
BESIDE = 0.026


def tables(motion: Motion) -> list[tuple[str, tuple[Cell, ...]]]:
    """The rows that a report has of such figures."""
    made = []
    for section in report(motion).sections:
        blocks = [block for block in section.blocks if isinstance(block, TableBlock)]
        if section.key == "outputs":
            made += [("", row) for row in blocks[0].rows]
        made += [(json.dumps(f), row) for block in blocks for f, row in zip(block.figures, block.rows, strict=False)]
    return made


@pytest.mark.parametrize(
    "name",
    [
        *("six-bar", "jaw-crusher-loaded", "oscillating-roller-follower"),
        *(pytest.param(name, marks=pytest.mark.full) for name in ("whitworth-quick-return", "geared-press")),
    ],
)
def test_changed_figures_are_those_of_the_changed_mechanism(name: str, made: Any, opened: Any) -> None:
    view = opened(made(name))
    before = view.value(CELLS)
    own = view.value(
        "Object.fromEntries(compoundkin.players[0].design.names.map("
        "(name) => [name, compoundkin.players[0].design.value(name)]))"
    )
    values = {key: own[key] + more for key, more in CHANGED[name].items()}
    view.value(
        "(values) => { compoundkin.players[0].design.change(values); compoundkin.players[0].figures.follow(); }", values
    )
    behind = view.value("[...document.querySelectorAll('tr.behind')].map((row) => row.dataset.figure)")
    assert behind == BEHIND.get(name, [])
    motion = ck.solve(changed(name, values))
    assert motion.assembled.all()
    told, wanted = view.value(CELLS), tables(motion)
    figures = [row for row in told if row[0] and row[0] not in (STAYS, *behind)]
    for (figure, cells), (other, row) in zip(
        figures, [one for one in wanted if one[0] not in ("", STAYS, *behind)], strict=True
    ):
        assert json.loads(figure) == json.loads(other)
        _agree(motion, json.loads(figure), cells, row)
    poses = {float(cells[0]): cells for figure, cells in told if not figure}
    for _, row in (one for one in wanted if not one[0]):
        for text, cell in zip(poses[float(str(row[0]))], row, strict=True):
            assert float(text) == pytest.approx(cell, rel=1e-7, abs=1e-6)
    view.value("() => { compoundkin.players[0].design.reset(); compoundkin.players[0].figures.follow(); }")
    assert view.value(CELLS) == before
    assert view.complaints == []


def changed(name: str, values: Mapping[str, float]) -> ck.Mechanism:
    """A mechanism of the catalog with other dimensions."""
    return ck.compile(load(name), [next(iter(load(name).links)) + ".angle"], free=list(values)).mechanism(dict(values))


def _agree(motion: Motion, figure: list[str], cells: list[str], row: tuple[Cell, ...]) -> None:
    """A row that the browser tells is that of Python: values to 1e-6 of the largest, places where they are the only."""
    known = [cell for cell in row[2:] if isinstance(cell, float)]
    scale = max(map(abs, known), default=1.0)
    for k, (text, cell) in enumerate(zip(cells, row, strict=True)):
        if not isinstance(cell, float):
            assert k < 2 or text == ("" if cell is None else cell)
        elif _is_place(figure, k, len(row)):
            assert float(text) == pytest.approx(cell, abs=BESIDE) or _elsewhere(motion, figure[1], k, float(text))
        else:
            assert float(text) == pytest.approx(cell, abs=1e-6 * scale)


def _is_place(figure: list[str], k: int, count: int) -> bool:
    return figure[0] != "stroke" and k in (count - 1, count - 3) and k > 2


def _elsewhere(motion: Motion, name: str, k: int, place: float) -> bool:
    """Whether a quantity is as low or as high at that place of its driver too."""
    (found,) = extremes(motion, name)
    there = ck.solve(motion.mechanism, {motion.mechanism.drives[0].link: np.deg2rad([place])})
    vector, _, part = name.rpartition(".")
    value = abs(ck.quantity(there, vector).values[0]) if part == LENGTH else ck.quantity(there, name).values[0]
    ends = found.least.value[0], found.greatest.value[0]
    return bool(min(abs(value - end) for end in ends) < 1e-6 * max(map(abs, ends)))
