"""The drawn pose is followed in both directions over the whole range asked for, and nothing hangs on the way."""

from __future__ import annotations

import json
import warnings
from time import perf_counter
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics import Motion
from tests.support import REFERENCE, reference


def quietly(*args: Any, **words: Any) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(*args, **words)


# --- the example of a branch from 106.60 to 210.25 degrees -------------------------------------------------

PLACES = {
    "A": 0.6 + 0.2j,
    "B": -0.1 - 2.3j,
    "C": 0.4 - 2.1j,
    "D": 0.9 + 0.6j,
    "E": 0.8 + 0.8j,
    "F": 0.3 - 0.5j,
    "G": -0.3 + 1.5j,
}
LINKS = {"frame": "ADG", "AB": "AB", "BCE": "BCE", "CD": "CD", "EF": "EF", "FG": "FG"}
BRANCH = (106.60, 210.25)


def stephenson() -> ck.Mechanism:
    links = [ck.link(name, *letters) for name, letters in LINKS.items()]
    return ck.Mechanism("Stephenson III", *links, ck.drive("FG"), ck.drawn(**PLACES))


def solved(degrees: np.ndarray) -> np.ndarray:
    """Which of the driver's values are assembled; those that are keep their lengths and go on smoothly."""
    motion = quietly(stephenson(), {"FG": np.deg2rad(degrees)})
    at = {k: np.atleast_1d(motion.points[k].position) for k in PLACES}
    good = np.atleast_1d(motion.assembled)
    for letters in LINKS.values():
        for one, other in zip(letters, letters[1:] + letters[0], strict=True):
            length = np.abs(at[one] - at[other])[good]
            assert np.allclose(length, abs(PLACES[one] - PLACES[other]), atol=1e-11)
    return good


@pytest.mark.parametrize(
    ("first", "last", "count", "of"),
    [(110, 205, 20, 20), (105, 205, 20, 21), (205, 105, 20, 21), (90, 225, 21, 28), (107, 210, 21, 21)],
)
def test_the_range_may_reach_beyond_the_branch(first: int, last: int, count: int, of: int) -> None:
    """110..205 degrees by 5 gave 20 of 20, 105..205 nothing at all."""
    degrees = np.arange(first, last + np.sign(last - first), 5.0 * np.sign(last - first))
    good = solved(degrees)
    assert (int(good.sum()), len(good)) == (count, of)
    assert np.array_equal(good, (degrees > BRANCH[0]) & (degrees < BRANCH[1]))


def test_a_full_turn_has_the_poses_of_the_branch() -> None:
    motion = quietly(stephenson())
    degrees = np.arange(0.0, 361.0, 5.0)
    assert np.array_equal(motion.assembled, (degrees > BRANCH[0]) & (degrees < BRANCH[1]))
    assert int(motion.assembled.sum()) == 21


def test_the_limits_of_the_branch() -> None:
    """106.60 and 210.25 degrees, by `gaps` of the full turn."""
    before, after = ck.gaps(quietly(stephenson()))
    assert round(np.rad2deg(before.end["FG"]), 2) == BRANCH[0]
    assert round(np.rad2deg(after.begin["FG"]), 2) == BRANCH[1]


def test_the_drawn_pose_lies_between_two_poses_and_its_motion_goes_through_it() -> None:
    drawn = float(np.angle(PLACES["G"] - PLACES["F"])) % (2.0 * np.pi)
    motion = quietly(stephenson(), {"FG": drawn + np.array([-0.3, -0.1, 0.0, 0.1])}, order=0)
    assert max(abs(motion.points[k].position[2] - p) for k, p in PLACES.items()) < 1e-12


@pytest.mark.parametrize(
    ("first", "last"), [(215, 480), (210, 470), (300, 480), (-200, -100), (0, 900), (880, 0), (0, 355), (300, 460)]
)
def test_the_branch_is_reached_through_the_wrap_of_a_full_turn(first: int, last: int) -> None:
    """Ranges that contain the branch only after whole turns, in part at both ends, several times, or not at all."""
    degrees = np.arange(first, last + np.sign(last - first), 5.0 * np.sign(last - first))
    turned = degrees % 360.0
    assert np.array_equal(solved(degrees), (turned > BRANCH[0]) & (turned < BRANCH[1]))


def test_through_the_wrap_poses_have_the_same_rates() -> None:
    degrees = np.arange(110.0, 210.0, 5.0)
    near, far = (ck.solve(stephenson(), {"FG": np.deg2rad(degrees + turn)}, speed=1.0) for turn in (0.0, -720.0))
    for k in range(3):
        assert np.allclose(near.points["E"].derivative(k), far.points["E"].derivative(k), rtol=1e-8, atol=1e-10)


def test_single_poses_beyond_what_the_nearer_way_crosses() -> None:
    """From 106.70 degrees the nearer way to -70 leads down across a limit, the other one does not."""
    there = ck.solve(stephenson(), {"FG": np.deg2rad(np.arange(110.0, 206.0, 5.0))})
    alone = ck.solve(stephenson(), {"FG": np.deg2rad(205.0 - 360.0)})
    assert abs(complex(alone.points["E"].position) - there.points["E"].position[-1]) < 1e-12


def test_the_farther_way_where_the_nearer_one_crosses_a_limit() -> None:
    """Drawn near the lower limit: 290 to 120 degrees is asked for downwards, its nearest end lies beyond that limit."""
    degrees = np.concatenate([np.linspace(466.0, 400.0, 12), np.linspace(200.0, 120.0, 9)])
    assert np.array_equal(solved(degrees), (degrees < BRANCH[1]))


# --- mechanisms that were refused, jumped, or took minutes ---------------------------------------------------


def hard(name: str) -> tuple[dict[str, Any], ck.Mechanism, Motion]:
    entry = reference(name, "hard")
    mechanism = ck.load(str(REFERENCE / entry["file"]))
    return entry, mechanism, quietly(mechanism, {k: np.array(v) for k, v in entry["drivers"].items()})


def leads_where_it_says(entry: dict[str, Any], mechanism: ck.Mechanism, motion: Motion) -> None:
    expected, size = entry["expected"], mechanism.geometry.size
    count = expected["assembled_at_least_from_the_first_pose_on"]
    assert motion.assembled[:count].all()
    for letter, place in mechanism.sketch.items():
        assert abs(motion.points[letter].position[0] - place) < 1e-6 * size
    for letter, place in expected["at_last_reached"].items():
        assert abs(motion.points[letter].position[count - 1] - complex(*place)) < 1e-9 * size


@pytest.mark.parametrize("name", ["case_1114", "case_800004", "case_20170", "case_20239"])
def test_hard_cases(name: str) -> None:
    """Full turns that cannot be completed, and configurations that run to infinity: two minutes before."""
    begin = perf_counter()
    entry, mechanism, motion = hard(name)
    assert perf_counter() - begin < 10.0
    leads_where_it_says(entry, mechanism, motion)


def test_all_hard_cases_are_there() -> None:
    names = {entry["id"] for entry in json.loads((REFERENCE / "hard.json").read_text())}
    assert {path.stem for path in (REFERENCE / "hard").glob("*.toml")} == names
