"""Time to take chains of random dyads apart; run with ``pytest tests/benchmarks -p benchmark``."""

from __future__ import annotations

import random
import time

import numpy as np
import pytest

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose

# Of the exponent, on a machine with other work.
NOISE = 0.05


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
    sizes = (3_000, 10_000, 30_000, 100_000)
    seconds = [min(taken(chain_of_dyads(links)) for _ in range(2)) for links in sizes]
    exponent = np.polyfit(np.log(sizes), np.log(seconds), 1)[0]
    print(
        *(f"{n:,} links: {t:.2f} s" for n, t in zip(sizes, seconds, strict=True)), f"exponent {exponent:.2f}", sep="; "
    )
    assert exponent < 1.1 + NOISE


def taken(mechanism: Mechanism) -> float:
    start = time.process_time()
    decompose(mechanism)
    return time.process_time() - start
