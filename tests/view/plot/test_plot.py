"""What is drawn is the data of the motion, and what is marked is where it belongs."""

from __future__ import annotations

import re
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, UnknownName
from tests import catalog
from tests.view.loaded import MASS, REACH, SPEED, crank_forces

pytest.importorskip("matplotlib")

from compoundkin.analysis.coupler import centrodes as solved_centrodes
from compoundkin.files import load
from compoundkin.view import plot
from compoundkin.view.plot.quantity_plot import LARGE, SUDDEN

ROOT = Path(__file__).parents[3]
CURVES = ROOT / "compoundkin/view/page/assets/curves.js"
# where coupler and rocker of the catalog's triple rocker are in line, by the cosine rule
LIMIT = np.rad2deg(np.arccos((4**2 + 7**2 - 8**2) / (2 * 4 * 7)))


def solved(name: str, values: Any = None, **options: Any) -> ck.results.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(load(name), values, **options)


@pytest.fixture(scope="module")
def six_bar() -> ck.results.Motion:
    return solved("six-bar", order=3)


@pytest.fixture(scope="module")
def rocker() -> ck.results.Motion:
    return solved("triple-rocker", np.deg2rad(np.arange(0.0, 361.0, 2.5)))


@pytest.fixture(scope="module")
def sweep() -> ck.results.Motion:
    """Five lengths of the coupler."""
    return ck.solve(
        ck.Mechanism(
            "Four-bar",
            ck.link("frame", A=0, D=80),
            ck.link("crank", A=0, B=25),
            ck.link("coupler", B=0, C=np.linspace(60, 90, 5)[:, None], P=30 + 20j),
            ck.link("rocker", D=0, C=50),
            ck.drive("crank"),
        )
    )


