"""The drawn pose is followed in both directions over the whole range asked for, and nothing hangs on the way."""

from __future__ import annotations

import json
import warnings
from time import process_time
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics import Motion
from tests.support import EVERYTHING, REFERENCE, reference


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
    ("first", "last"), [(215, 480), (210, 470), (-200, -100), (0, 900), (880, 0), (0, 355), (300, 460)]
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


# --- random drawn six-bars against a continuation of their own -------------------------------------------------


def drawn_at_random(rng: np.random.Generator) -> tuple[dict[str, complex], ck.Mechanism]:
    """A Stephenson III drawn anyhow; driven at FG it has a group of class III."""
    places = {k: complex(*rng.uniform(-3.0, 3.0, 2).round(1)) for k in "ABCDEFG"}
    links = [ck.link(name, *letters) for name, letters in LINKS.items()]
    return places, ck.Mechanism("random", *links, ck.drive("FG"), ck.drawn(**places))


BARS = ("AB", "BC", "BE", "CE", "CD", "EF")


def gaps_of(x: np.ndarray, theta: float, places: dict[str, complex]) -> tuple[np.ndarray, np.ndarray]:
    """How much the six distances are off, and their derivatives by the coordinates of B, C and E."""
    at = dict(zip("BCE", x[::2] + 1j * x[1::2], strict=True)) | {k: places[k] for k in "ADG"}
    at["F"] = places["G"] - abs(places["G"] - places["F"]) * np.exp(1j * theta)
    off, rows = np.empty(6), np.zeros((6, 6))
    for row, (one, other) in enumerate(BARS):
        gap = at[one] - at[other]
        off[row] = abs(gap) ** 2 - abs(places[one] - places[other]) ** 2
        for letter, sense in ((one, 2.0), (other, -2.0)):
            if letter in "BCE":
                k = 2 * "BCE".index(letter)
                rows[row, k : k + 2] += sense * gap.real, sense * gap.imag
    return off, rows


def followed(places: dict[str, complex], start: float, end: float) -> dict[float, np.ndarray]:
    """B, C, E at whole steps of five degrees from the drawn angle, as far as short steps of Newton lead."""
    x = np.array([v for k in "BCE" for v in (places[k].real, places[k].imag)])
    theta, found, step = start, {}, np.sign(end - start) * np.deg2rad(5.0)
    marks = STEP * (np.arange(np.floor(start / STEP) + 1, end / STEP) if end > start
                    else np.arange(np.ceil(start / STEP) - 1, end / STEP, -1))  # fmt: skip
    for mark in marks:
        while theta != mark:
            goal = mark if abs(mark - theta) <= abs(step) else theta + step
            new, matrix = newton(x, goal, places)
            slow = (
                new is not None
                and np.max(np.abs(new - x)) < 0.2
                and sign_of(matrix) == sign_of(gaps_of(x, theta, places)[1])
            )
            if slow:
                x, theta, step = new, goal, 1.5 * step
            elif abs(step) < 1e-5:
                return found
            else:
                step = step / 2.0
        found[round(float(mark / STEP))] = x
    return found


STEP = np.deg2rad(5.0)


def sign_of(matrix: np.ndarray) -> float:
    return float(np.sign(np.linalg.det(matrix)))


def newton(x: np.ndarray, theta: float, places: dict[str, complex]) -> tuple[np.ndarray | None, np.ndarray]:
    for _ in range(8):
        off, matrix = gaps_of(x, theta, places)
        step = np.linalg.solve(matrix, off)
        x = x - step
        if np.max(np.abs(step)) < 1e-11:
            return x, gaps_of(x, theta, places)[1]
    return None, matrix


@pytest.mark.full
def test_no_random_drawn_stephenson_iii_is_lost() -> None:
    """Over a full turn; 9 of 59 once lost everything: what own continuation reaches is reached."""
    rng, reached = np.random.default_rng(1), 0
    for _ in range(7):
        places, mechanism = drawn_at_random(rng)
        motion = quietly(mechanism, order=0)
        start = float(np.angle(places["G"] - places["F"])) % (2.0 * np.pi)
        for end in (start + 2.0 * np.pi, start - 2.0 * np.pi):
            for mark, x in followed(places, start, end).items():
                assert motion.assembled[mark % 72]
                # beyond the range the branch may come in on its other side, a whole turn on
                if 0 <= mark <= 72:
                    there = [motion.points[k].position[mark] for k in "BCE"]
                    assert np.allclose(there, x[::2] + 1j * x[1::2], atol=1e-7)
                reached += 1
    assert reached > 300


