"""The verbs `configurations` and `circuits`."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), catch_exceptions=False)


def rows(result: Result, key: str) -> list[dict[str, Any]]:
    blocks = json.loads(result.stdout)["sections"][key]["blocks"]
    found = next(block for block in blocks if block["kind"] == "table")
    return [dict(zip([column["name"] for column in found["columns"]], row, strict=True)) for row in found["rows"]]


def test_configurations_of_a_crank_rocker_close() -> None:
    result = run("configurations", "crank-rocker", "--at", "60", "--format", "json")
    assert result.exit_code == 0
    found = rows(result, "configurations")
    assert [row["configuration"] for row in found] == ["RRR(coupler)+", "RRR(coupler)-"]
    # both modes are mirror images in the line from the crank pin to the rocker's pin
    sums = [row["coupler"] + row["rocker"] for row in found]
    assert np.cos(np.deg2rad(sums[0] - sums[1])) != pytest.approx(0.0)
    assert found[0]["coupler"] != pytest.approx(found[1]["coupler"])


@pytest.mark.parametrize("form", ["text", "markdown", "json"])
def test_circuits_of_a_triple_rocker(form: str) -> None:
    result = run("circuits", "triple-rocker", "--format", form)
    assert result.exit_code == 0
    assert "1 circuit, 2 branches, 2 limit positions" in " ".join(result.stdout.split())


def test_limits_name_their_group() -> None:
    result = run("circuits", "stephenson-iii", "--format", "json")
    assert {row["group"] for row in rows(result, "limits")} == {"RRR (EF, FG)", "RRR (BCE, CD)"}
    assert [row["branches"] for row in rows(result, "circuits")] == [4, 2]
    assert all(row["from"] < row["to"] for row in rows(result, "branches"))


def test_a_range_in_degrees() -> None:
    result = run("circuits", "crank-rocker", "--from", "10", "--to", "50", "--format", "json")
    assert {(round(row["from"], 9), round(row["to"], 9)) for row in rows(result, "branches")} == {(10.0, 50.0)}
    assert {row["ended by"] for row in rows(result, "branches")} == {"the end of the range"}


@pytest.mark.parametrize(
    ("args", "code", "text"),
    [
        (("circuits", "five-bar"), 2, "name one"),
        (("circuits", "five-bar", "--driver", "lft"), 2, "did you mean 'left'"),
        (("circuits", "crank-rocker", "--from", "10"), 2, "give both"),
        (("configurations", "triple-rocker", "--at", "180"), 3, "the nearest value is"),
    ],
)
def test_mistakes(args: tuple[str, ...], code: int, text: str) -> None:
    result = run(*args)
    assert (result.exit_code, text in result.stderr) == (code, True), result.output


def test_singularities_of_a_parallelogram() -> None:
    result = run("singularities", "parallelogram", "--format", "json")
    assert result.exit_code == 0, result.output
    assert [row["kind"] for row in rows(result, "singularities")] == ["change point"] * 2
    assert "2 branches meet" in run("singularities", "parallelogram").stdout
    assert "velocity of C" in run("draw", "parallelogram", "--singularities").stdout
    assert run("draw", "parallelogram", "--singularities", "--at", "35").exit_code == 2


def test_singularities_beside_a_gap() -> None:
    result = run("singularities", "triple-rocker", "--from", "-180", "--to", "180", "--step", "5")
    assert result.exit_code == 3, result.output
    assert result.stdout.count("limit position") == 2
