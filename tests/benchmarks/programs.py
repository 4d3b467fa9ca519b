"""Compiled programs beside what can be written by hand: `python -m tests.benchmarks.programs`.

The six-bar of Example 3-4: NumPy by hand, C by hand (plain, and eight poses at a time with vector extensions), `solve`,
and `compile` with each back end that is installed. Ratios are medians over rounds in which each ran once, and of the
shortest times. All, C too, make the arrays of their results anew at each call.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterable
from statistics import median
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.programs.backends import BACK_ENDS, chosen_back_end
from tests.benchmarks import four_bar, six_bar, six_bar_in_c
from tests.benchmarks.__main__ import heading, row
from tests.benchmarks.measure import Times, interleaved, ratio

MANY, FEW, DESIGNS = 36_000, 361, 4096
POINT = ("G.position", "G.velocity", "G.acceleration")
RATES = ("position", "velocity", "acceleration"), ("angle", "angular_velocity", "angular_acceleration")
ALL = (
    *(f"{name}.{word}" for name in six_bar.POINTS for word in RATES[0]),
    *(f"{name}.{word}" for name in six_bar.LINKS for word in RATES[1]),
)
FREE = ("crank.D", "plate.A", "plate.C", "rocker.A")
Subjects = dict[str, Callable[[], Any]]


def back_ends() -> list[str]:
    """Those that are installed."""
    found = []
    for name in BACK_ENDS:
        try:
            found.append(chosen_back_end(name))
        except ck.errors.InvalidInput:
            print(f"  left out: {name} is not installed")
    return found


def calls(outputs: Iterable[str], crank: Any, **options: Any) -> Subjects:
    """The six-bar's outputs by every back end."""

    def call(name: str) -> Callable[[], Any]:
        path = ck.compile(six_bar.mechanism(), tuple(outputs), backend=name)
        return lambda: path({"crank": crank}, speed=six_bar.SPEED, **options)

    return {name: call(name) for name in back_ends()}


def in_c(crank: Any) -> Subjects:
    """C by hand, where there is gcc."""
    try:
        return {f"C, {kind}": lambda kind=kind: six_bar_in_c.asked(kind, crank) for kind in six_bar_in_c.TEXTS}  # type: ignore[misc]
    except OSError:
        return {}


def table(title: str, subjects: Subjects, count: int, rounds: int, beside: str) -> Times:
    """One row for each subject: the time of one of `count`, and how it compares with one of them."""
    heading(title)
    times = interleaved(subjects, rounds)
    for name in subjects:
        best = min(times[name]) / (min(times[beside]) if beside in times else 1.0)
        note = f"{ratio(times, name, beside):.2f} x {beside}, {best:.2f} at best; " if beside in times else ""
        row(name, median(times[name]) / count, f"{note}{shortest(min(times[name]) / count)}")
    return times


def shortest(seconds: float) -> str:
    """The shortest time, in words."""
    return f"{seconds * 1e9:.1f} ns at best" if seconds < 1e-6 else f"{seconds * 1e6:.0f} us at best"


def one_point() -> Times:
    """Position, velocity and acceleration of G."""
    crank = np.linspace(0.0, 2 * np.pi, MANY)

    def solved() -> list[Any]:
        motion = ck.solve(six_bar.mechanism(), {"crank": crank}, speed=six_bar.SPEED)
        return [motion.points["G"].derivative(k) for k in range(3)]

    subjects = {**in_c(crank), **calls(POINT, crank), "by hand": lambda: six_bar.by_hand(crank), "solve": solved}
    return table(f"one point, order 2, {MANY:,} poses", subjects, MANY, 40, "C, vectors")


def all_outputs() -> Times:
    """Everything that the program by hand computes."""
    crank = np.linspace(0.0, 2 * np.pi, MANY)
    plan = six_bar.mechanism()
    written: Subjects = {"C, vectors": lambda: six_bar_in_c.everything(crank)} if in_c(crank) else {}
    subjects: Subjects = {
        **written,
        **calls(ALL, crank),
        "by hand": lambda: six_bar.by_hand(crank),
        "solve": lambda: six_bar.asked(ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)),
    }
    return table(f"all {len(ALL)} outputs, {MANY:,} poses", subjects, MANY, 25, "by hand")