@pytest.mark.parametrize("seed", range(2) if EVERYTHING else range(1))
def test_whichever_place_is_drawn_the_motion_is_the_same(seed: int) -> None:
    """Drawn anywhere on the branch, asked for forth and back: one motion, and that of own continuation."""
    rng = np.random.default_rng(seed)
    drawn = float(np.angle(PLACES["G"] - PLACES["F"]))
    followed_from_there = followed(PLACES, drawn, np.deg2rad(210.0))
    degrees = 5.0 * np.array(sorted(followed_from_there))
    expected = np.array([followed_from_there[round(d / 5.0)] for d in degrees])
    there = rng.uniform(np.deg2rad(107.0), np.deg2rad(210.0))
    x, _ = newton(followed_from_there[round(float(there / STEP))], there, PLACES)
    assert x is not None
    places = {**PLACES, **dict(zip("BCE", (x[::2] + 1j * x[1::2]).tolist(), strict=True))}
    places["F"] = PLACES["G"] - abs(PLACES["G"] - PLACES["F"]) * np.exp(1j * there)
    mechanism = stephenson().replace(ck.drawn(**places))
    low, high = sorted(rng.integers(-10, len(degrees) + 10, 2))
    asked = degrees[0] + 5.0 * np.arange(low, high + 2)
    forth = quietly(mechanism, {"FG": np.deg2rad(asked)}, order=1)
    back = quietly(mechanism, {"FG": np.deg2rad(asked[::-1])}, order=1)
    good = (asked > BRANCH[0]) & (asked < BRANCH[1])
    assert np.array_equal(forth.assembled, good)
    assert np.array_equal(back.assembled, good[::-1])
    rows = [int(np.flatnonzero(degrees == d)[0]) for d in asked[good]]
    for k, letter in enumerate("BCE"):
        at = forth.points[letter].position
        assert np.allclose(at[good], expected[rows, 2 * k] + 1j * expected[rows, 2 * k + 1], atol=1e-8)
        assert np.allclose(back.points[letter].position[::-1], at, atol=1e-8, equal_nan=True)


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_of_both_ends_of_a_full_turn_the_one_with_the_drawn_value_is_the_drawn_pose(turns: int) -> None:
    """Drawn at an end of a full turn and near a limit: poses of the branch are those beside that end."""
    drawn = float(np.angle(PLACES["G"] - PLACES["F"]))
    mechanism = stephenson()
    degrees = np.rad2deg(drawn) + np.linspace(360.0 * min(turns, 0), 360.0 * max(turns, 0), 73 if turns else 1)
    motion = quietly(mechanism, {"FG": np.deg2rad(degrees)}, order=0)
    expected = {-1: 72, 0: 0, 1: 0}[turns]
    followed = motion.followed
    assert followed.poses.of_poses[0, expected] == pytest.approx(followed.curve.path.home, abs=1e-9)
    assert abs(motion.points["B"].position[expected] - PLACES["B"]) < 1e-9


# --- where a branch comes back after a gap ----------------------------------------------------------------------

RETURNING = {
    "A": 2.1 - 1.7j,
    "B": -2 + 2.5j,
    "C": -2.1 + 1.5j,
    "D": -1.1 - 0.8j,
    "E": 0.3 + 2.6j,
    "F": -3 - 2j,
    "G": 1.3 - 0.6j,
}


def every_sign(theta: float, places: dict[str, complex]) -> list[float]:
    """The signs of all configurations at a pose, by Newton from random places of B, C and E."""
    rng, found = np.random.default_rng(0), list[np.ndarray]()
    for _ in range(300):
        x, _ = newton(rng.uniform(-6.0, 6.0, 6), theta, places)
        if x is not None and not any(np.max(np.abs(x - other)) < 1e-6 for other in found):
            found.append(x)
    return [sign_of(gaps_of(x, theta, places)[1]) for x in found]


def test_a_general_group_comes_back_to_the_only_configuration_of_its_sign() -> None:
    """From 2..85 degrees it comes back at 197..325, where there is one configuration of its sign."""
    mechanism = stephenson().replace(ck.drawn(**RETURNING))
    motion = quietly(mechanism, order=1)
    drawn = np.array([v for k in "BCE" for v in (RETURNING[k].real, RETURNING[k].imag)])
    theta = float(np.angle(RETURNING["G"] - RETURNING["F"]))
    own = sign_of(gaps_of(drawn, theta, RETURNING)[1])
    assert motion.assembled[40:65].all()
    assert not motion.assembled[18:39].any()
    of_its_sign = {k: every_sign(float(np.deg2rad(5.0 * k)), RETURNING).count(own) for k in (20, 38, 41, 50, 64)}
    # at 100 degrees there is one that was there at 80 already, beside the branch that ends between: not its own
    assert of_its_sign == {20: 1, 38: 0, 41: 1, 50: 1, 64: 1}
    for index in (41, 50, 64):
        x = np.array([v for k in "BCE" for p in [motion.points[k].position[index]] for v in (p.real, p.imag)])
        off, matrix = gaps_of(x, float(np.deg2rad(5.0 * index)), RETURNING)
        assert np.max(np.abs(off)) < 1e-10
        assert sign_of(matrix) == own
    back = quietly(mechanism, {"FG": np.deg2rad(np.arange(360.0, -1.0, -5.0))}, order=1)
    assert np.allclose(back.points["E"].position[::-1], motion.points["E"].position, atol=1e-8, equal_nan=True)


def test_a_gap_says_why_its_group_does_not_come_back() -> None:
    """The other configuration of the sign goes on beside the branch; farther on there is none."""
    before, after = ck.gaps(quietly(stephenson()))
    assert "the one configuration there with the sign of its Jacobian goes on beside it" in before.reason
    assert "no configuration has the sign of its Jacobian there" in after.reason


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


@pytest.mark.parametrize("name", ["case_1114", "case_800004", "case_20170", "case_20239", "case_5500"])
def test_hard_cases(name: str) -> None:
    """Full turns that cannot be completed, false gaps at small lengths, what runs to infinity: two minutes before."""
    begin = process_time()
    entry, mechanism, motion = hard(name)
    assert process_time() - begin < 10.0
    leads_where_it_says(entry, mechanism, motion)


def test_all_hard_cases_are_there() -> None:
    names = {entry["id"] for entry in json.loads((REFERENCE / "hard.json").read_text())}
    # whose numbers are in the tests of the configuration curve
    others = {"knife-edge-drives-cam", "scissor-two-stages", "crank-shaper-near-its-limit"}
    assert {path.stem for path in (REFERENCE / "hard").glob("*.toml")} == names | others
