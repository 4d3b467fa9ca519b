"""`compoundkin forces`: what it prints, and what it says of wrong input."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from compoundkin.cli import cli


def test_what_has_no_units_is_told_how_to_state_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(cli, ["forces", "six-bar"])
    assert result.exit_code == 2 or "units" in str(result.exception)
