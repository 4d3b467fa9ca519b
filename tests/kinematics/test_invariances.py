"""What must not matter, over random compound mechanisms: dyads of every kind on each other, assembled as drawn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics import Motion
from tests.support import KINDS_OF_DYAD, Sketch, differences, drawn_values, examples, random_sketch, well_conditioned

SEEDS = st.integers(0, 2**32 - 1)
ORDER = 3
SWEEP = np.linspace(-0.02, 0.02, 5)
few = settings(max_examples=12)


def random_mechanism(seed: int) -> tuple[Sketch, ck.Mechanism]:
    """One to four random dyads on a crank or driven slide, none near a limit position."""
    rng = np.random.default_rng(seed)
    while True:
        kinds = list(rng.choice(KINDS_OF_DYAD, rng.integers(1, 5)))
        sketch = random_sketch(rng, kinds, driver=str(rng.choice(["R", "P"])))
        mechanism = sketch.mechanism()
        if well_conditioned(mechanism, 15.0, 0.03):
            return sketch, mechanism


def near_home(mechanism: ck.Mechanism, speed: float = 1.0, **more: Any) -> Motion:
    values = {name: value + SWEEP for name, value in drawn_values(mechanism).items()}
    speeds = dict.fromkeys(values, speed)
    return ck.solve(mechanism, values, speed=speeds, order=ORDER, **more)


def close(found: Any, expected: Any, k: int = 0) -> bool:
    """Equal to rounding, which grows with the order of the derivative."""
    scale = 1.0 + np.max(np.abs(expected))
    return bool(np.max(np.abs(np.asarray(found) - np.asarray(expected))) < 1e-10 * 10**k * scale)


def same(one: Motion, other: Motion, change: Callable[[Any, int], Any]) -> None:
    """Whether the points of two motions differ by a change of the plane alone, with all derivatives."""
    assert np.all(one.assembled)
    assert np.all(other.assembled)
    for letter, point in one.points.items():
        moved = other.points[letter]
        for k in range(ORDER + 1):
            assert close(moved.derivative(k), change(point.derivative(k), k), k)


@settings(max_examples=examples(25))
@given(seed=SEEDS)
def test_the_drawn_pose_is_solved_as_drawn(seed: int) -> None:
    """Every dimension read off the drawing; at the drawn driver value the drawing comes out."""
    sketch, mechanism = random_mechanism(seed)
    motion = ck.solve(mechanism, drawn_values(mechanism))
    for letter, place in sketch.places.items():
        assert close(motion.points[letter].position, place)
    for name, value in drawn_values(mechanism).items():
        assert close(motion.drives[name].value, value)
        driven = motion.structure.driven[name].pair.name
        assert close(np.exp(1j * motion.pairs[driven].value), np.exp(1j * value))


@few
@given(seed=SEEDS)
def test_all_points_of_a_letter_stay_together(seed: int) -> None:
    """Every pin, on every link that carries it, to all orders: closure without the pairs' equations."""
    _, mechanism = random_mechanism(seed)
    motion = near_home(mechanism)
    for letter, links in mechanism.pins.items():
        for link in links[1:]:
            there = motion.links[link].at(mechanism.geometry.points[link][letter])
            for k in range(ORDER + 1):
                assert close(there.derivative(k), motion.points[letter].derivative(k), k)


@few
@given(seed=SEEDS)
def test_derivatives_are_those_of_the_positions(seed: int) -> None:
    """Against ninth-order differences of separately solved positions, with speed, acceleration and jerk."""
    _, mechanism = random_mechanism(seed)
    start, step = drawn_values(mechanism), 2e-3
    w, a, j = 1.0, -0.7, 0.4
    times = step * np.arange(-4, 5)
    values = {k: v + w * times + a * times**2 / 2 + j * times**3 / 6 for k, v in start.items()}
    sampled = ck.solve(mechanism, values, order=0)
    rates = {name: dict.fromkeys(start, rate) for name, rate in (("speed", w), ("acceleration", a), ("jerk", j))}
    motion = ck.solve(mechanism, start, order=ORDER, **rates)  # type: ignore[arg-type]
    for letter, point in motion.points.items():
        expected = differences(sampled.points[letter].position, step)
        for k in range(1, ORDER + 1):
            assert abs(complex(point.derivative(k)) - expected[k - 1]) < 10.0 ** (2 * k - 9) * (
                1 + abs(expected[k - 1])
            )
    for name, link in motion.links.items():
        expected = differences(sampled.links[name].angle, step)
        found = (link.angular_velocity, link.angular_acceleration, link.angular_jerk)
        for k in range(1, ORDER + 1):
            assert abs(float(found[k - 1]) - expected[k - 1]) < 10.0 ** (2 * k - 9) * (1 + abs(expected[k - 1]))
    for name, pair in motion.pairs.items():
        expected = differences(sampled.pairs[name].value, step)
        for k, found_rate in enumerate((pair.rate, pair.second, pair.third), start=1):
            assert abs(float(found_rate) - expected[k - 1]) < 10.0 ** (2 * k - 9) * (1 + abs(expected[k - 1]))


