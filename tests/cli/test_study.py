"""The verb `study`, and the page on study files."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from jsonschema import Draft202012Validator

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.studies import load_study, study_schema
from tests.support import interrupts_heard

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "study-files.md").read_text("utf-8")
TEXT = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0].replace("count = 1024", "count = 128")
NAME = "six-bar-study.toml"


@pytest.fixture(autouse=True)
def beside_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path(NAME).write_text(TEXT, "utf-8")


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, ["study", *args], catch_exceptions=False)


def test_the_page_is_true() -> None:
    for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(code, {})
    own, again = load_study(NAME), load_study("the-same.toml")
    assert again.data == own.data
    for text in (TEXT, Path("the-same.toml").read_text("utf-8")):
        Draft202012Validator(study_schema()).validate(tomllib.loads(text))
    assert set(re.findall(r"^\| `(\w+)`", PAGE, re.MULTILINE)) | {"seed"} == set(study_schema()["properties"])


def test_what_is_wrong_is_told_as_on_the_page() -> None:
    wrong = TEXT.replace("low = 20, high = 29", "low = 29, high = 20").replace("drives.crank", "drives.crnk")
    Path(NAME).write_text(wrong, "utf-8")
    with pytest.raises(ck.errors.InvalidInput) as caught:
        load_study(NAME)
    assert str(caught.value) in re.sub("^    ", "", PAGE, flags=re.MULTILINE)
    found = run(NAME)
    assert found.exit_code == 2
    assert "where:  drives.crnk" in found.stderr


def test_the_summary_is_that_of_python() -> None:
    found = run(NAME, "--greatest", "G.x.stroke", "--best", "2", "--format", "json")
    assert found.exit_code == 0
    told = json.loads(found.stdout)
    result = load_study(NAME).run()
    said = told["sections"]["study"]["blocks"][0]["text"]
    assert f"{100 * result.assembled.mean():.6g} % of them assemble" in said
    # what is reported beside is the mechanism as it stands, which the page shows
    assert told["outcome"]["assembled"] == result.reference.assembled.sum()
    (figures,) = told["sections"]["figures"]["blocks"]
    rows = {row[0]: row[1:] for row in figures["rows"]}
    closed = result["bar.angle.greatest"][result.assembled]
    # angles in degrees
    assert rows["bar.angle.greatest"][0] == "deg"
    median = figures["columns"].index({"name": "50 %", "unit": ""}) - 1
    assert rows["bar.angle.greatest"][median] == pytest.approx(np.rad2deg(np.median(closed)), rel=1e-12)
    _, best = told["sections"]["best"]["blocks"]
    stroke = np.where(result.assembled, result["G.x.stroke"], -np.inf)
    assert [row[0] for row in best["rows"]] == np.argsort(-stroke)[:2].tolist()
    assert best["rows"][0][1] == pytest.approx(stroke.max(), rel=1e-12)
    # solved alone, by another way
    row = best["rows"][0][0]
    alone = np.ravel(ck.quantity(result.motion(row), "G.x.stroke").values)[0]
    assert alone == pytest.approx(stroke.max(), rel=5e-3)


def test_no_design_that_assembles_is_its_own_exit_code() -> None:
    Path(NAME).write_text(TEXT.replace("low = 20, high = 29", "low = 2, high = 3"), "utf-8")
    found = run(NAME)
    assert found.exit_code == 3
    assert "What does not assemble" in found.stdout
    # partly: each is counted once, by the group that fails
    Path(NAME).write_text(TEXT.replace("low = 20, high = 29", "low = 14, high = 20"), "utf-8")
    told = json.loads(run(NAME, "--format", "json").stdout)["sections"]["states"]["blocks"]
    result = load_study(NAME).run()
    assert [row[:2] for row in told[1]["rows"]] == [[(~result.assembled).sum(), "RRR(plate) cannot be assembled"]]


BIG = """
format = 1
mechanism = "six-bar"
outputs = ["bar.angle.least"]
sample = "random"
count = 32768
[dimensions]
"crank.D" = { centre = [13.5, 0], within = 0.5 }
[drives.crank]
values = { from = 0, to = 360, step = 10 }
"""


@pytest.mark.skipif(os.name != "posix", reason="no signals")
def test_ctrl_c_leaves_what_is_written_and_a_second_run_goes_on() -> None:
    pytest.importorskip("pyarrow")
    Path(NAME).write_text(BIG, "utf-8")
    args = [sys.executable, "-m", "compoundkin", "study", NAME, "-o", "rows", "--chunk", "4096"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with interrupts_heard():
        stopped = subprocess.Popen(args, stderr=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
    until = time.monotonic() + 60
    while not list(Path("rows").glob("*.parquet")) and time.monotonic() < until:
        time.sleep(0.01)
    stopped.send_signal(signal.SIGINT)
    out, told = stopped.communicate(timeout=60)
    assert (stopped.returncode, out) == (130, b"")
    # what click writes before it tells of Ctrl-C is an empty line
    assert told.decode().split("\n") == [
        "The rows computed are in rows: run it again to go on.",
        "",
        "Interrupted.",
        "",
    ]
    written = {path.name: path.stat().st_mtime_ns for path in Path("rows").glob("*.parquet")}
    assert 0 < len(written) < 8
    # by a process instead of threads, for the numbers do not depend on that
    found = run(NAME, "-o", "rows", "--workers", "1")
    assert found.exit_code == 0
    assert "32,768 rows are in rows." in found.stderr
    # what was there has not been computed again
    assert all(Path("rows", name).stat().st_mtime_ns == when for name, when in written.items())
    again = ck.results.StudyResult.open("rows")
    assert again["row"].tolist() == list(range(32768))
    alone = ck.quantity(again.motion(32767), "bar.angle.least").values
    assert again["bar.angle.least"][-1] == pytest.approx(np.ravel(alone)[0], abs=1e-3)


@pytest.mark.parametrize(
    ("args", "told"),
    [
        (["no.toml"], "there is no such file"),
        ([NAME, "--least", "G.y.stroke"], "did you mean 'G.x.stroke'?"),
        (["six-bar-study.md"], "study files end in .toml or .json"),
        ([NAME, "--workers", "0"], "0 is not in the range x>=1"),
    ],
)
def test_mistakes_are_told(args: list[str], told: str) -> None:
    found = run(*args)
    assert found.exit_code == 2
    assert told in found.stderr


def test_unknown_outputs_are_told_with_the_file() -> None:
    Path(NAME).write_text(TEXT.replace("G.x.stroke", "H.x.stroke"), "utf-8")
    found = run(NAME)
    assert found.exit_code == 2
    assert f"{NAME}: 1 problem" in found.stderr
    assert "H" in found.stderr
