"""`compoundkin plot`: pictures in files and on stdout, and what it says to wrong input; the page that describes it."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

pytest.importorskip("matplotlib")

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.view import plot

PAGE = (Path(__file__).parents[3] / "docs" / "plots.md").read_text("utf-8")
BEGINS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run a command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, ["plot", *args], catch_exceptions=False)


def test_a_file_has_the_plot_that_python_draws(run: Run) -> None:
    found = run("six-bar", "bar.angle", "G.velocity", "-o", "a.svg")
    assert (found.exit_code, found.stderr) == (0, "Wrote a.svg.\n")
    motion = ck.solve(load("six-bar"), order=2)
    assert Path("a.svg").read_bytes() == ck.plot(motion, "bar.angle", "G.velocity").content("svg")


@pytest.mark.parametrize(
    ("args", "draw"),
    [
        (("bar.angle", "--phase"), lambda m: plot.phase(m, "bar.angle")),
        (("G.velocity", "--hodograph", "--every", "9"), lambda m: plot.hodograph(m, "G.velocity", every=9)),
        (("G.speed", "--polar"), lambda m: plot.polar(m, "G.speed")),
        (("G", "C", "--path"), lambda m: plot.paths(m, "G", "C")),
        (("--centrodes", "plate", "frame"), lambda m: plot.centrodes(m, "plate")),
        (
            ("--output", "G.y,G.x", "--together", "--title", "T"),
            lambda m: m.plot("G.y", "G.x", stacked=False, title="T"),
        ),
        (("G.y", "--against", "bar"), lambda m: m.plot("G.y", against="bar")),
        (
            ("G.speed", "--log", "y", "--x-limits", "90", "270", "--y-limits", "1", "400", "--with", "six-bar"),
            lambda m: ck.plot([m, m], "G.speed", log="y", xlim=(90, 270), ylim=(1, 400), designs=["six-bar"] * 2),
        ),
    ],
    ids=lambda what: " ".join(what) if isinstance(what, tuple) else "",
)
def test_stdout_has_an_svg_of_any_kind(
    run: Run, args: tuple[str, ...], draw: Callable[[ck.results.Motion], plot.Plot]
) -> None:
    found = run("six-bar", *args)
    assert found.exit_code == 0, found.stderr
    assert found.stdout_bytes == draw(ck.solve(load("six-bar"), order=2)).content("svg")


def test_the_order_is_what_the_quantities_need(run: Run) -> None:
    assert run("six-bar", "bar.angular_acceleration", "--phase", "-o", "a.png").exit_code == 0
    assert run("six-bar", "G.jerk.x", "--against", "G.x", "-o", "a.png").exit_code == 0
    low = run("six-bar", "G.jerk", "--order", "2", "-o", "a.png")
    assert low.exit_code == 2
    assert "order" in low.stderr


def test_gaps_are_drawn_and_explained(run: Run) -> None:
    found = run("triple-rocker", "--from", "0", "--to", "120", "--step", "1", "-o", "a.png")
    assert found.exit_code == 3
    assert "|BD|" in found.stderr
    assert Path("a.png").read_bytes().startswith(BEGINS[".png"])


@pytest.mark.parametrize(
    ("args", "told"),
    [
        (("six-bar", "bar.angel"), "did you mean 'bar.angle'?"),
        (("six-bra", "bar"), "did you mean 'six-bar'?"),
        (("six-bar", "bar", "-o", "a.gif"), "plots end in .png, .svg, .pdf"),
        (("six-bar", "bar", "-o", "no/a.png"), "cannot be written"),
        (("six-bar", "bar", "--phase", "--polar"), "a plot is of one kind"),
        (("six-bar", "bar", "--phase", "--against", "time"), "does not go with --phase"),
        (("six-bar", "bar", "--every", "3"), "marks curves in a plane"),
        (("six-bar", "bar", "G", "C", "--phase"), "there are 3 quantities"),
        (("six-bar", "bar", "--centrodes", "plate", "frame"), "centrodes take no quantities"),
        (("six-bar", "--centrodes", "plaet", "frame"), "did you mean 'plate'?"),
        (("six-bar", "bar", "--against", "tme"), "did you mean 'time'?"),
        (("six-bar", "bar", "--at", "30"), "single pose"),
    ],
    ids=lambda what: " ".join(what) if isinstance(what, tuple) else what,
)
def test_mistakes_are_explained(run: Run, args: tuple[str, ...], told: str) -> None:
    found = run(*args)
    assert found.exit_code == 2
    assert told in " ".join(found.stderr.split())
    assert not list(Path().iterdir())


@pytest.mark.full
def test_the_examples_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code = "\n".join(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
    exec(compile(code, "plots.md", "exec"), {})
    named = re.findall(r'save\(\s*"(.*?)"\s*\)', code)
    assert len(named) == 15
    for name in named:
        assert Path(name).read_bytes().startswith(BEGINS[Path(name).suffix])


@pytest.mark.full
@pytest.mark.parametrize("line", re.findall(r"^    compoundkin plot (.*)$", PAGE, re.MULTILINE))
def test_the_commands_of_the_page_run(run: Run, line: str) -> None:
    found = run(*shlex.split(line.partition(" > ")[0]))
    assert found.exit_code == (3 if line.startswith("triple-rocker") else 0), found.stderr


def test_fine_steps_are_drawn_as_asked_for(run: Run) -> None:
    found = run("six-bar", "bar.angle", "--from", "0", "--to", "90", "--step", "1")
    motion = ck.solve(load("six-bar"), np.deg2rad(np.arange(0.0, 91.0)), order=2)
    assert found.stdout_bytes == ck.plot(motion, "bar.angle").content("svg")
