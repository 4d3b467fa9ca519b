"""Exercises: rounded numbers are what is solved, variants are no special cases, files are whole."""

from __future__ import annotations

import csv
import itertools
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.structure.redundancy import constraint_equations
from compoundkin.view.report.exercises import FASTEST, printed
from tests.catalog import mechanism as loaded


@pytest.fixture(scope="module")
def four_bars() -> ck.results.Exercises:
    return ck.exercise(ck.linkages.four_bar(60, 20, 50, 40), vary=0.1, seed=7, count=8)


def answers(one: ck.results.Exercise) -> dict[str, float]:
    return {a.quantity: a.value for asked in one.questions for a in asked.answers}


def test_printed_lengths_are_what_is_solved(four_bars: ck.results.Exercises) -> None:
    """By the law of cosines with the printed lengths alone, and Freudenstein's velocity ratio."""
    for one in four_bars.variants:
        rows = {row[1]: row[2] for row in one.given}
        a, b, c = (float(rows[f"length {word}"]) for word in ("AB", "BC", "DC"))
        d = float(re.findall(r"[-\d.]+", rows["point D"])[0])
        theta, omega = np.deg2rad(float(one.drives[0][1])), float(one.drives[0][3])
        found = answers(one)
        pin = a * np.exp(1j * theta)
        phi, psi = np.deg2rad(found["coupler.angle"]), np.deg2rad(found["rocker.angle"])
        assert pin + b * np.exp(1j * phi) == pytest.approx(d + c * np.exp(1j * psi), abs=1e-9)
        ratio = a * np.sin(phi - theta) / (c * np.sin(phi - psi))
        assert found["rocker.angular_velocity"] == pytest.approx(omega * ratio)


def test_lengths_have_two_digits_and_differ_from_variant_to_variant(four_bars: ck.results.Exercises) -> None:
    lengths = [tuple(row[2] for row in one.given) for one in four_bars.variants]
    assert len(set(lengths)) == len(lengths)
    numbers = [float(row[2]) for one in four_bars.variants for row in one.given if str(row[1]).startswith("length")]
    assert all(printed(number) == number for number in numbers)


def test_variants_turn_fully_and_are_no_special_cases(four_bars: ck.results.Exercises) -> None:
    for one in four_bars.variants:
        assert ck.solve(one.mechanism).assembled.all()
        angles = [float(np.rad2deg(one.motion.links[name].angle)) % 180 for name in ("crank", "coupler", "rocker")]
        gaps = [abs((x - y + 90) % 180 - 90) for x, y in itertools.combinations([*angles, 0.0, 90.0], 2)]
        assert min(gap for gap in gaps if gap < 90) > 2.9
        assert all(
            abs(value) < FASTEST * 2 for name, value in answers(one).items() if name.endswith("angular_velocity")
        )


def test_one_variant_does_not_depend_on_how_many_there_are(four_bars: ck.results.Exercises) -> None:
    again = ck.exercise(ck.linkages.four_bar(60, 20, 50, 40), vary=0.1, seed=7, count=3)
    assert again.answers == four_bars.answers[: len(again.answers)]
    other = ck.exercise(ck.linkages.four_bar(60, 20, 50, 40), vary=0.1, seed=8)
    assert other[0].given != four_bars[0].given


def test_a_parallelogram_remains_one() -> None:
    one = ck.exercise(loaded("parallelogram"), seed=3)[0]
    found = answers(one)
    assert found["follower.angular_velocity"] == pytest.approx(float(one.drives[0][3]))
    points = one.mechanism.geometry.points
    assert points["crank"]["B"] == points["follower"]["C"] != loaded("parallelogram").geometry.points["crank"]["B"]


def test_forces_agree_with_virtual_work() -> None:
    one = ck.exercise(loaded("toggle-press-loaded"), seed=7, questions="forces")[0]
    speed, force = one.motion.points["D"].velocity, -10000.0
    power = force * float(np.ravel(speed)[0].real)
    rate = float(one.drives[0][3])
    assert answers(one)["crank.effort"] * rate == pytest.approx(-power, rel=1e-9)


@pytest.mark.parametrize("name", ["five-bar", "class-iii-six-bar", "crank-shaper", "hydraulic-crane", "geneva-wheel"])
def test_many_kinds_of_mechanisms(name: str) -> None:
    one = ck.exercise(loaded(name), seed=1)[0]
    assert [asked.kind for asked in one.questions][:3] == ["mobility", "groups", "positions"]
    assert all(np.isfinite(value) for value in answers(one).values() if not isinstance(value, str))


