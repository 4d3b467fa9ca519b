"""What people mistype, closed and named standard output, and what is left behind when a command is ended."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.test_process import interrupts_heard

ROOT = Path(__file__).parents[2]
RUN = [sys.executable, "-m", "compoundkin"]


def run(*args: str, shell: str = "", cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    words = " ".join([*(f"'{word}'" for word in [*RUN, *args]), shell])
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(words, shell=True, capture_output=True, text=True, cwd=cwd, check=False, env=env)


@pytest.mark.parametrize("speed", [["300", "rpm"], ["300 rpm"], ["300rpm"], ["crank=300", "rpm"]])
def test_a_unit_may_stand_apart_from_its_rate(speed: list[str]) -> None:
    told = run("solve", "six-bar", "--at", "35", "--speed", *speed, "--output", "crank.rate")
    assert told.returncode == 0, told.stderr
    assert float(told.stdout.splitlines()[-1].split(",")[1]) == pytest.approx(31.41592653589793, rel=1e-15)


def test_radians_are_warned_about_in_one_line() -> None:
    told = run("solve", "six-bar", "--from", "0", "--to", "6.283", "--step", "0.1", "--output", "bar.angle")
    assert told.returncode == 0
    assert told.stderr.startswith("Warning: --drive crank: 0 to 6.283 degrees look like radians; write degrees")
    assert len(told.stderr.splitlines()) == 1
    for option in (("--at", "0:6.283:0.1"), ("--drive", "crank=0:6.283:0.1")):
        assert run("solve", "six-bar", *option, "--output", "bar.angle").stderr == told.stderr


@pytest.mark.parametrize("args", [("solve", "six-bar", "--at", "35"), ("catalog",), ("structure", "six-bar")])
def test_closed_standard_output_is_told(args: tuple[str, ...]) -> None:
    told = run(*args, shell=">&-")
    assert told.returncode == 2
    assert told.stderr.splitlines()[0] == "Error: standard output is closed"
    assert "Traceback" not in run(*args, shell=">&- 2>&-").stderr


@pytest.mark.parametrize("shell", ["2>&-", "2>/dev/full"])
@pytest.mark.parametrize(
    ("code", "args"),
    [
        (0, ("report", "crank-rocker")),
        (3, ("solve", "triple-rocker", "--at", "0:180:30", "--output", "coupler.angle")),
        (2, ("report", "no-such")),
        (2, ("no-such",)),
    ],
)
def test_standard_error_may_be_closed_or_full(code: int, args: tuple[str, ...], shell: str) -> None:
    told = run(*args, shell=shell)
    assert told.returncode == code
    assert bool(told.stdout) == (code != 2)


@pytest.mark.parametrize("name", ["-", "/dev/stdout"])
def test_standard_output_may_be_named(name: str) -> None:
    plain = run("solve", "six-bar", "--at", "35")
    named = run("solve", "six-bar", "--at", "35", "-o", name)
    assert (named.returncode, named.stdout, named.stderr) == (0, plain.stdout, "")
    assert run("report", "six-bar", "-o", name).stdout.startswith("Six-bar of Example 3-4\n===")
    assert run("draw", "six-bar", "-o", name).stdout.startswith("<svg")


def test_files_are_still_written(tmp_path: Path) -> None:
    for verb, suffix in (("solve", "csv"), ("draw", "svg"), ("report", "md")):
        told = run(verb, "six-bar", "-o", str(tmp_path / f"a.{suffix}"))
        assert told.returncode == 0, told.stderr
        assert (tmp_path / f"a.{suffix}").stat().st_size > 100


def test_errors_show_control_characters(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('format = 1\ntitle = "x"\n"\\u001b[31m" = 1\n')
    told = run("structure", str(tmp_path / "a.toml"))
    assert told.returncode == 2
    assert "\x1b" not in told.stderr
    assert "\\x1b[31m" in told.stderr


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="films need ffmpeg")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_an_ended_film_leaves_nothing_behind(number: signal.Signals, code: int, tmp_path: Path) -> None:
    temporary, here = tmp_path / "tmp", tmp_path / "here"
    temporary.mkdir()
    here.mkdir()
    env = {**os.environ, "TMPDIR": str(temporary), "PYTHONPATH": str(ROOT)}
    words = [*RUN, "animate", "six-bar", "--seconds", "60", "--size", "1200", "-o", "film.mp4"]
    with interrupts_heard():
        process = subprocess.Popen(words, cwd=here, env=env, stderr=subprocess.PIPE)
    with process:
        begun = time.monotonic()
        # not before the film is being written: no program is safe in the instant in which a folder comes into being
        while not list(temporary.glob("*/*")) and time.monotonic() - begun < 60.0:
            time.sleep(0.05)
        assert list(temporary.glob("*/*"))
        process.send_signal(number)
        assert process.wait(timeout=60.0) == code
    assert list(temporary.iterdir()) == []
    assert list(here.iterdir()) == []
