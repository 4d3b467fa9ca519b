"""Packages as users get them: built, installed where no checkout is, and every verb tried. `python -m tests.packages`

A source distribution is built, a wheel of it, and the wheel is installed without extras into fresh environments: with
the newest versions of what it depends on, and with the lowest that pyproject.toml allows. In each, every verb either
works or says in one form which extra it needs: with the newest each call in a process of its own, as users make them,
with the lowest all in one, which takes a fifth of the time. Printed are the size of the wheel and the time to a first
report.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
import venv
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
# The largest wheel, in bytes: half of it is the catalog and the scripts of pages.
LARGEST = 3_000_000
# How calls are made: by the programs of an environment, in a folder.
Make = Callable[[Path, list[str], Path], list[tuple[int, str]]]
NEEDS_EXTRA = "pip install 'compoundkin["
# A call of each verb, with what is in the folder it runs in; several where forms of results need extras.
CALLS = {
    "report": ["report six-bar", "report six-bar --format html -o six-bar.html"],
    "open": ["open --help"],
    "structure": ["structure six-bar"],
    "solve": ["solve six-bar -o six-bar.csv", "solve six-bar -o six-bar.parquet"],
    "draw": ["draw six-bar -o six-bar.svg", "draw six-bar -o six-bar.png"],
    "animate": ["animate crank-rocker -o moving.svg", "animate crank-rocker -o moving.gif"],
    "plot": ["plot six-bar G.velocity -o plot.svg"],
    "centres": ["centres six-bar --at 35"],
    "configurations": ["configurations six-bar --at 35"],
    "circuits": ["circuits crank-rocker"],
    "singularities": ["singularities parallelogram"],
    "workspace": ["workspace five-bar P"],
    "characteristics": ["characteristics crank-rocker"],
    "forces": ["forces engine-gas-pressure"],
    "size": ["size shaper-cutting-force"],
    "simulate": ["simulate engine-gas-pressure --until 0.01"],
    "study": ["study study.toml"],
    "optimise": ["optimise crank-rocker --free crank.B.x=1:3 --least rocker.angle.stroke --starts 2"],
    "synthesise": ["synthesise task.toml"],
    "trace": ["trace curve.csv --links 4"],
    "exercise": ["exercise four-bar:60,20,50,40 --count 2 -o exercises"],
    "mcp": ["mcp"],
    "studio": ["studio --help"],
    "tolerance": ["tolerance crank-rocker --tolerance crank.B=0.05"],
    "import": ["import crank-rocker.linkage2 -o imported.toml"],
    "export": ["export crank-rocker -o again.linkage2", "export crank-rocker --to dxf -o crank-rocker.dxf"],
    "compare": ["compare crank-rocker crank-rocker"],
    "check": ["check six-bar"],
    "catalog": ["catalog list"],
    "atlas": ["atlas --links 6"],
    "new": ["new mine.toml"],
    "set": ["set given.toml crank.B.x=22"],
    "schema": ["schema"],
    "completion": ["completion bash"],
}
STUDY = """\
format = 1
count = 64
mechanism = "crank-rocker"
outputs = ["rocker.angle.stroke"]

[dimensions]
"crank.B" = { centre = [2, 0], within = 0.1 }
"""
TASK = """\
format = 1
task = "swing"
angle = 40
time_ratio = 1.25
"""
# Makes calls one after another; writes of each, as a line of JSON, the exit code and what was said.
ALL_IN_ONE = """\
import json, sys, traceback
from click.testing import CliRunner
from compoundkin.cli import cli
for call in json.load(sys.stdin):
    done = CliRunner().invoke(cli, call.split())
    fault = "" if done.exc_info is None or done.exc_info[0] is SystemExit else "".join(
        traceback.format_exception(*done.exc_info))
    print(json.dumps([done.exit_code, done.output + fault]), flush=True)
