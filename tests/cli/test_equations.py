"""`compoundkin structure NAME --equations`, in symbols and with numbers."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli

Run = Callable[..., Result]
CRANK, ROD = 0.12, 0.26


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, ["structure", *args], catch_exceptions=False)


def tables(result: Result, key: str) -> list[list[list[Any]]]:
    """The rows of all tables of a section."""
    blocks = json.loads(result.stdout)["sections"][key]["blocks"]
    return [block["rows"] for block in blocks if block["kind"] == "table"]


def formulas(result: Result, key: str) -> list[tuple[str, str]]:
    blocks = json.loads(result.stdout)["sections"][key]["blocks"]
    return [(block["text"], block["latex"]) for block in blocks if block["kind"] == "formula"]


def test_equations_and_numbers_of_the_slider_crank(run: Run) -> None:
    """Closed form: in the book's own quantities, P. E. Nikravesh, AME 352 notes."""
    result = run("slider-crank", "--equations", "--order", "2", "--at", "35", "--speed", "2", "--format", "json")
    assert result.exit_code == 0
    (matrix, latex), (first, _), (second, right) = formulas(result, "rates")
    assert matrix == "[ -AB sin(rod)  -1 ]\n[  AB cos(rod)   0 ]"
    assert latex.startswith(r"A = \begin{bmatrix} -\overline{\text{AB}}\,\sin \theta_{\text{rod}} & -1 \\ ")
    assert first.split("\n")[1] == "AB rod' cos(rod) = -OA crank' cos(crank)"
    assert "crank'^2" in second
    assert r"\ddot{s}_{\text{stroke}}" in right
    crank, omega = np.deg2rad(35.0), 2.0
    rod = -np.arcsin(CRANK * np.sin(crank) / ROD)
    numbers, values = tables(result, "pose")
    along = CRANK * omega * np.array([np.sin(crank), -np.cos(crank)])
    assert numbers[0][:4] == pytest.approx(["loop 1 x", -ROD * np.sin(rod), -1.0, along[0]])
    assert numbers[1][:4] == pytest.approx(["loop 1 y", ROD * np.cos(rod), 0.0, along[1]])
    rate = along[1] / (ROD * np.cos(rod))
    shown = {row[0]: row[1:] for row in values}
    assert shown["rod"][:4] == pytest.approx([np.rad2deg(rod), "deg", rate, "rad/s"])
    assert shown["s(stroke)"][2] == pytest.approx(-ROD * np.sin(rod) * rate - along[0])
    assert shown["crank"] == [pytest.approx(35.0), "deg", 2.0, "rad/s", 0.0, "rad/s^2", "given"]


def test_newton_and_freudenstein_of_a_four_bar(run: Run) -> None:
    """R. L. Norton, Design of Machinery, example 4-1: 20.298 and 57.325 deg; K1 = 2.5, K2 = 1.25, K3 = 0.5625."""
    result = run("four-bar-norton", "--equations", "--at", "40", "--newton", "--estimate", "coupler=30",
                 "--estimate", "rocker=70", "--format", "json")  # fmt: skip
    assert result.exit_code == 0
    (steps,) = tables(result, "newton")
    assert steps[0][1:3] == pytest.approx([30.0, 70.0])
    assert steps[-1][1:3] == pytest.approx([20.298, 57.325], abs=1e-3)
    assert steps[-1][-1] is None
    assert len(steps) < 8
    text = run("four-bar-norton", "--equations", "--at", "40", "--newton").stdout
    assert "K1 = 2.5, K2 = 1.25, K3 = 0.5625, K4 = 0.833333, K5 = -2.04167." in " ".join(text.split())
    assert "This is the pose that the groups give one by one." in text
    other = run("four-bar-norton", "--equations", "--at", "40", "--newton", "--estimate", "coupler=-60",
                "--estimate", "rocker=-100").stdout  # fmt: skip
    assert "another configuration" in other


def test_rates_of_norton(run: Run) -> None:
    """R. L. Norton, Design of Machinery, examples 6-7 and 7-1: -4.121, 6.998 rad/s; 296.089, 470.134 rad/s^2."""
    rates = "--speed", "25", "--acceleration", "15"
    result = run("four-bar-norton", "--equations", "--order", "2", "--at", "40", *rates, "--format", "json")
    shown = {row[0]: (row[3], row[5]) for row in tables(result, "pose")[1]}
    assert shown["coupler"] == pytest.approx((-4.121, 296.089), abs=1e-3)
    assert shown["rocker"] == pytest.approx((6.998, 470.134), abs=1e-3)
    assert shown["crank"] == (25.0, 15.0)


def test_several_drivers(run: Run) -> None:
    result = run("five-bar", "--equations", "--order", "1", "--at", "left=60", "--at", "right=100", "--format", "json")
    assert result.exit_code == 0
    shown = {row[0]: row[1] for row in tables(result, "pose")[1]}
    assert (shown["left"], shown["right"]) == pytest.approx((60.0, 100.0))


def test_a_pose_out_of_reach_is_explained(run: Run) -> None:
    result = run("double-rocker", "--equations", "--order", "2", "--at", "170", "--newton")
    assert result.exit_code == 3
    assert "does not close" in result.stdout
    assert "No pose was found" in result.stdout


def test_a_limit_position_is_said(run: Run) -> None:
    result = run("parallelogram", "--equations", "--order", "1", "--at", "0")
    assert result.exit_code == 0
    assert "The matrix is singular" in result.stdout


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--order", "2"), "add --equations"),
        (("--at", "35"), "add --equations"),
        (("--newton",), "add --equations"),
        (("--equations", "--estimate", "rod=3"), "add --newton"),
        (("--equations", "--order", "3"), "3 is not in the range"),
        (("--equations", "--order", "-1"), "-1 is not in the range"),
        (("--equations", "--at", "crnk=35"), "there is no driver 'crnk'"),
        (("--equations", "--at", "35,40"), "a single pose"),
        (("--equations", "--newton", "--estimate", "rot=3"), "'rod'"),
        (("--equations", "--newton", "--estimate", "3"), "write NAME=VALUE"),
        (("--equations", "--newton", "--estimate", "rod=x"), "'x' is not a number"),
        (("--equations", "--newton", "--estimate", "rod=1", "--estimate", "rod=2"), "twice"),
        (("--equations", "--at", "35", "--design", "2"), "there is no design 2"),
        (("--equations", "--at", "35", "--speed", "3"), "add --order 1"),
        (("--equations", "--order", "1", "--acceleration", "3"), "add --order 2"),
    ],
)
def test_what_does_not_go_together(run: Run, options: tuple[str, ...], said: str) -> None:
    result = run("slider-crank", *options)
    assert result.exit_code == 2
    assert said in result.stderr
    assert "Traceback" not in result.stderr


def test_a_rate_of_several_drivers_is_told_to_have_a_name(run: Run) -> None:
    """The remedy was an option that the verb does not have."""
    result = run("five-bar", "--equations", "--order", "1", "--speed", "2")
    assert result.exit_code == 2
    assert "write NAME=VALUE, NAME one of left, right" in result.stderr


def test_the_whole_catalog_is_written(run: Run) -> None:
    """Of every kind of row one: cams, gears, racks, wheels, drivers between links, more rows than unknowns, none."""
    for name in ("oscillating-flat-follower", "rack-and-pinion-steering", "rolling-wheel", "double-parallelogram-lift",
                 "planetary-train", "excavator-arm", "v8-engine"):  # fmt: skip
        result = run(name, "--equations", "--order", "2", "--newton")
        assert result.exit_code == 0, name
        assert max(map(len, result.stdout.split("\n"))) <= 80, name
