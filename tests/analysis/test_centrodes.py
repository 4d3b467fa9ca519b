"""Relative motion, poles and centrodes: published curves, rolling, numeric differentiation, invariance."""

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

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")


def test_elliptic_trammel_has_the_circles_of_cardan() -> None:
    curves = coupler.centrodes(catalog("elliptic-trammel"), "rod")
    assert np.abs(curves.fixed) == pytest.approx(3.0, abs=1e-12)
    assert np.abs(curves.moving - 1.5) == pytest.approx(1.5, abs=1e-12)
    fixed, moving = coupler.centrode_curvature(catalog("elliptic-trammel", order=3), "rod")
    assert np.abs(fixed) == pytest.approx(1 / 3.0, abs=1e-12)
    assert np.abs(moving) == pytest.approx(1 / 1.5, abs=1e-12)


def test_scott_russell_has_the_circles_of_cardan_too() -> None:
    curves = coupler.centrodes(catalog("scott-russell"), "rod")
    assert np.abs(curves.fixed) == pytest.approx(2.0, abs=1e-12)
    assert np.abs(curves.moving - 1.0) == pytest.approx(1.0, abs=1e-12)


def test_oldham_block_rolls_in_a_circle_of_twice_its_size() -> None:
    """The block's centre runs round the circle over the shafts' distance; its pole is the point of it opposite M."""
    motion = catalog("oldham-coupling")
    curves = coupler.centrodes(motion, "block")
    assert curves.fixed == pytest.approx(1.2 - np.asarray(motion.points["M"].position), abs=1e-12)
    assert np.abs(curves.moving) == pytest.approx(1.2, abs=1e-12)


def test_cranks_of_the_antiparallelogram_are_rolling_ellipses() -> None:
    """F. Reuleaux (1875): foci are the pins of each crank, the major axis is the length of the long links."""
    motion = ck.solve(load("antiparallelogram"), {"crank": np.linspace(0.2, 2.9, 40)})
    curves = coupler.centrodes(motion, "follower", on="crank")
    for locus in (curves.fixed, curves.moving):
        assert np.abs(locus) + np.abs(locus - 30.0) == pytest.approx(60.0, abs=1e-9)


def test_pole_of_the_connecting_rod_is_where_the_crank_meets_the_normal_of_the_guide() -> None:
    motion = catalog("slider-crank")
    found = coupler.pole(motion, "rod")
    x, crank = motion.points["B"].x, motion.links["crank"].angle
    up = np.abs(np.cos(crank)) < 1e-9
    assert found.world[~up] == pytest.approx((x + 1j * x * np.tan(crank))[~up], rel=1e-12)
    assert found.infinite.tolist() == up.tolist()
    assert np.all(np.isinf(found.fixed[up]) & np.isinf(found.moving[up]) & np.isinf(found.world[up]))
    assert np.abs(found.direction[up].imag) == pytest.approx(1.0)
    assert np.all(found.direction[~up] == 0)
    assert found.homogeneous[up][:, 2].tolist() == [0.0, 0.0]


def test_pole_of_a_slide_is_at_infinity_across_the_guide_also_where_it_turns_back() -> None:
    motion = catalog("slider-crank")
    found = coupler.pole(motion, "piston")
    assert found.infinite.all()
    assert found.defined.all()
    assert found.direction.real == pytest.approx(0.0, abs=1e-12)
    turning = coupler.pole(catalog("six-bar"), "block", on="bar")
    assert turning.infinite.all()
    assert turning.direction.real == pytest.approx(0.0, abs=1e-9)


def test_pole_of_a_parallelogram_is_at_infinity_along_the_cranks() -> None:
    motion = ck.solve(load("parallelogram"), {"crank": np.linspace(0.3, 2.8, 12)})
    found = coupler.pole(motion, "coupler")
    along = np.exp(1j * motion.links["crank"].angle)
    assert found.infinite.all()
    assert (np.conj(along) * found.direction).imag == pytest.approx(0.0, abs=1e-9)


def test_pole_of_a_pin_is_the_pin() -> None:
    motion = catalog("six-bar")
    for letter, (one, other) in {k: v for k, v in motion.mechanism.pins.items() if len(v) == 2}.items():
        found = coupler.pole(motion, one, on=other)
        assert found.fixed == pytest.approx(motion.mechanism.geometry.points[other][letter], abs=1e-9)
        assert found.moving == pytest.approx(motion.mechanism.geometry.points[one][letter], abs=1e-9)
        assert found.world == pytest.approx(np.asarray(motion.points[letter].position), abs=1e-9)


