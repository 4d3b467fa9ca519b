"""`save`: everything that can be saved, in every form of the one table of suffixes, and what else is told."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.base.suffixes import READ_ALONE, SUFFIXES, file_format
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.programs.compiled_path import compile


@cache
def motion() -> ck.results.Motion:
    return ck.solve(load("crank-rocker"), {"crank": ck.deg([0, 20, 40])})


MAKERS: dict[str, Callable[[], Any]] = {
    "mechanism": lambda: load("crank-rocker"),
    "table": lambda: motion().table("rocker.angle"),
    "picture": lambda: ck.draw(motion(), size=60),
    "plot": lambda: motion().plot("rocker.angle"),
    "animation": lambda: motion().animate(size=60, seconds=0.2),
    "page": lambda: ck.report(motion()).page(),
    "report": lambda: ck.report(motion()),
    "program": lambda: compile(load("crank-rocker"), "rocker.angle"),
    "study": lambda: ck.study(load("crank-rocker"), {"crank.B.x": (1.8, 2.2)}, ["rocker.angle"], count=8),
}
BEGINS = {
    "toml": b"format = 1", "csv": b"crank.value [deg],rocker.angle [deg],assembled\n", "npz": b"PK", "parquet": b"PAR1",
    "png": b"\x89PNG", "pdf": b"%PDF", "gif": b"GIF8", "html": b"<!DOCTYPE html>", "markdown": b"# ", "json": b"{",
    "c": b"/*", "python": b'"""', "javascript": b"/*", "matlab": b"function out = ",
}  # fmt: skip
SAVED = [kind for kind in SUFFIXES if kind not in READ_ALONE]
ALL = [(kind, suffix) for kind in SAVED for suffix in SUFFIXES[kind]]


@pytest.mark.parametrize(("kind", "suffix"), ALL)
def test_everything_is_saved_in_every_form_of_the_table(kind: str, suffix: str, tmp_path: Path) -> None:
    if suffix == ".mp4" and not shutil.which("ffmpeg"):
        pytest.skip("there is no ffmpeg")
    path = tmp_path / f"a{suffix.upper()}"
    ck.save(MAKERS[kind](), path)
    content = path.read_bytes()
    form = SUFFIXES[kind][suffix]  # type: ignore[index]
    assert content.startswith(BEGINS.get(form, b""))
    assert len(content) > 100 or kind == "table"


def test_a_motion_is_saved_as_its_whole_table(tmp_path: Path) -> None:
    ck.save(motion(), tmp_path / "motion.csv")
    ck.save(motion().table(), tmp_path / "table.csv")
    assert (tmp_path / "motion.csv").read_bytes() == (tmp_path / "table.csv").read_bytes()


@pytest.mark.parametrize(
    ("kind", "name", "told"),
    [
        ("plot", "a.gif", "a plot is not saved as '.gif', an animation is; plots end in .png, .svg, .pdf"),
        ("table", "a.xlsx", "a table is not saved as '.xlsx'; tables end in .csv, .json, .npz, .parquet"),
        ("picture", "a", "the file has no suffix; pictures end in .svg, .png, .pdf, .tex"),
        ("mechanism", "a.md", "a mechanism is not saved as '.md', a report is; mechanism files end in .toml, .json"),
        ("page", "a.json", "a mechanism, a table, a report and a study are; pages end in .html"),
        ("report", "a.csv", "a report is not saved as '.csv', a table is; reports end in .txt, .md, .json, .html"),
    ],
)
def test_a_wrong_suffix_is_told_what_can_be_saved_so(kind: str, name: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(ck.errors.InvalidInput) as error:
        ck.save(MAKERS[kind](), tmp_path / name)
    assert told in str(error.value)
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_saved_is_told_what_can(tmp_path: Path) -> None:
    with pytest.raises(
        ck.errors.InvalidInput, match=r"a list cannot be saved; mechanism files end in .*; tables end in .*; "
    ):
        ck.save([1, 2], tmp_path / "a.csv")


def test_pages_and_reports_need_no_suffix(tmp_path: Path) -> None:
    ck.save(MAKERS["page"](), tmp_path / "page")
    ck.save(MAKERS["report"](), tmp_path / "report")
    assert (tmp_path / "page").read_text().startswith("<!DOCTYPE html>")
    assert (tmp_path / "report").read_text() == ck.report(motion()).text()


@pytest.mark.parametrize("kind", SAVED)
def test_a_file_that_cannot_be_written_is_told(kind: str, tmp_path: Path) -> None:
    with pytest.raises(ck.errors.InvalidInput, match="cannot be written"):
        ck.save(MAKERS[kind](), tmp_path / "missing" / f"a{next(iter(SUFFIXES[kind]))}")  # type: ignore[index]


@pytest.mark.parametrize(("verb", "kind"), [("solve", "table"), ("draw", "picture"), ("plot", "plot")])
def test_the_command_line_refuses_what_python_refuses_before_it_solves(verb: str, kind: str) -> None:
    result = CliRunner().invoke(cli, [verb, "six-bar", "-o", "a.xyz"], standalone_mode=False)
    assert isinstance(result.exception, ck.errors.InvalidInput)
    assert f"a {kind} is not saved as '.xyz'" in str(result.exception)


@pytest.mark.parametrize("suffix", [".pdf", ".svg", ".csv", ".toml"])
@pytest.mark.parametrize("verb", ["report", "structure", "centres", "configurations", "circuits", "check", "atlas"])
def test_a_report_of_the_command_line_is_refused_before_its_mechanism_is_read(
    verb: str, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    what = ["--links", "4"] if verb == "atlas" else ["no-such-mechanism"]
    result = CliRunner().invoke(cli, [verb, *what, "-o", f"a{suffix}"], standalone_mode=False)
    with pytest.raises(ck.errors.InvalidInput) as in_python:
        file_format("report", f"a{suffix}")
    assert isinstance(result.exception, ck.errors.InvalidInput)
    assert str(result.exception) == str(in_python.value)
    assert not list(tmp_path.iterdir())


def test_a_report_without_suffix_is_text_and_a_format_that_is_given_rules(tmp_path: Path) -> None:
    runner, text = CliRunner(), ck.report(ck.decompose(load("crank-rocker"))).text()
    for name, options in (("plain", []), ("a.log", ["--format", "text"])):
        asked = ["structure", "crank-rocker", "-o", str(tmp_path / name), *options]
        assert runner.invoke(cli, asked, standalone_mode=False).exception is None
        assert (tmp_path / name).read_text() == text


def test_the_page_on_files_lists_what_can_be_saved_as_what() -> None:
    page = (Path(__file__).parents[2] / "docs" / "file-format.md").read_text(encoding="utf-8")
    rows = page.partition("## What can be saved as what")[2].splitlines()
    told = [re.findall(r"`(\.\w+)`", row) for row in rows if row.startswith("| a")]
    assert told == [list(SUFFIXES[kind]) for kind in SAVED]
