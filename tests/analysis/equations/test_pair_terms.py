"""Loops across pairs of which the kind says nothing: by its lower equivalent, or from its closure alone."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.equations.expressions import latex, text
from compoundkin.analysis.equations.loop_equations import LoopEquations, loop_equations
from compoundkin.structure import assur_groups
from compoundkin.view.page.mathml import mathml
from compoundkin.view.report.equations_sections import IMPLICIT_FUNCTIONS, equations_section
from compoundkin.view.report.report_data import Paragraph
from compoundkin.view.report.structure_sections import equation_count

PAGE = (Path(__file__).parents[3] / "docs" / "adding.md").read_text(encoding="utf-8")


@pytest.fixture(params=["with its lower equivalent", "without"])
def oldham(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The word of the Oldham pair of the page on adding kinds, with and without its optional `equivalent`."""
    module = ModuleType("oldham")
    words = vars(module)
    code = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0]
    monkeypatch.setitem(sys.modules, "oldham", module)
    exec(compile(code, "oldham.py", "exec"), words)
    if request.param == "without":
        monkeypatch.delattr(words["Oldham"], "equivalent")
    monkeypatch.setitem(assur_groups._RANK, "T", 99)
    return words["oldham"]


def tray(oldham: Any) -> ck.Mechanism:
    """A tray on a crank, kept level by an Oldham pair."""
    return ck.Mechanism(
        "Level tray",
        ck.link("frame", A=(0, 0)),
        ck.link("crank", A=(0, 0), B=(30, 0)),
        ck.link("tray", B=(2, 1), C=(50, 10)),
        oldham("tray", on="frame", at="C", through="A", turn=0.2),
        ck.drive("crank"),
    )


def values_of(motion: ck.results.Motion, equations: LoopEquations) -> dict[str, Any]:
    """The unknowns as the solved poses show them; the frame does not turn."""
    across = motion.points["C"].position - motion.points["A"].position
    values = {name: link.angle for name, link in motion.links.items()}
    for unknown in equations.unknowns:
        if unknown.kind != "angle":
            along_x = unknown.kind == "x" or unknown.owner.endswith("(x)")
            values[unknown.key] = across.real if along_x else across.imag
    return values


def test_an_oldham_pair_has_loop_equations_that_its_motion_satisfies(oldham: Any) -> None:
    motion = ck.solve(tray(oldham), {"crank": ck.deg([0, 90, 200])}, speed=2)
    assert ck.verify(motion).passed
    equations = loop_equations(motion.structure)
    values, count = values_of(motion, equations), equation_count(motion.structure)
    assert equations.is_solvable
    assert (equations.equations, len(equations.unknowns)) == (count.equations, count.unknowns) == (4, 4)
    for one in (*equations.loops, *equations.auxiliary):
        assert np.max(np.abs(one.at(values))) < 1e-12, text(one)
        assert np.max(np.abs(one.at({**values, "tray": values["tray"] + 0.1}))) > 1e-3, text(one)
        assert mathml(latex(one))


def test_what_only_its_closure_says_is_written_as_a_function(oldham: Any) -> None:
    equations = loop_equations(tray(oldham))
    (loop,), (own,) = equations.loops, equations.auxiliary
    keys = [unknown.key for unknown in equations.unknowns]
    if "x(tray/frame)" in keys:
        assert text(own) == "F1[tray/frame](tray, x(tray/frame), y(tray/frame)) = 0"
        assert text(loop).endswith("- y(tray/frame) e^(i 90°) - x(tray/frame) = 0")
        said = [block.text for block in equations_section(equations).blocks if isinstance(block, Paragraph)]
        assert IMPLICIT_FUNCTIONS.format(pairs="tray/frame") in said
    else:
        assert keys[-2:] == ["s(tray/frame (x))", "s(tray/frame (y))"]
        assert text(own) == "tray - 11.4592° = 0"


def test_rates_of_an_oldham_pair_follow_from_its_closure(oldham: Any) -> None:
    motion = ck.solve(tray(oldham), {"crank": ck.deg([10, 90, 200])}, speed=2, acceleration=3)
    equations = loop_equations(motion.structure, order=2)
    first, second = equations.velocity.at(motion), equations.acceleration.at(motion)
    across = motion.points["C"]
    for found, moved in ((first, across.velocity), (second, across.acceleration)):
        for own in found.unknowns:
            if own.kind == "angle":
                assert np.max(np.abs(found.rate(own.key))) < 1e-12, own.key  # the tray does not turn
            else:
                along_x = own.kind == "x" or own.owner.endswith("(x)")
                assert np.allclose(found.rate(own.key), moved.real if along_x else moved.imag, rtol=1e-12)
    written = [entry for row in equations.velocity.matrix.entries for entry in row if not entry.is_zero]
    for own in (*written, *(one for row in equations.acceleration.right_side.entries for one in row)):
        assert mathml(own.latex)
    if equations.system.rows[-1].function is not None:
        assert equations.velocity.rows[-1].startswith("tray' dF1[tray/frame]/d(tray) + x'(tray/frame) dF1[")
        assert equations.acceleration.rows[-1].endswith("= -F1''[tray/frame]")
