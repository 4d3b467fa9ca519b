"""Plots and the report of a search of better dimensions: before and after, places wanted, where searches ended."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")

import compoundkin as ck
from compoundkin.studies.goals.constraints import at_least
from tests import catalog

STROKE = "rocker.angle.stroke"
TURN = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)


@cache
def smaller_stroke() -> ck.results.Optimum:
    free = {"rocker.C.x": (3.5, 4.5)}
    bound = at_least("rocker.transmission_angle.least", np.deg2rad(10.0))
    return ck.optimise(catalog.mechanism("crank-rocker"), free, STROKE, bound, starts=2)


@cache
def wanted() -> np.ndarray[Any, Any]:
    """Where the coupler's pin goes with a longer rocker."""
    rocker = catalog.mechanism("crank-rocker")
    longer = rocker.replace(ck.link("rocker", D=0, C=4.2))
    return np.array(ck.solve(longer, TURN).points["C"].position)


@cache
def path() -> ck.results.Optimum:
    free = {"rocker.C.x": (3.6, 4.4), "crank.B.x": (1.9, 2.1)}
    return ck.optimise(catalog.mechanism("crank-rocker"), free, ck.goals.path("C", wanted()), values=TURN, starts=3)


def tables(report: ck.results.Report, section: str) -> list[list[list[Any]]]:
    blocks = json.loads(report.json())["sections"][section]["blocks"]
    return [block["rows"] for block in blocks if block["kind"] == "table"]


def test_paths_have_the_places_wanted_and_go_through_a_whole_turn() -> None:
    axes = path().plot().figure.axes[0]
    lines = {line.get_label(): line.get_xdata() + 1j * line.get_ydata() for line in axes.get_lines()}
    np.testing.assert_array_equal(lines["wanted"], wanted())
    for label, motion in (("before", path().before), ("after", path().motion)):
        at = np.asarray(motion.points["C"].position)
        # every pose asked is on the curve, which closes
        assert np.abs(lines[label][None, :] - at[:, None]).min(axis=1).max() < 0.02
        assert abs(lines[label][0] - lines[label][-1]) < 1e-9
    assert {text.get_text() for text in axes.texts} == {str(k) for k in range(1, 9)}


def test_courses_are_before_and_after() -> None:
    found = smaller_stroke()
    axes = found.plot().figure.axes[0]
    before, after = axes.get_lines()
    np.testing.assert_allclose(before.get_ydata(), np.rad2deg(found.before.links["rocker"].angle))
    np.testing.assert_allclose(after.get_ydata(), np.rad2deg(found.motion.links["rocker"].angle))
    both = ck.plots.improvement(found, "C", "rocker.angular_velocity").figure
    assert [one.get_ylabel() for one in both.axes] == ["y [length]", "rocker.angular_velocity\n[rad/s]"]
    assert both.get_suptitle().startswith("Crank-rocker: objective 61.4261 deg → ")
    with pytest.raises(ck.errors.UnknownName):
        ck.plots.improvement(found, "rocker.angel")


def test_searches_come_the_best_first() -> None:
    found = path()
    axes = ck.plots.starts(found).figure.axes[0]
    lines = {line.get_label().partition(":")[0]: np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()}
    assert len(lines["ended"]) == found.starts == 3
    assert sorted(lines["began"]) == pytest.approx(sorted(found.begun))
    np.testing.assert_allclose(lines["ended"], np.sort(found.ended), atol=found.begun.max() * 1e-3)
    assert axes.get_yscale() == "log"
    assert lines["before"][0] == pytest.approx(found.value_before)


def test_the_report_tells_what_changed_and_how_sure_it_is() -> None:
    found = smaller_stroke()
    report = ck.report(found)
    ((name, unit, before, after, change, low, high, said),) = tables(report, "changes")[0]
    own = found.changes[0]
    assert (name, unit, before, after, low, high) == (own.name, own.unit, own.before, own.after, own.low, own.high)
    assert change == pytest.approx(after - before)
    assert said == (f"{own.binds} bound" if own.binds else "")
    (constraint,) = tables(report, "constraints")[0]
    angle = ck.quantity(found.motion, "rocker.transmission_angle.least").values
    assert constraint[1:4] == [pytest.approx(float(np.rad2deg(np.min(angle))) - 10.0, abs=1e-6), "deg", True]
    minima = tables(report, "minima")[0]
    assert minima[0][:2] == [1, pytest.approx(float(np.rad2deg(found.value)))]
    assert minima[0][-1] == pytest.approx(own.after)
    assert report.outcome.verified is True
    assert report.outcome.checks == len(found.check.findings) == len(tables(report, "checks")[0])
    text = report.text()
    assert "The objective came from 61.4261 deg to " in text
    assert f"{found.agreed} ended at an objective as good as the best." in " ".join(text.split())


def test_its_page_and_notebooks_show_it() -> None:
    html = ck.page(path()).html
    assert html.count('<img src="data:image/svg+xml;base64,') == 2
    assert "all " in html
    shown = path()._repr_html_()
    assert shown is not None
    assert shown.count("<table") >= 3
