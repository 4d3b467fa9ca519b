"""Curvature of paths, circles of Bresse, stationary curvature: two ways for each number, and known curves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis import coupler
from compoundkin.files import load
from tests.analysis.relative_motions import catalog, fastest, random_mechanism, turning_pairs
from tests.catalog import THIRD, each
from tests.support import differences, drawn_values

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.base.errors.UnassembledPoses")
SEEDS = range(12)


def random_motion(seed: int, **words: Any) -> ck.results.Motion:
    mechanism = random_mechanism(seed)
    return ck.solve(mechanism, drawn_values(mechanism), **{"speed": 1.0, "order": 3, **words})


def local(motion: ck.results.Motion, link: str, on: str, points: Any) -> Any:
    """Points of the observing link's frame in the moving link's own."""
    seen = coupler.relative_link(motion, link, on)
    return np.exp(-1j * seen.angle) * (points - np.asarray(seen.origin.position))


def well_placed(motion: ck.results.Motion, link: str, point: Any, on: str, rate: Any) -> Any:
    """Poses at which neither the point nor the turning is nearly at rest: there curvature is ill-conditioned."""
    seen = coupler.relative_link(motion, link, on)
    speed = np.asarray(coupler.relative_point(motion, link, point, on).speed)
    with np.errstate(invalid="ignore"):
        return (speed > 1e-2 * rate * motion.size) & (np.abs(seen.angular_velocity) > 1e-2 * rate)


@each(THIRD)
def test_euler_savary_agrees_with_velocity_and_acceleration(name: str) -> None:
    motion = catalog(name)
    compared, rate = 0, fastest(motion)
    # where nothing turns, every path is straight or that of a slide: there is no pole to compare with
    turning = any(np.any(np.abs(link.angular_velocity) > 1e-9) for link in motion.links.values())
    for link in motion.links:
        # of links that are seen from many others, the frame and its neighbour in the list stand for all
        for on in [other for other in motion.links if other != link][:2]:
            for letter in motion.mechanism.geometry.points[link]:
                good = well_placed(motion, link, letter, on, rate)
                a, b = (f(motion, link, letter, on) for f in (coupler.path_curvature, coupler.euler_savary))
                assert np.all(a.defined[good] & b.defined[good])
                error = np.abs(a.curvature[good] - b.curvature[good])
                assert np.all(error * motion.size <= 1e-9 * (1.0 + np.abs(a.curvature[good]) * motion.size))
                bent = good & ~(a.inflection | b.inflection) & (a.radius < 1e3 * motion.size)
                apart = np.abs(a.centre[bent] - b.centre[bent])
                assert np.all(apart <= 1e-6 * np.maximum(np.abs(b.centre[bent]), motion.size))
                compared += np.count_nonzero(good)
    assert compared > 0 or not turning


@pytest.mark.parametrize("seed", SEEDS)
def test_curvature_of_random_points_against_differences_of_the_path(seed: int) -> None:
    mechanism, step = random_mechanism(seed), 5e-4
    motion = ck.solve(mechanism, {k: v + step * np.arange(-4, 5) for k, v in drawn_values(mechanism).items()})
    point = complex(*np.random.default_rng(seed).uniform(-2, 2, 2))
    for link in [name for name in motion.links if name != "frame"]:
        path = np.asarray(motion.links[link].at(point).position)
        v, a, _ = differences(path, step)
        if abs(v) > 0.1:
            expected = (np.conj(v) * a).imag / abs(v) ** 3
            found = coupler.path_curvature(motion, link, point).curvature[4]
            assert found == pytest.approx(expected, rel=1e-4, abs=1e-5)


def test_a_pinned_end_runs_on_a_circle_about_its_pivot() -> None:
    motion = catalog("four-bar-norton")
    for letter, centre, radius in (("A", 0.0, 40.0), ("B", 100.0, 80.0)):
        for way in (coupler.path_curvature, coupler.euler_savary):
            found = way(motion, "coupler", letter)
            assert found.radius == pytest.approx(radius, rel=1e-9)
            assert found.centre == pytest.approx(centre, abs=1e-7)


def test_a_point_of_the_trammel_draws_an_ellipse() -> None:
    """Semi-axes 2 along x and 1 along y; curvature a b / (a^2 sin^2 + b^2 cos^2)^(3/2)."""
    motion = catalog("elliptic-trammel")
    t = motion.links["rod"].angle
    expected = 2.0 / (4.0 * np.sin(t) ** 2 + np.cos(t) ** 2) ** 1.5
    for way in (coupler.path_curvature, coupler.euler_savary):
        assert np.abs(way(motion, "rod", (1.0, 0.0)).curvature) == pytest.approx(expected, rel=1e-12)


def test_exact_straight_lines_are_inflections_all_along() -> None:
    for name, link, letter in (("peaucellier", "BP", "P"), ("hart-inversor", "BC", "Q"), ("scott-russell", "rod", "C")):
        found = coupler.path_curvature(catalog(name), link, letter)
        assert found.inflection.all()
        assert np.all(np.isinf(found.radius) & np.isinf(found.centre) & (found.curvature == 0))


def test_the_point_of_watts_linkage_is_straight_to_the_third_derivative() -> None:
    """In the middle of the figure of eight the tangent has four neighbouring points in common with it and more."""
    motion = ck.solve(load("watt-straight-line"), {"arm-1": 0.0}, order=3)
    assert coupler.path_curvature(motion, "coupler", "P").inflection
    assert coupler.curvature_rate(motion, "coupler", "P") == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_points_of_the_inflection_circle_move_straight(seed: int) -> None:
    motion = random_motion(seed)
    turns = np.exp(1j * np.linspace(0.3, 6.0, 7))
    for link, on in turning_pairs(motion, 0.05):
        circle = coupler.inflection_circle(motion, link, on)
        assert not circle.is_line
        for turn in turns if circle.diameter > 0 else ():
            point = circle.centre - circle.radius * circle.direction * turn
            found = coupler.path_curvature(motion, link, complex(local(motion, link, on, point)), on)
            assert circle.offset(point) == pytest.approx(0.0, abs=1e-12 * (motion.size + circle.radius))
            assert found.curvature * motion.size == pytest.approx(0.0, abs=1e-8)
        if circle.diameter > 0:
            pole = coupler.euler_savary(motion, link, complex(local(motion, link, on, circle.opposite)), on)
            assert pole.curvature * motion.size == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_circles_of_bresse_and_the_acceleration_pole(seed: int) -> None:
    motion = random_motion(seed, acceleration=0.6)
    for link, on in turning_pairs(motion, 0.05):
        normal, tangential = (f(motion, link, on) for f in (coupler.inflection_circle, coupler.tangential_circle))
        pole = coupler.acceleration_pole(motion, link, on)
        still = coupler.relative_point(motion, link, complex(local(motion, link, on, pole)), on)
        scale = motion.size + abs(complex(pole))
        assert abs(complex(still.acceleration)) < 1e-8 * scale * fastest(motion) ** 2
        for circle in (normal, tangential) if normal.diameter > 0 else ():
            assert circle.offset(pole) == pytest.approx(0.0, abs=1e-8 * (scale + circle.diameter))
        if normal.diameter > 0:
            assert (np.conj(normal.direction) * tangential.direction).real == pytest.approx(0.0, abs=1e-9)
            point = complex(local(motion, link, on, tangential.centre + 1j * tangential.direction * tangential.radius))
            path = coupler.relative_point(motion, link, point, on)
            v, a = complex(path.velocity), complex(path.acceleration)
            assert abs((v.conjugate() * a).real) < 1e-8 * (abs(v) * abs(a) + abs(v) ** 2)


def test_circles_of_a_rod_that_translates_for_a_moment_are_lines() -> None:
    """A slider-crank with the crank upright: the pole is at infinity, the inflection circle a straight line."""
    motion = ck.solve(load("slider-crank"), {"crank": np.pi / 2}, speed=1.6, acceleration=0.9)
    circle, tangential = coupler.inflection_circle(motion, "rod"), coupler.tangential_circle(motion, "rod")
    for line in (circle, tangential):
        assert line.is_line
        assert line.defined
        assert np.isinf(line.radius)
        assert np.isinf(line.centre)
    for s in (-0.3, 0.0, 0.2):
        point = complex(circle.through + 1j * circle.direction * s)
        found = coupler.path_curvature(motion, "rod", complex(local(motion, "rod", "frame", point)))
        assert found.inflection
        point = complex(tangential.through + 1j * tangential.direction * s)
        path = motion.links["rod"].at(complex(local(motion, "rod", "frame", point)))
        assert (np.conj(path.velocity) * path.acceleration).real == pytest.approx(0.0, abs=1e-12)
    assert circle.offset(motion.points["B"].position) == pytest.approx(0.0, abs=1e-12)
    assert coupler.path_curvature(motion, "rod", "A").radius == pytest.approx(0.12)
    assert not coupler.euler_savary(motion, "rod", "A").defined
    assert not coupler.canonical_frame(motion, "rod").defined


def test_circle_of_the_tangential_accelerations_at_constant_turning_is_the_pole_normal() -> None:
    motion = ck.solve(load("elliptic-trammel"), {"rod": [2.0]}, speed=1.0, acceleration=0.0)
    line, frame = coupler.tangential_circle(motion, "rod"), coupler.canonical_frame(motion, "rod")
    assert line.is_line.all()
    assert line.offset(frame.origin + 2.0 * frame.normal) == pytest.approx(0.0, abs=1e-12)
    assert np.isinf(coupler.acceleration_pole(catalog("slider-crank"), "piston")[3])


def test_pins_have_an_inflection_circle_of_no_size() -> None:
    motion = catalog("crank-rocker")
    for pair in (("crank", "frame"), ("coupler", "crank")):
        circle, frame = coupler.inflection_circle(motion, *pair), coupler.canonical_frame(motion, *pair)
        assert np.all(circle.diameter == 0)
        assert np.all(frame.tangent == 0)
        assert np.array_equal(circle.centre, circle.through)
    assert not coupler.tangential_circle(motion, "crank").defined.any()
    assert not coupler.path_curvature(motion, "crank", "A").defined.any()


def test_a_point_at_the_pole_has_a_cusp() -> None:
    motion = ck.solve(load("crank-rocker"), {"crank": np.linspace(1.0, 2.0, 5)})
    at_pole = coupler.pole(motion, "coupler").moving
    for way in (coupler.path_curvature, coupler.euler_savary):
        found = way(motion, "coupler", at_pole)
        assert found.cusp.all()
        assert np.all(found.radius == 0)
        assert np.array_equal(found.centre, found.position)


def test_diameter_is_pole_velocity_by_angular_velocity_and_joins_the_centrodes() -> None:
    """1/rho_fixed - 1/rho_moving = 1/d, with both curvatures measured on the loci by differences."""
    step = 1e-3
    motion = ck.solve(load("crank-rocker"), {"crank": 1.3 + step * np.arange(-4, 5)}, order=3)
    curves, frame = coupler.centrodes(motion, "coupler"), coupler.canonical_frame(motion, "coupler")
    turning = motion.links["coupler"].angular_velocity
    assert frame.diameter == pytest.approx(np.abs(coupler.pole_velocity(motion, "coupler") / turning), rel=1e-9)
    bends = []
    for locus in (curves.fixed, curves.moving):
        v, a, _ = differences(locus, step)
        bends.append(np.sign(turning[4]) * (np.conj(v) * a).imag / abs(v) ** 3)
    assert bends[0] - bends[1] == pytest.approx(1.0 / frame.diameter[4], rel=1e-4)
    assert [b[4] for b in coupler.centrode_curvature(motion, "coupler")] == pytest.approx(bends, rel=1e-4)


@pytest.mark.parametrize("seed", SEEDS)
def test_balls_point_is_straight_to_the_third_derivative(seed: int) -> None:
    motion = random_motion(seed)
    for link, on in turning_pairs(motion, 0.05):
        cubic = coupler.stationary_curvature(motion, link, on)
        if not cubic.defined or cubic.every_point:
            continue
        point = complex(local(motion, link, on, cubic.ball))
        found = coupler.path_curvature(motion, link, point, on)
        if well_placed(motion, link, point, on, fastest(motion)):
            circle = coupler.inflection_circle(motion, link, on)
            assert circle.offset(cubic.ball) == pytest.approx(0.0, abs=1e-8 * motion.size)
            assert found.curvature * motion.size == pytest.approx(0.0, abs=1e-7)
            assert coupler.curvature_rate(motion, link, point, on) * motion.size**2 == pytest.approx(0.0, abs=1e-5)


def test_points_of_the_cubic_keep_their_curvature_and_moving_pins_are_on_it() -> None:
    motion = ck.solve(load("crank-rocker"), {"crank": np.linspace(0.9, 2.4, 7)}, order=3)
    cubic = coupler.stationary_curvature(motion, "coupler")
    for letter in ("B", "C"):
        assert cubic.residual(np.asarray(motion.points[letter].position)) == pytest.approx(0.0, abs=1e-9)
    for angle in (0.4, 1.1, 2.0, 2.9):
        point = cubic.at(angle)
        assert cubic.residual(point) == pytest.approx(0.0, abs=1e-9)
        change = coupler.curvature_rate(motion, "coupler", local(motion, "coupler", "frame", point))
        assert change == pytest.approx(0.0, abs=1e-8)


def test_change_of_curvature_against_differences_of_the_curvature() -> None:
    step = 1e-3
    motion = ck.solve(load("crank-rocker"), {"crank": 1.3 + step * np.arange(-4, 5)}, order=3)
    bend = coupler.path_curvature(motion, "coupler", (2.0, 1.5)).curvature
    speed = motion.links["coupler"].at((2.0, 1.5)).speed
    expected = differences(bend, step)[0] / speed[4]
    assert coupler.curvature_rate(motion, "coupler", (2.0, 1.5))[4] == pytest.approx(expected, rel=1e-7)


def test_every_point_of_cardans_inflection_circle_is_balls() -> None:
    cubic = coupler.stationary_curvature(catalog("elliptic-trammel", order=3), "rod")
    assert cubic.every_point.all()
    assert np.isnan(cubic.ball).all()
    assert cubic.inverse_n == pytest.approx(0.0, abs=1e-12)
    assert cubic.inverse_m == pytest.approx(1.0 / 3.0)


@pytest.mark.parametrize("speed", [2.0, -1.0, 1e-3])
@pytest.mark.parametrize("seed", range(6))
def test_geometry_does_not_depend_on_the_driver(seed: int, speed: float) -> None:
    base = random_motion(seed)
    other = random_motion(seed, speed=speed, acceleration=0.7 * speed**2, jerk=-0.4 * speed**3)
    for link, on in turning_pairs(base, 0.05):
        one, two = (coupler.canonical_frame(motion, link, on) for motion in (base, other))
        assert two.diameter == pytest.approx(one.diameter, rel=1e-7, abs=1e-9 * base.size)
        assert two.tangent == pytest.approx(one.tangent, abs=1e-7)
        point = complex(1.3, -0.4)
        a, b = (coupler.path_curvature(motion, link, point, on) for motion in (base, other))
        assert b.curvature == pytest.approx(np.sign(speed) * a.curvature, rel=1e-6, abs=1e-9)
        assert b.centre == pytest.approx(a.centre, rel=1e-6)
        balls = [coupler.stationary_curvature(motion, link, on).ball for motion in (base, other)]
        assert balls[0] == pytest.approx(balls[1], rel=1e-4, abs=1e-6 * base.size, nan_ok=True)


CHANGES = {
    "moved": (lambda p: p + (40 - 25j), 1.0),
    "rotated": (lambda p: p * np.exp(0.8j), 1.0),
    "scaled": (lambda p: 1000.0 * p, 1000.0),
    "mirrored": (lambda p: p.conjugate(), 1.0),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("seed", range(6))
def test_circles_go_along_when_the_mechanism_is_moved(seed: int, change: str) -> None:
    moved, factor = CHANGES[change]
    one = random_motion(seed)
    mechanism = random_mechanism(seed, moved)
    two = ck.solve(mechanism, drawn_values(mechanism), order=3)
    for link, on in turning_pairs(one, 0.05):
        if on != "frame":
            continue
        a, b = (coupler.inflection_circle(motion, link) for motion in (one, two))
        assert b.diameter == pytest.approx(factor * a.diameter, rel=1e-6, abs=1e-8 * two.size)
        assert b.centre == pytest.approx(moved(complex(a.centre)), rel=1e-6)
        for letter in one.mechanism.geometry.points[link]:
            p, q = (coupler.path_curvature(motion, link, letter) for motion in (one, two))
            if p.defined and not p.inflection and p.radius < 1e3 * one.size:
                assert q.centre == pytest.approx(moved(complex(p.centre)), rel=1e-6)
                assert q.radius == pytest.approx(factor * p.radius, rel=1e-6)


def test_poses_that_have_no_rates_are_masked() -> None:
    motion = catalog("triple-rocker", values={"driver": np.linspace(0.0, 2 * np.pi, 73)}, order=3)
    regular = motion.regular.reshape(motion.shape)
    assert not regular.all()
    found = coupler.path_curvature(motion, "coupler", "B")
    assert not found.defined[~regular].any()
    assert np.isnan(found.radius[~regular]).all()
    assert np.isnan(coupler.inflection_circle(motion, "coupler").diameter[~regular]).all()
    assert np.isnan(coupler.acceleration_pole(motion, "coupler")[~regular]).all()
    assert np.isnan(coupler.curvature_rate(motion, "coupler", "B")[~regular]).all()
    assert np.isnan(coupler.stationary_curvature(motion, "coupler").inverse_m[~regular]).all()


def test_bad_input_says_what_is_wrong() -> None:
    mechanism = load("crank-rocker")
    low, still = ck.solve(mechanism, order=1), ck.solve(mechanism, speed=0.0, acceleration=1.0)
    circles = (coupler.inflection_circle, coupler.tangential_circle)
    for found in (coupler.canonical_frame, *circles, coupler.acceleration_pole):
        with pytest.raises(ck.errors.InvalidInput, match=r"solve\(..., order=2\)"):
            found(low, "coupler")
        with pytest.raises(ck.errors.InvalidInput, match="every driver's speed is zero"):
            found(still, "coupler")
    with pytest.raises(ck.errors.InvalidInput, match=r"solve\(..., order=3\)"):
        coupler.stationary_curvature(ck.solve(mechanism), "coupler")
    with pytest.raises(ck.errors.InvalidInput, match=r"solve\(..., order=3\)"):
        coupler.curvature_rate(ck.solve(mechanism), "coupler", "B")
    with pytest.raises(ck.errors.UnknownName, match="'coupler'"):
        coupler.path_curvature(ck.solve(mechanism), "copler", "B")
    with pytest.raises(ck.errors.UnknownName, match="no such point"):
        coupler.euler_savary(ck.solve(mechanism), "coupler", "A")
