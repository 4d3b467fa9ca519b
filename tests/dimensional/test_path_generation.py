"""Path generation without timing, poses with points: planted linkages are found, published counts are met."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional.dyad_pairs import COUNTS, NUMBERS, Family, orientations, shipped
from compoundkin.errors import InvalidInput

# Wampler, Morgan and Sommese, J. Mech. Des. 114 (1992) 153, problem 3, and the viable cognates found for it.
WMS3 = [(0.25, 0), (0.52, 0.1), (0.8, 0.7), (1.2, 1.0), (1.4, 1.3), (1.1, 1.48), (0.7, 1.4), (0.2, 1.0), (0.02, 0.4)]
VIABLE = {(1.21669735, 0.88585011), (1.34112894, 0.08454041), (0.7044594, 0.41389746)}


def planted(count: int, seed: int) -> tuple[complex, complex, np.ndarray, np.ndarray]:
    """Fixed pivots of a random crank-rocker, points of its coupler over a part of a turn, and orientations there."""
    rng = np.random.default_rng(seed)
    crank, coupler, rocker, ground = 1.0, 3.0 + rng.random(), 2.6 + rng.random(), 3.0 + rng.random()
    a, turn = complex(*rng.normal(size=2)), np.exp(1j * rng.uniform(0, 2 * np.pi))
    b = a + ground * turn
    q = np.linspace(0.3, 0.3 + rng.uniform(3, 5), count)
    joint = a + crank * np.exp(1j * q) * turn
    way = b - joint
    along = (np.abs(way) ** 2 + coupler**2 - rocker**2) / (2 * np.abs(way))
    other = joint + way / np.abs(way) * (along + 1j * np.sqrt(coupler**2 - along**2))
    u = (other - joint) / coupler
    return a, b, joint + u * complex(1.2, 0.9), u


def planted_curve(seed: int) -> np.ndarray:
    """The whole coupler curve of a random crank-rocker."""
    rng = np.random.default_rng(seed)
    crank, coupler, rocker, ground = 1.0, 3.0 + rng.random(), 2.6 + rng.random(), 3.0 + rng.random()
    joint = crank * np.exp(1j * np.linspace(0, 2 * np.pi, 200, endpoint=False))
    way = ground - joint
    along = (np.abs(way) ** 2 + coupler**2 - rocker**2) / (2 * np.abs(way))
    other = joint + way / np.abs(way) * (along + 1j * np.sqrt(coupler**2 - along**2))
    return joint + (other - joint) / coupler * complex(1.2, 0.9)


def reaches(answer: Any, points: np.ndarray) -> float:
    """How far the best paths of all mechanisms stay from the points at most: solved anew, between poses too."""
    worst = 0.0
    for one in answer.mechanisms:
        motion = ck.solve(one)
        path = motion.points["P"].position.xy @ [1, 1j]
        near = []
        for point in points:
            k = int(np.argmin(np.abs(path - point)))
            first, second = path[max(k - 1, 0)], path[min(k + 1, len(path) - 1)]
            chord = (second - first) / abs(second - first)
            near.append(abs(((point - path[k]) * np.conj(chord)).imag))
        worst = max(worst, *near)
    return worst


def has(answer: Any, a: complex, b: complex) -> bool:
    """Whether a linkage with these pivots is among the candidates, whatever its defects."""
    every = [*(one.candidate for one in answer.solutions), *(one.candidate for one in answer.rejected)]
    return any(
        min(abs(p - a) + abs(q - b), abs(p - b) + abs(q - a)) < 1e-6 for one in every for p, q in [one.pivots[:2]]
    )


@pytest.mark.parametrize("family", COUNTS, ids=str)
def test_shipped_starts_meet_their_equations_and_are_as_many_as_published(family: Family) -> None:
    """The equal lengths of each dyad at all places, written anew."""
    start, unknowns = shipped(family)
    assert unknowns.shape[1] == COUNTS[family]
    numbers = np.empty((NUMBERS, COUNTS[family]), dtype=complex)
    size = sum(len(part) for part in family.unknown)
    numbers[np.concatenate(family.unknown)] = unknowns[:size]
    if family.pivots:
        numbers[2:4] = start.ground[:2, None]
    if family.pivots > 1:
        numbers[6:] = start.ground[2:, None]
    u = np.concatenate([np.tile(start.u[:, None], COUNTS[family]), unknowns[size:]])
    for x, xc, a, ac in (numbers[:4], numbers[4:]):
        forth, back = start.d[:, None] - a + u * x, start.e[:, None] - ac + xc / u
        first = (x - a) * (xc - ac)
        assert np.max(np.abs(forth * back - first) / (1 + np.abs(first) + np.abs(a * ac) + np.abs(x * xc))) < 1e-8


def test_both_equations_give_one_orientation() -> None:
    start, unknowns = shipped(Family(0, 4, 2))
    numbers = np.empty((NUMBERS, unknowns.shape[1]), dtype=complex)
    numbers[[0, 1, 4, 5]], numbers[[2, 3]] = unknowns[:4], start.ground[:2, None]
    numbers[[6, 7]] = start.ground[2:, None]
    np.testing.assert_allclose(orientations(numbers, start.d, start.e), unknowns[4:], rtol=1e-6)


@pytest.mark.parametrize("seed", range(2))
def test_five_points_and_both_pivots(seed: int) -> None:
    a, b, points, _ = planted(5, seed)
    answer = ck.synthesise(ck.tasks.points(points), ground=[a, b])
    assert answer.complete.startswith("36 of 36 linkages")
    assert has(answer, a, b)
    assert reaches(answer, points) < 2e-2


@pytest.mark.full
def test_seven_points_and_one_pivot() -> None:
    a, b, points, _ = planted(7, 5)
    answer = ck.synthesise(ck.tasks.points(points), ground=[a])
    assert answer.complete.startswith("243 of 243")
    assert has(answer, a, b)


@pytest.mark.parametrize("poses", [4, pytest.param(3, marks=pytest.mark.full), pytest.param(2, marks=pytest.mark.full)])
def test_poses_and_points(poses: int) -> None:
    """Every pair of dyads that exists is counted; the planted one is there."""
    counts = {4: 30, 3: 201, 2: 1112}
    count = poses + 10 - 2 * poses
    a, b, places, u = planted(count, 10 + poses)
    angles = np.angle(u)
    rows = [(z.real, z.imag, angle) for z, angle in zip(places[:poses], angles[:poses], strict=True)]
    answer = ck.synthesise(ck.tasks.mixed(poses=rows, points=places[poses:]))
    assert answer.complete.startswith(f"{counts[poses]} of {counts[poses]} pairs of dyads")
    assert has(answer, a, b)


@pytest.mark.full
def test_nine_points_of_wampler_morgan_and_sommese() -> None:
    """All 1442 classes, 64 of them real; one linkage passes all nine in order on one circuit, with two cognates."""
    answer = ck.synthesise(ck.tasks.points(WMS3))
    assert answer.complete == "1442 of 1442 classes of cognates, 64 of them real"
    pivots = {(round(p.real, 5), round(p.imag, 5)) for one in answer.solutions for p in one.candidate.pivots[:2]}
    assert pivots == {(round(x, 5), round(y, 5)) for x, y in VIABLE}
    assert reaches(answer, np.array(WMS3) @ [1, 1j]) < 2e-2


@pytest.mark.full
def test_fewer_points_leave_a_family() -> None:
    """Two points, of which an arc is made: more would take the rest of the same way."""
    _, _, points, _ = planted(2, 3)
    answer = ck.synthesise(ck.tasks.points(points))
    assert answer.complete.startswith("some of infinitely many")
    assert "chosen beside the task" in answer.note
    assert len(answer) > 0
    assert reaches(answer, points) < 5e-2


def test_more_points_than_linkages_go_through() -> None:
    _, _, points, _ = planted(10, 3)
    with pytest.raises(InvalidInput, match="nine points, seven with one given pivot"):
        ck.synthesise(ck.tasks.points(points))
    with pytest.raises(InvalidInput, match="1 fixed pivot"):
        ck.synthesise(ck.tasks.points(points[:8]), ground=[0j])
    rows = [(z.real, z.imag, 0.1 * k) for k, z in enumerate(points[:4])]
    with pytest.raises(InvalidInput, match="no method"):
        ck.synthesise(ck.tasks.mixed(poses=rows, points=points[4:9]))
