"""What people see of dimensional synthesis: pictures, reports, notebooks."""

from __future__ import annotations

import re

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.sketch.synthesis_pictures import passes_in_order

POSES = [(-0.48, -0.4, -81.0), (0.63, -0.82, 57.0), (0.2, 0.46, 22.0), (-0.62, -0.89, -126.0)]
FOUR = [(x, y, np.deg2rad(angle)) for x, y, angle in POSES]
PLATE = [(2.00, 2.50, 53.1), (1.82, 4.10, 24.8), (-0.47, 3.42, 26.1), (-1.33, 1.34, 45.9), (-0.22, 0.46, 71.4)]


@pytest.fixture(scope="module")
def answer():
    return ck.synthesise(ck.tasks.poses("plate", [(x, y, np.deg2rad(angle)) for x, y, angle in PLATE]))


def test_the_curves_pass_the_poles_and_are_edged_where_a_crank_passes_in_order():
    found = ck.dyads(FOUR)
    picture = found.draw()
    assert len(re.findall(r">P\d\d<", picture.svg)) == 6
    # every pole is a centre of the curve
    for pole in found.poles:
        assert np.min(np.abs(found.curve.centres - pole.place)) < 0.05
    edged = passes_in_order(found.curve, found.task)
    assert 0 < np.sum(edged) < len(edged)
    for k in np.flatnonzero(edged & (found.curve.lengths < 5))[::40]:
        arm = found.task.z + found.task.u * found.curve.points[k] - found.curve.centres[k]
        angle = np.unwrap(np.angle(arm))
        ways = [np.cumsum(np.mod(sense * np.diff(angle), 2 * np.pi)) for sense in (1, -1)]
        assert min(way[-1] for way in ways) < 2 * np.pi


def test_answers_stand_side_by_side_with_their_task(answer):
    picture = answer.draw()
    for number in range(1, len(answer) + 1):
        assert f"{number}  " in picture.svg or f"{number} " in picture.svg
    assert "rejected for branch" in picture.svg
    assert answer.task.in_words in picture.svg


def test_the_report_tells_figures_dimensions_and_defects(answer):
    report = answer.report()
    text = report.text()
    assert "4 real dyads of 4, 6 linkages" in text
    rows = report.section("mechanisms").blocks[1].rows
    assert [row[4] for row in rows] == pytest.approx([np.rad2deg(one.transmission) for one in answer])
    assert len(report.section("rejected").blocks[1].rows) == len(answer.rejected)
    nothing = ck.synthesise(answer.task, transmission=ck.deg(85))
    assert "No candidate is without a defect." in nothing.report().text()
    assert "no mechanism" not in nothing.draw().svg


def test_notebooks_show_them(answer):
    assert answer._repr_html_().count("<figure") == 1
    assert "Rejected candidates" in answer._repr_html_()
    assert "<svg" in ck.dyads(FOUR)._repr_html_()
    links = ck.link("crank", A=0, B=2), ck.link("coupler", B=0, C=5, P=(2, 1.5)), ck.link("rocker", D=0, C=4)
    four_bar = ck.Mechanism("Crank-rocker", ck.link("frame", A=0, D=5), *links, ck.drive("crank"))
    found = ck.cognates(four_bar, "P")
    assert "Cognates(3 linkages for P" in found._repr_html_()
