"""The pages on pictures, on circuits, on a press drive and others are true: read from the top, their Python runs."""

from __future__ import annotations

import inspect
import re
import shlex
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.dimensional import curve_fitting, sampled_functions, sampled_motions
from compoundkin.files import loads

DOCS = Path(__file__).parents[1] / "docs"
READERS = ["for-students.md", "for-engineers.md", "for-programmers.md"]
TASKS = "first-tasks.md"
# Of the searches for linkages: what pages print holds for fewer designs too, which take half the time or less.
FEWER: dict[Any, dict[str, int]] = {
    curve_fitting: {"DESIGNS": 20_000, "STARTED": 50, "ROUNDS": 1, "GIVEN": 2},
    sampled_functions: {"DESIGNS": 20_000},
    sampled_motions: {"DESIGNS": 20_000},
}


@pytest.fixture
def fewer_designs(monkeypatch: pytest.MonkeyPatch) -> None:
    for module, values in FEWER.items():
        for name, value in values.items():
            monkeypatch.setattr(module, name, value)


@pytest.mark.parametrize(
    "page",
    [
        "pictures.md",
        "circuits.md",
        "press-drive.md",
        "machine.md",
        pytest.param("simulation.md", marks=pytest.mark.full),
    ],
)
def test_the_python_of_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line[4:] for line in (DOCS / page).read_text("utf-8").splitlines() if line.startswith("    ")]
    assert len(lines) > 10
    exec("\n".join(line for line in lines if not line.startswith("compoundkin ")), {})


def test_the_page_on_loads_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "loads.md").read_text("utf-8")
    exec("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), {})
    printed = capsys.readouterr().out
    assert all(shown in printed for shown in re.findall(r"```text\n(.*?)```", page, re.DOTALL))
    assert "mass centre and inertia of a uniform bar A-B\n(15+0j) 30.0\n" in printed


@pytest.mark.full
@pytest.mark.usefixtures("fewer_designs")
def test_the_page_on_synthesis_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "synthesis.md").read_text("utf-8")
    names: dict[str, Any] = {}
    for code, shown in re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", page, re.DOTALL):
        exec(code, names)
        assert capsys.readouterr().out == shown


@pytest.mark.parametrize("page", [*READERS, TASKS])
def test_ten_minutes_of_a_reader_are_true(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text, names, shown = (DOCS / page).read_text("utf-8"), dict[str, Any](), ""
    for kind, block in re.findall(r"```(python|text)\n(.*?)```", text, re.DOTALL):
        if kind == "python":
            exec(block, names)
            shown = capsys.readouterr().out
        else:
            assert shown == block


@pytest.mark.full
@pytest.mark.parametrize("page", READERS)
def test_the_commands_of_a_reader_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for block in re.findall(r"```sh\n(.*?)```", (DOCS / page).read_text("utf-8"), re.DOTALL):
        for line in block.splitlines():
            words = shlex.split(line)[1:]
            if not (words[-1].endswith(".dxf") and not find_spec("ezdxf")):
                ran = CliRunner().invoke(cli, words)
                assert ran.exit_code == 0, f"{line}\n{ran.output}"


def test_the_page_on_outlines_prints_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec("\n".join(re.findall(r"```python\n(.*?)```", (DOCS / "outlines.md").read_text("utf-8"), re.DOTALL)), {})
    assert capsys.readouterr().out.splitlines() == [
        "2 pairs of links touch",
        "crank and frame touch from 335.6721 to 16.6997 degrees",
        "pin B and frame touch from 341.8859 to 10.4859 degrees",
        "rocker and frame come to 5.2737",
    ]


def test_the_page_on_machines_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "machine.md").read_text("utf-8")
    lines = [line[4:] for line in page.splitlines() if line.startswith("    ")]
    names: dict[str, Any] = {}
    exec("\n".join(lines[: lines.index("print(balance.text())")]), names)
    assert names["balance"].text() in page


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of JAX's own
def test_the_page_on_compiled_programs_is_true(tmp_path: Path) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "compiled.md").read_text("utf-8"), re.DOTALL)
    names: dict[str, Any] = {}
    for block in blocks:
        if "import jax" not in block or find_spec("jax"):
            exec(block, names)
    # the task was led to what it was made of, and the slopes are those of solving
    assert np.allclose(names["best"].x, names["wanted"], rtol=1e-6)
    turn, at = names["turn"], names["worst"]
    motion = ck.solve(names["six_bar"], turn, speed=10, modes=names["path"].modes)
    assert np.allclose(names["places"], motion.points["G"].position, rtol=1e-12, atol=0)
    for name, slope in zip(names["found"].by, names["slopes"], strict=True):
        stated = names["path"].programs.stated
        own = float(stated.own(stated.known[name]))
        near = [ck.compile(names["six_bar"], "bar.angle", free=name).mechanism({name: own + h}) for h in (1e-4, -1e-4)]
        angles = [ck.solve(one, turn[at], modes=names["path"].modes).links["bar"].angle for one in near]
        assert float(angles[0] - angles[1]) / 2e-4 == pytest.approx(float(slope[at]), rel=1e-7)


