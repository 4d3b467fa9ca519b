"""Reports of thousands of links are summarised where they are read, whole where that is asked for and in files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.structure import graph

GROUPS = 400


def fan(groups: int) -> ck.Mechanism:
    """A crank that moves so many dyads, each with a rocker of its own: letters alone."""
    crank = ck.link("crank", "A", *(f"B{k}" for k in range(groups)))
    links = [ck.link(f"{name}{k}", *ends(k)) for k in range(groups) for name, ends in DYAD.items()]
    frame = ck.link("frame", "A", *(f"F{k}" for k in range(groups)))
    return ck.Mechanism(f"{groups} dyads", frame, crank, *links, ck.drive("crank"))


DYAD: dict[str, Any] = {"rod": lambda k: (f"B{k}", f"C{k}"), "arm": lambda k: (f"F{k}", f"C{k}")}


@pytest.fixture(scope="module")
def made() -> ck.results.Report:
    return ck.report(ck.decompose(fan(GROUPS)))


def test_text_names_the_first_and_counts_the_rest(made: ck.results.Report) -> None:
    text = made.text()
    # 2 + 2 * 400 links, 1 + 3 * 400 pairs, a paragraph and the frame before the groups
    assert "... and 702 rows more, in the whole report." in text
    assert "... and 1,101 rows more, in the whole report." in text
    assert "... and 302 parts more, in the whole report." in text
    assert len(text.splitlines()) < 1600
    whole = made.text(whole=True)
    assert "in the whole report" not in whole
    assert all(f"rod{k}" in whole for k in range(GROUPS))


def test_markdown_and_json_are_whole(made: ck.results.Report) -> None:
    sections = json.loads(made.json())["sections"]
    assert len(sections["links"]["blocks"][-1]["rows"]) == 2 + 2 * GROUPS
    assert f"rod{GROUPS - 1}" in made.markdown()


@pytest.mark.full
def test_reports_of_a_hundred_links_are_whole_as_they_are() -> None:
    made = ck.report(ck.decompose(fan(49)))
    assert made.text() == made.text(whole=True)


@pytest.mark.parametrize("options", [(), ("--whole",), ("-o", "fan.txt")])
def test_the_command_line_has_a_flag(options: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ck.save(fan(200), "fan.toml")
    found = CliRunner().invoke(cli, ["structure", "fan.toml", *options], catch_exceptions=False)
    assert found.exit_code == 0
    printed = Path("fan.txt").read_text() if "-o" in options else found.stdout
    assert ("in the whole report" in printed) == (not options)


def test_the_links_are_numbered_once_for_all_loops(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not once for each loop: with 20,002 links that took most of a minute."""
    structure, calls = ck.decompose(fan(GROUPS)), []
    own = graph._numbered
    monkeypatch.setattr(graph, "_numbered", lambda links: calls.append(1) or own(links))
    assert len(graph.independent_loops(structure)) == GROUPS
    assert len(calls) == 1
    calls.clear()
    assert sum(1 for _ in graph.simple_loops(structure, limit=20)) == 20
    assert len(calls) == 1


def test_the_centres_of_a_hundred_links_are_refused_with_a_reason() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="100 links have 4,950 instant centres, too many to derive"):
        ck.draw(fan(49), kind="circle")
