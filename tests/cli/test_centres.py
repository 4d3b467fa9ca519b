from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli
from compoundkin.files import shipped_mechanisms
from tests import catalog

Run = Callable[..., Result]
CRANK, ROD = 0.12, 0.26


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, list(args), catch_exceptions=False)


def table(result: Result, key: str) -> dict[str, dict[str, Any]]:
    """The rows of a section's table by their first cells."""
    blocks = json.loads(result.stdout)["sections"][key]["blocks"]
    found = next(block for block in blocks if block["kind"] == "table")
    heads = [column["name"] for column in found["columns"]]
    return {row[0]: dict(zip(heads, row, strict=True)) for row in found["rows"]}


@pytest.mark.parametrize("angle", [20, 65, 135, 250])
def test_the_slider_crank_has_the_centres_of_the_textbook(run: Run, angle: int) -> None:
    result = run("centres", "slider-crank", "--at", str(angle), "--format", "json")
    assert result.exit_code == 0
    t = np.deg2rad(angle)
    pin = CRANK * np.exp(1j * t)
    slider = pin.real + np.sqrt(ROD**2 - pin.imag**2)
    primary, secondary = table(result, "primary"), table(result, "secondary")
    assert len(primary) + len(secondary) == 6
    # the guide is along x: the centre of piston and frame is at infinity along its normal
    guide = primary["(frame piston)"]
    assert (guide["x"], guide["y"]) == (None, None)
    assert guide["at infinity, direction"] == pytest.approx(90.0)
    # crank line x normal at the slider
    rod = secondary["(frame rod)"]
    assert (rod["x"], rod["y"]) == pytest.approx((slider, slider * np.tan(t)), rel=1e-9)
    assert rod["lines"] == "(frame crank)(crank rod) x (frame piston)(piston rod)"
    # crank and piston: where the line of the rod meets the normal of the guide through the pivot
    piston = secondary["(crank piston)"]
    assert piston["x"] == pytest.approx(0.0, abs=1e-12)
    assert piston["y"] == pytest.approx(pin.imag * slider / (slider - pin.real), rel=1e-9)
    ratio = table(result, "velocities")["rod"]
    assert ratio["from centres"] == pytest.approx(-pin.real / (slider - pin.real), rel=1e-9)
    assert ratio["as solved"] == pytest.approx(ratio["from centres"], rel=1e-9)


def test_primary_centres_name_their_pairs_and_come_first(run: Run) -> None:
    result = run("centres", "six-bar", "--at", "35")
    assert result.exit_code == 0
    assert result.stdout.index("Primary centres") < result.stdout.index("Secondary centres")
    assert "N = n (n - 1) / 2 = 6 * 5 / 2 = 15" in result.stdout
    assert "7 of the 15 centres are primary, 8 secondary." in result.stdout
    assert "prismatic pair slot" in result.stdout
    assert "conditioning" not in result.stdout


def test_without_a_pose_it_is_the_first_of_the_file(run: Run) -> None:
    assert run("centres", "stephenson-ii-driven-at-binary").stdout.count("At crank 107°.") == 1


def test_several_drivers_are_named(run: Run) -> None:
    given = "--at", "crank-1=80", "--at", "crank-2=200", "--speed", "crank-1=2"
    result = run("centres", "3-rrr", *given, "--format", "json")
    assert result.exit_code == 0
    text = json.loads(result.stdout)["sections"]["centres"]["blocks"][0]["text"]
    assert text.startswith("At crank-1 80°, crank-2 200° and crank-3 335°.")
    assert table(result, "velocities")["crank-1"]["as solved"] == pytest.approx(2.0)


def test_a_driver_that_slides_is_given_a_length(run: Run) -> None:
    result = run("centres", "rapson-slide", "--at", "0.5", "--format", "json")
    assert "At crosshead 0.5" in json.loads(result.stdout)["sections"]["centres"]["blocks"][0]["text"]
    assert "rad/s" in result.stdout


def test_the_derivation_needs_no_pose(run: Run) -> None:
    result = run("centres", "six-bar", "--derivation", "--format", "json")
    steps = json.loads(result.stdout)["sections"]
    assert list(steps) == ["derivation"]
    rows = steps["derivation"]["blocks"][1]["rows"]
    assert [row[0] for row in rows] == list(range(1, 16))
    assert rows[0] == [1, "(frame crank)", "pin E"]
    assert rows[7] == [8, "(frame plate)", "(frame crank)(crank plate) x (frame rocker)(rocker plate)"]
    both = json.loads(run("centres", "six-bar", "--derivation", "--at", "35", "--format", "json").stdout)
    assert list(both["sections"]) == ["derivation", "centres", "primary", "secondary", "velocities"]


def test_a_pose_that_cannot_be_assembled(run: Run) -> None:
    result = run("centres", "triple-rocker", "--at", "179")
    assert result.exit_code == 3
    assert "does not close: |BD| = 10.9996 > |BC| + |CD| = 5 + 3" in " ".join(result.stdout.split())
    assert "cannot be assembled" in result.stderr


@pytest.mark.parametrize(
    ("args", "told"),
    [
        (("six-bar", "--at", "0,35"), "this is not one number"),
        (("six-bar", "--at", "x"), "this is not one number"),
        (("six-bar", "--at", "crnk=3"), "did you mean 'crank'?"),
        (("six-bar", "--at", "3", "--at", "4"), "given twice"),
        (("3-rrr", "--at", "35"), "there are 3 drivers"),
        (("six-bar", "--design", "2"), "there is no design 2"),
        (("six-bra",), "six-bar"),
    ],
)
def test_bad_input_is_told(run: Run, args: tuple[str, ...], told: str) -> None:
    result = run("centres", *args)
    assert (result.exit_code, result.stdout) == (2, "")
    assert told in result.stderr


def test_a_mechanism_that_cannot_be_solved(run: Run, tmp_path: Path) -> None:
    text = shipped_mechanisms.path("crank-rocker").read_text(encoding="utf-8")
    (tmp_path / "undriven.toml").write_text(text.partition("[[drives]]")[0], encoding="utf-8")
    result = run("centres", "undriven.toml")
    assert result.exit_code == 2
    assert "What stands in the way" in result.stdout


def test_a_file_takes_its_form_from_its_name(run: Run, tmp_path: Path) -> None:
    result = run("centres", "oldham-coupling", "-o", "out.md")
    assert (result.exit_code, result.stdout) == (0, "")
    text = (tmp_path / "out.md").read_text(encoding="utf-8")
    assert "| (frame block) |" in text
    assert r"(frame input)(input block) x (frame output)(output block)" in text


# every third; that the others agree is tested in tests/analysis/centres/test_catalog.py
@pytest.mark.parametrize("name", catalog.CHOSEN[::3])
def test_mechanisms_fit_80_columns_and_agree(run: Run, name: str) -> None:
    result = run("centres", name)
    assert result.exit_code == 0
    assert max(map(len, result.stdout.splitlines())) <= 80
    for row in table(run("centres", name, "--format", "json"), "velocities").values():
        if row["difference"] is not None:
            assert row["difference"] <= 1e-9 * max(1.0, abs(row["as solved"]))


def test_a_report_has_centres_when_asked(run: Run) -> None:
    sections = json.loads(run("report", "six-bar", "--centres", "35", "--format", "json").stdout)["sections"]
    assert list(sections)[-4:] == ["centres", "primary", "secondary", "velocities"]
    assert "centres" not in json.loads(run("report", "six-bar", "--format", "json").stdout)["sections"]
    missing = run("report", "triple-rocker", "--centres", "179")
    assert missing.exit_code == 3
    assert "does not close" in missing.stdout
