"""Plots of pages: curves that are the motion's between its poses too, jumps, marks, axes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.kinematics.extremes import between, extremes
from compoundkin.view.report import page
from tests import catalog

PANELS = "Object.fromEntries(compoundkin.players[0].plots.panels.map((panel) => [panel.name, panel]))"


def test_curves_are_those_of_the_motion_between_its_poses_too(made: Any, opened: Any) -> None:
    motion, view = catalog.motion("six-bar"), opened(made("six-bar"))
    places = np.linspace(0.0, 72.0, 500)
    there = between(motion, 0, places, 2)
    wanted = {
        "G.velocity": np.ravel(ck.quantity(there, "G.velocity").values),
        "bar.angular_acceleration": np.ravel(ck.quantity(there, "bar.angular_acceleration").values),
    }
    for name, values in wanted.items():
        drawn = view.value(
            f"([name, xs]) => {PANELS}[name].curves.map((curve) => xs.map((x) => curve.at(x)))",
            [name, (5.0 * places).tolist()],
        )
        parts = (values.real, values.imag, np.abs(values)) if np.iscomplexobj(values) else (values,)
        for curve, part in zip(drawn, parts, strict=True):
            np.testing.assert_allclose(curve, part, atol=2e-3 * np.abs(values).max())
    (speed,) = extremes(motion, "G.velocity.length")
    marks = view.value(f"{PANELS}['G.velocity'].curves[2].marks")
    assert marks[1]["y"] == pytest.approx(speed.greatest.value[0], rel=1e-5)
    assert marks[1]["x"] == pytest.approx(np.rad2deg(speed.greatest.at.drives["crank"][0]), abs=0.01)


def test_jumps_part_curves_rounding_has_no_marks_and_axes_have_limits(opened: Any, tmp_path: Path) -> None:
    laws = ck.laws
    law = laws.program(laws.dwell(0.25), laws.rise(1.0, over=0.51, law="harmonic"), laws.dwell(0.24), start=0.4)
    parts = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=3), ck.link("arm", D=0, C=3)
    names = ["arm.angular_acceleration", "crank.angular_velocity", "B.position"]
    mechanism = ck.Mechanism("program", *parts, ck.drive("crank", law=law), outputs=names)
    longer = ck.link("rod", B=0, C=3.2)
    changed = ck.Mechanism("program", *parts[:2], longer, parts[3], ck.drive("crank", law=law), outputs=names)
    motion = ck.solve(mechanism, time=np.linspace(0.0, 1.0, 23))
    page(motion).save(tmp_path / "jump.html")
    view = opened(tmp_path / "jump.html")
    pieces = view.value(f"{PANELS}['arm.angular_acceleration'].curves[0].pieces.map((one) => [one[0], one.at(-1)])")
    assert [(round(a["x"], 6), round(b["x"], 6)) for a, b in pieces] == [(0, 0.25), (0.25, 0.76), (0.76, 1)]
    exact = ck.solve(mechanism, time=np.array([0.25 + 1e-9, 0.76 - 1e-9])).links["arm"].angular_acceleration
    assert [one["y"] for one in pieces[1]] == pytest.approx(exact.tolist(), rel=1e-6)
    _follows(view, ck.solve(changed, time=motion.time))
    view.value("compoundkin.players[0].plots.add('A.position')")
    assert view.value(f"{PANELS}['A.position'].curves.map((curve) => curve.marks.length)") == [0, 0]
    assert view.value(
        "compoundkin.players[0].plots.panels.every(({ plot }) => plot.series.every((one, k) => !k || !one.pxAlign))"
    )
    panel = view.locator(".plot").last
    panel.get_by_role("button", name="Axes").click()
    field = panel.get_by_role("textbox", name="from")
    field.fill("0.5")
    field.press("Enter")
    assert view.value("compoundkin.players[0].plots.panels.at(-1).plot.scales.x.min") == 0.5
    panel.locator(".u-over").dblclick()
    assert view.value("compoundkin.players[0].plots.panels.at(-1).plot.scales.x.min") == 0.0
    assert view.complaints == []


def _follows(view: Any, motion: ck.results.Motion) -> None:
    """The extremes of a changed motion in time, on both sides of jumps too."""
    view.value(
        "() => { compoundkin.players[0].design.change({ 'rod.C.x': 3.2 }); compoundkin.players[0].figures.follow(); }"
    )
    (found,) = extremes(motion, "arm.angular_acceleration")
    row = view.value("""() => [...document.querySelectorAll("tr[data-figure]")]
        .find((row) => row.dataset.figure.includes("range") && row.dataset.figure.includes("arm.angular_acc"))
        .innerHTML.match(/data-sort="[^"]*"/g).map((text) => Number(text.slice(11, -1)))""")
    wanted = [float(v) for end in (found.least, found.greatest) for v in (end.value[0], np.array(end.at.time)[0])]
    assert row[:4] == pytest.approx(wanted, abs=1e-5)
    view.value("() => { compoundkin.players[0].design.reset(); compoundkin.players[0].figures.follow(); }")


def test_a_constant_rate_of_poses_that_accelerate_is_drawn_level(opened: Any, tmp_path: Path) -> None:
    """Both shafts of an Oldham coupling turn alike: at 5 rad/s at every pose, whatever their acceleration is there."""
    page(ck.solve(load("oldham-coupling"), speed=5, acceleration=2)).save(tmp_path / "oldham.html")
    view = opened(tmp_path / "oldham.html")
    low, high = view.value("""() => {
      const one = compoundkin.players[0].plots.panels.find(({ name }) => name === "output.angular_velocity");
      return ["low", "high"].map((end) => one.curves[0].ends[end].y);
    }""")
    assert high - low < 1e-9
    assert abs(low - 5) < 1e-9