def curves(axes: Any) -> dict[str, tuple[Any, Any]]:
    """The lines of an axes that run through poses, by their labels."""
    lines = [line for line in axes.get_lines() if line.get_linestyle() == "-" and len(line.get_xdata()) > 2]
    return {line.get_label(): (np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in lines}


def at_poses(values: Any, poses: int) -> Any:
    """What a curve of a motion without jumps and gaps has at the poses: it is solved between them too."""
    step, rest = divmod(len(values) - 1, poses - 1)
    assert rest == 0
    assert len(values) > 240
    return values[::step]


def texts(axes: Any) -> list[str]:
    return [text.get_text() for text in axes.texts]


# --- over the driver, time, other quantities ------------------------------------------------------------


def test_the_lines_are_the_motions_arrays(six_bar: ck.results.Motion) -> None:
    first, second = ck.plot(six_bar, "bar.angle", "G.velocity").figure.axes
    (angle,) = curves(first).values()
    np.testing.assert_allclose(at_poses(angle[0], 73), np.rad2deg(six_bar.drives["crank"].value), rtol=1e-12)
    np.testing.assert_allclose(at_poses(angle[1], 73), np.rad2deg(six_bar.links["bar"].angle), rtol=1e-12)
    fine = solved("six-bar", np.deg2rad(curves(second)["x"][0]))
    for motion, step in ((six_bar, 4), (fine, 1)):
        velocity = np.asarray(motion.points["G"].velocity)
        drawn = curves(second)
        for name, values in (("x", velocity.real), ("y", velocity.imag), ("length", abs(velocity))):
            np.testing.assert_allclose(drawn[name][1][::step], values, rtol=0, atol=1e-9)


def test_units_and_names_are_on_the_axes(six_bar: ck.results.Motion) -> None:
    axes = ck.plot(six_bar, "bar.angle", "bar.angular_acceleration", "G.acceleration", "slot.rate").figure.axes
    labels = [one.get_ylabel().replace("\n", " ") for one in axes]
    wanted = ["bar.angle [°]", "bar.angular_acceleration [rad/s²]", "G.acceleration [mm/s²]", "slot.rate [mm/s]"]
    assert labels == wanted
    assert [one.get_xlabel() for one in axes] == ["", "", "", "crank [°]"]


def test_against_a_quantity(six_bar: ck.results.Motion) -> None:
    (axes,) = six_bar.plot("G.velocity.x", against="bar.angle").figure.axes
    ((x, y),) = curves(axes).values()
    np.testing.assert_allclose(at_poses(x, 73), np.rad2deg(six_bar.links["bar"].angle), rtol=1e-12)
    np.testing.assert_array_equal(at_poses(y, 73), six_bar.points["G"].velocity.real)
    assert axes.get_xlabel() == "bar.angle [°]"


def test_a_motion_in_time_is_drawn_over_time_unless_told() -> None:
    crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank", speed=3.0))
    motion = ck.solve(crank, time=np.linspace(0.0, 1.0, 21))
    (axes,) = ck.plot(motion, "B.x").figure.axes
    ((x, _),) = curves(axes).values()
    np.testing.assert_array_equal(at_poses(x, 21), motion.time)
    assert axes.get_xlabel() == "time [s]"
    (axes,) = ck.plot(motion, "B.x", against="driver").figure.axes
    ((x, _),) = curves(axes).values()
    np.testing.assert_allclose(at_poses(x, 21), np.rad2deg(3.0 * np.linspace(0.0, 1.0, 21)))
    (axes,) = ck.plot(motion, "B.x", against="pose").figure.axes
    assert at_poses(next(iter(curves(axes).values()))[0], 21).tolist() == list(range(21))


def test_quantities_of_one_unit_share_a_panel(six_bar: ck.results.Motion) -> None:
    names = ("bar.angle", "G.speed", "plate.angle")
    first, second = ck.plot(six_bar, *names, stacked=False).figure.axes
    assert (first.get_ylabel(), second.get_ylabel()) == ("[°]", "G.speed [mm/s]")
    assert list(curves(first)) == ["bar.angle", "plate.angle"]


def test_designs_are_a_family_of_curves(sweep: ck.results.Motion) -> None:
    x, y, length = ck.plot(sweep, "P.velocity", designs=list("abcde")).figure.axes
    assert [one.get_ylabel().replace("\n", " ") for one in (x, y, length)] == [
        "P.velocity.x [length/s]",
        "P.velocity.y [length/s]",
        "P.velocity.length [length/s]",
    ]
    drawn = [at_poses(values, 73) for _, values in curves(y).values()]
    np.testing.assert_array_equal(drawn, sweep.points["P"].velocity.imag)
    figure = x.figure
    assert [text.get_text() for text in figure.legends[0].get_texts()] == list("abcde")


def test_several_motions_share_panels(six_bar: ck.results.Motion, rocker: ck.results.Motion) -> None:
    other = solved("crank-rocker")
    (axes,) = ck.plot([other, rocker], "rocker.angular_velocity").figure.axes
    assert axes.get_xlabel() == "crank, driver [°]"
    for line, motion in zip(curves(axes).values(), (other, rocker), strict=True):
        assert np.nanmax(line[1]) >= np.nanmax(motion.links["rocker"].angular_velocity) - 1e-12
    named = [text.get_text() for text in axes.figure.legends[0].get_texts()]
    assert named == [motion.mechanism.title for motion in (other, rocker)]
    same = ck.plot([six_bar, six_bar], "bar", designs=["one", "two"]).figure.legends[0]
    assert [text.get_text() for text in same.get_texts()] == ["one", "two"]
    inches = ck.solve(
        ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, G=2), ck.drive("crank"), unit="in")
    )
    with pytest.raises(ck.errors.InvalidInput, match="it would be in mm of one mechanism and in of another"):
        ck.plot([six_bar, inches], "G")


def test_axes_have_the_limits_that_are_asked_for(six_bar: ck.results.Motion) -> None:
    (axes,) = ck.plot(six_bar, "G.speed", xlim=(200, 300), ylim=(0, 280)).figure.axes
    assert (axes.get_xlim(), axes.get_ylim()) == ((200, 300), (0, 280))
    assert texts(axes) == []  # the highest value is beyond, the lowest one elsewhere
    (axes,) = ck.plot(six_bar, "bar.angle", xlim=(270, 330)).figure.axes
    ((x, y),) = curves(axes).values()
    seen = y[(x >= 270) & (x <= 330)]
    low, high = axes.get_ylim()
    # the vertical axis fits what is seen
    assert low < seen.min() < seen.max() < high
    assert high - low < 1.5 * np.ptp(seen)


