"""Displacements between positions: poles, pole triangles and image poles by what they must do, in plain geometry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.base.arrays import wrapped
from tests.analysis import relative_motions

coupler = ck.figures
Position = coupler.LinkPosition
SEEDS = st.integers(0, 2**32 - 1)
MANY = 50


def positions(seed: int, count: int) -> list[Any]:
    """So many positions, each an array of them."""
    rng = np.random.default_rng(seed)
    return [
        Position(rng.uniform(-3, 3, MANY) + 1j * rng.uniform(-3, 3, MANY), rng.uniform(-6, 6, MANY))
        for _ in range(count)
    ]


def place(position: Any, p: complex) -> Any:
    """Where a point of the link is in a position, by the rotation alone."""
    return position.point + np.exp(1j * position.angle) * p


def close(a: Any, b: Any, good: Any = True) -> None:
    assert np.max(np.where(good, np.abs(a - b) / (1.0 + np.abs(b)), 0.0)) < 1e-10


def turned(point: Any, about: Any, angle: Any) -> Any:
    return about + np.exp(1j * angle) * (point - about)


@settings(max_examples=10)
@given(seed=SEEDS)
def test_a_displacement_is_a_rotation_about_its_pole(seed: int) -> None:
    """And the pole is as J. M. McCarthy and G. S. Soh have it, by sine and cosine of half the angle from the origin."""
    one, two = positions(seed, 2)
    found = coupler.displacement(one, two)
    for p in (0j, 1.5 - 0.7j):
        close(turned(place(one, p), found.pole, found.angle), place(two, p))
        close(found.moved(place(one, p)), place(two, p))
    d = place(two, np.exp(-1j * one.angle) * -one.point)  # where the origin of the plane goes
    half = found.angle / 2
    x = (d.real * np.sin(half) - d.imag * np.cos(half)) / (2 * np.sin(half))
    y = (d.real * np.cos(half) + d.imag * np.sin(half)) / (2 * np.sin(half))
    close(found.pole, x + 1j * y)
    close(found.translation, two.point - one.point)
    assert found.defined.all()
    assert not found.infinite.any()
    back = coupler.displacement(two, one)
    close(back.pole, found.pole)
    close(np.exp(1j * back.angle), np.exp(-1j * found.angle))


@settings(max_examples=10)
@given(seed=SEEDS)
def test_rotations_about_the_corners_come_back_and_are_twice_the_corners_angles(seed: int) -> None:
    one, two, three = positions(seed, 3)
    triangle = coupler.pole_triangle(one, two, three)
    points: Any = np.array([[0j], [1.0 - 2.0j]])
    for pole, angle in zip(triangle.poles, triangle.angles, strict=True):
        points = turned(points, pole, angle)
    size = 1 + np.max(np.abs(triangle.poles), axis=0)
    close(points / size, np.array([[0j], [1.0 - 2.0j]]) / size)
    for corner, angle in zip(triangle.corner_angles, triangle.angles, strict=True):
        sine = np.abs(np.sin(corner - angle / 2))
        assert np.max(sine * np.min([np.abs(np.sin(a / 2)) for a in triangle.angles], axis=0)) < 1e-9
    total = sum(triangle.corner_angles)
    assert np.max(np.abs(wrapped(2 * total))) < 1e-6  # those of a triangle, either way round


@settings(max_examples=10)
@given(seed=SEEDS)
def test_image_poles_are_the_points_that_come_to_the_poles(seed: int) -> None:
    """By both displacements from the position they are seen in, which the mirror images know nothing of."""
    one, two, three = positions(seed, 3)
    triangle = coupler.pole_triangle(one, two, three)
    p12, p23, p31 = triangle.poles
    good = np.max(np.abs(triangle.poles), axis=0) < 100
    for image, pole, here, others in (
        (triangle.images[0], p23, one, (two, three)),
        (triangle.images[1], p31, two, (one, three)),
        (triangle.images[2], p12, three, (one, two)),
    ):
        for other in others:
            close(coupler.displacement(here, other).moved(image), pole, good)


def test_translations_have_poles_at_infinity() -> None:
    """The coupler of a parallelogram; and of three positions, of which two are a translation apart."""
    motion = ck.solve(ck.load("parallelogram"))
    first, later = coupler.link_position(motion, "coupler", 0), coupler.link_position(motion, "coupler", range(1, 20))
    found = coupler.displacement(first, later)
    assert found.infinite.all()
    assert np.isinf(found.pole).all()
    assert np.max(np.abs((np.conj(found.direction) * found.translation).real)) < 1e-9
    turn, shift = Position((1, 0), 2.0), Position((0, 3), 0.0)
    triangle = coupler.pole_triangle(Position((0, 0), 0.0), turn, shift)
    assert [bool(one.infinite) for one in triangle.displacements] == [False, False, True]
    assert abs(triangle.corner_angles[0] - 1.0) < 1e-12
    close(coupler.displacement(Position((0, 0), 0.0), turn).moved(triangle.images[0]), triangle.poles[1])
    assert np.isinf(triangle.images[1])
    still = coupler.displacement(turn, turn)
    assert not still.defined
    assert np.isnan(still.pole)
    assert (still.angle, still.translation) == (0.0, 0.0)


def test_positions_of_a_motion_have_their_poles_where_its_pins_say() -> None:
    """On the perpendicular bisectors of the ways of both pins; and seen from the crank, the pin itself."""
    motion = relative_motions.catalog("crank-rocker")
    at = np.arange(1, 60, 7)
    found = coupler.displacement(*(coupler.link_position(motion, "coupler", k) for k in (at, at + 5)))
    for letter in ("B", "C"):
        ways = np.asarray(motion.points[letter].position)
        assert np.max(np.abs(np.abs(found.pole - ways[at]) - np.abs(found.pole - ways[at + 5]))) < 1e-9 * motion.size
    seen = [coupler.link_position(motion, "coupler", k, on="crank") for k in (at, at + 5)]
    pin = coupler.relative_point(motion, "coupler", "B", on="crank").position[0]
    assert np.max(np.abs(coupler.displacement(*seen).pole - pin)) < 1e-9 * motion.size


def test_the_pole_of_a_small_displacement_is_the_instant_centre() -> None:
    """From poses a little before to as much after, so that the error falls with the square of the step."""
    gaps = []
    for step in (0.02, 0.01):
        motion = ck.solve(ck.load("crank-rocker"), {"crank": [1.0 - step, 1.0, 1.0 + step]})
        found = coupler.displacement(*(coupler.link_position(motion, "coupler", k) for k in (0, 2)))
        gaps.append(abs(found.pole - coupler.pole(motion, "coupler").fixed[1]) / motion.size)
    assert gaps[1] < 1e-3
    assert 3.5 < gaps[0] / gaps[1] < 4.5


def test_designs_keep_their_axis_and_unassembled_poses_are_not_known() -> None:
    bars = ck.link("frame", A=(0, 0), D=(7, 0)), ck.link("crank", A=(0, 0), B=(np.array([[4.0], [1.0]]), 0))
    rest = ck.link("coupler", B=(0, 0), C=(5, 0)), ck.link("rocker", D=(0, 0), C=(3, 0))
    mechanism = ck.Mechanism("m", *bars, *rest, ck.drive("crank"))
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism, {"crank": np.array([0.0, 1.0, np.pi])})
    found = coupler.displacement(*(coupler.link_position(motion, "coupler", k) for k in (0, [1, 2])))
    assert found.pole.shape == (2, 2)
    assert found.defined.tolist() == motion.assembled[:, 1:].tolist()
    assert np.array_equal(np.isnan(found.pole), ~found.defined)


def test_what_does_not_fit_is_refused_by_its_name() -> None:
    motion = relative_motions.catalog("crank-rocker")
    calls: tuple[tuple[Callable[[], Any], str], ...] = (
        (lambda: coupler.link_position(motion, "coupler", 1000), "at: it is not the index of a pose; 0 to"),
        (lambda: coupler.link_position(motion, "coupler", 0.5), "at: it is not"),
        (lambda: coupler.link_position(motion, "coupler", np.nan), "at: it is not"),
        (lambda: coupler.link_position(motion, "coupler", [0.0, -np.inf]), "at: it is not"),
        (lambda: coupler.link_position(motion, "coupler", motion), "at: Motion"),
        (lambda: coupler.link_position(motion, "coupler", 0, on="coupler"), "on: "),
        (lambda: Position((0, np.inf), 0.0), "point: it is infinite"),
        (lambda: Position(np.zeros(2), np.zeros(3)), "shapes: "),
        (lambda: coupler.displacement(Position(np.zeros(2), 0.0), Position(np.zeros(3), 0.0)), "shapes: "),
        (lambda: coupler.displacement(Position(np.zeros(2), 0.0), Position(1j, 1.0)).moved(np.zeros(3)), "shapes: "),
    )
    for call, why in calls:
        with pytest.raises(ck.errors.InvalidInput, match=why):
            call()
    with pytest.raises(ck.errors.UnknownName, match="couplr"):
        coupler.link_position(motion, "couplr", 0)