def small() -> Times:
    """One call of 361 poses."""
    crank, plan = np.linspace(0.0, 2 * np.pi, FEW), six_bar.mechanism()
    solved: Subjects = {"solve": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)}
    return table(f"a call of {FEW} poses", {**calls(POINT, crank), **in_c(crank), **solved}, 1, 300, "solve")


def forms() -> Times:
    """The forms of a call of 361 poses, one pose, and sums of one design, with the fastest back end."""
    crank, name = np.linspace(0.0, 2 * np.pi, FEW), back_ends()[0]
    path = ck.compile(six_bar.mechanism(), POINT, free=FREE, backend=name)
    cost = ck.compile(six_bar.mechanism(), POINT[:1], free=FREE, backend=name).objective(
        lambda at: abs(at["G.position"] - at["target"]) ** 2
    )
    point = {"crank.D": six_bar.ED, "plate.A": six_bar.DA, "plate.C": six_bar.DC, "rocker.A": six_bar.AB}
    out = {output: np.empty(FEW, complex) for output in POINT}
    several, target, one = crank.tolist(), six_bar.by_hand(crank)["G"][0], np.array([0.7])
    subjects: Subjects = {
        "array": lambda: path(crank, speed=six_bar.SPEED),
        "one pose": lambda: path(one, speed=six_bar.SPEED),
        "one number": lambda: path(0.7, speed=six_bar.SPEED),
        "out=": lambda: path(crank, speed=six_bar.SPEED, out=out),
        "time=": lambda: path(0.0, speed=six_bar.SPEED, time=crank),
        "list": lambda: path(several, speed=six_bar.SPEED),
        "np.float64": lambda: path(crank, speed=np.float64(six_bar.SPEED)),
        "design": lambda: path(crank, point, speed=six_bar.SPEED),
        "objective": lambda: cost(crank, point, target=target),
        "gradient": lambda: cost.gradient(crank, point, target=target),
    }
    return table(f"forms of a call of {FEW} poses", {**subjects, **in_c(crank)}, 1, 500, "array")


def into_arrays() -> Times:
    """Position, velocity and acceleration of G, into arrays that are there."""
    crank = np.linspace(0.0, 2 * np.pi, MANY)
    subjects = calls(POINT, crank, out={output: np.empty(MANY, complex) for output in POINT})
    if in_c(crank):
        kept = [np.empty(MANY, complex) for _ in POINT]
        subjects["C, vectors"] = lambda: six_bar_in_c.compiled("vectors")(crank, kept)
    return table(f"one point into kept arrays, {MANY:,} poses", subjects, MANY, 100, "C, vectors")


