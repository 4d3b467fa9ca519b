"""What only a real process shows: pipes, colour, encodings, start-up."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

COMMAND = [sys.executable, "-m", "compoundkin"]
ROOT = Path(__file__).parents[2]


def run(*args: str, **extra: Any) -> subprocess.CompletedProcess[bytes]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **extra.pop("env", {})}
    return subprocess.run([*COMMAND, *args], capture_output=True, env=environment, timeout=60, check=False, **extra)


def test_exit_codes_reach_the_shell() -> None:
    assert run("structure", "six-bar").returncode == 0
    assert run("structure", "no-such").returncode == 2


def test_piped_output_is_plain_and_the_same_twice() -> None:
    first, second = (run("report", "six-bar", env={"FORCE_COLOR": "1", "COLUMNS": "200"}) for _ in range(2))
    assert first.stdout == second.stdout
    assert b"\x1b" not in first.stdout
    assert max(map(len, first.stdout.decode().splitlines())) <= 80


@pytest.mark.skipif(os.name != "posix", reason="there is no /dev/stdout")
def test_a_report_may_be_written_to_a_piped_stdout() -> None:
    done = run("structure", "six-bar", "-o", "/dev/stdout")
    assert (done.returncode, done.stdout) == (0, run("structure", "six-bar").stdout)


@pytest.mark.skipif(os.name != "posix", reason="pipes end otherwise")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_leaves_early_is_no_error(unbuffered: str) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": unbuffered}
    writer = subprocess.Popen(
        [*COMMAND, "solve", "six-bar", "--step", "0.05"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment,
    )  # fmt: skip
    assert writer.stdout is not None
    assert writer.stderr is not None
    assert writer.stdout.readline().startswith(b"crank.value")
    writer.stdout.close()
    assert writer.stderr.read() == b""
    writer.stderr.close()
    assert writer.wait(60) == 141


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_long_output_arrives_whole(unbuffered: str) -> None:
    done = run("solve", "six-bar", "--step", "0.2", env={"PYTHONUNBUFFERED": unbuffered})
    assert len(done.stdout.splitlines()) == 1802


@contextmanager
def interrupts_heard() -> Iterator[None]:
    """Processes started now hear Ctrl-C, also where the tests run in the background of a shell that ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(os.name != "posix", reason="no signals")
def test_ctrl_c_is_no_traceback() -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with interrupts_heard():
        job = subprocess.Popen(
            [*COMMAND, "solve", "six-bar", "--step", "0.001", "--order", "3"],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment,
        )  # fmt: skip
    # long after the start, long before the end
    time.sleep(4.0)
    job.send_signal(signal.SIGINT)
    error = job.communicate(timeout=60)[1]
    assert b"Traceback" not in error
    assert (job.returncode, error.strip()) == (130, b"Interrupted.")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device")
def test_a_full_disk_is_an_error() -> None:
    with open("/dev/full", "wb") as full:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [*COMMAND, "report", "six-bar"],
            stdout=full, stderr=subprocess.PIPE, env=environment, timeout=60, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert b"Error: the results cannot be written" in done.stderr
    assert b"Traceback" not in done.stderr


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission(tmp_path: Path) -> None:
    path = tmp_path / "secret.toml"
    path.write_text("format = 1")
    path.chmod(0)
    done = run("report", str(path))
    assert done.returncode == 2
    assert b"Permission denied" in done.stderr


def test_names_that_the_encoding_lacks_are_no_error(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    text = 'format = 1\ntitle = "Gr\u00fcbler \u2192"\n[links.frame]\npoints = { A = [0, 0] }\n'
    path.write_text(text, encoding="utf-8")
    done = run("structure", str(path), env={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert done.stdout.startswith(b"Gr?bler ?")


def test_the_start_loads_only_what_is_used() -> None:
    listed = run("structure", "six-bar", env={"PYTHONPROFILEIMPORTTIME": "1"}).stderr.decode()
    loaded = {line.rpartition("|")[2].strip() for line in listed.splitlines()}
    # NetworkX finds the parts of the chain that is named
    assert not loaded & {"scipy", "pandas", "pyarrow", "matplotlib"}
    assert "compoundkin.cli.report" not in loaded


def test_help_loads_no_command_and_no_rich() -> None:
    listed = run("--help", env={"PYTHONPROFILEIMPORTTIME": "1"}).stderr.decode()
    loaded = {line.rpartition("|")[2].strip() for line in listed.splitlines()}
    assert not any(name == "rich" or name.startswith("rich.") for name in loaded)
    assert not {name for name in loaded if name.startswith("compoundkin.cli.")} - {"compoundkin.cli.shell"}


def test_completion_answers_with_names() -> None:
    environment = {"_COMPOUNDKIN_COMPLETE": "bash_complete", "COMP_WORDS": "compoundkin report six", "COMP_CWORD": "2"}
    assert b"plain,six-bar" in run(env=environment).stdout
