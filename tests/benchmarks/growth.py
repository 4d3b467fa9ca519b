"""How time grows: with links (a chain of dyads, each moved by the one before), with poses, with designs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

import compoundkin as ck
from tests.benchmarks import six_bar

LINKS, POSES, DESIGNS = (10, 20, 40, 80), (1_000, 10_000, 100_000), (100, 1_000, 10_000)
TURN = np.linspace(0.0, 2 * np.pi, 37)


def chain(dyads: int) -> ck.Mechanism:
    """Return a crank and so many RRR dyads, each with its foot on the frame: two links a dyad."""
    feet = {f"F{k}": (4.0 * (k + 1), 0.0) for k in range(dyads)}
    items: list[Any] = [ck.link("frame", A=0, **feet), ck.link("crank", A=0, B0=1), ck.drive("crank")]
    for k in range(dyads):
        items.append(ck.link(f"rod{k}", **{f"B{k}": 0, f"C{k}": 4}))
        items.append(ck.link(f"arm{k}", **{f"F{k}": 0, f"C{k}": 2.5j, f"B{k + 1}": 1.2j}))
    return ck.Mechanism("Chain of dyads", *items)


def exponents() -> Iterator[tuple[str, Sequence[int], list[float], float]]:
    """Yield tasks with their sizes, their seconds, and the exponent with which these grow from the third size on."""
    yield from (_grown(*task) for task in _tasks())


def _tasks() -> Iterator[tuple[str, Sequence[int], Callable[[int], Callable[[], Any]]]]:
    links = [2 * n + 2 for n in LINKS]
    plans = {count: chain((count - 2) // 2) for count in links}

    def verified(count: int) -> Callable[[], Any]:
        motion = ck.solve(plans[count], {"crank": TURN})
        return lambda: ck.verify(motion)

    yield "solve 37 poses, by links", links, lambda n: lambda: ck.solve(plans[n], {"crank": TURN})
    yield "verify 37 poses, by links", links, verified
    yield "compile, by links", links, lambda n: lambda: ck.compile(plans[n], [f"C{(n - 2) // 2 - 1}.position"])
    plan = six_bar.mechanism()
    turns = {n: np.linspace(0.0, 2 * np.pi, n) for n in POSES}
    yield "solve the six-bar, by poses", POSES, lambda n: lambda: ck.solve(plan, {"crank": turns[n]}, speed=10.0)
    sweeps = {n: six_bar.mechanism(rocker=np.linspace(26.0, 30.0, n)[:, None]) for n in DESIGNS}
    yield "solve 37 poses, by designs", DESIGNS, lambda n: lambda: ck.solve(sweeps[n], {"crank": TURN}, speed=10.0)


def _grown(
    name: str, sizes: Sequence[int], task: Callable[[int], Callable[[], Any]]
) -> tuple[str, Sequence[int], list[float], float]:
    seconds = [_least(task(size)) for size in sizes]
    last = slice(-2, None)
    slope = np.polyfit(np.log(sizes[last]), np.log(seconds[last]), 1)[0]
    return name, sizes, seconds, float(slope)


def _least(call: Callable[[], Any]) -> float:
    """Return the least seconds of processor time of a few calls."""
    found = []
    for _ in range(4):
        start = time.process_time()
        call()
        found.append(time.process_time() - start)
    return min(found)
