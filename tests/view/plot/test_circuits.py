"""Branches as curves: they pass through all configurations, meet at limit positions, and are as many as are known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.view.plot.circuit_plot import segment_positions, segment_quantity
from compoundkin.view.report import report
from tests import catalog

pytest.importorskip("matplotlib")

from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.view import plot
from compoundkin.view.plot.circuit_plot import branch_curve, wrapped_curve
from tests.configurations.mechanisms import four_bar
from tests.support import REFERENCE

# where coupler and rocker of the catalog's triple rocker are in line, by the cosine rule
LIMIT = np.rad2deg(np.arccos((4**2 + 7**2 - 8**2) / (2 * 4 * 7)))
NAMES = ["six-bar", "stephenson-iii", "class-iii-six-bar", "jansen-leg", "crank-rocker", "double-rocker", "watt-ii"]


def lines(axes: Any) -> list[Any]:
    """The curves of an axes: what is no mark."""
    return [line for line in axes.get_lines() if line.get_linestyle() != "None"]


def marks(axes: Any, marker: str) -> list[tuple[float, float]]:
    found = [line for line in axes.get_lines() if line.get_marker() == marker and line.get_linestyle() == "None"]
    pairs = [(x, y) for line in found for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)]
    return [(float(x), float(y)) for x, y in pairs if np.isfinite(x) and np.isfinite(y)]


def crossed(axes: Any, value: float) -> list[float]:
    """Where the curves of an axes cross a value of the driver."""
    found = []
    for line in lines(axes):
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        with np.errstate(invalid="ignore"):
            k = np.flatnonzero((x[:-1] - value) * (x[1:] - value) < 0)
        found += (y[k] + (value - x[k]) / (x[k + 1] - x[k]) * (y[k + 1] - y[k])).tolist()
    return sorted(found)


# --- the curves ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_the_curves_cross_a_driver_value_at_its_configurations(name: str) -> None:
    mechanism = load(name)
    letter = ck.decompose(mechanism).groups[-1].inner[0].letters[0]
    x, y = plot.circuits(mechanism, letter).figure.axes
    low, high = x.get_xlim()
    for value in low + (high - low) * np.array([0.231, 0.617, 0.873]):
        try:
            places = np.ravel(ck.configurations(mechanism, np.deg2rad(value)).points(letter))
        except ck.errors.NotAssembled:
            places = np.zeros(0, dtype=complex)
        places = places[np.isfinite(places)]
        for axes, wanted in ((x, places.real), (y, places.imag)):
            np.testing.assert_allclose(crossed(axes, value), np.sort(wanted), atol=3e-4 * mechanism.geometry.size)


@settings(max_examples=15, deadline=None)
@given(st.tuples(*[st.floats(2.0, 9.0)] * 4))
def test_branches_of_a_circuit_meet_at_their_limit_positions(lengths: tuple[float, ...]) -> None:
    """At both ends of a branch there is the limit position, exactly, and the next branch begins there."""
    a, b, c, d = sorted(lengths)
    # the longest one shorter than the others together, and no change point near
    if d > a + b + c - 0.2 or abs(a + d - b - c) < 0.2:
        return
    found = ck.circuits(four_bar(c, b, a, d, "crank"))
    positions = segment_positions(found)
    (angle,) = segment_quantity(positions, "rocker.angle")
    ends: dict[int, list[float]] = {}
    for branch in found.branches:
        curve = branch_curve(positions, branch, angle)
        for k, limit in curve.limits:
            assert abs(np.angle(np.exp(1j * (np.deg2rad(curve.x[k]) - limit.value)))) < 1e-12
            wanted = limit.configuration.angles["rocker"]
            assert abs(np.angle(np.exp(1j * (np.deg2rad(curve.y[k]) - wanted)))) < 1e-12
            ends.setdefault(id(limit), []).append(float(curve.y[k]))
    assert len(ends) == len(found.limits)
    for both in ends.values():
        assert len(both) == 2
        assert abs(np.angle(np.exp(1j * np.deg2rad(both[0] - both[1])))) < 1e-12


def test_limit_positions_are_where_coupler_and_rocker_are_in_line() -> None:
    (axes,) = plot.circuits(load("triple-rocker"), "rocker.angle").figure.axes
    dots = sorted({round(x, 9) for x, _ in marks(axes, "o")})
    assert dots == pytest.approx([-LIMIT, LIMIT], abs=1e-8)
    reached = [np.nanmax(line.get_xdata()) for line in lines(axes)]
    assert reached == pytest.approx([LIMIT, LIMIT], abs=1e-9)


def test_a_turn_is_not_drawn_across_its_ends() -> None:
    """A crank that turns: within one turn, and no stroke from one side to the other."""
    for name, quantity in (("double-crank", "follower.angle"), ("planetary-train", "planet.angle")):
        (axes,) = plot.circuits(load(name), quantity).figure.axes
        for line in lines(axes):
            x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
            assert (np.nanmin(x), np.nanmax(x)) == (0.0, 360.0)
            assert np.nanmax(np.abs(np.diff(x))) < 30.0
            assert np.nanmax(np.abs(np.diff(y))) < 60.0
            assert np.nanmax(y) - np.nanmin(y) == pytest.approx(360.0)


@given(st.lists(st.floats(-170.0, 170.0), min_size=2, max_size=12), st.sampled_from([-180.0, 0.0, -90.0]))
def test_a_wrapped_curve_is_the_same_curve(steps: list[float], low: float) -> None:
    x = np.cumsum(steps)
    cut, along = wrapped_curve(x, np.arange(len(x), dtype=float), low)
    known = np.isfinite(cut)
    assert ((cut[known] >= low) & (cut[known] <= low + 360.0)).all()
    whole = np.interp(along[known], np.arange(len(x)), x)
    np.testing.assert_allclose(np.exp(1j * np.deg2rad(cut[known])), np.exp(1j * np.deg2rad(whole)), atol=1e-9)
    # without what was put in, every place is there
    assert set(range(len(x))) <= set(along[known].tolist())


def test_a_change_point_is_ringed_at_both_ends_of_the_turn() -> None:
    (axes,) = plot.circuits(load("parallelogram"), "P.y").figure.axes
    assert sorted({round(x, 6) for x, _ in marks(axes, "o")}) == [0.0, 180.0, 360.0]


def test_a_slide_is_followed_over_its_lengths() -> None:
    links = ck.link("frame", A=0, D=7), ck.link("barrel", A=0), ck.link("rod", B=0), ck.link("arm", D=0, B=4)
    cylinder = ck.slide("rod", on="barrel", at="B", through="A", turn=0.0, name="cylinder")
    press = ck.Mechanism(
        "Cylinder", *links, cylinder, ck.drive("rod", on="barrel"), ck.drawn(A=0, D=7, B=5 + 3j), unit="mm"
    )
    picture = plot.circuits(press, "arm.angle")
    (axes,) = picture.figure.axes
    assert axes.get_xlabel() == "rod [mm]"
    assert sorted({round(x, 6) for x, _ in marks(axes, "o")}) == [3.0, 11.0]


# --- how many, and which ---------------------------------------------------------------------------------


ENTRIES = json.loads((REFERENCE / "circuits.json").read_text(encoding="utf-8"))
FOUR_BARS = [entry for entry in ENTRIES if "joints" not in entry["dimensions"]]


@pytest.mark.parametrize("entry", FOUR_BARS, ids=[entry["id"] for entry in FOUR_BARS])
def test_as_many_colours_and_curves_as_the_reference_has_circuits_and_branches(entry: dict[str, Any]) -> None:
    d = entry["dimensions"]
    driver = "rocker" if "input t3" in entry["description"] else "crank"
    picture = plot.circuits(four_bar(d["a"], d["b"], d["c"], d["d"], driver), "coupler.angle")
    expected = entry["expected"]["circuits"]
    drawn = lines(picture.figure.axes[0])
    assert len({line.get_color() for line in drawn}) == len(expected)
    # a circuit has as many branches as limits, or one
    assert len(drawn) == sum(max(1, one["n_turning_points"]) for one in expected)


def test_the_legend_tells_circuit_and_branch_and_the_own_circuit_is_wide() -> None:
    found = ck.circuits(load("stephenson-iii"))
    picture = plot.circuits(found, "FG.angle")
    names, meanings = ([text.get_text() for text in legend.get_texts()] for legend in picture.figure.legends)
    assert names == [f"circuit {branch.circuit}, branch {branch.number}" for branch in found.branches]
    assert meanings == ["limit position", "where solving begins"]
    assert found.start is not None
    widths = [line.get_linewidth() for line in lines(picture.figure.axes[0])]
    own = [branch.circuit == found.start.circuit for branch in found.branches]
    assert [width == max(widths) for width in widths] == own
    (start,) = marks(picture.figure.axes[0], "D")
    assert start[0] == pytest.approx(np.rad2deg(found.start.value))
    labels = {text.get_text() for text in picture.figure.axes[0].texts}
    assert labels == {"RRR(BCE)", "RRR(EF)"}


def test_many_circuits_are_grey_but_for_the_own() -> None:
    """Four dyads of cranks that turn: sixteen circuits, which no reader tells apart by colours."""
    words = [ck.link("frame", A=0, **{f"D{k}": 40 * np.exp(1j * k) for k in range(4)}), ck.link("crank", A=0, B=8)]
    for k in range(4):
        words += [ck.link(f"rod-{k}", **{"B": 0, f"C{k}": 38}), ck.link(f"arm-{k}", **{f"D{k}": 0, f"C{k}": 25})]
    picture = plot.circuits(ck.Mechanism("Star", *words, ck.drive("crank")), "C3.x")
    assert len(lines(picture.figure.axes[0])) == 16
    assert len({line.get_color() for line in lines(picture.figure.axes[0])}) == 2
    names = [text.get_text() for text in picture.figure.legends[0].get_texts()]
    assert names[1:] == ["15 other circuits"]


def test_without_a_quantity_it_is_what_the_mechanism_states_or_what_tells_branches_apart() -> None:
    stated = plot.circuits(load("crank-rocker"))
    assert [axes.get_ylabel() for axes in stated.figure.axes] == ["rocker.angle [°]", "coupler.angle [°]"]
    plain = four_bar(4.0, 5.0, 3.0, 7.0, "crank")
    assert [axes.get_ylabel() for axes in plot.circuits(plain).figure.axes] == ["rocker.angle [°]"]


def test_one_driver_of_several_moves_and_the_title_tells_where_the_others_stand() -> None:
    five_bar = load("five-bar")
    picture = plot.circuits(five_bar, "P", driver="left", values={"right": ck.deg(100)})
    assert picture.figure.get_suptitle().endswith("right at 100°")
    place = np.ravel(ck.configurations(five_bar, {"left": ck.deg(70), "right": ck.deg(100)}).points("P"))
    np.testing.assert_allclose(crossed(picture.figure.axes[0], 70.0), np.sort(place.real), atol=1e-2)
    part = plot.circuits(five_bar, "P.x", driver="left", between=ck.deg([20.0, 60.0]))
    x = np.concatenate([line.get_xdata() for line in lines(part.figure.axes[0])])
    assert (np.nanmin(x), np.nanmax(x)) == (pytest.approx(20.0), pytest.approx(60.0))


# --- what is no position, and the command line -----------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "error", "told"),
    [
        ("rocker.angel", ck.errors.UnknownName, "did you mean 'rocker.angle'"),
        ("roker", ck.errors.UnknownName, "did you mean 'rocker'"),
        ("roker.angular_velocity", ck.errors.UnknownName, "did you mean 'rocker'"),
        ("rocker.angular_velocity", ck.errors.InvalidInput, "circuits show positions"),
        ("C.velocity.x", ck.errors.InvalidInput, "take C.x"),
        ("rocker.angle.x", ck.errors.UnknownName, "rocker.angle"),
    ],
)
def test_wrong_quantities_are_told(name: str, error: type[Exception], told: str) -> None:
    with pytest.raises(error, match=told):
        plot.circuits(load("triple-rocker"), name)


def test_circuits_that_are_found_take_no_options_of_their_finding() -> None:
    found = ck.circuits(load("triple-rocker"))
    with pytest.raises(ck.errors.InvalidInput, match="found already"):
        plot.circuits(found, "rocker.angle", driver="driver")
    with pytest.raises(ck.errors.InvalidInput, match="is no mechanism"):
        plot.circuits("triple-rocker")  # type: ignore[arg-type]


def test_the_command_draws_what_python_draws(tmp_path: Path) -> None:
    target = tmp_path / "a.svg"
    result = CliRunner().invoke(cli, ["plot", "triple-rocker", "rocker.angle", "--circuits", "-o", str(target)])
    assert result.exit_code == 0, result.stderr
    assert target.read_bytes() == plot.circuits(load("triple-rocker"), "rocker.angle").content("svg")
    asked = ["plot", "five-bar", "P.x", "--circuits", "--driver", "left", "--drive", "right=100"]
    part = CliRunner().invoke(cli, [*asked, "--from", "20", "--to", "60"])
    wanted = plot.circuits(
        load("five-bar"), "P.x", driver="left", values={"right": ck.deg(100)}, between=ck.deg([20.0, 60.0])
    )
    assert part.stdout_bytes == wanted.content("svg")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--circuits", "--phase"], "a plot is of one kind"),
        (["--circuits", "--step", "2"], "does not go with --circuits"),
        (["--circuits", "--speed", "3"], "does not go with --circuits"),
        (["--circuits", "--against", "time"], "does not go with --circuits"),
        (["--circuits", "--every", "3"], "marks curves in a plane"),
        (["--circuits", "--drive", "30"], "takes all its values"),
        (["--circuits", "--from", "10"], "a range has two ends"),
        (["--driver", "driver"], "give --circuits too"),
    ],
)
def test_options_that_do_not_go_with_circuits_are_told(options: list[str], told: str) -> None:
    result = CliRunner().invoke(cli, ["plot", "triple-rocker", "rocker.angle", *options])
    assert result.exit_code == 2
    assert told in " ".join(result.stderr.split())


def test_transmission_angles_over_circuits_end_at_zero() -> None:
    """Both branches of a triple rocker, from limit to limit of its driver; a ratio of rates is not shown so."""
    found = ck.circuits(catalog.mechanism("triple-rocker"))
    positions = segment_positions(found)
    (angle,) = segment_quantity(positions, "rocker.transmission_angle")
    assert angle.unit == "deg"
    assert np.abs(angle.values[:, [0, -1]]).max() < 1e-4
    assert np.nanmax(angle.values) == pytest.approx(90.0, abs=0.5)
    with pytest.raises(ck.errors.InvalidInput, match="circuits show positions, not rates"):
        segment_quantity(positions, "rocker.advantage")


def test_an_advantage_is_not_drawn_through_its_poles() -> None:
    """A crank-rocker has two toggle positions, and a double crank none: its extremes are marked."""
    rocker, crank = (ck.plot(catalog.motion(name), f"{link}.advantage").figure.axes[0]
                     for name, link in (("crank-rocker", "rocker"), ("double-crank", "follower")))  # fmt: skip
    cuts = np.isnan(rocker.lines[0].get_ydata()).sum()
    assert cuts == 2
    assert not any("−" in text.get_text() for text in rocker.texts if "cut off" not in text.get_text())
    assert not np.isnan(crank.lines[0].get_ydata()).any()


def test_poles_are_gaps_in_polar_plots_and_along_the_axis_too() -> None:
    motion = catalog.motion("crank-rocker")
    polar = ck.plots.polar(motion, "rocker.advantage").figure.axes[0]
    assert np.isnan(polar.lines[0].get_ydata()).sum() == 2
    assert polar.get_xlabel() == "rocker.advantage over crank [°]"
    across = ck.plot(motion, "rocker.transmission_angle", against="rocker.advantage").figure.axes[0]
    assert np.isnan(across.lines[0].get_xdata()).sum() == 2


def test_a_published_advantage_of_a_driver_at_rest_says_which_it_is() -> None:
    crank_rocker = catalog.mechanism("crank-rocker")
    published = ck.expect("rocker.advantage", 1.0, 1.0, **{"crank.speed": 0.0})
    rests = ck.Mechanism("Rests", *crank_rocker.items, published)
    where = rf"expected\[{len(rests.expectations) - 1}\].quantity: no driver moves"
    with pytest.raises(ck.errors.InvalidInput, match=where):
        report(ck.solve(rests))


def test_a_report_says_infinite_where_it_is() -> None:
    """At both dead points of a slider-crank, in the table and among the extremes; not a dash, as of no pose."""
    text = report(catalog.motion("slider-crank"), ["stroke.advantage"]).text()
    assert text.count(" inf") >= 3
    assert "always" not in text.split("Extremes")[1].split("Checks")[0]
