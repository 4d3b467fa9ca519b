"""The verb `workspace`."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), catch_exceptions=False)


def test_area_extent_and_boundary_are_told() -> None:
    """All modes: where two discs of radius 180 meet whose centres are 118 apart, 60081 mm2."""
    result = run("workspace", "five-bar", "P", "--every-mode", "--drive", "left=0:400")
    assert result.exit_code == 0
    assert "drivers: left 0 to 360°; right 0 to 360°" in result.stdout
    assert "area 6.008e+04 mm²; x -62 to 180 mm" in result.stdout
    assert "boundary: 1 outer, 0 inner" in result.stdout


def test_it_is_drawn(tmp_path: Path) -> None:
    path = tmp_path / "region.svg"
    result = run("workspace", "3-rrr", "P", "--orientation", "0", "--cells", "16", "--condition", "-o", str(path))
    assert result.exit_code == 0
    assert "platform at 0°" in result.stdout
    assert path.read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(("args", "told"), [
    (["five-bar", "P", "--drive", "left=10"], "write NAME=LOW:HIGH"),
    (["five-bar", "P", "--drive", "left=a:b"], "'a' is not a number"),
    (["five-bar", "P", "--every-mode", "--mode", "outer-left=+1"], "--mode says which one"),
    (["six-bar", "G"], "one driver (crank) moves G"),
    (["five-bar", "P", "-o", "x.csv"], "csv"),
])  # fmt: skip
def test_what_is_wrong_is_told(args: list[str], told: str) -> None:
    result = run("workspace", *args)
    assert result.exit_code == 2
    assert told in result.stderr
