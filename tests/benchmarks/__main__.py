"""Speed in one table, each subject beside others that ran in the same rounds: ``python -m tests.benchmarks``.

It takes half a minute; ``--save`` writes the table into `docs/benchmarks.md`, as that of this version, with the
machine.
Compared are the six-bar of Example 3-4 with C written by hand (eight poses at a time, and plainly), with NumPy written
by hand and with the usual loop of SciPy's `fsolve`; the four-bar in it with other packages, as far as they are
installed (`rivals`); and the start of commands with that of NumPy. Times are those of the processor, the least over
rounds in which each subject ran once: a table made beside other work is nearly that of a machine of its own.
``python -m tests.benchmarks.programs`` and ``.studies`` go into more detail; `test_ratios.py` checks that all agree,
and the goals: ``python -m pytest -c tests/benchmarks/pytest.ini tests/benchmarks``, never with the ordinary tests.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import compoundkin as ck
from tests.benchmarks import four_bar, growth, rivals, six_bar, six_bar_in_c
from tests.benchmarks.measure import Times, commands, interleaved, least_ratio

MANY, FEW, LOOPED, DESIGNS = 36_000, 361, 181, 4096
POINT = ("G.position", "G.velocity", "G.acceleration")
OF_C = ("C.position", "C.velocity", "C.acceleration")
PAGE = Path(__file__).parents[2] / "docs" / "benchmarks.md"
HEAD = "| task | by | time | beside |\n|---|---|---|---|"


class Row(NamedTuple):
    """A line of the table."""

    task: str
    by: str
    time: str
    beside: str


def compared(task: str, subjects: Mapping[str, Callable[[], Any]], count: int, rounds: int, beside: str) -> list[Row]:
    """Return a row for each subject: the time of one of `count`, and how many times as long as one of them it takes."""
    times = interleaved(subjects, rounds, time.process_time, is_warm=rounds >= 15)
    return [Row(task, name, shown(min(own) / count), _beside(times, name, beside)) for name, own in times.items()]


def _beside(times: Times, name: str, beside: str) -> str:
    return f"{least_ratio(times, name, beside):.2f} x {beside}" if name != beside and beside in times else ""


def shown(seconds: float) -> str:
    """Return a time with three digits."""
    scale, unit = next((s, u) for s, u in ((1e9, "ns"), (1e6, "us"), (1e3, "ms"), (1.0, "s")) if seconds * s < 1e3)
    return f"{seconds * scale:.3g} {unit}"


def heading(text: str) -> None:
    """Print a line above a table."""
    print(f"\n{text}")


def row(label: str, seconds: float, note: str) -> None:
    """Print one line of a table."""
    print(f"  {label:30s} {shown(seconds):>12s}   {note}")


def in_c(crank: Any) -> dict[str, Callable[[], Any]]:
    """Return C by hand, where there is gcc."""
    try:
        return {f"C, {kind}": lambda kind=kind: six_bar_in_c.asked(kind, crank) for kind in six_bar_in_c.TEXTS}  # type: ignore[misc]
    except OSError:
        return {}


def six_bar_rows() -> Iterator[Row]:
    """The six-bar's point G with velocity and acceleration, a long motion and a short one."""
    plan = six_bar.mechanism()
    path = ck.compile(plan, POINT)
    for count, rounds in ((MANY, 25), (FEW, 200)):
        crank = np.linspace(0.0, 2 * np.pi, count)

        def solved(crank: Any = crank) -> list[Any]:
            motion = ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)
            return [motion.points["G"].derivative(k) for k in range(3)]

        subjects: dict[str, Callable[[], Any]] = {
            **in_c(crank),
            "program": lambda crank=crank: path({"crank": crank}, speed=six_bar.SPEED),  # type: ignore[misc]
            "NumPy by hand": lambda crank=crank: six_bar.by_hand(crank),  # type: ignore[misc]
            "solve": solved,
        }
        beside = "C, vectors" if "C, vectors" in subjects else "program"
        yield from compared(f"six-bar, G to acceleration, {count:,} poses, each", subjects, count, rounds, beside)
        if count == MANY:
            yield from _kept_rows(path, crank, rounds)
    some = np.linspace(0.0, 2 * np.pi, LOOPED)
    loop = {"program": lambda: path({"crank": some}, speed=six_bar.SPEED), "fsolve": lambda: six_bar.by_fsolve(some)}
    yield from compared(f"six-bar, {LOOPED} poses, each", loop, LOOPED, 3, "program")
    few, one = np.linspace(0.0, 2 * np.pi, FEW), np.array([0.7])
    listed, earlier, at = few.tolist(), path(few, speed=six_bar.SPEED), few / six_bar.SPEED
    calls = {
        "an array": lambda: path(few, speed=six_bar.SPEED),
        "a list": lambda: path(listed, speed=six_bar.SPEED),
        "times": lambda: path(0.0, speed=six_bar.SPEED, time=at),
        "into an earlier result": lambda: path(few, speed=six_bar.SPEED, out=earlier),
        "one pose": lambda: path(one, speed=six_bar.SPEED),
        "a number": lambda: path(0.7, speed=six_bar.SPEED),
    }
    yield from compared(f"a call of the six-bar's program, {FEW} poses", calls, 1, 300, "an array")