def designs() -> Times:
    """Many designs with eight free dimensions: outputs, an objective, its gradient."""
    random, crank = np.random.default_rng(0), np.linspace(0.0, 2 * np.pi, FEW)
    points = {"crank.D": six_bar.ED, "plate.A": six_bar.DA, "plate.C": six_bar.DC, "rocker.A": six_bar.AB}
    places = {name: point * (1.0 + 0.01 * random.normal(size=(DESIGNS, 1))) for name, point in points.items()}
    target = six_bar.by_hand(crank)["G"][0]
    single = np.linspace(0.0, 2 * np.pi, DESIGNS * FEW // 8)
    subjects: Subjects = {}
    if in_c(crank):
        subjects["C, vectors, order 2"] = lambda: [six_bar_in_c.asked("vectors", single) for _ in range(8)]
    for name in back_ends():
        path = ck.compile(six_bar.mechanism(), POINT, free=FREE, backend=name)
        cost = ck.compile(six_bar.mechanism(), POINT[:1], free=FREE, backend=name).objective(
            lambda at: abs(at["G.position"] - at["target"]) ** 2
        )
        subjects[f"{name}, order 2"] = lambda p=path: p(crank, places, speed=six_bar.SPEED)  # type: ignore[misc]
        subjects[f"{name}, objective"] = lambda c=cost: c(crank, places, target=target)  # type: ignore[misc]
        subjects[f"{name}, gradient"] = lambda c=cost: c.gradient(crank, places, target=target)  # type: ignore[misc]
    beside = f"{back_ends()[0]}, objective"
    return table(f"{DESIGNS:,} designs of {FEW} poses, eight free numbers", subjects, DESIGNS * FEW, 5, beside)


def threads() -> Times:
    """One and two threads, over 16 times as many poses."""
    crank = np.linspace(0.0, 2 * np.pi, 16 * MANY)
    subjects = {
        f"{name}, {count}": call for count in (1, 2) for name, call in calls(POINT, crank, threads=count).items()
    }
    times = table(f"threads, {16 * MANY:,} poses", subjects, 16 * MANY, 10, f"{back_ends()[0]}, 1")
    for name in back_ends():
        print(f"  {name}: two threads {ratio(times, f'{name}, 1', f'{name}, 2'):.2f} x as fast as one")
    return times


def pylinkage() -> None:
    """The four-bar with its coupler point, which pylinkage's kernels can do too."""
    crank = np.arange(1, MANY + 1) * (2 * np.pi / MANY)
    outputs = tuple(f"{name}.{word}" for name in "DAC" for word in RATES[0])
    try:
        kernel = four_bar.by_pylinkage(2)
    except ImportError as missing:
        print(f"  left out: {missing}")
        return
    subjects: Subjects = {"pylinkage": lambda: kernel(MANY)}
    for name in back_ends():
        path = ck.compile(four_bar.mechanism(), outputs, backend=name)
        subjects[name] = lambda p=path: p({"crank": crank}, speed=six_bar.SPEED)  # type: ignore[misc]
    table(f"four-bar with coupler point, {MANY:,} poses", subjects, MANY, 15, "pylinkage")


def class_three() -> None:
    """A class III group over a sweep of designs."""
    plan, crank = ck.load("class-iii-six-bar"), np.linspace(0.0, 2 * np.pi, FEW)
    lengths = np.linspace(1.9, 2.0, 256)[:, None]
    swept = plan.replace(ck.link("crank", O=0, A3=lengths))
    subjects: Subjects = {"solve": lambda: ck.solve(swept, {"crank": crank}, speed=1.0)}
    for name in back_ends():
        path = ck.compile(plan, ("B1.position", "B1.velocity", "B1.acceleration"), free="crank.A3", backend=name)
        subjects[name] = lambda p=path: p({"crank": crank}, {"crank.A3": lengths}, speed=1.0)  # type: ignore[misc]
    table(f"class III, 256 designs of {FEW} poses", subjects, 256 * FEW, 3, "solve")


def beginnings() -> None:
    """Recording, compiling, loading from the cache: what comes before the first result."""
    heading("before the first result")
    crank = np.linspace(0.0, 2 * np.pi, FEW)
    kept = os.environ.get("COMPOUNDKIN_CACHE")
    for name in back_ends():
        found: dict[str, list[float]] = {"compile()": [], "first call": [], "from the cache": []}
        for _ in range(5):
            with tempfile.TemporaryDirectory() as folder:
                os.environ["COMPOUNDKIN_CACHE"] = folder
                for first in ("first call", "from the cache"):
                    start = time.perf_counter()
                    path = ck.compile(six_bar.mechanism(), POINT, backend=name)
                    found["compile()"].append(time.perf_counter() - start)
                    start = time.perf_counter()
                    path({"crank": crank}, speed=six_bar.SPEED)
                    found[first].append(time.perf_counter() - start)
        for label, seconds in found.items():
            row(f"{name}, {label}", median(seconds), f"{min(seconds) * 1e3:.1f} ms at best")
    if kept is None:
        del os.environ["COMPOUNDKIN_CACHE"]
    else:
        os.environ["COMPOUNDKIN_CACHE"] = kept


if __name__ == "__main__":
    for part in (
        one_point,
        into_arrays,
        all_outputs,
        small,
        forms,
        designs,
        threads,
        pylinkage,
        class_three,
        beginnings,
    ):
        part()
