"""Speed, as ratios measured side by side in one run: ``python -m tests.benchmarks`` (a minute and a half).

Compared are, for the six-bar of Example 3-4 with position, velocity and acceleration:

* NumPy written out by hand for this one mechanism, over whole arrays (`six_bar.by_hand`),
* the usual loop of SciPy's `fsolve` over the poses, with analytic Jacobian (`six_bar.by_fsolve`), timed on
  a few hundred poses and extrapolated,
* pylinkage's kernels compiled by numba, for the part of it that they can do (`four_bar`); left out where
  pylinkage or numba is not installed.

Times are medians, ratios medians over rounds in which each subject ran once. "solved" is `solve` alone,
"and asked" also reads every quantity that the others compute. `test_ratios.py` checks that all agree, and
the goals; it and the other tests here run with
``python -m pytest -c tests/benchmarks/pytest.ini tests/benchmarks``, never with the ordinary tests.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

import compoundkin as ck
from tests.benchmarks import four_bar, six_bar
from tests.benchmarks.measure import Times, commands, interleaved, ratio

MANY, FEW, LOOPED, VARIANTS, DESIGNS = 36_000, 361, 300, 1_000_000, 4096


def hand_and_loop() -> None:
    """36,000 poses of the six-bar, order 2."""
    crank, plan = np.linspace(0.0, 2 * np.pi, MANY), six_bar.mechanism()
    some = crank[: LOOPED * (MANY // LOOPED) : MANY // LOOPED]

    def solved() -> ck.results.Motion:
        return ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)

    fast = interleaved(
        {"hand": lambda: six_bar.by_hand(crank), "solved": solved, "asked": lambda: six_bar.asked(solved())}, 40
    )
    loop = interleaved({"loop": lambda: six_bar.by_fsolve(some)}, 3)
    heading(f"six-bar, {MANY:,} poses, position + velocity + acceleration")
    for name, label in (("hand", "NumPy by hand"), ("solved", "solved"), ("asked", "solved and asked")):
        best = min(fast[name]) / min(fast["hand"])
        row(label, median(fast[name]) / MANY, f"{ratio(fast, name, 'hand'):.2f} x by hand ({best:.2f} of the best)")
    each = median(loop["loop"]) / LOOPED
    row("fsolve loop", each, f"{each / (median(fast['asked']) / MANY):,.0f} x solved and asked")


def pylinkage() -> None:
    """36,000 poses of the four-bar with its coupler point."""
    heading(f"four-bar with coupler point, {MANY:,} poses (pylinkage has no swinging guide)")
    crank, plan = np.arange(1, MANY + 1) * (2 * np.pi / MANY), four_bar.mechanism()
    for order, what in ((1, "velocity"), (2, "acceleration")):
        try:
            kernel = four_bar.by_pylinkage(order)
        except ImportError as missing:
            print(f"  left out: {missing}")
            return

        def asked(order: int = order) -> Any:
            return four_bar.asked(ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED, order=order), order)

        times = interleaved({"pylinkage": lambda k=kernel: k(MANY), "asked": asked}, 20)
        row(f"pylinkage to {what}", median(times["pylinkage"]) / MANY, "")
        row("solved and asked", median(times["asked"]) / MANY, f"{ratio(times, 'pylinkage', 'asked'):.1f} x faster")


def forces() -> None:
    """Reactions in all pairs of the six-bar, beside the cost of its motion."""
    crank, plan = np.linspace(0.0, 2 * np.pi, MANY), six_bar.loaded()
    motion = ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)
    heading(f"six-bar with masses and loads, {MANY:,} poses, forces in all pairs")
    times = interleaved(
        {
            "solved": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED),
            "forces": lambda: ck.force_analysis(motion),
        },
        40,
    )
    row("solved", median(times["solved"]) / MANY, "")
    row("forces", median(times["forces"]) / MANY, f"{ratio(times, 'forces', 'solved'):.2f} x the motion")
    lengths = np.linspace(26.0, 30.0, DESIGNS)[:, None]
    sweep = six_bar.loaded(rocker=lengths, plate=lengths + 11.0)
    solved = ck.solve(sweep, {"crank": np.linspace(0.0, 2 * np.pi, FEW)}, speed=six_bar.SPEED)
    task(f"{DESIGNS:,} designs of {FEW} poses", DESIGNS * FEW, lambda: ck.force_analysis(solved).motion)


def small() -> None:
    """361 poses, imports, and the command line."""
    crank, plan = np.linspace(0.0, 2 * np.pi, FEW), six_bar.mechanism()
    heading("small tasks")
    times = interleaved({"solve": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)}, 200)
    row(f"solve {FEW} poses", median(times["solve"]), f"{min(times['solve']) * 1e3:.2f} ms at best")
    verb = "from compoundkin.cli import main; main()"
    starts = commands(
        {
            "numpy": ["-c", "import numpy"],
            "compoundkin": ["-c", "import compoundkin"],
            "structure": ["-c", verb, "structure", "catalog/six-bar.toml"],
        },
        7,
    )
    row("import compoundkin", median(starts["compoundkin"]), f"{beyond(starts, 'compoundkin'):.3f} s beyond numpy's")
    row("compoundkin structure", median(starts["structure"]), f"{beyond(starts, 'structure'):.3f} s beyond numpy's")


def large() -> None:
    """Designs, and a group without a closed form."""
    heading("large tasks (memory beyond the arguments)")
    lengths = np.linspace(26.0, 30.0, VARIANTS)[:, None]
    sweep = six_bar.mechanism(rocker=lengths, plate=lengths + 11.0)
    task(f"{VARIANTS:,} designs, one pose", VARIANTS, lambda: ck.solve(sweep, {"crank": [0.7]}, speed=six_bar.SPEED))
    designs = six_bar.mechanism(rocker=np.linspace(26.0, 30.0, 1000)[:, None])
    full = np.linspace(0.0, 2 * np.pi, FEW)
    task(f"1,000 designs of {FEW} poses", 1000 * FEW, lambda: ck.solve(designs, {"crank": full}, speed=six_bar.SPEED))
    triad = ck.load("catalog/class-iii-six-bar.toml")
    turn = np.linspace(0.0, 2 * np.pi, MANY)
    task(f"class III group, {MANY:,} poses", MANY, lambda: ck.solve(triad, {"crank": turn}, speed=six_bar.SPEED))


def task(label: str, poses: int, call: Callable[[], ck.results.Motion]) -> None:
    """One row: time a pose, time in all, and the highest memory."""
    times = interleaved({"it": call}, 3)
    tracemalloc.start()
    motion = call()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    closed = int(np.count_nonzero(motion.assembled))
    seconds = min(times["it"])
    row(label, seconds / poses, f"{seconds:.2f} s, {peak / 1e6:,.0f} MB, {closed:,} assembled")


def beyond(times: Times, name: str) -> float:
    """The seconds of a start beyond that of Python with NumPy."""
    return median(a - b for a, b in zip(times[name], times["numpy"], strict=True))


def heading(text: str) -> None:
    """A line above a table."""
    print(f"\n{text}")


def row(label: str, seconds: float, note: str) -> None:
    """One line of a table."""
    scale, unit = next((s, u) for s, u in ((1e9, "ns"), (1e6, "us"), (1e3, "ms"), (1.0, "s ")) if seconds * s < 1e3)
    print(f"  {label:30s} {seconds * scale:8.1f} {unit}   {note}")


if __name__ == "__main__":
    for part in (hand_and_loop, pylinkage, forces, small, large):
        part()