def away_rows() -> Iterator[Row]:
    """Calls at poses other than the drawn one, from which configurations are told."""
    arc, designs = np.linspace(2.0, 4.0, FEW), cycle(14.0 + 0.01 * np.arange(50))
    six, led, third = (
        ck.compile(ck.load(name), outputs, free=free)
        for name, outputs, free in (
            ("six-bar", POINT, "crank.D.x"),
            ("five-bar", ["P"], ()),
            ("class-iii-six-bar", ["B3"], ()),
        )
    )
    pose = {name: value + 0.1 for name, value in own_values(led).items()}
    one, several = (own_values(third)["crank"] + step for step in (0.2, 0.2 + 0.5 * np.linspace(0.0, 1.0, FEW)))
    calls = {
        "six-bar, an arc": lambda: six(arc, speed=six_bar.SPEED),
        "six-bar, an arc, a new design": lambda: six(arc, {"crank.D.x": next(designs)}, speed=six_bar.SPEED),
        "five-bar of two drivers, one pose": lambda: led(pose),
        "class III group, one pose": lambda: third(one),
        "class III group, an arc": lambda: third(several),
    }
    yield from compared(f"a call away from the drawing, {FEW} poses of an arc", calls, 1, 200, "six-bar, an arc")


def own_values(path: ck.results.CompiledPath) -> dict[str, float]:
    """The first values of a path's drivers in its own mechanism."""
    drives = ck.solve(path.mechanism(), order=0).inputs.drives
    return {name: float(np.ravel(value)[0]) for name, (value, *_) in drives.items()}


def _kept_rows(path: ck.results.CompiledPath, crank: Any, rounds: int) -> Iterator[Row]:
    """Results in arrays that are kept, and all that the program by hand computes."""
    out, found = ({name: np.empty(MANY, complex) for name in POINT} for _ in range(2))
    subjects: dict[str, Callable[[], Any]] = {"program": lambda: path(crank, speed=six_bar.SPEED, out=out)}
    if in_c(crank):
        subjects["C, vectors"] = lambda: six_bar_in_c.compiled("vectors")(crank, [*found.values()])
    task = f"six-bar, G to acceleration into kept arrays, {MANY:,} poses, each"
    yield from compared(task, subjects, MANY, 2 * rounds, "C, vectors")
    names = six_bar_in_c.OUTPUTS
    whole = ck.compile(six_bar.mechanism(), names)
    everything: dict[str, Callable[[], Any]] = {
        "program": lambda: whole(crank, speed=six_bar.SPEED),
        "NumPy by hand": lambda: six_bar.by_hand(crank),
        "memory of the results, filled": lambda: [np.ones(MANY, complex) for _ in range(18)],
    }
    if in_c(crank):
        everything["C, vectors"] = lambda: six_bar_in_c.everything(crank)
    beside = "C, vectors" if "C, vectors" in everything else "program"
    yield from compared(f"six-bar, all {len(names)} outputs, {MANY:,} poses, each", everything, MANY, rounds, beside)


def four_bar_rows() -> Iterator[Row]:
    """The four-bar's coupler point by other packages, as far as they are installed."""
    plan = four_bar.mechanism()
    path = ck.compile(plan, OF_C)
    for count, names in ((MANY, ("pylinkage", "kinepy")), (LOOPED, ("kimech", "mechanism"))):
        crank = np.linspace(0.0, 2 * np.pi, count)
        subjects: dict[str, Callable[[], Any]] = {
            "program": lambda crank=crank: path({"crank": crank}, speed=six_bar.SPEED),  # type: ignore[misc]
            "solve": lambda crank=crank: four_bar.asked(ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED), 2),  # type: ignore[misc]
        }
        for name in names:
            try:
                subjects[name] = rival(name, count)
            except ImportError as missing:
                print(f"left out: {name}: {missing}")
        yield from compared(f"four-bar, C to acceleration, {count:,} poses, each", subjects, count, 5, "program")


def rival(name: str, count: int) -> Callable[[], Any]:
    """Return another package's answer. Raises ImportError where it is missing."""
    if name == "pylinkage":
        kernel = four_bar.by_pylinkage(2)
        return lambda: kernel(count)
    return rivals.BY[name](count)


