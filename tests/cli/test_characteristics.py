"""`compoundkin characteristics`: its figures, forms, and what it says of wrong input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, ["characteristics", *args], catch_exceptions=False)


def test_figures_in_all_forms(run: Run, tmp_path: Path) -> None:
    text = run("whitworth-quick-return").stdout
    assert "time" in text
    assert "imbalance" in text
    made = json.loads(run("whitworth-quick-return", "--format", "json").stdout)
    rows = made["sections"]["performance"]["blocks"][0]["rows"]
    name, unit, stroke, forth, back, ratio, imbalance = rows[0]
    assert (name, unit) == ("ram.value", "mm")
    assert (stroke, forth, back, ratio, imbalance) == pytest.approx((150, 120, 240, 2, 60))
    assert run("whitworth-quick-return", "-o", "figures.md").exit_code == 0
    assert "## Performance" in (tmp_path / "figures.md").read_text(encoding="utf-8")


def test_outputs_and_tolerances_are_asked_for(run: Run) -> None:
    told = run("watt-ii", "--output", "FG.angle", "--dwell", "0.02").stdout
    assert "FG.angle dwells at" in told
    assert "0.02 of its stroke" in told.replace("\n", " ")
    assert "DCE.angle" not in told


@pytest.mark.parametrize(
    ("args", "code", "said"),
    [
        (("watt-ii", "--output", "FH.angle"), 2, "did you mean"),
        (("watt-ii", "--dwell", "3"), 2, "no part of a stroke"),
        (("watt-ii", "--design", "2"), 2, "there is only 0"),
        (("triple-rocker", "--from", "0", "--to", "180", "--step", "5"), 3, "cannot be assembled"),
    ],
)
def test_what_it_says_of_wrong_input(run: Run, args: tuple[str, ...], code: int, said: str) -> None:
    result = run(*args)
    assert result.exit_code == code
    assert said in result.output