def test_pole_of_a_rocker_at_the_end_of_its_swing_is_the_limit() -> None:
    """Crank 2 and coupler 5 in line: the rocker 4 stands still, and only second derivatives tell its pole."""
    dead = np.arccos((7.0**2 + 5.5**2 - 4.0**2) / (2 * 7.0 * 5.5))
    mechanism = load("crank-rocker")
    found = coupler.pole(ck.solve(mechanism, {"crank": [dead, dead + 0.1]}), "rocker")
    assert found.defined.all()
    assert found.world == pytest.approx(5.5, abs=1e-6)
    first = coupler.pole(ck.solve(mechanism, {"crank": [dead, dead + 0.1]}, order=1), "rocker")
    assert first.defined.tolist() == [False, True]
    assert np.isnan(first.world[0])
    rates = coupler.centrodes(ck.solve(mechanism, {"crank": [dead, dead + 0.1]}), "rocker")
    assert np.isnan(rates.fixed_velocity).tolist() == [True, False]


SIX_BARS = ["six-bar", "watt-ii", "crank-shaper", "class-iii-six-bar", "stephenson-iii-floating-driver"]


@pytest.mark.parametrize("name", SIX_BARS)
def test_three_poles_of_three_links_lie_on_a_line(name: str) -> None:
    """Aronhold and Kennedy, by homogeneous coordinates in the world, centres at infinity among them."""
    motion = catalog(name)
    links = list(motion.links)
    for i, a in enumerate(links):
        for j, b in enumerate(links[:i]):
            for c in links[:j]:
                rows = [_world(motion, *pair) for pair in ((a, b), (b, c), (a, c))]
                good = np.all(np.isfinite(rows), axis=(0, 2))
                assert good.sum() > len(good) / 2
                assert np.abs(np.linalg.det(np.stack(rows, axis=-2)[good])) == pytest.approx(0.0, abs=1e-9)


def _world(motion: ck.results.Motion, link: str, on: str) -> Any:
    found = coupler.pole(motion, link, on)
    far = np.exp(1j * motion.links[on].angle) * found.direction
    place = np.where(found.infinite, far, np.where(found.infinite, 0.0, found.world) / motion.size)
    rows = np.stack([place.real, place.imag, np.where(found.infinite, 0.0, 1.0)], axis=-1)
    return rows / np.linalg.norm(rows, axis=-1, keepdims=True)


@each(THIRD)
def test_a_point_at_the_pole_stands_still_all_others_turn_around_it_and_centrodes_roll(name: str) -> None:
    """The pole's velocities come from different series: equal as vectors means equal arcs and a common tangent."""
    motion = catalog(name)
    for link, on in turning_pairs(motion):
        # of links that are seen from many others, the frame and its neighbour in the list stand for all
        if on not in [other for other in motion.links if other != link][:2]:
            continue
        found = coupler.pole(motion, link, on)
        scale = 1.0 + np.abs(found.moving) / motion.size
        still = coupler.relative_point(motion, link, np.nan_to_num(found.moving), on).speed
        assert np.all((still <= 1e-9 * motion.size * scale * fastest(motion))[motion.assembled])
        turning = motion.links[link].angular_velocity - motion.links[on].angular_velocity
        for letter in motion.mechanism.geometry.points[link]:
            point = coupler.relative_point(motion, link, letter, on)
            from_centre = 1j * turning * (np.asarray(point.position) - found.fixed)
            error = np.abs(from_centre - np.asarray(point.velocity))
            assert np.all((error <= 1e-9 * motion.size * scale * fastest(motion))[motion.assembled])
        curves = coupler.centrodes(motion, link, on)
        turn = np.exp(1j * coupler.relative_link(motion, link, on).angle)
        known = np.isfinite(curves.fixed_velocity)
        slip = np.abs((turn * curves.moving_velocity - curves.fixed_velocity)[known])
        assert np.max(slip / (motion.size + np.abs(curves.fixed_velocity[known])), initial=0.0) < 1e-9