@few
@given(seed=SEEDS)
def test_moving_and_turning_the_drawing(seed: int) -> None:
    sketch, mechanism = random_mechanism(seed)
    turn, shift = np.exp(0.7j + 1j * (seed % 5)), 3 - 8j
    moved = sketch.mechanism(lambda p: complex(turn * p + shift))
    same(near_home(mechanism), near_home(moved), lambda v, k: turn * v + (shift if k == 0 else 0))


@few
@given(seed=SEEDS)
def test_scaling_the_drawing(seed: int) -> None:
    """Lengths scale, angles do not; a driven length scales with its rates."""
    sketch, mechanism = random_mechanism(seed)
    scale = 10.0 ** (seed % 13 - 6)
    scaled = sketch.mechanism(lambda p: scale * p)
    one = near_home(mechanism)
    is_angle = all(drive.is_angle for drive in one.drives.values())
    part = 1.0 if is_angle else scale
    values = {name: value + SWEEP * part for name, value in drawn_values(scaled).items()}
    other = ck.solve(scaled, values, speed=dict.fromkeys(values, part), order=ORDER)
    same(one, other, lambda v, k: scale * v) if scale >= 1 else same(other, one, lambda v, k: v / scale)


@few
@given(seed=SEEDS)
def test_mirroring_the_drawing(seed: int) -> None:
    """The mirror image moves as the mirror image, when it is driven the other way round."""
    sketch, mechanism = random_mechanism(seed)
    one = near_home(mechanism)
    mirrored = sketch.mechanism(lambda p: p.conjugate())
    sign = -1.0 if all(drive.is_angle for drive in one.drives.values()) else 1.0
    values = {name: value + sign * SWEEP for name, value in drawn_values(mirrored).items()}
    other = ck.solve(mirrored, values, speed=dict.fromkeys(values, sign), order=ORDER)
    same(one, other, lambda v, k: np.conjugate(v))


@few
@given(seed=SEEDS)
def test_names_and_order_of_what_is_written(seed: int) -> None:
    """Links renamed and written in another order, letters in another order after each link's first two."""
    sketch, mechanism = random_mechanism(seed)
    rng = np.random.default_rng(seed)
    names = {name: f"link number {k}" for k, name in enumerate(sorted(sketch.links, reverse=True)) if name != "frame"}
    shuffled = sketch.renamed(names)
    for drive in shuffled.drives:
        drive["name"] = "driver"
    shuffled.links = {
        name: [*letters[:2], *rng.permutation(letters[2:]).tolist()]
        for name, letters in sorted(shuffled.links.items(), key=lambda _: rng.random())
    }
    shuffled.slides = [shuffled.slides[k] for k in rng.permutation(len(shuffled.slides))]
    other = shuffled.mechanism()
    one, two = near_home(mechanism), near_home(other)
    same(one, two, lambda v, k: v)
    for name, new in names.items():
        assert close(two.links[new].angular_velocity, one.links[name].angular_velocity, 1)


def from_link(motion: Motion, link: str, drawn: Pose) -> Callable[[str], Series]:
    """The points' motion as seen from a link, which stays where it is drawn."""
    seen = drawn.compose(motion.poses[link].inverse())

    def point(letter: str) -> Series:
        found = motion.points[letter]
        return seen.at(Series(tuple(np.asarray(found.derivative(k)) / [1, 1, 2, 6][k] for k in range(ORDER + 1))))

    return point


@settings(max_examples=examples(20))
@given(seed=SEEDS, choice=st.integers(0, 100))
def test_any_link_may_be_the_frame(seed: int, choice: int) -> None:
    """Kinematic inversion: held by another link, the drive where it was, the mechanism has the same relative motion."""
    sketch, mechanism = random_mechanism(seed)
    held = [name for name in sketch.links if name != "frame"][choice % (len(sketch.links) - 1)]
    swapped = sketch.renamed({held: "frame", "frame": "old frame"})
    for drive in swapped.drives:
        drive.update(on="old frame", name="link0")
    other = swapped.mechanism()
    one = near_home(mechanism)
    two = near_home(other)
    drawn = mechanism.geometry.drawn[held]
    seen = from_link(one, held, Pose(constant(drawn.z.c[0]), constant(drawn.u.c[0])))
    assert np.all(two.assembled)
    for letter in sketch.places:
        expected = seen(letter)
        for k in range(ORDER + 1):
            assert close(two.points[letter].derivative(k), expected.derivative(k), k + 1)