def test_logarithmic_axes_have_plain_numbers(six_bar: ck.results.Motion) -> None:
    (axes,) = ck.plot(six_bar, "G.speed", log="y").figure.axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")
    assert [label.get_text() for label in axes.get_yticklabels()] == ["0.1", "1", "10", "100", "1000"]
    assert texts(axes) == ["288.8"]  # the lowest one is 0, which is nowhere


def test_curves_go_to_limit_positions_and_through_their_extremes(rocker: ck.results.Motion) -> None:
    (axes,) = ck.plot(rocker, "rocker.angle").figure.axes
    ((x, y),) = curves(axes).values()
    known = np.isfinite(y)
    assert x[known & (x < 180)].max() == pytest.approx(LIMIT, abs=1e-6)
    marks = [line for line in axes.get_lines() if line.get_marker() == "o" and line.get_markerfacecolor() != "white"]
    assert len(marks) == 2
    for mark in marks:
        (at,), (value,) = mark.get_xdata(), mark.get_ydata()
        assert np.interp(at, x[known], y[known]) == pytest.approx(value, abs=0.01)


def test_extremes_are_marked_with_their_values(six_bar: ck.results.Motion) -> None:
    (axes,) = ck.plot(six_bar, "bar.angle").figure.axes
    fine = np.rad2deg(solved("six-bar", np.deg2rad(np.linspace(0, 360, 36001))).links["bar"].angle)
    assert texts(axes) == [f"{fine.max():.4g}", f"{fine.min():.4g}"]
    assert texts(ck.plot(six_bar, "bar.angle", extremes=False).figure.axes[0]) == []


