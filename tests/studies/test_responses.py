"""Responses of many designs: what a study finds equals what `solve` finds of each design."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.kinematics.extremes import extremes
from compoundkin.studies.responses import Designs, Response, studied_path
from compoundkin.studies.responses.figure_response import SolvedResponse
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.variations import variation_of

RANGES = {"crank.D.x": variation_of("crank.D.x", (13.0, 14.0)), "plate.C": ck.around((12.3, 8.6), 0.5)}
COARSE, FINE = ck.deg(np.arange(0, 361, 10.0)), ck.deg(np.arange(0, 361, 1.0))


def given(name: str, values: Any = COARSE, mechanism: str = "six-bar", **rates: Any) -> tuple[Designs, Response]:
    path, (response,) = studied_path(ck.load(mechanism), list(RANGES), [name], values, **rates)
    return path.designs(sample_of("sobol", 16, 1).designs(RANGES, range(4, 12))), response


def hold_slopes(designs: Designs, response: Response, rtol: float, step: float = 1e-4) -> None:
    slopes = response.slopes(designs)
    for one, slope in zip(designs.path.coordinates, slopes, strict=True):
        above, below = (response.values(designs.moved(one, by)) for by in (step, -step))
        difference = (above - below) / (2.0 * step)
        assert np.abs(slope - difference).max() < rtol * np.abs(slopes).max()


@pytest.mark.parametrize("name", ["G.position", "G.velocity.length"])
def test_courses_are_those_of_solve(name: str) -> None:
    designs, response = given(name, speed=3.0)
    expected = ck.quantity(designs.motion, name).values
    assert np.abs(response.values(designs) - expected).max() < 1e-11 * np.abs(expected).max()
    hold_slopes(designs, response, 1e-6)


def of_solve(designs: Designs, name: str, **rates: Any) -> Number:
    """Return a figure found by `solve` at ten times as many poses."""
    compiled = designs.path.compiled
    mechanism = compiled.mechanism({key: value[:, None] for key, value in designs.dimensions.items()})
    return ck.quantity(ck.solve(mechanism, FINE, modes=compiled.modes, **rates), name).values[:, 0]


@pytest.mark.parametrize(
    "name",
    ["bar.angle.stroke", "plate.transmission_angle.least", "G.acceleration.length.greatest", "G.x.greatest"],
)
def test_figures_are_found_between_the_poses_with_their_slopes(name: str) -> None:
    designs, response = given(name, speed=2.0)
    expected, found = of_solve(designs, name, speed=2.0), response.values(designs)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    assert response.has_slopes
    hold_slopes(designs, response, 1e-6)


@pytest.mark.parametrize("name", ["bar.angle.time_ratio", "G.x.imbalance_angle"])
def test_ratios_of_strokes_follow_the_places_of_the_extremes(name: str) -> None:
    designs, response = given(name, ck.deg(np.array([*np.arange(0, 200, 10.0), *np.arange(200, 361, 5.0)])))
    assert np.abs(response.values(designs) - of_solve(designs, name)).max() < 1e-7
    assert response.has_slopes
    hold_slopes(designs, response, 1e-6, 1e-3)


def test_figures_with_kinks_and_zeros_are_found() -> None:
    designs, response = given("plate.transmission_angle.greatest")
    assert np.abs(response.values(designs) - np.pi / 2).max() < 1e-9
    designs, response = given("G.velocity.length.least", speed=2.0)
    assert response.values(designs).max() < 1e-8


@pytest.mark.parametrize("beside", [-0.3, -0.004, -1e-5, 0.0, 1e-5, 0.004, 0.3])
def test_figures_do_not_move_with_the_grid(beside: float) -> None:
    """Extremes of designs beside their poses are those that `extremes` finds, and of another grid."""
    crank = ck.load("slider-crank-offset")
    dead = np.arcsin(-20.0 / 160.0)  # where the least design's rod is in line with its crank
    radii = np.array([40.0, 40.0 + 1e-5, 40.01, 44.0])

    def stroke(first: float) -> tuple[Designs, Response]:
        values = first + np.deg2rad(5.0) * np.arange(73)
        path, (response,) = studied_path(crank, ["crank.A.x"], ["B.x.stroke"], values)
        return path.designs({"crank.A.x": radii}), response

    designs, response = stroke(dead - np.deg2rad(5.0) * (7.0 + beside))
    found = response.values(designs)
    closed = np.subtract(*(np.sqrt((120.0 + sign * radii) ** 2 - 400.0) for sign in (1.0, -1.0)))
    assert np.allclose(found, closed, rtol=1e-14)
    (solved,) = extremes(designs.motion, "B.x")
    assert np.allclose(found, solved.stroke, rtol=1e-14)
    ends = [response.extreme(designs, sign).place for sign in (1.0, -1.0)]  # type: ignore[attr-defined]
    for place, end in zip(ends, (solved.greatest, solved.least), strict=True):
        assert np.abs(place - end.at.place).max() < 1e-8


MANY_DESIGNS = 1024


@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("G.x.stroke", 10.0),
        ("plate.transmission_angle.least", 10.0),
        ("G.velocity.length.least", 30.0),
        pytest.param("bar.angle.time_ratio", 5.0, marks=pytest.mark.full),
        pytest.param("plate.transmission_angle.greatest", 30.0, marks=pytest.mark.full),
        pytest.param("G.acceleration.length.greatest", 5.0, marks=pytest.mark.full),
        pytest.param("crank.angle.greatest", 30.0, marks=pytest.mark.full),
    ],
)
def test_many_designs_have_the_extremes_of_few(name: str, step: float) -> None:
    """Compiled programs find what the search of a few designs finds, which knows nothing of them."""
    ranges = {**RANGES, "crank.D.x": variation_of("crank.D.x", (13.0, 24.0))}  # some do not assemble
    path, (response,) = studied_path(
        ck.load("six-bar"), list(ranges), [name], ck.deg(np.arange(0, 361, step)), speed=2.0
    )
    sample = sample_of("sobol", MANY_DESIGNS, 1)

    def found(rows: range) -> tuple[Number, Number]:
        designs = path.designs(sample.designs(ranges, rows))
        with suppress_pose_warnings():
            return response.values(designs), response.slopes(designs)

    parts = [found(range(k, k + 512)) for k in range(0, MANY_DESIGNS, 512)]
    for whole, part in zip(found(range(MANY_DESIGNS)), zip(*parts, strict=True), strict=True):
        expected = np.concatenate(part, axis=-1)
        known = ~np.isnan(expected)
        assert (np.isnan(whole) == ~known).all()
        assert np.abs(whole - expected)[known].max() < 1e-9 * max(1.0, np.abs(expected[known]).max())


def test_strokes_of_many_designs_are_those_of_the_closed_form() -> None:
    path, (response,) = studied_path(ck.load("slider-crank-offset"), ["crank.A.x"], ["B.x.stroke"], COARSE)
    radii = np.linspace(30.0, 60.0, MANY_DESIGNS)
    closed = np.subtract(*(np.sqrt((120.0 + sign * radii) ** 2 - 400.0) for sign in (1.0, -1.0)))
    assert np.allclose(response.values(path.designs({"crank.A.x": radii})), closed, rtol=1e-14, atol=0.0)


def test_angles_of_more_than_a_turn_are_continuous_between_the_poses() -> None:
    """The other crank of a drag link swings about the driven one: it turns as far, and is greatest between poses."""
    drag = ck.Mechanism(
        "Drag link", ck.link("frame", A=0, D=1), ck.link("crank", A=0, B=3), ck.link("coupler", B=0, C=2.5),
        ck.link("other", D=0, C=3), ck.drive("crank"), ck.mode(1, "coupler"),
    )  # fmt: skip
    # there and back, so that both ends of the swing are in the motion
    values = 7.0 * np.sin(np.linspace(0.0, np.pi, 97)) ** 2
    path, (response,) = studied_path(drag, ["crank.B.x"], ["other.angle.stroke"], values)
    lengths = np.array([2.8, 3.0, 3.2])
    found = response.values(path.designs({"crank.B.x": lengths}))
    for length, one in zip(lengths, found, strict=True):
        ends = ck.solve(path.compiled.mechanism({"crank.B.x": length}), np.linspace(0.0, 7.0, 3601))
        angle = ck.quantity(ends, "other.angle").values
        assert abs(one - np.ptp(angle)) < 1e-9
        assert one > 2.0 * np.pi


def test_figures_in_time_follow_the_laws_between_the_poses() -> None:
    times = np.linspace(0.0, 2.0 * np.pi / 3.0, 25)
    designs, response = given("bar.angle.stroke", 0.0, time=times, speed=3.0)
    expected = of_solve(designs, "bar.angle.stroke")
    assert np.abs(response.values(designs) - expected).max() < 1e-9 * expected.max()


def test_designs_that_do_not_assemble_have_no_figure() -> None:
    designs, response = given("bar.angle.stroke")
    lengths = np.append(designs.dimensions["crank.D.x"][1:], 90.0)
    broken = designs.path.designs({**designs.dimensions, "crank.D.x": lengths})
    with suppress_pose_warnings():
        values, slopes = response.values(broken), response.slopes(broken)
    assert np.isnan(values).tolist() == [False] * 7 + [True]
    assert np.isnan(slopes).all(axis=0).tolist() == [False] * 7 + [True]


def hold_solved(mechanism: str, dimension: str, name: str) -> None:
    path, (response,) = studied_path(ck.load(mechanism), [dimension], [name], COARSE, speed=3.0)
    assert isinstance(response, SolvedResponse)
    own = path.compiled.programs.stated.own(path.compiled.programs.dimensions[0])
    designs = path.designs({dimension: own * np.array([0.95, 1.0, 1.05])})
    found = response.values(designs)
    for row, value in zip(found, designs.dimensions[dimension], strict=True):
        motion = ck.solve(path.compiled.mechanism({dimension: value}), COARSE, speed=3.0, modes=path.compiled.modes)
        expected = np.broadcast_to(ck.quantity(motion, name).values, len(COARSE))[: row.size]
        assert np.abs(row - expected).max() < 1e-9 * np.abs(expected).max()
    assert not response.has_slopes
    slopes = response.slopes(designs)
    assert slopes.shape == (len(path.coordinates), *found.shape)
    hold_slopes(designs, response, 1e-4)


def test_forces_of_designs_are_solved() -> None:
    hold_solved("engine-gas-pressure", "crank.A.x", "crank.effort")
    hold_solved("engine-gas-pressure", "crank.A.x", "crank.effort.greatest")


def test_figures_of_groups_without_a_closed_form_are_solved() -> None:
    hold_solved("class-iii-six-bar", "leg-1.B1.x", "plate.angle.stroke")


def test_functions_of_a_pose_are_summed_with_their_slopes() -> None:
    target = np.exp(1j * COARSE)
    outputs = {"error": lambda at: abs(at["G.position"] - at["target"]) ** 2 * at["weight"], "G.x.greatest": None}
    given = {"target": target, "weight": 2.0}
    six_bar = ck.load("six-bar")
    path, (error, reach) = studied_path(six_bar, list(RANGES), outputs, COARSE, given=given)
    designs = path.designs(sample_of("sobol", 16, 1).designs(RANGES, range(4, 12)))
    expected = (2.0 * abs(ck.quantity(designs.motion, "G.position").values - target) ** 2).sum(axis=-1)
    assert np.abs(error.values(designs) - expected).max() < 1e-11 * expected.max()
    assert reach.name == "G.x.greatest"
    hold_slopes(designs, error, 1e-6)
    with pytest.raises(ck.errors.UnknownName, match=r"given\.speed"):
        studied_path(six_bar, list(RANGES), outputs, COARSE, given={**given, "speed": 1.0})
    with pytest.raises(ck.errors.UnknownName, match="Gx"):
        studied_path(six_bar, list(RANGES), {"error": lambda at: at["Gx"]}, COARSE)
    with pytest.raises(ck.errors.InvalidInput, match="no function"):
        studied_path(six_bar, list(RANGES), {"error": 3.0}, COARSE)


def test_led_designs_are_solved_in_time_too() -> None:
    path, (response,) = studied_path(ck.load("five-bar-led"), ["left.B"], ["left.angle.stroke"])
    own = path.compiled.programs.stated.own(path.compiled.programs.dimensions[0])
    designs = path.designs({"left.B": own * np.array([0.99, 1.0, 1.01])})
    expected = ck.quantity(designs.motion, "left.angle.stroke").values[:, 0]
    assert np.abs(response.values(designs) - expected).max() < 1e-9 * expected.max()


def test_numbers_of_laws_have_slopes_of_figures() -> None:
    program = ck.laws.program(ck.laws.rise(1.2, over=0.6), ck.laws.dwell(0.5), ck.laws.fall(1.2, over=0.8))
    press = ck.load("six-bar").replace(ck.drive("crank", law=program))
    times = np.linspace(0.0, 1.8, 37)
    path, (response,) = studied_path(
        press, ["crank.law.segments.0.over"], ["G.velocity.length.greatest"], None, time=times
    )
    designs = path.designs({"crank.law.segments.0.over": np.array([0.65, 0.6])})
    fine = ck.solve(press, time=np.linspace(0.0, 1.8, 3601))
    expected = ck.quantity(fine, "G.velocity.length.greatest").values[0]
    assert abs(response.values(designs)[1] - expected) < 1e-9 * expected
    hold_slopes(designs, response, 1e-6)
