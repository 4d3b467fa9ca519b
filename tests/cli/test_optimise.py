"""The verb `optimise`."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli

CRANK_ROCKER = "crank-rocker", "--starts", "4", "--from", "0", "--to", "360", "--step", "30"


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, ["optimise", *args], catch_exceptions=False)


def test_a_rocker_swings_as_far_as_it_should(tmp_path: Path) -> None:
    """The swing of the mechanism that is written, by the cosine theorem at its two dead centres."""
    path = tmp_path / "better.toml"
    wanted = "--free", "crank.B.x=1:3", "--target", "rocker.angle.stroke=60", "--full-turn"
    done = run(*CRANK_ROCKER, *wanted, "-o", str(path))
    assert done.exit_code == 0
    assert "rocker.angle.stroke 60°" in done.stdout
    found = ck.load(path)
    frame, crank, coupler, rocker = (
        abs(points[1] - points[0]) for link in found.links.values() for points in [list(link.points.values())]
    )
    ends = [np.arccos((rocker**2 + frame**2 - r**2) / (2 * rocker * frame)) for r in (coupler + crank, coupler - crank)]
    assert np.degrees(ends[0] - ends[1]) == pytest.approx(60, abs=1e-6)


def test_bounds_and_constraints_hold() -> None:
    done = run(
        *CRANK_ROCKER, "--free", "rocker.C.x=3.5:4.5", "--least", "rocker.angle.stroke",
        "--at-least", "rocker.angle.stroke=58", "--format", "json",
    )  # fmt: skip
    assert done.exit_code == 0
    assert "rocker.angle.stroke at least 58°" in done.stdout
    asked = "--free", "rocker.C.x=3.9:4.1", "--least", "rocker.angle.stroke", "--at-most", "rocker.angle.stroke=20"
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        done = run(*CRANK_ROCKER, *asked)
    assert done.exit_code == 4
    assert "Not all constraints hold" in done.stdout


WIDE = "--free", "crank.B.x=0.5:3,coupler.C.x=2:9,rocker.C.x=2:9", "--target", "rocker.angle.stroke=70"


def test_searches_begin_at_designs_of_an_atlas(tmp_path: Path) -> None:
    """Of an atlas that is made for it, or kept: all begin at designs that turn, and the same answer comes out."""
    pytest.importorskip("pyarrow")
    made, kept = tmp_path / "made.toml", tmp_path / "kept.toml"
    ck.coupler_atlas(4, 700, folder=tmp_path / "atlas")
    for given, path in (("700", made), (str(tmp_path / "atlas"), kept)):
        done = run(*CRANK_ROCKER, *WIDE, "--full-turn", "--atlas", given, "-o", str(path))
        assert done.exit_code == 0
    assert made.read_text(encoding="utf-8") == kept.read_text(encoding="utf-8")
    angles = ck.solve(ck.load(made), values=ck.deg(np.arange(0, 360, 0.5))).links["rocker"].angle
    assert np.degrees(np.ptp(angles)) == pytest.approx(70, abs=0.01)


@pytest.mark.parametrize(
    ("file", "given", "said"),
    [
        ("crank-rocker", "nowhere", "there is no such folder\n  where:  --atlas nowhere"),
        ("crank-rocker", ".", "it holds no atlas of coupler curves"),
        ("crank-rocker", "1", "2 to 1000000"),
        ("crank-rocker", "99999999999", "2 to 1000000"),
        ("crank-rocker", "-5", "no such folder"),
        ("six-bar", "four", "whose linkages have 4 links"),
        ("double-parallelogram-lift", "100", "chains of an atlas have four to eight"),
    ],
)
def test_what_is_no_atlas_for_a_mechanism_is_told(
    file: str, given: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    if given == "four":
        ck.coupler_atlas(4, 100, folder="four")
    name = next(name for name, link in ck.load(file).links.items() if name != "frame" and len(link.points) > 1)
    letter = list(ck.load(file).links[name].points)[1]
    done = run(file, "--free", f"{name}.{letter}.x=1:30", "--least", f"{letter}.x.stroke", f"--atlas={given}")
    assert done.exit_code == 2
    assert said in done.stderr


def test_an_atlas_with_nothing_in_the_ranges_is_told() -> None:
    done = run(*CRANK_ROCKER, "--free", "rocker.C.x=900:901", "--least", "rocker.angle.stroke", "--atlas", "100")
    assert done.exit_code == 2
    assert "no design of the atlas lies within the ranges" in done.stderr


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("--free", "crank.B.x=1:3"), "nothing is said to be least"),
        (("--least", "rocker.angle.stroke"), "no dimension may change"),
        (("--free", "crank.B.x=1", "--least", "rocker.angle.stroke"), "this is no dimension with its bounds"),
        (("--free", "crank.B.x=a:3", "--least", "rocker.angle.stroke"), "a"),
        (("--free", "crank.Q.x=1:3", "--least", "rocker.angle.stroke"), "did you mean 'crank.B.x'?"),
        (("--free", "crank.B.x=1:3,crank.B.x=1:2", "--least", "rocker.angle.stroke"), "given twice"),
        (("--free", "crank.B.x=3:1", "--least", "rocker.angle.stroke"), "crank.B.x"),
        (("--free", "crank.B.x=1:3", "--target", "rocker.angle.stroke"), "no figure with its value"),
        (("--free", "crank.B.x=1:3", "--least", "rocker.angle"), "a value at every pose"),
        (("--free", "crank.B.x=1:3", "--least", "rocker.angle.stroke", "-o", "x.png"), ".png"),
    ],
)
def test_what_is_wrong_is_named(args: tuple[str, ...], said: str) -> None:
    done = run(*CRANK_ROCKER, *args)
    assert done.exit_code == 2
    assert said in done.stderr


def test_a_json_file_is_the_report_and_its_help_says_so(tmp_path: Path) -> None:
    path = tmp_path / "better.json"
    assert (
        run(*CRANK_ROCKER, "--free", "crank.B.x=1:3", "--target", "rocker.angle.stroke=60", "-o", str(path)).exit_code
        == 0
    )
    assert "sections" in json.loads(path.read_text(encoding="utf-8"))
    assert ".csv" not in run("--help").stdout
