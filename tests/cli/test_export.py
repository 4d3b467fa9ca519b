"""The verb `export`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from compoundkin.base.suffixes import SUFFIXES
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.kinematics import solve
from compoundkin.kinematics.quantities import quantity


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, ["export", *args], catch_exceptions=False)


def test_every_form_goes_to_a_file_by_its_suffix_as_to_stdout(tmp_path: Path) -> None:
    for suffix, form in SUFFIXES["program"].items():
        path = tmp_path / f"my-bar{suffix}"
        told = run("six-bar", "--output", "G", "-o", str(path))
        assert (told.exit_code, told.stdout) == (0, "")
        assert f"Wrote {path}." in told.stderr
        shown = run("six-bar", "--output", "G", "--to", form, "--name", "my_bar").stdout
        assert path.read_text(encoding="utf-8") == shown
        assert "my_bar(" in shown


def test_the_function_is_called_as_the_file_and_has_its_outputs(tmp_path: Path) -> None:
    path = tmp_path / "bar"
    assert run("six-bar", "--to", "python", "--free", "plate.C,crank.D", "-o", str(path)).exit_code == 0
    names: dict[str, object] = {}
    exec(path.read_text(encoding="utf-8"), names)
    found = names["bar"](0.5)  # type: ignore[operator]
    solved = solve(load("six-bar"), {"crank": [0.5]})
    for name in load("six-bar").outputs:
        for one in quantity(solved, name).components:
            assert found[one.name.replace(".", "_")] == pytest.approx(float(np.ravel(one.values)[0]), rel=1e-12)
    moved = names["bar"](0.5, plate_C_x=12.0)  # type: ignore[operator]
    assert moved["G_position_x"] != found["G_position_x"]


def test_what_no_program_can_have_is_left_out_of_the_files_outputs() -> None:
    result = run("watt-i", "--to", "c")
    assert result.exit_code == 0
    assert "assembled" in result.stdout


def test_a_mode_is_kept() -> None:
    texts = [run("crank-rocker", "--to", "c", *more).stdout for more in ((), ("--mode", "rocker=+1"))]
    assert "coupler, rocker: -1" in texts[0]
    assert "coupler, rocker: +1" in texts[1]


@pytest.mark.parametrize(("args", "told"), [
    (["six-bar"], "the form is missing"),
    (["six-bar", "-o", "a.f90"], "give --to, or end it in .c, "),
    (["six-bar", "--to", "fortran"], "'fortran' is not one of"),
    (["six-bar", "--to", "c", "--output", "Q.position"], "Q.position"),
    (["parallelogram", "--to", "c"], "passes a change point"),
])  # fmt: skip
def test_what_is_wrong_is_told(args: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*args)
    assert result.exit_code == 2
    assert told in result.stderr
    assert not list(tmp_path.iterdir())


def test_a_file_that_is_there_is_not_replaced_unless_forced(tmp_path: Path) -> None:
    path = tmp_path / "a.c"
    path.write_text("mine")
    refused = run("six-bar", "-o", str(path))
    assert refused.exit_code == 2
    assert "--force" in refused.stderr
    assert path.read_text() == "mine"
    assert run("six-bar", "-o", str(path), "--force").exit_code == 0
    assert path.read_text().startswith("/*")