@pytest.mark.parametrize(
    "page",
    [
        *(pytest.param(page, marks=pytest.mark.full) for page in ("studies.md", "optimisation.md")),
        "exchange/index.md",
        "exchange/geogebra.md",
    ],
)
def test_the_pages_on_many_designs_and_other_programs_print_what_they_show(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    text = (DOCS / page).read_text("utf-8")
    for code, shown in re.findall(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", text, re.DOTALL):
        exec(code, names)
        printed = capsys.readouterr().out
        assert shown in ("", printed)


@pytest.mark.full
@pytest.mark.usefixtures("fewer_designs")
def test_the_page_on_sketches_is_true(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    text = (DOCS / "from-a-sketch.md").read_text("utf-8")
    for code, shown in re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", text, re.DOTALL):
        exec(code, names)
        assert capsys.readouterr().out == shown
    assert {"walking-leg.svg", "film-advance.svg"} == {path.name for path in tmp_path.glob("*.svg")}


def test_the_page_on_data_sets_prints_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    text = (DOCS / "data-sets.md").read_text("utf-8")
    parts = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", text, re.DOTALL)
    assert len(parts) == 7
    for code, shown in parts:
        # readers that no extra of the package installs run where they are
        if all(find_spec(one) for one in ("polars", "duckdb", "torch") if f"import {one}" in code):
            exec(code, names)
            assert capsys.readouterr().out == shown


def test_the_page_on_optimisation_names_all_goals() -> None:
    text = (DOCS / "optimisation.md").read_text("utf-8")
    assert set(re.findall(r"ck\.goals\.(\w+)", text)) == set(ck.goals.__all__)


def test_the_words_for_profiles_are_named_with_their_module() -> None:
    for page in DOCS.glob("*.md"):
        if page.stem in ("synthesis", "cli"):  # of linkages: its verb and its tool have that name
            continue
        bare = re.findall(r"`(?:disc|profile|formula|synthesise|cam_analysis)`", page.read_text("utf-8"))
        assert bare == [], page.name


def test_the_help_of_an_arc_names_its_parameters() -> None:
    named = re.findall(r"`(\w+)`", (ck.arc.__doc__ or "").partition("Held:")[0])
    assert "centre_at" in named
    assert set(named) <= set(inspect.signature(ck.arc).parameters)


def test_the_paper_cites_what_its_bibliography_has() -> None:
    paper = DOCS.parent / "paper"
    text, bibliography = ((paper / name).read_text("utf-8") for name in ("paper.md", "paper.bib"))
    assert set(re.findall(r"@(\w+)", text)) == set(re.findall(r"^@\w+\{(\w+),", bibliography, re.MULTILINE))
    assert all((paper / picture).is_file() for picture in re.findall(r"\]\((\w+\.png)\)", text))


def test_the_first_tasks_have_files_that_work_and_commands_that_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each file is solved as it stands; the words of each command are read, what they do is tested verb by verb."""
    monkeypatch.chdir(tmp_path)
    text = (DOCS / TASKS).read_text("utf-8")
    press, triad, swapped = map(loads, re.findall(r"```toml\n(.*?)```", text, re.DOTALL))
    assert [len(one.links) for one in (press, triad, swapped)] == [6, 6, 4]
    assert all(ck.solve(one).assembled.all() for one in (press, triad, swapped))
    assert [group.class_ for group in ck.decompose(triad).groups] == [3]
    side = np.sqrt(20**2 + 30**2)  # of the plate: its third corner from both others
    assert f"{side:.2f}" in text
    commands = [line for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    assert len(commands) > 20
    for line in commands:
        verb, *words = shlex.split(line, comments=True)[1:]
        command = cli.get_command(click.Context(cli), verb)
        assert command is not None, line
        command.make_context(verb, words)  # raises UsageError for what there is not
