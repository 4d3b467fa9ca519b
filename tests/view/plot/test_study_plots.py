"""Plots of studies, tolerances and optimisations, and what the report says of these."""

from __future__ import annotations

import json
from functools import cache
from itertools import chain
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.goals.constraints import at_least
from tests import catalog

pytest.importorskip("matplotlib")

from compoundkin.base import percentiles
from compoundkin.studies import study_rows
from compoundkin.studies.study_result import pareto_rows
from compoundkin.view.plot.scatter_plots import rank_correlation
from compoundkin.view.plot.study_columns import drawn_rows

STROKE, TRANSMISSION, ANGLE = "rocker.angle.stroke", "rocker.transmission_angle.least", "rocker.angle"
CRANK, ROD = "crank.B.x", "coupler.C.x"
TURN = np.linspace(0.0, 2.0 * np.pi, 13)


def studied(count: int = 128, crank: tuple[float, float] = (1.0, 3.2)) -> ck.results.StudyResult:
    free = {CRANK: crank, ROD: (5.0, 7.5)}
    asked = [STROKE, TRANSMISSION, ANGLE, "C.position"]
    return ck.study(catalog.mechanism("crank-rocker"), free, asked, count=count, values=TURN).run()


@pytest.fixture(scope="module")
def result() -> ck.results.StudyResult:
    return studied()


@pytest.fixture(scope="module")
def tolerances() -> ck.results.ToleranceAnalysis:
    given, asked = {"crank.B": 0.01, "rocker.C": 0.02}, [ANGLE, "C.position", STROKE]
    return ck.tolerance(catalog.mechanism("crank-rocker"), given, asked, clearance={"B": 0.01}, values=TURN)


def texts(axes: Any) -> list[str]:
    return [text.get_text() for text in axes.texts]


def heading(plot: ck.results.Plot) -> str:
    return str(plot.figure.get_suptitle())


def test_the_front_is_what_no_row_betters() -> None:
    """Against every pair of rows, with equal values, and with rows that are not known."""
    drawn = np.random.default_rng(4)
    for count in (0, 1, 7, 200):
        first, second = drawn.integers(0, 12, (2, count)).astype(float)
        first[::9] = np.nan
        a, b = first[:, None], second[:, None]
        better = (first <= a) & (second <= b) & ((first < a) | (second < b))
        expected = np.flatnonzero(~better.any(axis=1) & np.isfinite(first))
        found = pareto_rows(first, second)
        assert sorted(found) == list(expected)
        assert (np.diff(first[found]) >= 0).all()


def test_a_scatter_matrix_shows_the_rows_and_which_are_not_assembled(result: ck.results.StudyResult) -> None:
    assert 0 < result.assembled.sum() < len(result)
    plot = result.plot(CRANK, ROD, STROKE)
    grid = np.reshape(np.array(plot.figure.axes, dtype=object), (3, 3))
    missing, own = (part.get_offsets() for part in grid[1, 0].collections)
    for drawn, meant in ((missing, ~result.assembled), (own, result.assembled)):
        np.testing.assert_array_equal(drawn, np.column_stack([result[CRANK][meant], result[ROD][meant]]))
    strokes = grid[2, 0].collections[1].get_offsets()[:, 1]
    np.testing.assert_allclose(strokes, np.rad2deg(result[STROKE][result.assembled]), rtol=1e-14)
    assert heading(plot) == f"Crank-rocker: 128 designs, {np.count_nonzero(~result.assembled)} cannot be assembled"
    x, y = (np.argsort(np.argsort(result[name][result.assembled])) for name in (CRANK, STROKE))
    assert float(texts(grid[0, 2])[0]) == round(np.corrcoef(x, y)[0, 1], 2)
    coloured = result.plot(CRANK, STROKE, colour=TRANSMISSION).figure.axes
    assert coloured[-1].get_ylabel() == f"{TRANSMISSION} [°]"


def test_a_pareto_plot_has_the_front_of_all_rows(result: ck.results.StudyResult) -> None:
    plot = ck.plots.pareto(result, STROKE, TRANSMISSION, greatest=[STROKE])
    axes = plot.figure.axes[0]
    front = pareto_rows(-result[STROKE], np.where(result.assembled, result[TRANSMISSION], np.nan))
    drawn = {part.get_label(): np.asarray(part.get_offsets()) for part in axes.collections}
    expected = np.rad2deg(np.column_stack([result[STROKE], result[TRANSMISSION]]))
    np.testing.assert_allclose(drawn["front"], expected[front])
    assert len(drawn["front"]) + len(drawn["other designs"]) == result.assembled.sum()
    assert (axes.get_xlabel(), axes.get_ylabel()) == (f"{STROKE} [°], greatest", f"{TRANSMISSION} [°], least")
    assert len(front) > 12 or set(texts(axes)) <= set(map(str, front))


