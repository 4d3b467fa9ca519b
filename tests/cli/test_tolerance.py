"""The verb `tolerance`."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, ["tolerance", *args], catch_exceptions=False)


def rows(text: str) -> list[dict[str, str]]:
    return [{key.partition(" ")[0]: value for key, value in row.items()} for row in csv.DictReader(text.splitlines())]


def test_contributions_are_those_of_a_crank_by_hand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    frame, crank = ck.link("frame", A=0), ck.link("crank", A=0, B=2)
    ck.save(ck.Mechanism("Crank", frame, crank, ck.drive("crank"), outputs=("B.y",)), "crank.toml")
    given = "--tolerance", "crank.B.x=-0.01:0.05", "--clearance", "A=0.02", "--at", "30"
    assert run("crank.toml", *given, "-o", "table.csv").exit_code == 0
    first, second = rows(Path("table.csv").read_text())
    # B.y = x sin 30: half of -0.01 to 0.05, a sixth of their distance; the shaft anywhere on a circle of 0.02
    assert (first["source"], float(first["lower"]), float(first["upper"])) == ("crank.B.x", -0.01, 0.05)
    assert float(first["B.y.worst"]) == pytest.approx(0.03 / 2, rel=1e-9)
    assert float(first["B.y.deviation"]) == pytest.approx(0.01 / 2, rel=1e-9)
    assert float(second["B.y.worst"]) == pytest.approx(0.02, rel=1e-9)
    assert float(second["B.y.deviation"]) == pytest.approx(0.02 / np.sqrt(2), rel=1e-9)
    (band,) = rows(run("crank.toml", *given, "--bands").stdout)
    assert float(band["B.y.low"]) == pytest.approx(1.0 + 0.01 - 0.035, rel=1e-9)


def test_the_report_tells_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given = "six-bar", "--tolerance", "crank.D=0.05", "--clearance", "C=0.01", "--output", "G.x.stroke", "--step", "20"
    text = run(*given).stdout
    assert "What contributes" in text
    assert "clearance C" in text
    found = ck.tolerance(
        ck.load("six-bar"), {"crank.D": 0.05}, "G.x.stroke", clearance={"C": 0.01},
        values=ck.deg(range(0, 361, 20)),
    )  # fmt: skip
    assert f"{float(found['G.x.stroke'].deviation):.4g}" in text
    assert run(*given, "-o", "six-bar.md").exit_code == 0
    assert "## What contributes" in Path("six-bar.md").read_text("utf-8")


def test_angles_are_in_degrees() -> None:
    """A guide that is turned in its bar turns the bar back, wherever the rest is."""
    found = run("six-bar", "--tolerance", "slot.angle=-0.1:0.2", "--output", "bar.angle", "--at", "40",
                "--bands")  # fmt: skip
    (band,) = rows(found.stdout)
    angle, low, high = (float(band[f"bar.angle{word}"]) for word in ("", ".low", ".high"))
    assert angle == pytest.approx(np.rad2deg(ck.solve(ck.load("six-bar"), ck.deg(40)).links["bar"].angle))
    assert (low - angle, high - angle) == (pytest.approx(-0.2, rel=1e-6), pytest.approx(0.1, rel=1e-6))


@pytest.mark.parametrize(
    ("args", "told"),
    [
        (["--tolerance", "crnk.D=0.05", "--output", "G.x"], "did you mean 'crank.D'?"),
        (["--tolerance", "crank.D", "--output", "G.x"], "write NAME=0.05, or NAME=-0.02:0.05"),
        (["--tolerance", "crank.D=a", "--output", "G.x"], "'a' is not a number"),
        (["--tolerance", "crank.D=1,crank.D=2", "--output", "G.x"], "crank.D is given twice"),
        (["--tolerance", "crank.D=0.1", "--clearance", "Z=1", "--output", "G.x"], "clearance.Z"),
        (["--tolerance", "crank.D=0.1", "--output", "H.x"], "'H'"),
        (["--output", "G.x"], "nothing has a tolerance"),
        (["--tolerance", "crank.D=0.1", "--output", "G.x.stroke", "--bands"], "every pose"),
        (
            ["--tolerance", "crank.D=0.1", "--output", "G.x", "--bands", "--format", "json"],
            "it does not go with --bands, which is a table",
        ),
        (["--tolerance", "crank.D=0.1", "--output", "G.x", "-o", "a.png"], ".png"),
    ],
)
def test_mistakes_are_told(args: list[str], told: str) -> None:
    found = run("six-bar", *args)
    assert found.exit_code == 2
    assert told in found.stderr
