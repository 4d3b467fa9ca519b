"""That all ways of solving agree, and that the goals for speed hold; `python -m tests.benchmarks` prints the ratios."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from statistics import median

import numpy as np
import pytest

import compoundkin as ck
from tests.benchmarks import four_bar, six_bar
from tests.benchmarks.measure import commands, interleaved, least_ratio, ratio
from tests.dynamics.cases import crank_rocker

MANY = 36_000
TURN = np.linspace(0.0, 2 * np.pi, MANY)
# Goals are for a quiet machine; this much is left to noise.
NOISE = 1.25


def agree(one: six_bar.Answer, other: six_bar.Answer, tolerance: float) -> None:
    assert one.keys() == other.keys()
    for name in one:
        for k, (x, y) in enumerate(zip(one[name], other[name], strict=True)):
            scale = max(1.0, six_bar.SPEED**k, float(np.max(np.abs(y))))
            assert np.max(np.abs(x - y)) < tolerance * scale, (name, k)


def test_all_ways_agree() -> None:
    crank = TURN[::100]
    hand = six_bar.by_hand(crank)
    agree(six_bar.asked(ck.solve(six_bar.mechanism(), {"crank": crank}, speed=six_bar.SPEED)), hand, 1e-13)
    agree(six_bar.by_fsolve(crank), hand, 1e-11)


def test_by_hand_is_the_reference(reference_rows: list[dict[str, object]]) -> None:
    angles = np.deg2rad([row["crank_deg"] for row in reference_rows])
    hand = six_bar.by_hand(angles)
    for name in ("A", "C", "G"):
        for k, rate in enumerate(("position", "velocity", "acceleration")):
            expected = np.array([row[name][rate] for row in reference_rows]) @ [1, 1j]  # type: ignore[index]
            assert np.max(np.abs(hand[name][k] - expected)) < 1e-12 * np.max(np.abs(expected))


@pytest.mark.parametrize("order", [1, 2])
def test_pylinkage_agrees_and_is_slower(order: int) -> None:
    pytest.importorskip("numba")
    pytest.importorskip("pylinkage")
    kernel = four_bar.by_pylinkage(order)
    crank, plan = np.arange(1, MANY + 1) * (2 * np.pi / MANY), four_bar.mechanism()

    def asked() -> dict[str, tuple[np.ndarray, ...]]:
        return four_bar.asked(ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED, order=order), order)

    theirs, ours = kernel(MANY), asked()
    for name in ours:
        for x, y in zip(theirs[name], ours[name], strict=True):
            assert np.max(np.abs(x - y)) < 1e-9 * np.max(np.abs(y))  # it steps, and rounding adds up
    times = interleaved({"theirs": lambda: kernel(MANY), "ours": asked}, 15)
    assert ratio(times, "theirs", "ours") > 1.0


def test_six_bar_by_hand_and_by_loop() -> None:
    plan, some = six_bar.mechanism(), TURN[::360]

    def solved() -> ck.results.Motion:
        return ck.solve(plan, {"crank": TURN}, speed=six_bar.SPEED)

    fast = interleaved(
        {"hand": lambda: six_bar.by_hand(TURN), "solved": solved, "asked": lambda: six_bar.asked(solved())}, 25
    )
    assert ratio(fast, "solved", "hand") < ratio(fast, "asked", "hand")
    assert ratio(fast, "asked", "hand") < 2.0 * NOISE
    loop = interleaved({"loop": lambda: six_bar.by_fsolve(some)}, 2)
    assert min(loop["loop"]) / len(some) > 100 * max(fast["asked"]) / MANY


def test_many_poses_whatever_the_heap() -> None:
    """Steady for many motions one after another, thrown away or kept, after much else was allocated and freed."""
    plan, crank = six_bar.mechanism(), TURN
    scattered = [np.ones(1000 + 29 * k) for k in range(1000)]
    del scattered[::2]
    kept: list[ck.results.Motion] = []

    def solved() -> ck.results.Motion:
        return ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)

    def keeps() -> None:
        kept.append(solved())
        del kept[:-4]

    times = interleaved({"hand": lambda: six_bar.by_hand(crank), "solved": solved, "kept": keeps}, 25)
    # the best of those by hand had warm memory
    for name in ("solved", "kept"):
        assert median(times[name]) < 2.3 * NOISE * min(times["hand"])


def test_few_poses_beside_the_same_by_hand() -> None:
    """361 poses: the fixed costs of a call, beside NumPy by hand, which has none."""
    plan, crank = six_bar.mechanism(), TURN[::100]
    subjects = {
        "hand": lambda: six_bar.by_hand(crank),
        "solved": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED),
    }
    times = interleaved(subjects, 200)
    assert ratio(times, "solved", "hand") < 6.4 * NOISE


def test_small_tasks() -> None:
    plan, crank = six_bar.mechanism(), TURN[::100]
    times = interleaved({"it": lambda: ck.solve(plan, {"crank": crank}, speed=six_bar.SPEED)}, 100)
    assert min(times["it"]) < 1e-3


def test_starts_beside_importing_numpy(tmp_path: Path) -> None:
    """What every use of the package costs, in units of a start of Python that imports NumPy: about 70 ms."""
    page, verb = str(tmp_path / "page.html"), ["-m", "compoundkin"]
    goals = {
        "import": (1.6, ["-c", "import compoundkin"]),
        "solve": (3.2, ["-c", "import compoundkin as ck\nck.solve(ck.load('six-bar'))"]),
        "structure": (4.5, [*verb, "structure", "six-bar"]),
        "page": (8.5, [*verb, "report", "six-bar", "-o", page]),
    }
    codes = {"numpy": ["-c", "import numpy"], **{name: arguments for name, (_, arguments) in goals.items()}}
    times = commands(codes, 7, tmp_path / "bytecode")
    found = {name: least_ratio(times, name, "numpy") for name in goals}
    assert all(found[name] < goal * NOISE for name, (goal, _) in goals.items()), found


def test_forces_beside_the_motion() -> None:
    plan = six_bar.loaded()
    motion = ck.solve(plan, {"crank": TURN}, speed=six_bar.SPEED)
    times = interleaved(
        {
            "solved": lambda: ck.solve(plan, {"crank": TURN}, speed=six_bar.SPEED),
            "forces": lambda: ck.force_analysis(motion),
        },
        25,
    )
    assert ratio(times, "forces", "solved") < 2.5 * NOISE


def test_forces_of_many_designs_need_little_memory() -> None:
    """4,096 designs of 361 poses: less than 2 GB beyond the motion, at any time and for what is kept."""
    lengths = np.linspace(26.0, 30.0, 4096)[:, None]
    plan = six_bar.loaded(rocker=lengths, plate=lengths + 11.0)
    motion = ck.solve(plan, {"crank": np.linspace(0.0, 2 * np.pi, 361)}, speed=six_bar.SPEED)
    tracemalloc.start()
    forces = ck.force_analysis(motion)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert forces.shape == (4096, 361)
    assert peak < 2e9


def test_solve(benchmark) -> None:  # type: ignore[no-untyped-def]
    plan = six_bar.mechanism()
    benchmark(lambda: ck.solve(plan, {"crank": TURN}, speed=six_bar.SPEED))


def test_ten_seconds_of_a_four_bar_take_little_more_than_their_integration() -> None:
    """A tenth of a second on a quiet machine, which is SciPy's own time for as many steps of a formula."""
    from scipy.integrate import solve_ivp

    linkage = crank_rocker()

    def simulated() -> float:
        return ck.simulate(linkage, start=(0.0, 20.0), until=10.0).energy.worst

    def integrated() -> int:
        # a pendulum that takes as many evaluations
        found = solve_ivp(lambda t, y: np.array([y[1], -np.sin(y[0])]), (0, 365), [2.0, 0.0], "DOP853",
                          rtol=1e-11, atol=1e-11, dense_output=True)  # fmt: skip
        return int(found.nfev)

    assert simulated() < 1e-8
    assert abs(integrated() - ck.simulate(linkage, start=(0.0, 20.0), until=10.0).evaluations) < 2_000
    times = interleaved({"ours": simulated, "scipy": integrated}, 5)
    assert min(times["ours"]) < 0.3 * NOISE
    assert ratio(times, "ours", "scipy") < 1.3 * NOISE