def study_rows() -> Iterator[Row]:
    """Rows of studies: a sum over 36 poses, and figures between the poses."""
    from tests.benchmarks import studies  # late: it prints by what is here

    count = 2**17
    wanted: dict[str, Any] = {
        "a sum over the poses": (studies.ERROR, studies.TURN),
        "two extremes between them": (["P.y.greatest", "P.x.least"], studies.CYCLE),
        "a stroke and a least angle": (["rocker.angle.stroke", "coupler.transmission_angle.least"], studies.CYCLE),
    }
    programs = {name: studies.program(outputs, count, values) for name, (outputs, values) in wanted.items()}
    subjects = {name: lambda own=own: own.rows(range(count)) for name, own in programs.items()}  # type: ignore[misc]
    yield from compared("a row of a study at 36 poses, with states", subjects, count, 3, "a sum over the poses")


def force_rows() -> Iterator[Row]:
    """Forces in all pairs beside the motion; designs; a group without a closed form; a machine that runs."""
    crank, plan = np.linspace(0.0, 2 * np.pi, MANY), six_bar.loaded()
    motion = ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)
    tasks: dict[str, Callable[[], Any]] = {
        "solve": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED),
        "forces in all pairs": lambda: ck.force_analysis(motion),
    }
    yield from compared(f"six-bar with masses and loads, {MANY:,} poses, each", tasks, MANY, 15, "solve")
    lengths, few = np.linspace(26.0, 30.0, DESIGNS)[:, None], np.linspace(0.0, 2 * np.pi, FEW)
    sweep = six_bar.mechanism(rocker=lengths, plate=lengths + 11.0)
    designs = {"solve": lambda: ck.solve(sweep, {"crank": few}, speed=six_bar.SPEED)}
    yield from compared(f"{DESIGNS:,} designs of {FEW} poses, each pose", designs, DESIGNS * FEW, 2, "solve")
    triad = ck.load("class-iii-six-bar")
    general = {"solve": lambda: ck.solve(triad, {"crank": crank}, speed=six_bar.SPEED)}
    yield from compared(f"class III group, {MANY:,} poses, each", general, MANY, 3, "solve")
    runs = {"simulate": lambda: ck.simulate(plan, start={"crank": (0.0, 5.0)}, until=2.0)}
    yield from compared("six-bar with masses and loads, let go for 2 s", runs, 1, 3, "simulate")


def start_rows() -> Iterator[Row]:
    """The start of commands."""
    verb = "from compoundkin.cli import main; main()"
    folder = Path(tempfile.mkdtemp())
    codes = {
        "import numpy": ["-c", "import numpy"],
        "import compoundkin": ["-c", "import compoundkin"],
        "structure six-bar": ["-c", verb, "structure", "six-bar"],
        "report six-bar -o page.html": ["-c", verb, "report", "six-bar", "-o", str(folder / "page.html")],
    }
    times = commands(codes, 7, folder / "bytecode")
    yield from (
        Row("start", name, shown(min(own)), _beside(times, name, "import numpy")) for name, own in times.items()
    )


def growth_rows() -> Iterator[Row]:
    """How time grows: its exponent between the two largest sizes."""
    for name, sizes, seconds, exponent in growth.exponents():
        counts = ", ".join(f"{size:,}" for size in sizes)
        yield Row(f"{name}: {counts}", "time", ", ".join(map(shown, seconds)), f"exponent {exponent:.2f}")


def machine() -> str:
    """Return what the machine is."""
    try:
        found = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text("ascii", "replace"))
        processor = found[1] if found else platform.processor()
    except OSError:
        processor = platform.processor()
    try:
        compiler = subprocess.run(
            ["gcc", "-dumpfullversion"], capture_output=True, text=True, check=True
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        compiler = "none"
    cores = f"{os.cpu_count()} cores"
    return f"{processor}, {cores}; Python {platform.python_version()}, NumPy {np.__version__}, gcc {compiler}"


def saved(rows: list[str]) -> None:
    """Write the table of this version into the page, in place of one of the same version."""
    from compoundkin.base.version import VERSION

    text = "\n".join([f"## {VERSION}", "", f"On {machine()}.", "", HEAD, *rows, ""])
    page = PAGE.read_text("utf-8")
    before, *versions = re.split(r"(?m)^(?=## )", page)
    others = [one for one in versions if not one.startswith(f"## {VERSION}\n")]
    PAGE.write_text("\n".join([before.rstrip(), "", text, *others]).rstrip() + "\n", "utf-8")


def main() -> None:
    """Measure all, print it line by line, and save it if so asked."""
    parser = argparse.ArgumentParser(description="Speed beside C, NumPy and other packages, in one table.")
    parser.add_argument("--save", action="store_true", help="write the table into docs/benchmarks.md")
    save = parser.parse_args().save
    print(f"On {machine()}.\n\n{HEAD}")
    rows = []
    for part in (six_bar_rows, away_rows, four_bar_rows, study_rows, force_rows, start_rows, growth_rows):
        for one in part():
            rows.append(f"| {' | '.join(one)} |")
            print(rows[-1], flush=True)
    if save:
        saved(rows)


if __name__ == "__main__":
    main()
