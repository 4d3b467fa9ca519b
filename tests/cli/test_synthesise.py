"""`compoundkin synthesise`: task files, what it prints and writes, and what it says of wrong files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.dimensional.task_words import read_task


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), standalone_mode=True)


SWING = 'format = 1\ntask = "swing"\nangle = 40\ntime_ratio = 1.25\n[conditions]\ntransmission = 40\n'


def written(folder: Path, text: str) -> str:
    path = folder / "task.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_task_file_gives_a_report_files_and_a_picture(tmp_path: Path) -> None:
    file = written(tmp_path, SWING)
    found, picture = tmp_path / "found", tmp_path / "found.svg"
    result = run("synthesise", file, "--save", str(found), "--picture", str(picture))
    assert result.exit_code == 0
    assert "a swing of 40 degrees" in result.stdout
    assert "Crank-rocker" in result.stdout
    assert picture.read_text(encoding="utf-8").startswith("<svg")
    best = ck.load(found / "1.toml")
    assert np.isclose(ck.quantity(ck.solve(best), "output.angle.stroke").values[0], ck.deg(40))
    told = json.loads(run("synthesise", file, "--format", "json").stdout)
    assert len(told["sections"]["mechanisms"]["blocks"][1]["rows"]) == len(list(found.iterdir()))


def test_no_mechanism_is_exit_code_three(tmp_path: Path) -> None:
    text = SWING.replace("transmission = 40", "transmission = 80")
    result = run("synthesise", written(tmp_path, text))
    assert result.exit_code == 3
    assert "No candidate is without a defect." in result.stdout


def test_angles_of_files_are_degrees() -> None:
    document = {"format": 1, "task": "poses", "link": "plate", "poses": [[0, 0, 0], [1, 0, 45], [2, 1, 90]],
                "velocities": {"1": [1, 0, 90]}}  # fmt: skip
    task, conditions = read_task(document)
    same = ck.tasks.poses("plate", [(0, 0, 0), (1, 0, np.pi / 4), (2, 1, np.pi / 2)], velocities={1: (1, 0, np.pi / 2)})
    assert np.allclose(task.u, same.u)
    assert task.velocities == same.velocities
    assert conditions == {}
    pairs = {"linkage": "slider-crank", "pairs": [[0, 0], [90, 1], [120, 2]]}
    slider, _ = read_task({"format": 1, "task": "function", **pairs})
    assert np.allclose(slider.inputs, np.deg2rad([0, 90, 120]))
    assert slider.outputs.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('task = "swing"', "format = 1"),
        ('format = 1\ntask = "jump"', "one of poses, points, mixed"),
        ('format = 1\ntask = "swing"\nangel = 3', "did you mean 'angle'"),
        ('format = 1\ntask = "swing"', "a task of swing needs angle"),
        ('format = 1\ntask = "poses"\nlink = "a"\nposes = [[1, 2]]', "three numbers each"),
        ('format = 1\ntask = "swing"\nangle = 40\n[conditions]\nregon = 3', "did you mean 'region'"),
        ('format = 1\ntask = "swing"\nangle = "wide"', "angle"),
        ("format = 1\ntask = [", "TOML"),
        ('format = 1\ntask = ["swing"]', "one of poses, points, mixed"),
        ('format = 1\ntask = "swing"\nangle = 40\n[conditions]\ntransmission = [30, 40]', "transmission"),
    ],
)
def test_wrong_files_say_where(tmp_path: Path, text: str, message: str) -> None:
    result = run("synthesise", written(tmp_path, text))
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr


def test_results_have_a_place_before_anything_is_solved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file where a folder is to be, a folder with the files of another run, a form that no picture has."""
    monkeypatch.setattr("compoundkin.dimensional.synthesis.synthesise", None)
    file = written(tmp_path, SWING)
    for options, message in (
        (("--save", file), "not empty"),
        (("--save", str(tmp_path)), "not empty"),
        (("--picture", str(tmp_path / "found.xyz")), "pictures end in"),
        (("--picture", str(tmp_path / "no" / "found.svg")), "there is no folder"),
        (("-o", str(tmp_path / "no" / "found.md")), "there is no folder"),
    ):
        result = run("synthesise", file, *options)
        assert result.exit_code == 2
        assert message in " ".join(result.stderr.split())
    assert [one.name for one in tmp_path.iterdir()] == ["task.toml"]