@few
@given(seed=SEEDS)
def test_a_faster_driver_scales_the_derivatives(seed: int) -> None:
    """Speed w, no acceleration: the k-th derivative is w**k times that at speed 1."""
    _, mechanism = random_mechanism(seed)
    one, fast = near_home(mechanism), near_home(mechanism, speed=-3.0)
    same(one, fast, lambda v, k: v * (-3.0) ** k)
    for name, link in one.links.items():
        other = fast.links[name]
        assert close(other.angular_acceleration, 9 * link.angular_acceleration, 2)
        assert close(other.angular_jerk, -27 * link.angular_jerk, 3)


@few
@given(seed=SEEDS)
def test_dimensions_written_in_other_axes(seed: int) -> None:
    """The same links written out by coordinates in axes laid at random, instead of as drawn."""
    sketch, mechanism = random_mechanism(seed)
    rng = np.random.default_rng(seed)
    items: list[Any] = []
    axes = {name: (complex(*rng.standard_normal(2)), np.exp(1j * rng.uniform(0, 6))) for name in sketch.links}
    axes["frame"] = (0j, 1 + 0j)
    for name, letters in sketch.links.items():
        z, u = axes[name]
        items.append(ck.link(name, **{k: complex((sketch.places[k] - z) / u) for k in letters}))
    for words, pair in zip(sketch.slides, mechanism.written_pairs, strict=True):
        guide, block = pair.ends(mechanism.geometry)
        drawn = mechanism.geometry.drawn
        along = drawn[words["on"]].u.c[0] * guide.direction
        # the offset as a length across the guide; the turn as the angle from the guide to the block's axes
        offset = float((np.conj(along) * (sketch.places[words["at"]] - sketch.places[words["through"]])).imag)
        turn = float(np.angle(axes[words["link"]][1] / along))
        items.append(ck.slide(**words, offset=offset, turn=turn))
        assert block.direction is not None
    items += [ck.drive(**words) for words in sketch.drives]
    other = ck.Mechanism("other axes", *items, ck.drawn(**sketch.places))
    one = near_home(mechanism)
    start = drawn_values(mechanism)
    if one.drives["link0"].is_angle:
        letters = sketch.links["link0"]
        start = {"link0": float(np.angle(axes["link0"][1]))}
        assert len(letters) >= 2
    two = ck.solve(other, {k: v + SWEEP for k, v in start.items()}, order=ORDER)
    same(one, two, lambda v, k: v)


def test_an_unbranched_chain_of_many_dyads() -> None:
    """Sixty dyads, one on another: rounding stays small and every point is where it is drawn."""
    rng = np.random.default_rng(0)
    sketch = random_sketch(rng, rng.choice(KINDS_OF_DYAD, 60))
    mechanism = sketch.mechanism()
    assert len(ck.decompose(mechanism).groups) == 60
    motion = ck.solve(mechanism, drawn_values(mechanism), order=0)
    for letter, place in sketch.places.items():
        assert abs(complex(motion.points[letter].position) - place) < 1e-8


@pytest.mark.parametrize("kind", KINDS_OF_DYAD)
def test_each_kind_alone_over_designs(kind: str) -> None:
    """Dimensions as arrays: a batch of drawings solved at once is each of them solved alone."""
    rng = np.random.default_rng(3)
    sketch = random_sketch(rng, [kind])
    many = {
        k: p + 0.05 * (rng.standard_normal((4, 1)) + 1j * rng.standard_normal((4, 1))) for k, p in sketch.places.items()
    }
    # the crank's axes are to be the same in every design
    first = sketch.links["link0"][0]
    many[first] = np.full((4, 1), sketch.places[first])
    items = list(sketch.mechanism().items[:-1])
    values = drawn_values(sketch.mechanism())["link0"] + SWEEP
    together = ck.solve(ck.Mechanism("m", *items, ck.drawn(**many)), {"link0": values}, order=ORDER)
    assert together.shape == (4, 5)
    for row in range(4):
        one = ck.Mechanism("m", *items, ck.drawn(**{k: complex(v[row, 0]) for k, v in many.items()}))
        alone = ck.solve(one, {"link0": values}, order=ORDER)
        assert np.array_equal(alone.assembled, together.assembled[row])
        for letter, point in alone.points.items():
            for k in range(ORDER + 1):
                assert close(together.points[letter].derivative(k)[row], point.derivative(k), k)
