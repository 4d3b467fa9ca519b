"""What only a real process shows: pipes, closed and full streams, encodings, signals, what is imported at the start."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from compoundkin.cli import cli
from tests.support import interrupts_heard

COMMAND = [sys.executable, "-m", "compoundkin"]
ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
SOLVE = ("solve", "six-bar", "--at", "35", "--output", "G.x")


def run(*args: str, **extra: Any) -> subprocess.CompletedProcess[bytes]:
    """Run the command in a process of its own."""
    environment = {**ENVIRONMENT, **extra.pop("env", {})}
    return subprocess.run([*COMMAND, *args], capture_output=True, env=environment, timeout=60, check=False, **extra)


def shell(redirected: str, *args: str) -> subprocess.CompletedProcess[str]:
    """Run the command by a shell that redirects its streams."""
    words = " ".join([*(f"'{word}'" for word in [*COMMAND, *args]), redirected])
    return subprocess.run(words, shell=True, capture_output=True, text=True, env=ENVIRONMENT, check=False)


def invoked(*args: str) -> Result:
    """Run the command in this process."""
    return CliRunner().invoke(cli, list(args), catch_exceptions=False)


def run_main(capfd: pytest.CaptureFixture[str], *args: str) -> tuple[int, str, str]:
    """Run the whole command in this process, its own handling of errors and arguments included."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("default")
            with pytest.raises(SystemExit) as ended:
                cli.main(list(args))
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    captured = capfd.readouterr()
    return int(ended.value.code or 0), captured.out, captured.err