@pytest.mark.parametrize("seed", range(12))
def test_pole_velocities_against_numeric_differentiation(seed: int) -> None:
    mechanism = random_mechanism(seed)
    step, start = 2e-4, drawn_values(mechanism)
    motion = ck.solve(mechanism, {k: v + step * np.arange(-4, 5) for k, v in start.items()}, speed=1.0)
    for link, on in turning_pairs(motion):
        curves = coupler.centrodes(motion, link, on)
        if np.max(np.abs(curves.fixed)) > 20.0 * motion.size:
            continue
        scale = motion.size + np.max(np.abs(curves.fixed_velocity))
        for locus, rate in ((curves.fixed, curves.fixed_velocity), (curves.moving, curves.moving_velocity)):
            assert np.abs(differences(locus, step)[0] - rate[4]) / scale < 1e-5
        assert coupler.pole_velocity(motion, link, on) == pytest.approx(curves.fixed_velocity, rel=1e-12)


def test_arc_lengths_of_both_centrodes_are_equal() -> None:
    """Measured along the polygons of the loci themselves, 20,000 chords."""
    motion = ck.solve(load("crank-rocker"), {"crank": np.linspace(1.0, 2.5, 20001)})
    curves = coupler.centrodes(motion, "coupler")
    fixed, moving = (np.cumsum(np.abs(np.diff(locus))) for locus in (curves.fixed, curves.moving))
    assert fixed[-1] > 1.0
    assert moving == pytest.approx(fixed, rel=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_roles_exchanged_exchange_the_centrodes(seed: int) -> None:
    mechanism = random_mechanism(seed)
    motion = ck.solve(mechanism, drawn_values(mechanism), order=3)
    for link, on in turning_pairs(motion):
        one, other = coupler.pole(motion, link, on), coupler.pole(motion, on, link)
        for a, b in ((one.fixed, other.moving), (one.moving, other.fixed), (one.world, other.world)):
            assert a == pytest.approx(b, rel=1e-7, abs=1e-9 * motion.size)
        fixed, moving = coupler.centrode_curvature(motion, link, on)
        fixed_, moving_ = coupler.centrode_curvature(motion, on, link)
        assert (fixed, moving) == pytest.approx((-moving_, -fixed_), rel=1e-5, abs=1e-6 / motion.size, nan_ok=True)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("speed", [2.0, -1.0, 1e-3])
def test_centrodes_do_not_depend_on_the_driver(seed: int, speed: float) -> None:
    mechanism = random_mechanism(seed)
    base = ck.solve(mechanism, drawn_values(mechanism), speed=1.0, acceleration=0.0, order=3)
    other = ck.solve(mechanism, drawn_values(mechanism), speed=speed, acceleration=0.7 * speed**2, order=3)
    for link, on in turning_pairs(base):
        one, two = coupler.centrodes(base, link, on), coupler.centrodes(other, link, on)
        assert two.fixed == pytest.approx(one.fixed, rel=1e-7)
        assert two.moving == pytest.approx(one.moving, rel=1e-7, abs=1e-9 * base.size)
        assert two.fixed_velocity / speed == pytest.approx(one.fixed_velocity, rel=1e-6, abs=1e-8 * base.size)
        bends = [coupler.centrode_curvature(motion, link, on) for motion in (base, other)]
        for a, b in zip(*bends, strict=True):
            assert b == pytest.approx(a, rel=1e-5, abs=1e-6 / base.size, nan_ok=True)


CHANGES = {
    "moved": lambda p: p + (40 - 25j),
    "rotated": lambda p: p * np.exp(0.8j),
    "scaled": lambda p: 1000.0 * p,
    "mirrored": lambda p: p.conjugate(),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("seed", range(6))
def test_poles_go_along_when_the_mechanism_is_moved(seed: int, change: str) -> None:
    plain, moved = random_mechanism(seed), random_mechanism(seed, CHANGES[change])
    one, two = (ck.solve(m, drawn_values(m), speed=1.0) for m in (plain, moved))
    for link, on in turning_pairs(one):
        a, b = coupler.pole(one, link, on), coupler.pole(two, link, on)
        assert b.world == pytest.approx(CHANGES[change](complex(a.world)), rel=1e-6)


def test_links_seen_from_links_give_velocities_and_accelerations() -> None:
    """Against the transport formula v = v_rel + v_carried with Coriolis, by the absolute motion alone."""
    motion = catalog("hibbeler-quick-return")
    for link, on in turning_pairs(motion):
        if on == "frame":
            continue
        letter = next(iter(motion.mechanism.geometry.points[link]))
        seen, pose = coupler.relative_point(motion, link, letter, on), motion.links[on]
        absolute = motion.links[link].at(motion.mechanism.geometry.points[link][letter])
        u, omega, alpha = np.exp(1j * pose.angle), pose.angular_velocity, pose.angular_acceleration
        arm = u * seen.position
        v = pose.origin.velocity + 1j * omega * arm + u * seen.velocity
        carried = pose.origin.acceleration + (1j * alpha - omega**2) * arm
        a = carried + 2j * omega * u * seen.velocity + u * seen.acceleration
        assert np.asarray(v) == pytest.approx(np.asarray(absolute.velocity), abs=1e-9 * motion.size)
        assert np.asarray(a) == pytest.approx(np.asarray(absolute.acceleration), abs=1e-8 * motion.size)


def test_designs_keep_their_axes_and_a_single_pose_its_own() -> None:
    mechanism = load("elliptic-trammel")
    rod = ck.link("rod", A=(0, 0), B=(np.array([[2.0], [3.0]]), np.zeros((2, 1))), M=0.5, P=(1, 0.5))
    motion = ck.solve(mechanism.replace(rod), {"rod": np.linspace(2.0, 3.0, 5)})
    curves = coupler.centrodes(motion, "rod")
    assert curves.fixed.shape == motion.shape == (2, 5)
    assert np.abs(curves.fixed) == pytest.approx(np.repeat([[2.0], [3.0]], 5, axis=1))
    single = coupler.pole(ck.solve(mechanism, {"rod": 2.0}), "rod")
    assert np.shape(single.fixed) == ()
    assert abs(single.fixed) == pytest.approx(3.0)


def test_poses_that_are_not_assembled_or_have_no_rates_are_masked() -> None:
    motion = catalog("triple-rocker", values={"driver": np.linspace(0.0, 2 * np.pi, 73)})
    found = coupler.pole(motion, "coupler")
    assert not motion.assembled.all()
    assert found.defined.tolist() == motion.regular.reshape(motion.shape).tolist()
    assert np.isnan(found.fixed[~found.defined]).all()
    assert np.isfinite(found.fixed[found.defined & ~found.infinite]).all()
    assert np.isnan(found.homogeneous[~found.defined][:, 2]).all()


def test_links_that_never_move_relative_to_each_other_have_no_pole() -> None:
    frame = ck.link("frame", A=0, D=5, E=8)
    items = [ck.link("crank", A=0, B=1), ck.link("one", E=0), ck.drive("crank"), ck.drive("one", values=0.0, speed=0.0)]
    motion = ck.solve(ck.Mechanism("m", frame, *items), {"crank": [0.0, 1.0]})
    assert not coupler.pole(motion, "one").defined.any()


def test_bad_input_says_what_is_wrong() -> None:
    mechanism = load("crank-rocker")
    motion = ck.solve(mechanism, order=1)
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'coupler'"):
        coupler.pole(motion, "couplr")
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'rocker'"):
        coupler.relative_point(motion, "coupler", "B", on="rockr")
    with pytest.raises(ck.errors.UnknownName, match="link 'coupler' has no such point; known: B, C"):
        coupler.relative_point(motion, "coupler", "Q")
    with pytest.raises(ck.errors.InvalidInput, match="does not move relative to itself"):
        coupler.relative_link(motion, "coupler", on="coupler")
    with pytest.raises(ck.errors.InvalidInput, match="not a point"):
        coupler.relative_point(motion, "coupler", (1, 2, 3))
    with pytest.raises(ck.errors.InvalidInput, match="does not broadcast"):
        coupler.relative_point(motion, "coupler", np.zeros(5, complex))
    with pytest.raises(
        ck.errors.InvalidInput, match=r"order 2; the motion was solved to order 1; solve\(..., order=2\)"
    ):
        coupler.centrodes(motion, "coupler")
    with pytest.raises(ck.errors.InvalidInput, match="order 1"):
        coupler.pole(ck.solve(mechanism, order=0), "coupler")
    with pytest.raises(ck.errors.InvalidInput, match=r"no driver moves at pose \(3,\)"):
        coupler.pole(ck.solve(mechanism, {"crank": np.arange(5.0)}, speed=[1, 1, 1, 0, 1]), "coupler")
