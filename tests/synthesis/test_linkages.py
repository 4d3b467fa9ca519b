"""Linkages from their lengths: closed forms, ranges, the same from Python, files and specifications, wrong lengths."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.errors import InvalidInput, UnknownName
from compoundkin.synthesis.linkages import KINDS, linkage_of

DEG = np.pi / 180.0
make: Any = ck.linkages


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), catch_exceptions=False)


def one(values: Any) -> float:
    return float(np.ravel(values)[0])


@pytest.mark.parametrize("name", KINDS)
def test_every_example_moves_from_its_drawing_and_is_the_same_however_it_is_written(name: str, tmp_path: Path) -> None:
    kind = KINDS[name]
    words = shlex.split(kind.example)
    motion = ck.solve(kind.written(words))
    assert not motion.failed.any()
    assert ck.verify(motion).passed
    path = tmp_path / "mine.toml"
    assert run("new", name, *words, "-o", str(path)).exit_code == 0
    for other in (ck.load(path), linkage_of(f"{name}:{';'.join(words)}")):
        assert other is not None
        again = ck.solve(other)
        for letter in motion.points:
            np.testing.assert_allclose(again.points[letter].position.xy, motion.points[letter].position.xy, atol=1e-9)


@pytest.mark.parametrize("closure", ["open", "crossed"])
def test_the_rocker_of_a_four_bar_by_the_law_of_cosines(closure: str) -> None:
    a, b, c, d, q = 20.0, 50.0, 40.0, 60.0, 1.0
    motion = ck.solve(make.four_bar(d, a, b, c, closure=closure), {"crank": [q]}, speed=10)
    way = a * np.exp(1j * q) - d
    inner = np.arccos((c**2 + abs(way) ** 2 - b**2) / (2 * c * abs(way)))
    rocker = np.angle(way) - (inner if closure == "open" else -inner)
    assert np.exp(1j * one(motion.links["rocker"].angle)) == pytest.approx(np.exp(1j * rocker), abs=1e-12)
    # angular velocities by the projection on the coupler
    coupler = np.angle(d + c * np.exp(1j * rocker) - a * np.exp(1j * q))
    speed = 10 * a * np.sin(coupler - q) / (c * np.sin(coupler - rocker))
    assert one(motion.links["rocker"].angular_velocity) == pytest.approx(speed, rel=1e-12)


@given(st.lists(st.floats(1.0, 100.0), min_size=4, max_size=4))
def test_any_four_lengths_move_or_cannot_be_closed(lengths: list[float]) -> None:
    ground, crank, *_ = lengths
    shortest, longest = min(lengths), max(lengths)
    if longest >= sum(lengths) - longest:
        with pytest.raises(InvalidInput, match="cannot be closed"):
            make.four_bar(*lengths)
        return
    surplus = sum(lengths) - 2 * (shortest + longest)
    if abs(surplus) < 0.05 * longest or sum(lengths) - 2 * longest < 0.05 * longest:
        return  # next to change points, and to lengths that are nearly in one line
    motion = ck.solve(make.four_bar(*lengths))
    assert not motion.failed.any()
    turns = np.ptp(motion.drives["crank"].value) > 6.28
    assert turns == (surplus > 0 and shortest in (ground, crank))


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6, 1.0 / 3.0, 0.7])
def test_change_points_are_known_in_any_unit(scale: float) -> None:
    """Links that come to lie in one line are not parted by rounding: at no angle the linkage is cut there."""
    folded = make.four_bar(*(scale * one for one in (60, 20, 50, 10)))
    assert folded.description.startswith("A change-point linkage")
    (driver,) = folded.drives
    # from where coupler and rocker are stretched to where they are so on the other side
    half = np.arccos((60**2 + 20**2 - 60**2) / (2 * 60 * 20))
    assert np.ptp(driver.values) == pytest.approx(2 * half, abs=np.deg2rad(1.0))


def test_a_crank_that_cannot_turn_moves_over_its_range_and_no_farther() -> None:
    """Its ends by the law of cosines: coupler and rocker in line."""
    ground, crank, coupler, rocker = 50.0, 60.0, 40.0, 45.0
    values = ck.solve(make.four_bar(ground, crank, coupler, rocker)).drives["crank"].value
    end = np.arccos((ground**2 + crank**2 - (coupler + rocker) ** 2) / (2 * ground * crank))
    assert end - 1.0 * DEG < np.max(values) < end


@pytest.mark.parametrize(
    ("kind", "more"),
    [
        ("Watt I", {"coupler_point": (30, 0.6), "rocker_point": (25, -0.6)}),
        ("Watt II", {"rocker_point": (25, -0.5), "pivot": (100, 10)}),
        ("Stephenson I", {"crank_point": (15, 0.8), "rocker_point": (30, -0.5)}),
        ("Stephenson II", {"crank_point": (15, 0.8), "plate_point": (30, -0.5)}),
        ("Stephenson III", {"coupler_point": (30, 0.7), "pivot": (90, 40)}),
    ],
)
def test_six_bars_are_what_they_are_called(kind: str, more: dict[str, Any]) -> None:
    """By the name that the package finds from the structure alone."""
    made = make.six_bar(kind, 60, 20, 50, 40, 45, 45, **more)
    assert kind in str(ck.chains.structure_name(ck.decompose(made)))
    motion = ck.solve(made)
    assert not motion.failed.any()
    assert ck.verify(motion).passed


def test_numbers_of_books() -> None:
    """Stroke and time ratio of slider-cranks and quick returns; Geneva wheel; Willis' equation; height of a lift."""

    def figure(mechanism: ck.Mechanism, output: str, word: str) -> float:
        (found,) = ck.characteristics(ck.solve(mechanism), [output]).outputs
        value = getattr(found, word)
        return one(getattr(value, "values", value))

    stroke = figure(make.slider_crank(20, 60, offset=10), "stroke.value", "stroke")
    assert stroke == pytest.approx(np.sqrt(80**2 - 10**2) - np.sqrt(40**2 - 10**2), rel=1e-9)
    shaper = make.quick_return("crank-shaper", 25, 10, 65, 30, height=50)
    alpha = np.arccos(10 / 25)
    ratio = figure(shaper, "lever.angle", "time_ratio")
    assert max(ratio, 1 / ratio) == pytest.approx((np.pi - alpha) / alpha, rel=1e-6)
    assert np.ptp(ck.solve(make.geneva(6, 100)).links["wheel"].angle) == pytest.approx(np.pi / 3, rel=1e-9)
    train = ck.solve(make.planetary(32, 20, 2), speed=1)
    np.testing.assert_allclose(train.links["sun"].angular_velocity, 1 + 72 / 32, rtol=1e-12)
    lift = ck.solve(make.scissor(3, 2.0, 0.7, 1.9))
    height = 3 * np.sqrt(4 - lift.points["B"].position.xy[:, 0] ** 2)
    np.testing.assert_allclose(lift.points["L3"].position.xy[:, 1], height, atol=1e-9)
    yoke = ck.solve(make.scotch_yoke(20))
    np.testing.assert_allclose(yoke.points["Y"].position.xy[:, 0], 20 * np.cos(yoke.drives["crank"].value), atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: make.four_bar(200, 20, 50, 40), "not shorter than the others together, 110"),
        (lambda: make.four_bar(60, -20, 50, 40), "crank: -20 is not above zero"),
        (lambda: make.four_bar(60, 20, 50, np.nan), "rocker"),
        (lambda: make.four_bar(60, 20, 50, 40, closure="both"), "none of its words"),
        (lambda: make.four_bar(60, 20, 50, 40, point=(3, np.inf)), "point"),
        (lambda: make.slider_crank(20, 30, offset=60), "do not reach the guide"),
        (lambda: make.inverted_slider_crank(20, 20), "meets the pivot"),
        (lambda: make.quick_return("Whitworth", 40, 20, 75, 200), "above 40"),
        (lambda: make.quick_return("crank-shaper", 25, 10, 65, 10, height=50), "does not reach the ram"),
        (lambda: make.six_bar("Watt I", 60, 20, 50, 40, 45, 35), "coupler_point: a Watt I needs it"),
        (lambda: make.six_bar("Watt II", 60, 20, 50, 40, 1, 1, rocker_point=(25, 0), pivot=(300, 10)), "any angle"),
        (lambda: make.geared_five_bar(50, 20, 50, 50, 20, ratio=0), "no ratio"),
        (lambda: make.scissor(2, 2.0, 1.9, 0.7), "low < high < arm"),
        (lambda: make.scissor(10**9, 2.0, 0.7, 1.9), "100 at most"),
        (lambda: make.scissor(1.5, 2.0, 0.7, 1.9), "not a whole number"),
        (lambda: make.geneva(2, 100), "too few"),
        (lambda: make.cam_follower(40, 30, 4, 2, 2), "one turn"),
        (lambda: make.planetary(32, 20, driver="ring"), "none of its words"),
    ],
)
def test_lengths_that_cannot_be_are_told_with_those_that_would_do(wrong: Callable[[], object], said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        wrong()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("four-bar", "ground=60"), "crank, coupler, rocker are missing"),
        (("four-bar", "60", "20", "50", "40", "30"), "not two numbers"),
        (("four-bar", "60", "20", "50", "forty"), "'forty' is no number"),
        (("four-bar", "grund=60"), "did you mean 'ground'?"),
        (("four-bar", "60", "20", "50", "40", "ground=3"), "given twice"),
        (("four-bars", "60"), "did you mean 'four-bar'?"),
        (("geneva", "slots=2.5", "distance=3"), "not a whole number"),
        (("six-bar", "kind=Wat", "60"), "did you mean 'Watt I'?"),
    ],
)
def test_words_that_cannot_be_are_told_and_nothing_is_written(
    words: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    done = run("new", *words, "-o", str(tmp_path / "mine.toml"))
    assert done.exit_code == 2
    assert said in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_specification_does_wherever_a_file_does(tmp_path: Path) -> None:
    done = run("solve", "four-bar:60,20,50,40", "--at", "60", "--speed", "10", "--output", "rocker.angular_velocity")
    assert "2.91595776" in done.stdout
    for verb in ("report", "structure", "check", "characteristics", "circuits"):
        assert run(verb, "four-bar:60,20,50,40").exit_code == 0
    assert run("draw", "slider-crank:20,60,offset=5", "-o", str(tmp_path / "s.svg")).exit_code == 0
    assert all(name in run("new", "--list").stdout for name in KINDS)


def test_names_are_known_as_python_spells_them_and_with_a_slip() -> None:
    for name in ("four_bar", "Four-Bar", " four-bar ", "fourbar", "4-bar"):
        made = linkage_of(f"{name}:60,20,50,40")
        assert made is not None
        assert made.title == "Four-bar linkage"
    with pytest.raises(UnknownName, match="did you mean 'five-bar'"):
        linkage_of("fivve-bar:60,20,50,40,20")
    for other in ("C:/drafts/press.toml", "https://example.org/?mech=1", "press.toml:1", "four-bar"):
        assert linkage_of(other) is None


def test_a_negative_number_is_no_option(tmp_path: Path) -> None:
    path = tmp_path / "my linkage.toml"
    made = run("new", "slider-crank", "20", "60", "-5", "-o", str(path))
    assert made.exit_code == 0, made.output
    by_name = make.slider_crank(20, 60, offset=-5)
    assert one(ck.solve(ck.load(path), [0.3]).points["B"].x) == pytest.approx(
        one(ck.solve(by_name, [0.3]).points["B"].x)
    )
    assert f"compoundkin report {shlex.quote(str(path))}" in made.output
    assert "-20 is not above zero" in run("new", "four-bar", "60", "-20", "50", "40").output
