from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

import compoundkin.kinematics
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.cli import cli
from compoundkin.files import shipped_mechanisms
from compoundkin.kinematics import Motion

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, list(args), catch_exceptions=False)


def corrupted(motion: Motion, link: str) -> Motion:
    """The motion with the velocity of one link's origin 0.1 % off."""
    pose = motion.poses[link]
    first, second, *rest = pose.z.c
    return replace(motion, poses={**motion.poses, link: Pose(Series((first, second * 1.001, *rest)), pose.u)})


@pytest.mark.parametrize("form", ["text", "markdown", "json"])
def test_a_sound_motion_passes(run: Run, form: str) -> None:
    result = run("check", "six-bar", "--format", form)
    assert result.exit_code == 0
    assert "All 73 poses assembled; all " in result.stdout
    assert "FAIL" not in result.stdout
    assert result.stderr == ""


def test_every_finding_has_value_limit_and_place(run: Run) -> None:
    made = json.loads(run("check", "six-bar", "--step", "15", "--order", "3", "--format", "json").stdout)
    rows = made["sections"]["checks"]["blocks"][-1]["rows"]
    assert made["outcome"]["checks"] == made["outcome"]["checks_passed"] == len(rows)
    assert all(row[1] <= row[2] and row[4] is True for row in rows)
    assert {"closure", "velocity", "acceleration", "jerk"} <= {row[0] for row in rows}


def test_a_wrong_velocity_is_named_with_its_group_and_pose(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    solve = compoundkin.kinematics.solve
    wrong: Any = lambda *given, **more: corrupted(solve(*given, **more), "rod")  # noqa: E731
    monkeypatch.setattr(compoundkin.kinematics, "solve", wrong)
    result = run("check", "slider-crank", "--at", "0,65")
    assert result.exit_code == 4
    assert "checks FAILED" in result.stdout
    said = " ".join(result.stderr.split())
    assert "FAILED: velocity: " in said
    assert "crank 65" in said or "crank 0" in said
    assert "in the RRP group of rod and piston" in said
    assert "What failed" in result.stdout


def test_poses_that_cannot_be_assembled(run: Run) -> None:
    result = run("check", "triple-rocker", "--from", "0", "--to", "180", "--step", "10")
    assert result.exit_code == 3
    assert "Poses that cannot be assembled" in result.stdout
    assert "cannot be assembled" in result.stderr


@pytest.mark.parametrize("args", [("six-bar", "--at", "x"), ("six-bra",), ("six-bar", "--order", "7")])
def test_bad_input_is_told(run: Run, args: tuple[str, ...]) -> None:
    result = run("check", *args)
    assert (result.exit_code, result.stdout) == (2, "")


def test_a_mechanism_that_cannot_be_solved(run: Run, tmp_path: Path) -> None:
    text = shipped_mechanisms.path("crank-rocker").read_text(encoding="utf-8")
    (tmp_path / "undriven.toml").write_text(text.partition("[[drives]]")[0], encoding="utf-8")
    result = run("check", "undriven.toml")
    assert result.exit_code == 2
    assert "What stands in the way" in result.stdout


def test_a_table_is_written_to_a_file(run: Run, tmp_path: Path) -> None:
    result = run("check", "crank-rocker", "-o", "check.md")
    assert (result.exit_code, result.stdout) == (0, "")
    assert "| closure |" in (tmp_path / "check.md").read_text(encoding="utf-8")