# --- arguments ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [["300", "rpm"], ["300 rpm"], ["300rpm"], ["crank=300", "rpm"]])
def test_a_unit_may_stand_apart_from_its_rate(speed: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    code, out, error = run_main(capfd, "solve", "six-bar", "--at", "35", "--speed", *speed, "--output", "crank.rate")
    assert code == 0, error
    assert float(out.splitlines()[-1].split(",")[1]) == pytest.approx(31.41592653589793, rel=1e-15)


def test_a_warning_on_radians_is_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    given = (
        ("--from", "0", "--to", "6.283", "--step", "0.1"),
        ("--at", "0:6.283:0.1"),
        ("--drive", "crank=0:6.283:0.1"),
    )
    errors = [run_main(capfd, "solve", "six-bar", *one, "--output", "bar.angle")[2] for one in given]
    assert errors[0].startswith("Warning: --drive crank: 0 to 6.283 degrees look like radians; write degrees")
    assert len(errors[0].splitlines()) == 1
    assert errors == [errors[0]] * 3


def test_errors_show_control_characters(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.toml").write_text('format = 1\ntitle = "x"\n"\\u001b[31m" = 1\n')
    code, _, error = run_main(capfd, "structure", str(tmp_path / "a.toml"))
    assert code == 2
    assert "\x1b" not in error
    assert "\\x1b[31m" in error


# --- standard streams -----------------------------------------------------------------------------------


def test_piped_output_is_plain_and_the_same_twice() -> None:
    done = run("report", "six-bar", env={"FORCE_COLOR": "1", "COLUMNS": "200"})
    assert (done.returncode, done.stdout.decode()) == (0, invoked("report", "six-bar").stdout)
    assert b"\x1b" not in done.stdout
    assert max(map(len, done.stdout.decode().splitlines())) <= 80


def test_standard_output_may_be_named() -> None:
    plain = invoked(*SOLVE).stdout
    named = run(*SOLVE, "-o", "/dev/stdout")
    assert (named.returncode, named.stdout.decode(), named.stderr) == (0, plain, b"")
    assert invoked(*SOLVE, "-o", "-").stdout == plain
    assert invoked("report", "six-bar", "-o", "-").stdout.startswith("Six-bar of Example 3-4\n===")
    assert invoked("draw", "six-bar", "-o", "/dev/stdout").stdout.startswith("<svg")


def test_closed_standard_output_is_an_error() -> None:
    done = shell(">&-", *SOLVE)
    assert done.returncode == 2
    assert done.stderr.splitlines()[0] == "Error: standard output is closed"
    assert "Traceback" not in shell(">&- 2>&-", "structure", "six-bar").stderr


@pytest.mark.parametrize(
    ("code", "redirected", "args"),
    [
        (0, "2>&-", ("report", "crank-rocker")),
        (3, "2>/dev/full", ("solve", "triple-rocker", "--at", "0:180:30", "--output", "coupler.angle")),
        (2, "2>&-", ("report", "no-such")),
        (2, "2>/dev/full", ("no-such",)),
    ],
)
def test_standard_error_may_be_closed_or_full(code: int, redirected: str, args: tuple[str, ...]) -> None:
    done = shell(redirected, *args)
    assert done.returncode == code
    assert bool(done.stdout) == (code != 2)


@pytest.mark.skipif(os.name != "posix", reason="pipes end otherwise")
@pytest.mark.parametrize("unbuffered", ["1", pytest.param("", marks=pytest.mark.full)])
def test_a_reader_that_leaves_early_is_no_error(unbuffered: str) -> None:
    writer = subprocess.Popen(
        [*COMMAND, "solve", "six-bar", "--step", "0.05"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**ENVIRONMENT, "PYTHONUNBUFFERED": unbuffered},
    )  # fmt: skip
    assert writer.stdout is not None
    assert writer.stderr is not None
    assert writer.stdout.readline().startswith(b"crank.value")
    writer.stdout.close()
    assert writer.stderr.read() == b""
    writer.stderr.close()
    assert writer.wait(60) == 141


@pytest.mark.parametrize("unbuffered", ["1", pytest.param("", marks=pytest.mark.full)])
def test_long_output_arrives_whole(unbuffered: str) -> None:
    done = run("solve", "six-bar", "--step", "0.2", env={"PYTHONUNBUFFERED": unbuffered})
    assert len(done.stdout.splitlines()) == 1802


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device")
def test_a_full_disk_is_an_error() -> None:
    done = shell(">/dev/full", *SOLVE)
    assert done.returncode == 2
    assert "Error: the results cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission(tmp_path: Path) -> None:
    path = tmp_path / "secret.toml"
    path.write_text("format = 1")
    path.chmod(0)
    done = invoked("report", str(path))
    assert done.exit_code == 2
    assert "Permission denied" in done.stderr


def test_names_that_the_encoding_lacks_are_no_error(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    text = 'format = 1\ntitle = "Gr\u00fcbler \u2192"\n[links.frame]\npoints = { A = [0, 0] }\n'
    path.write_text(text, encoding="utf-8")
    done = run("structure", str(path), env={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert done.stdout.startswith(b"Gr?bler ?")


# --- signals --------------------------------------------------------------------------------------------


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="no signals")
def test_ctrl_c_is_no_traceback() -> None:
    with interrupts_heard():
        job = subprocess.Popen(
            [*COMMAND, "solve", "six-bar", "--step", "0.001", "--order", "3"],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=ENVIRONMENT,
        )  # fmt: skip
    # long after the start, long before the end
    time.sleep(4.0)
    job.send_signal(signal.SIGINT)
    error = job.communicate(timeout=60)[1]
    assert b"Traceback" not in error
    assert (job.returncode, error.strip()) == (130, b"Interrupted.")


SIGNALLED = """
import os, signal, sys
from compoundkin.cli.shell import counting, deferred_signals, guarded

class Finalized:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)

def run():
    if sys.argv[1] == "evaluated":  # a text that is evaluated, as CSS selectors are
        eval("os.kill(os.getpid(), signal.SIGINT)")
    if sys.argv[1] == "swallowed":  # by what runs callbacks, as servers do
        with deferred_signals(lambda: print("told")):
            try:
                os.kill(os.getpid(), signal.SIGINT)
            except BaseException:
                pass
    with counting("working", "things") as progress:
        if sys.argv[1] == "dropped":  # where Python drops exceptions
            Finalized()
        progress(1, 2)
        print("went on")

guarded(run)
"""


@pytest.mark.skipif(os.name != "posix", reason="no signals")
@pytest.mark.parametrize(("where", "out"), [("evaluated", b""), ("dropped", b""), ("swallowed", b"told\n")])
def test_ctrl_c_is_heard_wherever_it_comes(where: str, out: bytes, tmp_path: Path) -> None:
    (tmp_path / "signalled.py").write_text(SIGNALLED, encoding="utf-8")
    with interrupts_heard():
        ended = subprocess.run(
            [sys.executable, "-m", "signalled", where], cwd=tmp_path, env=ENVIRONMENT,
            capture_output=True, timeout=60, check=False,
        )  # fmt: skip
    assert (ended.returncode, ended.stdout) == (130, out)
    assert ended.stderr.splitlines()[-1] == b"Interrupted."


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="films need ffmpeg")
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGTERM, 143), pytest.param(signal.SIGINT, 130, marks=pytest.mark.full)]
)
def test_an_ended_film_leaves_nothing_behind(number: signal.Signals, code: int, tmp_path: Path) -> None:
    temporary, here = tmp_path / "tmp", tmp_path / "here"
    temporary.mkdir()
    here.mkdir()
    words = [*COMMAND, "animate", "six-bar", "--seconds", "60", "--size", "1200", "-o", "film.mp4"]
    with interrupts_heard():
        process = subprocess.Popen(
            words, cwd=here, env={**ENVIRONMENT, "TMPDIR": str(temporary)}, stderr=subprocess.PIPE
        )
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


# --- imports and completion -----------------------------------------------------------------------------


def imports(*args: str) -> set[str]:
    """The modules that a command loads."""
    listed = run(*args, env={"PYTHONPROFILEIMPORTTIME": "1"}).stderr.decode()
    return {line.rpartition("|")[2].strip() for line in listed.splitlines()}


def test_the_start_loads_only_what_is_used() -> None:
    loaded = imports("structure", "six-bar")
    # NetworkX finds the parts of the chain that is named
    assert not loaded & {"scipy", "pandas", "pyarrow", "matplotlib", "compoundkin.cli.report"}


def test_help_loads_no_command_and_no_rich() -> None:
    loaded = imports("--help")
    assert not any(name == "rich" or name.startswith("rich.") for name in loaded)
    assert not {name for name in loaded if name.startswith("compoundkin.cli.")} - {"compoundkin.cli.shell"}


def test_completion_answers_with_names() -> None:
    environment = {"_COMPOUNDKIN_COMPLETE": "bash_complete", "COMP_WORDS": "compoundkin report six", "COMP_CWORD": "2"}
    assert b"plain,six-bar" in run(env=environment).stdout
