"""Every shipped mechanism is sound, its published numbers hold, and it does what its page says.

Run as a script, ``python -m tests.files.test_catalog``, it writes docs/catalog.md anew.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.files import load, shipped_mechanisms
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.quantities import quantity as named
from compoundkin.model.elements import Expectation
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose
from tests.catalog import NAMES, each, mechanism, motion

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "catalog.md"

# Straight lines that are exact, and all other identities: rounding over a few dyads, for lengths near 1.
EXACT = 1e-12
# The same for accelerations, whose terms are up to a thousand times greater and cancel.
EXACT_RATE = 1e-9


def value(motion: Motion, quantity: str) -> Any:
    """What a quantity such as ``G.velocity`` is in a motion."""
    owner, _, what = quantity.rpartition(".")
    if what in ("position", "velocity", "acceleration"):
        return getattr(motion.points[owner], what)
    if what in ("angle", "angular_velocity", "angular_acceleration"):
        return getattr(motion.links[owner], what)
    if what == "value":
        return motion.pairs[owner].value
    return named(motion, quantity).values


def deviation(mechanism: Mechanism, expected: Expectation) -> float:
    """How far the solved quantity is from the published one, angles apart from whole turns."""
    given: dict[str, dict[str, float]] = {"": {}, "speed": {}, "acceleration": {}}
    for key, number in expected.at:
        drive, _, rate = key.partition(".")
        given[rate][drive] = number
    rates = {rate: numbers for rate, numbers in given.items() if rate and numbers}
    time = given[""].pop("time", None)
    # a figure of the whole motion is the same at all its poses
    found = value(solve(mechanism, given[""] or None, time=time, **rates), expected.quantity)
    solved = complex(np.ravel(found)[0])
    gap = solved - expected.value
    if expected.quantity.endswith(".angle"):
        return abs(float(np.angle(np.exp(1j * gap.real))))
    return max(abs(gap.real), abs(gap.imag))


# --- every mechanism ------------------------------------------------------------------------------------


@each(NAMES)
def test_says_what_it_is(name: str) -> None:
    item = mechanism(name)
    assert item.title
    assert item.source
    assert item.description.endswith(".")
    assert item.outputs


@each(NAMES)
def test_decomposes_without_faults(name: str) -> None:
    structure = decompose(mechanism(name))
    assert structure.faults == ()
    assert len(structure.groups) > 0


@each(NAMES)
def test_is_assembled_over_its_whole_range(name: str) -> None:
    assert np.all(motion(name).assembled)
    assert motion(name).shape[-1] > 1


@each(NAMES)
def test_outputs_are_finite(name: str) -> None:
    for quantity in mechanism(name).outputs:
        assert np.all(np.isfinite(value(motion(name), quantity))), quantity


@each(NAMES)
def test_moves_continuously_and_closes_after_a_turn(name: str) -> None:
    solved = motion(name)
    for letter, point in solved.points.items():
        assert np.max(np.abs(np.diff(point.position))) < 0.35 * solved.size, letter
    turns = [np.ptp(drive.value) for drive in solved.drives.values() if drive.is_angle]
    if len(turns) == 1 and np.isclose(turns[0], 2 * np.pi):
        for letter, point in solved.points.items():
            assert abs(point.position[0] - point.position[-1]) < 1e-9 * solved.size, letter


@each(NAMES)
def test_a_pose_alone_is_that_pose_of_the_motion(name: str) -> None:
    """The assembly mode is chosen by the drawing, not by where the motion happens to begin."""
    solved = motion(name)
    for k in np.linspace(0, solved.shape[-1] - 1, 4).astype(int):
        alone = solve(mechanism(name), {drive: d.value[k] for drive, d in solved.drives.items()})
        for letter, point in solved.points.items():
            gap = abs(complex(alone.points[letter].position) - point.position[k])
            assert gap < 1e-9 * solved.size, (k, letter)


@each(NAMES)
def test_drawing_is_near_the_assembled_pose(name: str) -> None:
    """A drawing that only chooses the mode is still a drawing of the mechanism: 2 % of its size."""
    item = mechanism(name)
    for link, pose in item.geometry.drawn.items():
        for letter, p in item.geometry.points[link].items():
            if letter in item.sketch:
                gap = abs(pose.at(p).c[0] - item.sketch[letter])
                assert gap < 0.02 * item.geometry.size, (link, letter)


@each(NAMES)
def test_published_numbers_hold(name: str) -> None:
    off = {expected: deviation(mechanism(name), expected) for expected in mechanism(name).expectations}
    assert not {expected: gap for expected, gap in off.items() if not gap <= expected.tolerance}


# --- the main example, against the reference to all its digits ------------------------------------------


def test_six_bar_to_the_third_derivative() -> None:
    from tests.support import reference

    rows = reference("sixbar_example_3_4")["expected"]["rows"]
    crank = np.deg2rad([row["crank_deg"] for row in rows])
    solved = solve(mechanism("six-bar"), {"crank": crank}, order=3)
    for letter in ("A", "C", "G"):
        for k, what in enumerate(("position", "velocity", "acceleration", "jerk")):
            expected = [complex(*row[letter][what]) for row in rows]
            np.testing.assert_allclose(solved.points[letter].derivative(k), expected, rtol=1e-10, atol=1e-8)
    for link, key in (("plate", "theta3"), ("rocker", "theta2"), ("bar", "theta4")):
        motion = solved.links[link]
        rates = (motion.angular_velocity, motion.angular_acceleration, motion.angular_jerk)
        for solution, what in zip(rates, ("rate", "second", "third"), strict=True):
            np.testing.assert_allclose(solution, [row[key][what] for row in rows], rtol=1e-10, atol=1e-9)
    for k, what in enumerate(("value", "rate", "second", "third")):
        np.testing.assert_allclose(
            solved.pairs["slot"].derivative(k), [row["slide"][what] for row in rows], rtol=1e-10, atol=1e-8
        )


# --- what the descriptions promise ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "letter", "x"),
    [("peaucellier", "P", 2.405), ("hart-inversor", "Q", -2.4375), ("scott-russell", "C", 0.0)],
)
def test_exact_straight_lines(name: str, letter: str, x: float) -> None:
    point = motion(name).points[letter]
    assert np.max(np.abs(point.x - x)) < EXACT
    assert np.max(np.abs(point.velocity.real)) < EXACT_RATE * np.max(np.abs(point.velocity))
    assert np.max(np.abs(point.acceleration.real)) < EXACT_RATE * np.max(np.abs(point.acceleration))
    assert np.ptp(point.y) > 1


def test_hart_points_stay_in_line_and_invert() -> None:
    p, q = (motion("hart-inversor").points[k].position for k in "PQ")
    np.testing.assert_allclose(p * np.conj(q), -2.4375, atol=EXACT)


@pytest.mark.parametrize(
    ("name", "offset", "bound", "length"),
    [
        ("chebyshev-straight-line", 4.0, 0.0098, 3.8),
        ("roberts-straight-line", 0.0, 0.0100, 1.6),
    ],
)
def test_near_straight_lines(name: str, offset: float, bound: float, length: float) -> None:
    point = motion(name).points["P"]
    assert np.max(np.abs(point.y - offset)) < bound
    assert np.ptp(point.x) > length


def test_hoecken_is_straight_and_steady_for_half_a_turn() -> None:
    crank = np.deg2rad(np.arange(90, 271))
    point = solve(mechanism("hoecken-straight-line"), {"crank": crank}).points["P"]
    assert np.max(np.abs(point.y - 4)) < 0.01
    assert np.ptp(point.x) > 3.9
    middle = np.abs(point.velocity.real[30:-30])
    assert np.min(middle) > 0.95 * np.max(middle)


def test_watt_is_straight_in_the_middle() -> None:
    arm = np.deg2rad(np.linspace(-10, 10, 41))
    point = solve(mechanism("watt-straight-line"), {"arm-1": arm}).points["P"]
    assert np.max(np.abs(point.x)) < 0.001
    assert np.ptp(point.y) > 1.7


def test_pantograph_enlarges() -> None:
    tracer, pen = motion("pantograph").points["C"], motion("pantograph").points["P"]
    for k in range(3):
        np.testing.assert_allclose(pen.derivative(k), 2.5 * tracer.derivative(k), atol=1e-9)


def test_oldham_shafts_turn_alike() -> None:
    links = motion("oldham-coupling").links
    for what in ("angle", "angular_velocity", "angular_acceleration"):
        a, b = getattr(links["input"], what), getattr(links["output"], what)
        np.testing.assert_allclose(np.ptp(a - b), 0, atol=EXACT)


def test_trammel_draws_ellipses_and_a_circle() -> None:
    rod = motion("elliptic-trammel").links["rod"]
    np.testing.assert_allclose(np.abs(rod.at((1.5, 0)).position), 1.5, rtol=EXACT)
    for s in (-1.0, 0.5, 2.0, 4.0):
        point = rod.at((s, 0))
        np.testing.assert_allclose((point.x / (3 - s)) ** 2 + (point.y / s) ** 2, 1, rtol=1e-11)


def test_trammel_is_a_cardan_motion() -> None:
    """Every point of the circle over AB moves on a straight line through O."""
    rod = motion("elliptic-trammel").links["rod"]
    for angle in (0.3, 1.0, 2.5, 4.0):
        z = rod.at(1.5 + 1.5 * np.exp(1j * angle)).position
        farthest = z[np.argmax(np.abs(z))]
        assert np.max(np.abs((z * np.conj(farthest)).imag)) < 1e-11


def test_scotch_yoke_is_a_cosine() -> None:
    solved = motion("scotch-yoke")
    np.testing.assert_allclose(solved.points["Y"].x, 2 * np.cos(solved.drives["crank"].value), atol=EXACT)


def test_parallelogram_translates() -> None:
    solved = motion("parallelogram")
    assert np.max(np.abs(solved.links["coupler"].angle)) < EXACT
    np.testing.assert_allclose(solved.links["follower"].angle, solved.links["crank"].angle, rtol=EXACT)
    assert np.max(np.abs(solved.links["coupler"].angular_acceleration)) < EXACT_RATE


def test_antiparallelogram_turns_against_itself() -> None:
    solved = motion("antiparallelogram")
    assert np.all(solved.links["follower"].angular_velocity * solved.links["crank"].angular_velocity < 0)


def test_who_turns_fully() -> None:
    def travel(name: str, link: str) -> float:
        return float(np.rad2deg(np.ptp(motion(name).links[link].angle)))

    assert travel("double-crank", "follower") == pytest.approx(360)
    assert travel("whitworth-turning-guide", "guide") == pytest.approx(360)
    assert travel("crank-rocker", "rocker") == pytest.approx(61.43, abs=0.1)
    assert travel("oscillating-guide", "lever") == pytest.approx(2 * 22.02, abs=0.1)
    assert travel("four-bar-norton", "rocker") < 180


def test_crank_rocker_reaches_its_published_limits() -> None:
    """Limits of the rocker from the triangle of the stretched and the folded crank and coupler."""
    a, b, c, d = 2.0, 5.0, 4.0, 5.5
    limits = [np.pi - np.arccos((c * c + d * d - r * r) / (2 * c * d)) for r in (b + a, b - a)]
    crank = np.linspace(0, 2 * np.pi, 7201)
    rocker = solve(mechanism("crank-rocker"), {"crank": crank}, order=0).links["rocker"].angle
    np.testing.assert_allclose([rocker.min(), rocker.max()], limits, atol=1e-6)


def test_atkinson_makes_four_unequal_strokes() -> None:
    crank = np.linspace(0, 2 * np.pi, 721)
    piston = solve(mechanism("atkinson-engine"), {"crank": crank}).pairs["piston"].value[:-1]
    extreme = (piston - np.roll(piston, 1)) * (np.roll(piston, -1) - piston) < 0
    strokes = np.abs(np.diff(piston[extreme], append=piston[extreme][0]))
    assert len(strokes) == 4
    assert np.max(strokes) > 1.3 * np.min(strokes)


def test_v_engine_runs_45_degrees_apart() -> None:
    crank = np.deg2rad(np.arange(0, 360, 5))
    later = crank + np.deg2rad(45)
    front = solve(mechanism("v-engine"), {"crank": crank}).pairs["front"].value
    rear = solve(mechanism("v-engine"), {"crank": later}).pairs["rear"].value
    np.testing.assert_allclose(front, rear, atol=EXACT * 10)


def test_scissor_lift_rises_level() -> None:
    solved = motion("scissor-lift")
    np.testing.assert_allclose(solved.points["E"].y, 2 * np.sqrt(4 - solved.pairs["foot"].value ** 2), rtol=EXACT)
    assert np.max(np.abs(solved.links["platform"].angle)) < EXACT


@pytest.mark.parametrize(("name", "low"), [("klann-leg", 0.06), ("jansen-leg", 3.0)])
def test_legs_stand_on_the_ground_for_a_good_part_of_the_turn(name: str, low: float) -> None:
    height = motion(name).points["foot"].y
    assert np.mean(height < height.min() + low) > 0.35
    assert np.ptp(height) > 4 * low


def test_quick_returns_return_quickly() -> None:
    crank = np.deg2rad(np.arange(0, 360, 0.5))
    for name, pair, ratio in (("whitworth-quick-return", "ram", 2.0), ("crank-shaper", "ram", None)):
        rate = solve(mechanism(name), {"crank": crank}).pairs[pair].rate
        slow = max(np.mean(rate > 0), np.mean(rate < 0))
        assert slow / (1 - slow) == pytest.approx(ratio, rel=0.01) if ratio else slow > 0.6


# --- the same links, driven elsewhere: closed forms and iteration must agree ----------------------------


@pytest.mark.parametrize(
    ("one", "other", "drive", "coordinate", "letter", "part"),
    [
        ("stephenson-iii", "stephenson-iii-driven-at-rocker", "CD", "D", "E", slice(10, 40)),
        ("stephenson-iii", "stephenson-iii-driven-at-dyad", "FG", "G", "E", slice(10, 40)),
        ("stephenson-iii", "stephenson-iii-floating-driver", "EF", "E", "F", slice(20, 38)),
        ("stephenson-ii-driven-at-binary", "stephenson-ii", "crank", "F", "C", slice(None)),
        ("watt-ii", "watt-ii-driven-at-ternary", "DCE", "D", "F", slice(19, 36)),
        ("slider-crank", "slider-crank-driven-by-piston", "piston", "stroke", "A", slice(4, 33)),
    ],
)
def test_same_linkage_driven_elsewhere(
    one: str, other: str, drive: str, coordinate: str, letter: str, part: slice
) -> None:
    first = motion(one)
    links = {"crank": "FAB"} if one.startswith("stephenson-ii-") else {}
    link = links.get(drive, drive)
    if mechanism(other).drives[0].on == "frame" and link in first.links and coordinate in first.mechanism.carriers:
        driven = (
            first.links[link].angle,
            first.links[link].angular_velocity,
            first.links[link].angular_acceleration,
        )
    elif coordinate in first.mechanism.carriers:
        a, b = first.links["EF"], first.links["BCE"]
        driven = tuple(getattr(a, k) - getattr(b, k) for k in ("angle", "angular_velocity", "angular_acceleration"))
    else:
        pair = first.pairs[coordinate]
        driven = pair.value, pair.rate, pair.second
    q, speed, acceleration = (np.asarray(v)[part] for v in driven)
    hint = {k: p.position[part][0] for k, p in first.points.items() if k in mechanism(other).carriers}
    second = solve(mechanism(other), {drive: q}, speed={drive: speed}, acceleration={drive: acceleration}, hint=hint)
    a, b = first.points[letter], second.points[letter]
    scale = first.size
    for k in range(3):
        mine, theirs = a.derivative(k)[part], b.derivative(k)
        size = max(scale, float(np.max(np.abs(mine))))
        assert np.max(np.abs(mine - theirs)) < 1e-7 * size, k


# --- names, paths and the page --------------------------------------------------------------------------


def test_names_are_the_files() -> None:
    assert list(NAMES) == sorted(file.stem for file in (ROOT / "catalog").iterdir() if file.suffix == ".toml")
    assert all(name == name.lower() and " " not in name and "_" not in name for name in NAMES)
    assert len({mechanism(name).title for name in NAMES}) == len(NAMES)


def test_a_name_works_where_a_file_does() -> None:
    assert load(shipped_mechanisms.resolve("six-bar")) == load("six-bar")


def test_an_existing_file_wins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("six-bar").write_text("mine")
    assert shipped_mechanisms.resolve("six-bar") == Path("six-bar")
    assert shipped_mechanisms.resolve(tmp_path / "six-bar") == tmp_path / "six-bar"


def test_a_folder_of_that_name_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("six-bar").mkdir()
    assert shipped_mechanisms.resolve("six-bar") == shipped_mechanisms.path("six-bar")


def test_an_unknown_name_says_the_nearest() -> None:
    for call in (shipped_mechanisms.path, load, shipped_mechanisms.resolve):
        with pytest.raises(UnknownName, match="did you mean 'peaucellier'"):
            call("peaucelier")


@pytest.mark.parametrize("text", ["six-bar.toml", "drafts/six-bar", "no.json", "C:\\six-bar"])
def test_a_missing_file_is_called_a_file(text: str) -> None:
    with pytest.raises(InvalidInput, match="there is no such file"):
        shipped_mechanisms.resolve(text)


def test_a_missing_file_with_a_catalog_name_says_so() -> None:
    with pytest.raises(InvalidInput, match="the catalog's mechanism is called 'six-bar'"):
        shipped_mechanisms.resolve("six-bar.toml")


def test_a_wheel_carries_the_files_inside_the_package(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "compoundkin", tmp_path / "compoundkin", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "catalog", tmp_path / "compoundkin" / "_catalog")
    code = "from compoundkin.files import shipped_mechanisms as s; print(s.folder(), *s.shipped(), sep='|')"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    place, *found = ran.stdout.strip().split("|")
    assert Path(place) == tmp_path / "compoundkin" / "_catalog"
    assert tuple(found) == NAMES


def test_names_do_not_load_numpy() -> None:
    code = "import sys; from compoundkin.base.errors import Problem; before = 'numpy' in sys.modules;"
    code += "from compoundkin.files.shipped_mechanisms import shipped; shipped(); print(before, 'numpy' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    before, after = out.split()
    assert before == after, "catalog itself must not be what loads NumPy"


def page() -> str:
    """docs/catalog.md as it has to be."""
    lines = [
        "# The catalog",
        "",
        "Shipped mechanisms, each one file in `catalog/`. A name works wherever a mechanism file does:",
        '`compoundkin report six-bar`, or `ck.load("six-bar")` in Python.',
        "The groups are those of the solving order; *numbers* counts the published or independently computed",
        "values in the file that the tests hold the solution to. The source of each is in its file.",
        "",
        "<!-- written by `python -m tests.files.test_catalog`; a test asserts that it is up to date -->",
        "",
        "| name | mechanism | groups | numbers | what to look at |",
        "|---|---|---|---|---|",
    ]
    for name in NAMES:
        item = mechanism(name)
        groups = ", ".join(group.name for group in decompose(item).groups)
        cells = [
            f"[`{name}`](../catalog/{name}.toml)",
            item.title,
            groups,
            str(len(item.expectations) or ""),
            item.description,
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def test_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: python -m tests.files.test_catalog"


if __name__ == "__main__":
    with warnings.catch_warnings():
        PAGE.write_text(page(), encoding="utf-8")