def test_the_files_are_whole(tmp_path: Path) -> None:
    made = ck.exercise(loaded("toggle-press-loaded"), seed=7, count=2)
    folder = made.save(tmp_path / "new")
    stems = [f"{k:02d}{end}" for k in (1, 2) for end in ("", "-solution")]
    expected = {f"{stem}.{form}" for stem in stems for form in ("md", "html", "tex", "svg")}
    assert {path.name for path in folder.iterdir()} == expected | {"01.toml", "02.toml", "answers.csv"}
    assert ck.load(folder / "02.toml") == made[1].mechanism
    with (folder / "answers.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(made.answers)
    assert {row["variant"] for row in rows} == {"1", "2"}
    for path in folder.glob("*.tex"):
        text = path.read_text()
        plain = re.sub(r"\\[{}\\]", "", text)
        assert plain.count("{") == plain.count("}")

        assert len(re.findall(r"\\begin\{(\w+)", text)) == len(re.findall(r"\\end\{(\w+)", text))
        body = text.replace("°", "")
        assert not [sign for sign in body if ord(sign) > 255]
    # the sheet does not give the groups away
    for name in ("01", "01-solution"):
        text = (folder / f"{name}.tex").read_text()
        used = {
            one
            for options in re.findall(r"\\(?:path|node)\[([^]]*)\]", text)
            for one in re.findall(r"ck-[\w-]+", options)
        }
        assert used
        assert used <= {*re.findall(r"(ck-[\w-]+)/\.style", text)}  # another is an arrow to TikZ, and an error
    assert 'ck-bar1"' not in (folder / "01.svg").read_text()
    assert 'ck-bar1"' in (folder / "01-solution.svg").read_text()
    with pytest.raises(ck.errors.InvalidInput, match="not empty"):
        made.save(folder)


def test_files_are_there_together_or_not_at_all(tmp_path: Path) -> None:
    made = ck.exercise(ck.linkages.four_bar(60, 20, 50, 40), questions="mobility", count=2)

    def interrupted(*_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        made.save(tmp_path / "new", interrupted)
    assert not list(tmp_path.iterdir())
    # an empty folder, in which somebody may work, is filled and stays the same one
    (tmp_path / "own").mkdir()
    before = (tmp_path / "own").stat().st_ino
    made.save(tmp_path / "own")
    assert (tmp_path / "own").stat().st_ino == before
    assert (tmp_path / "own" / "answers.csv").exists()
    assert [one.name for one in tmp_path.iterdir()] == ["own"]


@pytest.mark.parametrize("name", ["disc-cam-roller-program", "flat-faced-follower"])
def test_something_moves_at_the_given_pose(name: str) -> None:
    """Followers of cams rest for a part of the turn: then there is nothing to find."""
    for seed in range(4):
        one = ck.exercise(loaded(name), seed=seed, questions="velocities")[0]
        assert any(abs(value) > 0.0 for value in answers(one).values())


def test_a_link_may_have_no_point() -> None:
    assert len(ck.exercise(loaded("five-bar-led"), questions="positions")[0].questions[0].answers) > 1


def test_wrong_words_are_told() -> None:
    bar = ck.linkages.four_bar(60, 20, 50, 40)
    with pytest.raises(ck.errors.UnknownName, match="velocities"):
        ck.exercise(bar, questions="velocity")
    with pytest.raises(ck.errors.InvalidInput, match="no loads"):
        ck.exercise(bar, questions="forces")
    with pytest.raises(ck.errors.InvalidInput, match="ten percent"):
        ck.exercise(bar, vary=10)


def test_cylinders_may_drive_what_is_asked_about() -> None:
    """They turn short levers faster than their own rate by the size of the whole; that is no limit position."""
    one = ck.exercise(loaded("hydraulic-digger"), vary=0.1, seed=0).variants[0]
    assert [row[0] for row in one.drives] == ["boom-cylinder", "stick-cylinder", "bucket-cylinder"]
    assert np.isfinite(answers(one)["bucket.angular_velocity"])


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex is installed")
def test_a_sheet_is_set_by_latex(tmp_path: Path) -> None:
    ck.exercise(ck.linkages.slider_crank(20, 60), seed=3, questions="mobility").save(tmp_path / "sheets")
    told = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "01.tex"],
        cwd=tmp_path / "sheets", capture_output=True, timeout=60, check=False,
    )  # fmt: skip
    assert told.returncode == 0, told.stdout.decode(errors="replace")[-1500:]
    assert (tmp_path / "sheets" / "01.pdf").read_bytes().startswith(b"%PDF")


def test_what_is_overconstrained_is_not_searched_for_from_afar(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[Any] = []
    corrected = constraint_equations.corrected
    monkeypatch.setattr(constraint_equations, "corrected", lambda *given: looks.append(given) or corrected(*given))
    made = ck.exercise(ck.load("conjugate-cams"), questions="mobility")
    # lengths of conjugate cams that change alone leave nothing assembled: each is looked for near the drawing only
    assert made.fixed
    assert len(looks) < 80
