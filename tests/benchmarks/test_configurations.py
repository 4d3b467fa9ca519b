"""How long all configurations take: a class III group over a full turn, and nine-link trusses."""

from __future__ import annotations

from time import perf_counter

import numpy as np
import pytest

from compoundkin.kinematics.assembly import Configurations, Connection, GroupGeometry, all_configurations
from tests.kinematics.assembly.cases import triad
from tests.kinematics.assembly.trusses import baranov_trusses, random_truss

POSES = 361


def best(geometry: GroupGeometry, times: int = 3) -> tuple[float, Configurations]:
    found = all_configurations(geometry)  # what depends on the structure alone is kept
    taken = []
    for _ in range(times):
        start = perf_counter()
        found = all_configurations(geometry)
        taken.append(perf_counter() - start)
    return min(taken), found


@pytest.mark.parametrize("word", ["RR,RR,RR", "RR,RR,PR", "RR,PR,RP"])
def test_class_iii_over_a_turn(word: str) -> None:
    drawn = triad(word, np.random.default_rng(3))
    first = drawn.connections[0]
    circle = first.points[0] + 0.5 * np.exp(1j * np.linspace(0, 2 * np.pi, POSES))
    moving = Connection(first.bodies, (circle, first.points[1]), first.directions)
    taken, found = best(GroupGeometry(drawn.n, (moving, *drawn.connections[1:]), drawn.size))
    assert np.all(found.count == 6)
    assert taken < (0.15 if "P" not in word else 0.5)


def test_nine_link_trusses() -> None:
    for k, graph in enumerate(baranov_trusses(9)):
        taken, found = best(random_truss(graph, np.random.default_rng(k)), times=1)
        assert found.certified
        assert taken < 3.0
