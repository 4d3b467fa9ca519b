"""Reports of studies and tolerance analyses: their numbers, their pages, what notebooks show."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog

ANGLE, STROKE = "rocker.angle", "rocker.angle.stroke"
TURN = np.linspace(0.0, 2.0 * np.pi, 13)


@cache
def tolerances() -> ck.results.ToleranceAnalysis:
    given, asked = {"crank.B": 0.01, "rocker.C": 0.02}, [ANGLE, "C.position", STROKE]
    return ck.tolerance(catalog.mechanism("crank-rocker"), given, asked, clearance={"B": 0.01}, values=TURN)


@cache
def result() -> ck.results.StudyResult:
    free = {"crank.B.x": (1.0, 3.2), "coupler.C.x": (5.0, 7.5)}
    return ck.study(catalog.mechanism("crank-rocker"), free, [STROKE, ANGLE], count=64, values=TURN).run()


def tables(report: ck.results.Report, section: str) -> list[tuple[list[str], list[list[Any]]]]:
    blocks = json.loads(report.json())["sections"][section]["blocks"]
    found = [block for block in blocks if block["kind"] == "table"]
    return [([f"{c['name']} [{c['unit']}]".removesuffix(" []") for c in b["columns"]], b["rows"]) for b in found]


def test_errors_are_those_of_the_analysis_in_degrees() -> None:
    found = tolerances()[ANGLE]
    pose = int(np.argmax(found.deviation))
    (heads, rows), (_, sampled) = tables(ck.report(tolerances()), "errors")
    assert heads == ["output", "unit", "crank [deg]", "nominal", "worst low", "worst high", "deviation"]
    own = [float(np.rad2deg(values[pose])) for values in (found.nominal, found.low, found.high, found.deviation)]
    assert rows[0][:2] == [ANGLE, "deg"]
    assert rows[0][2:] == pytest.approx([np.rad2deg(TURN[pose]), *own], rel=1e-3)
    assert rows[-1][:3] == [STROKE, "deg", None]
    percentiles = np.rad2deg(found.sample.percentiles[:, pose])
    assert [row[4] for row in sampled[:3]] == pytest.approx(percentiles.tolist(), rel=1e-12)


def test_contributions_come_by_their_shares() -> None:
    every = tables(ck.report(tolerances(), [STROKE]), "contributions")
    assert len(every) == 1
    heads, rows = every[0]
    found = tolerances()[STROKE]
    assert heads == ["source", "lower", "upper", "unit", "share [%]", "worst case [deg]", "deviation [deg]"]
    shares = {row[0]: row[4] for row in rows}
    assert list(shares.values()) == sorted(shares.values(), reverse=True)
    for name, share in found.contributions.items():
        assert shares[name] == pytest.approx(100.0 * share, abs=0.005)
    assert sum(shares.values()) == pytest.approx(100.0, abs=0.02)


def test_bands_stand_at_the_poses() -> None:
    ((heads, rows),) = tables(ck.report(tolerances(), [ANGLE]), "bands")
    assert heads[:2] == ["crank [deg]", "rocker.angle [deg]"]
    assert [row[0] for row in rows] == pytest.approx(np.rad2deg(TURN).tolist())
    assert [row[2] for row in rows] == pytest.approx(np.rad2deg(tolerances()[ANGLE].worst).tolist(), rel=1e-3)


def test_a_study_lists_the_best_of_what_is_asked() -> None:
    report = ck.report(result(), [STROKE])
    assert [section.key for section in report.sections] == ["study", "figures", "states", "best"]
    least, greatest = tables(report, "best")
    assert [row[0] for row in least[1]] == [row["row"] for row in result().best(STROKE, 3)]
    assert [row[0] for row in greatest[1]] == [row["row"] for row in result().best(STROKE, 3, greatest=True)]
    with pytest.raises(ck.errors.InvalidInput, match="design: a study is reported as a whole"):
        ck.report(result(), design=1)


@pytest.mark.parametrize("found", [result, tolerances], ids=lambda one: one.__name__)
def test_all_forms_are_written_and_the_page_has_its_plots(found: Any) -> None:
    pytest.importorskip("matplotlib")
    report = ck.report(found())
    assert report.text().startswith("Crank-rocker\n")
    assert max(map(len, report.text().splitlines())) <= 80
    assert "## " in report.markdown()
    html = report.html()
    plots = re.findall(r'<img src="data:image/svg.xml;base64,[^"]+" alt="([^"]+)"', html)
    assert len(plots) == len(set(plots)) == (2 if found is result else 5)
    assert "25 of 25" not in html
    assert "13 of 13 poses assembled" in html


@pytest.mark.parametrize("found", [result, tolerances], ids=lambda one: one.__name__)
def test_notebooks_show_the_tables(found: Any) -> None:
    shown = found()._repr_html_()
    assert shown.count("<table") >= 2
    assert "rocker.angle.stroke" in shown


def test_without_matplotlib_pages_have_no_plots(monkeypatch: pytest.MonkeyPatch) -> None:
    from compoundkin.view.page import study_figures

    monkeypatch.setattr(study_figures, "find_spec", lambda name: None)
    assert "<img" not in ck.page(tolerances()).html
