"""The verb `atlas` and the options of `structure` that add sections."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), catch_exceptions=False)


def table(result: Result, section: str, kind: str = "table") -> list:
    blocks = json.loads(result.stdout)["sections"][section]["blocks"]
    return next(block["rows"] for block in blocks if block["kind"] == kind)


# Numbers of chains: A. G. Erdman and G. N. Sandor, Advanced Mechanism Design; of trusses and groups: E. E. Peisakh.
@pytest.mark.parametrize(("links", "number", "inversions"), [(4, 1, 1), (6, 2, 5), (8, 16, 71)])
def test_chains_and_inversions(links, number, inversions):
    result = run("atlas", "--links", str(links), "--inversions", "--format", "json")
    assert len(table(result, "chains")) == number
    assert len(table(result, "inversions")) == inversions == sum(row[4] for row in table(result, "chains"))


@pytest.mark.parametrize(("links", "number"), [(3, 1), (5, 1), (7, 3), (9, 28)])
def test_trusses(links, number):
    assert len(table(run("atlas", "--links", str(links), "--trusses", "--format", "json"), "trusses")) == number


@pytest.mark.parametrize(("links", "number"), [(2, 1), (4, 2), (6, 10), (8, 173)])
def test_groups(links, number):
    assert len(table(run("atlas", "--links", str(links), "--groups", "--format", "json"), "assur_groups")) == number


def test_odd_numbers_of_links_have_no_chains_of_mobility_one():
    assert "leaves no whole number of pairs" in " ".join(run("atlas", "--links", "7").stdout.split())


@pytest.mark.parametrize(
    "args", [("--links", "99"), ("--links", "6", "--mobility", "9"), ("--links", "10", "--groups")]
)
def test_lists_that_there_are_not(args):
    result = CliRunner().invoke(cli, ["atlas", *args])
    assert result.exit_code == 2
    assert "there is no list" in result.stderr


def test_alternatives_of_a_structure():
    rows = table(run("structure", "stephenson-ii", "--alternatives", "--format", "json"), "alternatives")
    assert len(rows) == 14
    assert sum(row[-1] for row in rows) == 42
    assert "With this frame no driver" in run("structure", "stephenson-ii", "--alternatives").stdout


def test_equations_are_latex_in_markdown_and_text_in_text():
    assert r"\overline{\text{OA}}\,e^{i\theta_{\text{crank}}}" in run(
        "structure", "slider-crank", "--equations", "--format", "markdown").stdout  # fmt: skip
    assert "OA e^(i crank) + AB e^(i rod) - s(stroke) = 0" in run("structure", "slider-crank", "--equations").stdout
    formulas = json.loads(run("structure", "slider-crank", "--equations", "--format", "json").stdout)
    blocks = formulas["sections"]["equations"]["blocks"]
    assert all("latex" in block for block in blocks if block["kind"] == "formula")