def test_bands_are_the_percentiles_of_assembled_designs(result: ck.results.StudyResult) -> None:
    plot = ck.plots.bands(result, ANGLE, "C.position", percentiles=(5, 50, 95))
    angle, x, _ = plot.figure.axes
    np.testing.assert_allclose(
        angle.lines[0].get_ydata(), np.rad2deg(np.median(result[ANGLE][result.assembled], axis=0))
    )
    np.testing.assert_allclose(angle.lines[0].get_xdata(), np.rad2deg(TURN))
    edges = x.collections[0].get_paths()[0].vertices[:, 1]
    own = np.percentile(result["C.position"][result.assembled].real, [5, 95], axis=0)
    assert set(np.round(own.ravel(), 9)) <= set(np.round(edges, 9))
    assert [one.get_ylabel() for one in (angle, x)] == [
        "rocker.angle [°]",
        "C.position.x",
    ] or "length" in x.get_ylabel()


def test_a_histogram_counts_every_assembled_design(result: ck.results.StudyResult) -> None:
    axes = result.plot(STROKE).figure.axes[0]
    assert sum(bar.get_height() for bar in axes.patches) == result.assembled.sum()
    values = np.rad2deg(np.percentile(result[STROKE][result.assembled], [5, 50, 95]))
    np.testing.assert_allclose([line.get_xdata()[0] for line in axes.lines], values)
    assert any(text.startswith("median: ") for text in texts(axes))


def test_bands_of_tolerances_are_errors_and_have_the_worst_case(tolerances: ck.results.ToleranceAnalysis) -> None:
    angle = tolerances.plot(ANGLE).figure.axes[0]
    found = tolerances[ANGLE]
    edges = [np.round(one.get_paths()[0].vertices[:, 1], 9) for one in angle.collections]
    for drawn, half in zip(edges, (found.worst, 3.0 * found.deviation), strict=True):
        assert set(np.round(np.rad2deg(half), 9)) <= set(drawn)
    lines = {line.get_label(): line.get_ydata() for line in angle.lines}
    np.testing.assert_array_equal(lines["nominal"], 0.0)
    low = np.rad2deg(found.sample.percentiles[0] - found.nominal)
    np.testing.assert_allclose(lines["0.135, 50, 99.865 % of random designs"], low)
    whole = ck.plots.bands(tolerances, "C.position", relative=False).figure.axes
    np.testing.assert_allclose(whole[0].lines[0].get_ydata(), tolerances["C.position.x"].nominal)


def test_contributions_are_shares_and_parts_the_greatest_first(tolerances: ck.results.ToleranceAnalysis) -> None:
    shares, parts = tolerances.plot(STROKE).figure.axes
    found = tolerances[STROKE]
    names = sorted(found.contributions, key=lambda name: -float(found.contributions[name]))
    assert [label.get_text().replace("\n", "") for label in shares.get_yticklabels()] == names
    np.testing.assert_allclose(
        [bar.get_width() for bar in shares.patches], [100 * found.contributions[n] for n in names]
    )
    np.testing.assert_allclose(
        [bar.get_width() for bar in parts.patches], [np.rad2deg(found.worst_parts[n]) for n in names]
    )
    assert sum(bar.get_width() for bar in shares.patches) == pytest.approx(100.0)
    at = ck.plots.contributions(tolerances, ANGLE, pose=3)
    assert heading(at).replace("\n", " ").startswith("Crank-rocker: rocker.angle at crank 90°, worst case ±")


def test_a_histogram_of_tolerances_has_the_normal_distribution_beside_it(
    tolerances: ck.results.ToleranceAnalysis,
) -> None:
    axes = ck.plots.histogram(tolerances, STROKE).figure.axes[0]
    assert sum(bar.get_height() for bar in axes.patches) == tolerances.count
    curve = next(line for line in axes.lines if line.get_label() == "normal, by slopes")
    x, y = curve.get_data()
    width = axes.patches[0].get_width()
    area = float(np.sum((y[1:] + y[:-1]) / 2.0 * np.diff(x)))
    assert area == pytest.approx(tolerances.count * width, rel=1e-3)