def test_where_the_acceleration_jumps_so_does_its_curve() -> None:
    """A parabolic law: 4 times lift by span squared at most (Norton), no peak beside the jump, no line through it."""
    law = ck.laws.program(ck.laws.dwell(0.33), ck.laws.rise(10.0, over=1.0, law="parabolic"), ck.laws.dwell(0.4))
    slide = ck.slide("block", on="frame", through="A", angle=0)
    block = ck.Mechanism("block", ck.link("frame", A=0), ck.link("block", B=0), slide, ck.drive("block", law=law))
    motion = ck.solve(block, time=np.linspace(0.0, 1.73, 40))
    (axes,) = ck.plot(motion, "B.acceleration.x").figure.axes
    assert [text.replace("−", "-") for text in texts(axes)] == ["40", "-40"]
    ((x, y),) = curves(axes).values()
    steps = np.abs(np.diff(y))
    assert np.nanmax(steps) < 1e-9
    breaks = np.flatnonzero(np.isnan(y))
    np.testing.assert_allclose(x[breaks], [0.33, 0.83, 1.33], atol=1e-9)
    np.testing.assert_allclose(y[breaks - 1], [0.0, 40.0, -40.0], atol=1e-9)
    np.testing.assert_allclose(y[breaks + 1], [40.0, -40.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(np.unique(y[np.isfinite(y)].round(9)), [-40.0, 0.0, 40.0])


def test_what_is_nothing_but_rounding_is_drawn_as_constant() -> None:
    motion = solved("parallelogram")
    (axes,) = ck.plot(motion, "follower.angular_velocity").figure.axes
    assert axes.get_ylim() == (pytest.approx(0.5), pytest.approx(1.5))
    assert texts(axes) == []
    slider = ck.solve(load("slider-crank-offset"))
    velocity, turn = ck.plot(slider, "B.velocity.y", "piston.angular_velocity").figure.axes
    assert texts(velocity) == texts(turn) == []
    # a zero rate of an angle goes by the driver's, 10 rad/s, whatever the lengths
    assert turn.get_ylim() == (pytest.approx(-10.0), pytest.approx(10.0))


# --- gaps, limit positions, change points ---------------------------------------------------------------


def test_gaps_are_shaded_between_the_limits(rocker: ck.results.Motion) -> None:
    (axes,) = ck.plot(rocker, "rocker.angle").figure.axes
    (shade,) = axes.patches
    edges = shade.get_x(), shade.get_x() + shade.get_width()
    assert edges == (pytest.approx(LIMIT, abs=1e-6), pytest.approx(360 - LIMIT, abs=1e-6))
    names = [text.get_text() for legend in axes.figure.legends for text in legend.get_texts()]
    assert names == ["cannot be assembled", "next to a gap"]


def test_gaps_of_a_motion_in_time_are_shaded_at_their_times() -> None:
    motion = solved("triple-rocker", {"driver": 0.0}, speed=2.0, time=np.linspace(0.0, 1.5, 61))
    (axes,) = ck.plot(motion, "rocker.angle").figure.axes
    (shade,) = axes.patches
    assert shade.get_x() == pytest.approx(np.deg2rad(LIMIT) / 2.0, abs=1e-6)
    assert shade.get_x() + shade.get_width() == 1.5


def test_rings_are_at_the_poses_next_to_limits(rocker: ck.results.Motion) -> None:
    (axes,) = ck.plot(rocker, "rocker.angle").figure.axes
    (ring,) = [line for line in axes.get_lines() if line.get_markerfacecolor() == "white"]
    assert ring.get_xdata().tolist() == pytest.approx([87.5, 272.5])


def test_rates_that_grow_without_limit_do_not_flatten_the_rest() -> None:
    driver = np.deg2rad(np.append(np.arange(0.0, LIMIT, 1.0), LIMIT - 1e-5))
    motion = solved("triple-rocker", driver)
    (axes,) = ck.plot(motion, "rocker.angular_acceleration").figure.axes
    assert np.nanmax(np.abs(motion.links["rocker"].angular_acceleration)) > 1e6
    assert max(map(abs, axes.get_ylim())) < 1e3
    assert "cut off" in axes.get_title("left")


def test_change_points_are_dashed() -> None:
    (axes,) = ck.plot(solved("parallelogram"), "follower.angle").figure.axes
    dashed = [float(line.get_xdata()[0]) for line in axes.get_lines() if line.get_linestyle() == "--"]
    # a parallelogram is flat where its crank is in line with the frame
    assert all(min(abs(x - k) for k in (0, 180, 360)) < 1e-6 for x in dashed)
    assert any(abs(x - 180) < 1e-6 for x in dashed)


# --- curves in the plane ----------------------------------------------------------------------------------


def test_a_phase_plot_is_a_quantity_against_its_rate(six_bar: ck.results.Motion) -> None:
    for name, rate in (("bar.angle", "bar.angular_velocity"), ("G.y", "G.velocity.y"), ("slot", "slot.rate")):
        (axes,) = plot.phase(six_bar, name).figure.axes
        assert (axes.get_xlabel().split()[0], axes.get_ylabel().split()[0]) == (name, rate)
    ((x, y),) = curves(plot.phase(six_bar, "bar.angle").figure.axes[0]).values()
    np.testing.assert_allclose(x, np.rad2deg(six_bar.links["bar"].angle), rtol=1e-12)
    np.testing.assert_allclose(y, six_bar.links["bar"].angular_velocity)


def test_a_hodograph_is_the_velocity_in_the_plane(six_bar: ck.results.Motion) -> None:
    (axes,) = plot.hodograph(six_bar, "G.velocity", every=9).figure.axes
    x, y = curves(axes)["G.velocity"]
    np.testing.assert_array_equal(x + 1j * y, np.asarray(six_bar.points["G"].velocity))
    assert axes.get_aspect() == 1.0
    (marks,) = [line for line in axes.get_lines() if line.get_marker() == "o"]
    # eight marks, the ninth being the first one again
    np.testing.assert_array_equal(marks.get_xdata(), x[:-1:9])


def test_a_polar_plot_has_the_driver_for_its_angle(six_bar: ck.results.Motion) -> None:
    (axes,) = plot.polar(six_bar, "G.velocity").figure.axes
    angle, radius = curves(axes)["G.velocity.length"]
    np.testing.assert_allclose(angle, six_bar.drives["crank"].value, atol=1e-12)
    np.testing.assert_array_equal(radius, np.abs(six_bar.points["G"].velocity))
    assert axes.get_ylim()[0] == 0.0
    assert plot.polar(six_bar, "bar.angular_velocity").figure.axes[0].get_ylim()[0] < 0.0


def test_paths_of_letters_and_of_places_on_links(six_bar: ck.results.Motion) -> None:
    (axes,) = plot.paths(six_bar, "G", ("plate", (20, 10)), ("bar", 55)).figure.axes
    drawn = curves(axes)
    assert list(drawn) == ["G", "plate (20, 10)", "bar (55, 0)"]
    g, tip = drawn["G"], drawn["bar (55, 0)"]
    np.testing.assert_array_equal(g[0] + 1j * g[1], np.asarray(six_bar.points["G"].position))
    np.testing.assert_allclose(np.add(tip[0], 1j * tip[1]), np.asarray(six_bar.points["G"].position), rtol=1e-12)
    assert {"E", "B", "F"} <= set(texts(axes))


def test_a_path_seen_from_another_link(six_bar: ck.results.Motion) -> None:
    (axes,) = plot.paths(six_bar, "C", on="bar").figure.axes
    x, y = curves(axes)["C"]
    # the block slides along the bar's own line, at its distance from F
    np.testing.assert_allclose(y, 0.0, atol=1e-9)
    np.testing.assert_allclose(x, abs(six_bar.points["C"].position - (-34j)), rtol=1e-9)


def test_centrodes_touch_at_the_pole() -> None:
    motion = solved("elliptic-trammel")
    (axes,) = plot.centrodes(motion, "rod", pose=7).figure.axes
    drawn = curves(axes)
    fixed, moving = (np.add(x, 1j * np.asarray(y)) for x, y in drawn.values())
    np.testing.assert_allclose(fixed, solved_centrodes(motion, "rod").fixed, atol=1e-12)
    assert moving[7] == pytest.approx(fixed[7], abs=1e-9)
    # Cardan's circles: the moving one has half the radius, inside the fixed one
    np.testing.assert_allclose(abs(moving - fixed[7] / 2), 1.5, rtol=1e-9)


def test_every_kind_draws_designs(sweep: ck.results.Motion) -> None:
    for picture in (
        plot.phase(sweep, "rocker.angle"),
        plot.hodograph(sweep, "P.velocity"),
        plot.polar(sweep, "rocker.angular_velocity"),
        plot.paths(sweep, "P"),
    ):
        assert len([line for line in picture.figure.axes[0].get_lines() if len(line.get_xdata()) == 73]) == 5
    assert plot.centrodes(sweep, "coupler", design=4).content("png").startswith(b"\x89PNG")


# --- files, style, mistakes -------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["svg", "png", "pdf"])
def test_the_same_plot_is_the_same_file(six_bar: ck.results.Motion, tmp_path: Path, form: str) -> None:
    for name in ("a", "b"):
        ck.plot(six_bar, "bar.angle", "G.velocity").save(tmp_path / f"{name}.{form}")
    first, second = (tmp_path.joinpath(f"{name}.{form}").read_bytes() for name in ("a", "b"))
    assert first == second
    assert len(first) > 5000


def test_an_svg_does_not_tell_when_it_was_made(six_bar: ck.results.Motion) -> None:
    assert "<dc:date>" not in ck.plot(six_bar, "bar.angle")._repr_svg_()


def test_the_users_settings_neither_matter_nor_change(six_bar: ck.results.Motion) -> None:
    import matplotlib

    plain = ck.plot(six_bar, "bar.angle").content("svg")
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black", "svg.fonttype": "none"}):
        before = dict(matplotlib.rcParams)
        assert ck.plot(six_bar, "bar.angle").content("svg") == plain
        assert dict(matplotlib.rcParams) == before


def test_a_name_is_not_read_as_mathematics() -> None:
    crank = ck.Mechanism("$x^$ 100%", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
    assert ck.plot(ck.solve(crank), "B").content("png").startswith(b"\x89PNG")


def mistakes() -> list[tuple[Callable[[ck.results.Motion], Any], type[Exception], str]]:
    return [
        (lambda m: ck.plot(m, "bar.angel"), ck.errors.UnknownName, "did you mean 'bar.angle'"),
        (lambda m: ck.plot(m, "G.velocity.lenth"), ck.errors.UnknownName, "G.velocity.lenth"),
        (lambda m: ck.plot(m, "bar.angle.x"), ck.errors.UnknownName, "bar.angle is no vector"),
        (lambda m: ck.plot(m, "G", size=(-1, 3)), ck.errors.InvalidInput, "width and height in inches"),
        (lambda m: plot.polar(m, "G", size=(np.nan, 3)), ck.errors.InvalidInput, "is not a size"),
        (lambda m: ck.plot(m, "G", against="tme"), ck.errors.UnknownName, "did you mean 'time'"),
        (lambda m: ck.plot(m, "G", against="time"), ck.errors.InvalidInput, "not a motion in time"),
        (lambda m: ck.plot(m, "bar", against="G"), ck.errors.InvalidInput, "G.length"),
        (lambda m: ck.plot(m, "bar", designs=["a", "b"]), ck.errors.InvalidInput, "1 designs and 2 names"),
        (lambda m: ck.plot(m, "bar", xlim=(90, 0)), ck.errors.InvalidInput, "from 90 to 0 is not a range"),
        (lambda m: ck.plot(m, "bar", xlim=(500, 600)), ck.errors.InvalidInput, "no pose is between 500 and 600"),
        (lambda m: ck.plot(m, "bar", "G", ylim=(0, 1)), ck.errors.InvalidInput, "the panels are in °, mm"),
        (lambda m: ck.plot(m, "bar", log="z"), ck.errors.InvalidInput, "'z' is not an axis"),
        (lambda m: ck.plot(m, "bar", log="y", ylim=(0, 1)), ck.errors.InvalidInput, "begin above zero"),
        (lambda m: ck.plot(m, "G.velocity.x", log="y"), ck.errors.InvalidInput, "has positive values only"),
        (lambda m: ck.plot([], "bar"), ck.errors.InvalidInput, "none is given"),
        (lambda m: ck.plot(m, "bar").save("bar.gif"), ck.errors.InvalidInput, ".png, .svg, .pdf"),
        (lambda m: ck.plot(m, "bar").save("/no/such/folder/bar.png"), ck.errors.InvalidInput, "cannot be written"),
        (lambda m: plot.phase(m, "G.velocity"), ck.errors.UnknownName, "G.velocity.x"),
        (lambda m: plot.phase(m, "G.speed"), ck.errors.UnknownName, "rate has a name"),
        (lambda m: plot.phase(m, "G.x", "G.velocity"), ck.errors.InvalidInput, "it is a vector"),
        (lambda m: plot.phase(m, "bar", every=0), ck.errors.InvalidInput, "every"),
        (lambda m: plot.hodograph(m, "bar.angle"), ck.errors.InvalidInput, "not a vector"),
        (lambda m: plot.hodograph(m, "G.velocity", "G.jerk"), ck.errors.InvalidInput, "one by one"),
        (lambda m: plot.polar(m, "bar.angle", "G.speed"), ck.errors.InvalidInput, "one by one"),
        (lambda m: plot.polar(m, "bar.angle", around="slot"), ck.errors.InvalidInput, "not an angle"),
        (lambda m: plot.paths(m, "g"), ck.errors.UnknownName, "there is no such point"),
        (lambda m: plot.paths(m, ("plaet", 1)), ck.errors.UnknownName, "did you mean 'plate'"),
        (lambda m: plot.centrodes(m, "plate", pose=99), ck.errors.InvalidInput, "0 to 72"),
        (lambda m: plot.centrodes(m, "plate", "plate"), ck.errors.InvalidInput, "relative to itself"),
    ]


@pytest.mark.parametrize(("draw", "error", "told"), mistakes(), ids=[told for _, _, told in mistakes()])
def test_mistakes_are_told(
    six_bar: ck.results.Motion, draw: Callable[[ck.results.Motion], Any], error: type[Exception], told: str
) -> None:
    with pytest.raises(error) as caught:
        draw(six_bar)
    assert told in str(caught.value)


def test_a_single_pose_is_no_plot() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="single pose"):
        ck.plot(solved("six-bar", 0.3), "bar.angle")


def test_without_matplotlib_the_remedy_is_told(six_bar: ck.results.Motion, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ck.errors.InvalidInput, match=r"pip install 'compoundkin\[plot\]'"):
        ck.plot(six_bar, "bar.angle")


def loaded_by(statement: str) -> set[str]:
    code = f"import sys\n{statement}\nprint(*sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(result.stdout.split())


def test_matplotlib_is_loaded_by_drawing_only() -> None:
    assert "matplotlib" not in loaded_by("import compoundkin, compoundkin.view.plot; compoundkin.plot")
    drawn = loaded_by(
        "import compoundkin as ck\n"
        "m = ck.Mechanism('m', ck.link('frame', A=0), ck.link('c', A=0, B=1), ck.drive('c'))\n"
        "ck.solve(m).plot('B').content('png')"
    )
    assert "matplotlib" in drawn
    assert "matplotlib.pyplot" not in drawn


WEIGHT, PULL = MASS * 9.81, MASS * SPEED**2 * REACH / 1000.0


def test_the_pin_of_a_crank_is_loaded_on_one_side_of_the_crank() -> None:
    # in the frame a circle about the weight with the centrifugal force as radius, in the crank one about that force
    frame, own = ck.plots.bearing_loads(crank_forces(), "A").figure.axes
    assert own.get_title() == "in the axes of crank"
    for axes, middle, radius in ((frame, 1j * WEIGHT, PULL), (own, -PULL, WEIGHT)):
        x, y = axes.get_lines()[0].get_data()
        assert np.allclose(np.abs(np.asarray(x) + 1j * np.asarray(y) - middle), radius)


def test_several_pairs_are_in_one_panel_and_wrong_names_are_said() -> None:
    with pytest.raises(InvalidInput, match="no pair is named"):
        ck.plots.bearing_loads(crank_forces())
    with pytest.raises(UnknownName, match="known"):
        ck.plots.bearing_loads(crank_forces().motion, "Z")


def test_no_line_of_a_bearing_goes_through_where_a_load_sets_in() -> None:
    forces = ck.force_analysis(catalog.motion("jaw-crusher-loaded"))
    frame = ck.plots.bearing_loads(forces, "D").figure.axes[0]
    line = frame.lines[0].get_xydata()
    breaks = np.flatnonzero(np.isnan(line[:, 0]))
    # the stone presses while the jaw closes: it sets in once, and ends once
    assert len(breaks) == 2
    assert len(line) == len(forces.motion.drives["eccentric"].value) + 2
    assert all(np.hypot(*(line[k + 1] - line[k - 1])) > 1e5 for k in breaks)


def test_pages_and_drawn_plots_part_the_curves_of_forces_alike() -> None:
    told = dict(re.findall(r"(SUDDEN|LARGE) = ([\d.]+)", CURVES.read_text("utf-8")))
    assert {name: float(value) for name, value in told.items()} == {"SUDDEN": SUDDEN, "LARGE": LARGE}


def test_efforts_have_their_mean() -> None:
    (axes,) = ck.plot(crank_forces(), "crank.effort").figure.axes
    dashed = [line for line in axes.get_lines() if str(line.get_label()).startswith("mean")]
    assert [line.get_label() for line in dashed] == ["mean 0"]


def test_no_line_joins_what_a_load_is_before_and_after_it_acts() -> None:
    """The stone presses while the jaw closes: between its dead points, 90 and 270 degrees to half a step."""
    (speed, force) = ck.plot(ck.force_analysis(solved("jaw-crusher-loaded")), "T.velocity.x", "D.force.x").figure.axes
    ((x, y),) = curves(force).values()
    breaks = np.flatnonzero(np.isnan(y))
    ((at, velocity),) = curves(speed).values()
    signs = at[:-1][np.sign(velocity[:-1]) * np.sign(velocity[1:]) < 0]
    np.testing.assert_allclose(x[breaks], signs, atol=3.0)
    assert len(breaks) == 2
    assert np.nanmax(np.abs(np.diff(y))) < 0.1 * np.nanmax(np.abs(y))