"""
CURVE = "".join(f"{x},{y}\n" for x, y in [(0, 0), (4, -1), (7, 0), (8, 2), (7, 4), (4, 5), (1, 4), (-1, 2), (0, 0)])


def build(folder: Path) -> Path:
    """Build the source distribution and, of it, the wheel."""
    run([sys.executable, "-m", "hatchling", "build", "--target", "sdist", "--directory", str(folder)], ROOT)
    (source,) = folder.glob("*.tar.gz")
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    run([*pip, "--wheel-dir", str(folder), str(source)], folder)
    (wheel,) = folder.glob("*.whl")
    return wheel


def lowest() -> list[str]:
    """Return the lowest versions that pyproject.toml allows, as constraints."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [requirement.replace(">=", "==") for requirement in project["dependencies"]]


def run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command that must succeed, away from any checkout."""
    done = _run(command, folder)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return done


def _run(command: list[str], folder: Path, given: str = "") -> subprocess.CompletedProcess[str]:
    # what is imported is compiled once, and kept
    left_out = {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE"}
    environment = {name: value for name, value in os.environ.items() if name not in left_out}
    return subprocess.run(
        command, cwd=folder, env=environment, input=given, capture_output=True, text=True, check=False
    )


def each_alone(programs: Path, calls: list[str], folder: Path) -> list[tuple[int, str]]:
    """Make each call in a process of its own; return exit codes and what was said."""

    def made(call: str) -> tuple[int, str]:
        done = _run([str(programs / "compoundkin"), *call.split()], folder)
        return done.returncode, done.stderr or done.stdout

    with ThreadPoolExecutor(2) as pool:
        return [*pool.map(made, calls)]


def all_in_one(programs: Path, calls: list[str], folder: Path) -> list[tuple[int, str]]:
    """Make all calls in one process; return exit codes and what was said."""
    done = _run([str(programs / "python"), "-c", ALL_IN_ONE], folder, json.dumps(calls))
    told = [(code, said) for code, said in map(json.loads, done.stdout.splitlines())]
    return told + [(1, f"it ended before: {done.stderr}")] * (len(calls) - len(told))


def tried(name: str, requirements: list[str], make: Make, folder: Path) -> Iterator[str]:
    """Install in a fresh environment, call every verb; yield lines about it, faults begin with "FAULT"."""
    start = time.perf_counter()
    venv.create(folder / name, with_pip=False)
    programs = folder / name / ("Scripts" if os.name == "nt" else "bin")
    pip = [sys.executable, "-m", "pip", "--python", str(programs / "python"), "install", "--quiet", "--no-compile"]
    run([*pip, *requirements], folder)
    work = folder / f"work-{name}"
    work.mkdir()
    command = str(programs / "compoundkin")
    run([command, "report", "six-bar"], work)
    yield f"{name}: installed, first report after {time.perf_counter() - start:.0f} s"
    for file, text in (("study.toml", STUDY), ("task.toml", TASK), ("curve.csv", CURVE)):
        (work / file).write_text(text, encoding="utf-8")
    run([command, "export", "crank-rocker", "-o", "crank-rocker.linkage2"], work)
    run([command, "new", "given.toml"], work)
    calls = [call for calls in CALLS.values() for call in calls]
    for call, (code, said) in zip(calls, make(programs, calls, work), strict=True):
        needs_extra = code == 2 and NEEDS_EXTRA in said
        if (code and not needs_extra) or "Traceback" in said:
            yield f"FAULT {name}: compoundkin {call}: {said}"
        elif needs_extra:
            yield f"{name}: {call}: {said.strip().splitlines()[-1]}"


def main() -> None:
    """Build, install, try."""
    from compoundkin.cli import VERBS

    if set(CALLS) != set(VERBS):
        raise SystemExit(f"verbs without a call: {set(VERBS) ^ set(CALLS)}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wheel = build(folder)
        size = wheel.stat().st_size
        print(f"{wheel.name}: {size / 1e6:.2f} MB", flush=True)
        environments = [
            ("newest", [str(wheel)], each_alone),
            ("lowest", [str(wheel), *lowest()], all_in_one),
        ]
        with ThreadPoolExecutor() as pool:
            lines = [*pool.map(lambda one: list(tried(*one, folder)), environments)]
        print("\n".join(line for some in lines for line in some))
        faults = sum(line.startswith("FAULT") for some in lines for line in some) + (size > LARGEST)
    raise SystemExit(f"{faults} faults" if faults else 0)


if __name__ == "__main__":
    main()
