"""Time to take chains of random dyads apart; run with ``pytest tests/benchmarks -p benchmark``."""

from __future__ import annotations

import random
import time

import pytest

from compoundkin.mechanism import Mechanism
from compoundkin.structure import decompose
from compoundkin.words import drive, link


def chain_of_dyads(links: int, seed: int = 0) -> Mechanism:
    """Dyads between random links that are there already, written in random order."""
    r = random.Random(seed)
    points: dict[str, dict[str, complex]] = {"frame": {"O": 0j}, "crank": {"O": 0j}}
    names = list(points)
    for i in range(2, links, 2):
        new = f"a{i}", f"b{i}"
        for name in new:
            points[name] = {f"M{i}": complex(r.random(), r.random())}
        for k, name in enumerate(new):
            for end in (r.choice(names), name):
                points[end][f"P{i}x{k}"] = complex(r.random(), r.random())
        names += new
    r.shuffle(names)
    return Mechanism("chain", *(link(name, **points[name]) for name in names), drive("crank"))


@pytest.mark.parametrize("links", [1_000, 10_000, 20_000])
def test_decomposition(benchmark, links):
    mechanism = chain_of_dyads(links)
    structure = benchmark.pedantic(decompose, args=(mechanism,), rounds=3)
    assert len(structure.groups) == links // 2 - 1


def test_growth_is_about_linear():
    seconds = []
    for links in (10_000, 20_000):
        mechanism = chain_of_dyads(links)
        start = time.perf_counter()
        decompose(mechanism)
        seconds.append(time.perf_counter() - start)
    ratio = seconds[1] / seconds[0]
    print(f"10,000 links: {seconds[0]:.2f} s; 20,000 links: {seconds[1]:.2f} s; ratio {ratio:.2f}")
    assert ratio < 4