def test_odd_studies_are_drawn_too() -> None:
    """A single design; none that can be assembled; a column that does not change."""
    single, none = studied(1), studied(8, crank=(8.0, 9.0))
    assert not none.assembled.any()
    for one in (single, none):
        drawn = one.plot(CRANK, STROKE, colour=STROKE), one.plot(STROKE), one.plot(ANGLE)
        for plot in (*drawn, ck.plots.pareto(one, STROKE, TRANSMISSION)):
            assert plot.figure.axes
    assert "no values" in texts(none.plot(ANGLE).figure.axes[0])
    assert heading(none.plot()) == "Crank-rocker: 8 designs, 8 cannot be assembled"
    assert rank_correlation(np.ones(9), np.arange(9.0)) is None


@pytest.mark.parametrize("most", [40, 2**22])
def test_what_is_read_piece_by_piece_is_drawn_as_the_whole(
    result: ck.results.StudyResult, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    """Pieces of 16 rows; courses whose values are sorted, or counted first."""

    def drawn() -> list[Any]:
        plots = (
            ck.plots.histogram(result, STROKE),
            ck.plots.pareto(result, STROKE, TRANSMISSION, greatest=[STROKE], colour=CRANK),
            ck.plots.bands(result, ANGLE),
            result.plot(CRANK, STROKE),
        )
        axes = [one for plot in plots for one in plot.figure.axes]
        bars = [[part.get_height() for part in one.patches] for one in axes]
        lines = [[np.asarray(part.get_ydata(), dtype=float) for part in one.lines] for one in axes]
        dots = [[np.asarray(part.get_offsets()) for part in one.collections] for one in axes]
        return [*bars, *chain(*lines, *dots), *(heading(plot) for plot in plots)]

    whole = drawn()
    monkeypatch.setattr(study_rows, "MOST_ROWS", 16)
    monkeypatch.setattr(percentiles, "MOST_SORTED", most)
    for one, other in zip(drawn(), whole, strict=True):
        np.testing.assert_array_equal(one, other)


def test_of_very_many_designs_some_thousands_are_drawn() -> None:
    rows = drawn_rows(2**20)
    assert len(rows) == len(np.unique(rows)) == 3000
    np.testing.assert_array_equal(rows, drawn_rows(2**20))


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda r, t: r.plot("rocker.angel"), "the study has no such column of numbers (did you mean 'rocker.angle'?)"),
        (lambda r, t: ck.plots.scatter_matrix(r, ANGLE), "rocker.angle: it has a value at every pose"),
        (lambda r, t: ck.plots.bands(r, STROKE), "it has one number for each design, none at the poses"),
        (lambda r, t: ck.plots.pareto(r, STROKE, ANGLE), "rocker.angle: it has a value at every pose"),
        (lambda r, t: ck.plots.pareto(r, STROKE, CRANK, greatest=[ROD]), "greatest: 'coupler.C.x' is neither figure"),
        (lambda r, t: ck.plots.bands(r, ANGLE, percentiles=(101,)), "percentiles: 101 is not a percentile"),
        (lambda r, t: ck.plots.contributions(t, "C.position"), "take C.position.x or C.position.y"),
        (lambda r, t: ck.plots.contributions(t, ANGLE, pose=13), "there is no pose 13 (0 to 12)"),
        (lambda r, t: ck.plots.contributions(t, STROKE, pose=0), "one number of the whole motion"),
        (lambda r, t: ck.plots.bands(t, STROKE), "one number of the whole motion"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_told(
    call: Any, told: str, result: ck.results.StudyResult, tolerances: ck.results.ToleranceAnalysis
) -> None:
    with pytest.raises(ck.errors.CompoundkinError) as caught:
        call(result, tolerances)
    assert told.partition(" (")[0] in str(caught.value)


EIGHTHS = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)


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
    return np.array(ck.solve(longer, EIGHTHS).points["C"].position)


@cache
def path() -> ck.results.Optimum:
    free = {"rocker.C.x": (3.6, 4.4), "crank.B.x": (1.9, 2.1)}
    return ck.optimise(catalog.mechanism("crank-rocker"), free, ck.goals.path("C", wanted()), values=EIGHTHS, starts=3)


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
    assert both.get_suptitle().startswith("Crank-rocker: objective 61.4261° → ")
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
    assert "The objective came from 61.4261° to " in text
    assert f"{found.agreed} ended at an objective as good as the best." in " ".join(text.split())


def test_its_page_and_notebooks_show_it() -> None:
    html = ck.page(path()).html
    assert html.count('<img src="data:image/svg+xml;base64,') == 2
    assert "all " in html
    shown = path()._repr_html_()
    assert shown is not None
    assert shown.count("<table") >= 3
