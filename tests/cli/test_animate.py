"""`compoundkin animate`: files and stdout, and what it says to wrong input; the page that describes it."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli, shell
from compoundkin.files import load
from tests import catalog

PAGE = (Path(__file__).parents[2] / "docs" / "animation.md").read_text("utf-8")

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, ["animate", *args], catch_exceptions=False)


def test_stdout_has_what_python_makes(run: Run) -> None:
    found = run("six-bar", "--path", "G", "--vectors", "velocity", "--seconds", "3")
    motion = catalog.motion("six-bar")
    assert (found.exit_code, found.stderr) == (0, "")
    assert found.stdout == motion.animate(paths="G", vectors="velocity", seconds=3).svg


def test_forces_are_those_of_python(run: Run) -> None:
    found = run("engine-gas-pressure", "--forces", "--at", "0:90:30")
    forces = ck.force_analysis(ck.solve(ck.load("engine-gas-pressure"), {"crank": ck.deg([0, 30, 60, 90])}))
    assert (found.exit_code, found.stdout) == (0, ck.animate(forces).svg)
    assert run("six-bar", "--forces").exit_code == 2  # it has no units of forces


def test_a_file_has_it_too(run: Run) -> None:
    found = run("six-bar", "--at", "0,120,240", "--size", "80", "--no-labels", "-o", "a.gif")
    assert (found.exit_code, found.stdout, found.stderr) == (0, "", "Wrote a.gif.\n")
    assert Path("a.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("six-bar", "-o", "a.avi"), "not saved as '.avi'"),
        (("six-bar", "-o", "none/a.gif"), "there is no folder none"),
        (("six-bar", "--path", "Q"), "no such point"),
        (("six-bar", "--fps", "0"), "does not fit"),
        (("six-bar", "--seconds", "-1"), "does not fit"),
        (("six-bar", "--vectors", "speed"), "'speed' is not one of"),
        (("six-bar", "--design", "3"), "no design 3"),
        (("six-bar", "--order", "0", "--vectors", "velocity"), "solved to order 0"),
        (("no-such-mechanism",), "no-such-mechanism"),
    ],
)
def test_wrong_input_is_told_and_leaves_no_file(run: Run, args: tuple[str, ...], said: str) -> None:
    found = run(*args)
    assert (found.exit_code, found.stdout) == (2, "")
    assert said in found.stderr
    assert not list(Path().iterdir())


def test_gaps_are_left_out_and_explained(run: Run) -> None:
    found = run("triple-rocker", "--from", "0", "--to", "120", "--step", "1", "-o", "a.svg")
    assert found.exit_code == 3
    assert "32 of 121 poses cannot be assembled" in found.stderr
    assert "|BD|" in found.stderr
    assert Path("a.svg").read_text("utf-8").startswith("<svg")


def test_no_pose_at_all_is_no_file(run: Run) -> None:
    found = run("triple-rocker", "--from", "100", "--to", "120", "-o", "a.svg")
    assert found.exit_code == 3
    assert not list(Path().iterdir())


def test_progress_is_shown_on_a_terminal_that_has_to_wait(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    with shell.counting("drawing", "frames", patience=0.0) as told:
        told(1, 3)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with shell.counting("drawing", "frames", patience=1000.0) as told:
        told(1, 3)
    assert capsys.readouterr().err.strip() == ""
    with shell.counting("drawing", "frames", patience=0.0) as told:
        told(1, 3)
        told(2, 3)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "2/3" in shown.err


def test_the_commands_of_the_page_are_understood() -> None:
    commands = re.findall(r"^    compoundkin (animate .*)$", PAGE, re.MULTILINE)
    assert len(commands) >= 5
    for line in commands:
        name, *args = shlex.split(line, comments=True)
        context = cli.get_command(None, name).make_context(name, args, resilient_parsing=False)  # type: ignore[arg-type,union-attr]
        load(context.params["file"])


def test_the_python_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"(?:^    (?!compoundkin ).*\n)+", PAGE, re.MULTILINE)
    names: dict[str, object] = {}
    for block in blocks:
        lines = [line[4:] for line in block.splitlines() if ".gif" not in line and ".mp4" not in line]
        exec("\n".join(lines), names)
    assert Path("six-bar.svg").read_text("utf-8").startswith("<svg")


def test_a_short_range_of_its_own_is_shown_finely(run: Run) -> None:
    assert run("five-bar").stdout == ck.animate(load("five-bar")).svg
    coarse = run("five-bar", "--drive", "left=60:120:3", "--drive", "right=75:105:1.5")
    assert coarse.stdout == catalog.motion("five-bar").animate().svg
