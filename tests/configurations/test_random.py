"""Random mechanisms: what is traced against what is counted, and what must not depend on how they are written."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.configurations.circuit_search import Circuits
from tests.configurations.mechanisms import random_six_bodies, random_triad
from tests.support import EVERYTHING, KINDS_OF_DYAD, Sketch, random_sketch

FINE = 360
# of class III, where every value is an elimination of its own
COARSE = 120
CHUNK = 25
CHUNK_III = 5
# How many random mechanisms of each sort; twice as many where everything is tested.
TIMES = 2 if EVERYTHING else 1


def dyadic(seed: int) -> Sketch:
    rng = np.random.default_rng(seed)
    kinds = [KINDS_OF_DYAD[i] for i in rng.integers(len(KINDS_OF_DYAD), size=rng.integers(1, 5))]
    return random_sketch(rng, kinds, driver="RP"[int(rng.integers(2))])


def class_iii(seed: int) -> Sketch:
    rng = np.random.default_rng(seed)
    return random_triad(rng, more=["RRR"] * int(rng.integers(2)))


def with_slides(seed: int) -> Sketch:
    rng = np.random.default_rng(seed)
    legs = [("RR", "RP", "PR")[int(rng.integers(3))] for _ in range(3)]
    return random_triad(rng, legs)


def grid_of(found: Circuits, count: int) -> np.ndarray:
    """Driver values over the whole range that was followed, none of them special."""
    low, high = min(c.low for c in found.circuits), max(c.high for c in found.circuits)
    if found.period:
        low, high = 0.1234, 0.1234 + found.period
    return low + (high - low) * (np.arange(count) + 0.5) / count


def crossings(found: Circuits, values: np.ndarray) -> np.ndarray:
    """How many branches cross each driver value, by their intervals alone."""
    total = np.zeros(len(values), dtype=int)
    for branch in found.branches:
        shifts = np.arange(-4, 5) * found.period if found.period else np.zeros(1)
        shifted = values[:, None] + shifts
        total += ((branch.low < shifted) & (shifted < branch.high)).sum(axis=1)
    return total


def check_counts(found: Circuits, count: int = FINE) -> None:
    """As many branches as real configurations cross every value of a fine grid."""
    values = grid_of(found, count)
    counted = ck.configurations(found.structure, {**found.fixed, found.driver: values}).real_count
    assert np.array_equal(crossings(found, values), counted)
    assert found.consistent


def check_way(found: Circuits, first: int, last: int) -> None:
    """A way along a circuit closes every pin and takes no leap."""
    way = found.path(first, last, poses=400)
    mechanism, size = found.structure.mechanism, found.placing.sweep.solving_order.size
    for letter, links in mechanism.pins.items():
        placed = [way.links[k].at(mechanism.geometry.points[k][letter]).c[0] for k in links]
        assert max(float(np.max(np.abs(p - placed[0]))) for p in placed) < 1e-7 * size
    assert way.branches[0] == first
    assert way.branches[-1] == last
    assert np.max(np.diff(way.along), initial=0.0) < 0.15 * max(way.along[-1], 1.0)


@pytest.mark.parametrize("start", range(0, 20 * TIMES, CHUNK))
def test_dyadic_mechanisms(start: int) -> None:
    for seed in range(start, start + CHUNK):
        found = ck.circuits(dyadic(seed).mechanism())
        check_counts(found)
        assert found.start is not None
        check_way(found, found.circuits[0].branches[0].number, found.circuits[0].branches[-1].number)


@pytest.mark.parametrize("start", range(1040, 1045 + 5 * TIMES, CHUNK_III))
def test_class_iii_mechanisms(start: int) -> None:
    for seed in range(start, start + CHUNK_III):
        found = ck.circuits(class_iii(seed).mechanism())
        check_counts(found, COARSE)
        assert found.start is not None
        longest = max(found.circuits, key=lambda circuit: len(circuit.branches))
        check_way(found, longest.branches[0].number, longest.branches[len(longest.branches) // 2].number)


@pytest.mark.parametrize("seed", range(2000, 2000 + TIMES))
def test_class_iii_mechanisms_with_slides(seed: int) -> None:
    check_counts(ck.circuits(with_slides(seed).mechanism()), COARSE)


@pytest.mark.parametrize("seed", range(2100, 2101 + TIMES))
def test_groups_of_six_links(seed: int) -> None:
    check_counts(ck.circuits(random_six_bodies(np.random.default_rng(seed)).mechanism()), COARSE)


@pytest.mark.parametrize("seed", range(3000, 3004))
def test_at_every_limit_two_configurations_appear_or_vanish(seed: int) -> None:
    found = ck.circuits(class_iii(seed).mechanism())
    for limit in found.limits:
        near = 1e-5
        beside = limit.value + np.array([-near, near])
        before, after = ck.configurations(found.structure, {found.driver: beside}).real_count
        close = [one for one in found.limits if abs(np.angle(np.exp(1j * (one.value - limit.value)))) < near]
        assert before - after == sum(2 if one.greatest else -2 for one in close)
        assert found.structure.groups[limit.group].links == limit.links


@pytest.mark.parametrize("make", [dyadic, class_iii])
@pytest.mark.parametrize("seed", range(5, 7))
def test_moved_turned_scaled_mirrored(make: Callable[[int], Sketch], seed: int) -> None:
    sketch = make(seed)
    found = ck.circuits(sketch.mechanism())
    turned, size = np.exp(0.7j), 3.0
    changed = {
        "moved": lambda p: p + 5 - 2j,
        "turned": lambda p: p * turned,
        "scaled": lambda p: p * size,
        "mirrored": lambda p: p.conjugate(),
    }
    is_angle = bool(found.period)
    expected = np.sort([limit.value for limit in found.limits])
    for name, change in changed.items():
        other = ck.circuits(sketch.mechanism(change))
        structure = [
            sorted((len(c.branches), abs(c.winding), c.closed) for c in one.circuits) for one in (found, other)
        ]
        assert structure[0] == structure[1], name
        values = np.array([limit.value for limit in other.limits])
        if is_angle:
            values = values - 0.7 if name == "turned" else -values if name == "mirrored" else values
            values = np.angle(np.exp(1j * values))
        elif name == "scaled":
            values = values / size
        assert np.sort(values) == pytest.approx(expected, abs=1e-8), name


@pytest.mark.parametrize("seed", range(2))
def test_names_do_not_depend_on_unrelated_links_or_on_the_run(seed: int) -> None:
    sketch = class_iii(seed)
    found = ck.circuits(sketch.mechanism())
    again = ck.circuits(sketch.mechanism())
    # a name holds the first link of a group only
    other = ck.circuits(sketch.renamed({"link0": "z", "leg1": "b", "leg2": "a"}).mechanism())
    for same in (again, other):
        assert [b.name for b in same.branches] == [b.name for b in found.branches]
        for end in ("low", "high"):
            values = [[getattr(branch, end) for branch in one.branches] for one in (same, found)]
            assert values[0] == pytest.approx(values[1])
