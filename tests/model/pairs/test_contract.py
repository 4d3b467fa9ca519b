"""What every kind of pair must do: `KINDS` is iterated, so that a new kind is tested the day it arrives."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.linalg import null_space

import compoundkin as ck
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series, constant
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs import KINDS, WRITTEN, Pair
from compoundkin.model.pairs.contract import Line, as_drivable, as_turn_counting
from tests.support import ends_at, largest, random_planar, random_pose, random_real, random_unit, sample

SEEDS = st.integers(0, 2**32 - 1)
every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=[kind.code for kind in KINDS.values()])
every_drivable_kind = pytest.mark.parametrize(
    "kind", [kind for kind in KINDS.values() if kind.held == 2], ids=lambda k: k.code
)

Ends = tuple[End, ...]
Poses = tuple[Pose, ...]


def pose_at(x: float, y: float, theta: float) -> Pose:
    return Pose(constant(complex(x, y)), constant(complex(np.cos(theta), np.sin(theta))), constant(theta))


def poses_at(state: np.ndarray) -> Poses:
    return tuple(pose_at(*part) for part in np.split(state, len(state) // 3))


def random_poses(pair: Pair, rng: np.random.Generator, order: int, shape: tuple[int, ...]) -> Poses:
    return tuple(random_pose(rng, order, shape) for _ in pair.members)


def free_ends(pair: Pair, rng: np.random.Generator) -> Ends:
    """Sides that do not close, in the links' frames."""
    return ends_at(pair, rng, random_poses(pair, rng, 0, ()))


def relative(pair: Pair, ends: Ends, state: np.ndarray) -> np.ndarray:
    poses = poses_at(state)
    return np.array([*[c.c[0] for c in pair.closure(ends, poses)], pair.coordinate(ends, poses).c[0]])


def assume_no_centre_of_curvature(pair: Pair, ends: Ends, poses: Poses) -> None:
    """A roller well outside its profile: near a centre of curvature the foot of its middle leaps."""
    if not getattr(pair, "is_flat", True):
        assume(bool(np.all(pair.closure(ends, still(poses))[0].c[0] > 0.4)))


def still(poses: Poses) -> Poses:
    return tuple(Pose(constant(p.z.c[0]), constant(p.u.c[0]), constant(p.angle.c[0])) for p in poses)


@every_kind
def test_says_what_it_is(kind: type[Pair]) -> None:
    pair = sample(kind)
    assert len(kind.code) == 1
    assert 0 < kind.held < 3
    assert kind.held + len(kind.free) <= 3
    assert len(pair.members) in (2, 3)
    assert (as_drivable(pair) is not None) == (kind.held == 2)
    assert pair.letters
    assert kind.title.endswith("pair")
    assert KINDS[kind.code] is kind
    if kind.table:
        assert WRITTEN[kind.table] is kind
        assert all(hasattr(pair, key.name) for key in kind.keys)
    assert pair.name == "name"


@every_kind
@given(seed=SEEDS)
def test_jacobian_against_central_differences(kind: type[Pair], seed: int) -> None:
    """Not only where the pair is closed, but for the angles, which are sines there."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    state = rng.standard_normal(3 * len(pair.members))
    ends = free_ends(pair, rng)
    assume_no_centre_of_curvature(pair, ends, poses_at(state))
    matrix = pair.jacobian(ends, poses_at(state))
    assert matrix.shape == (kind.held + 1, len(state))
    for column in range(len(state)):
        step = np.zeros(len(state))
        step[column] = 1e-3
        # four points: the error is of order 1e-12 times the fifth derivative
        near = relative(pair, ends, state + step) - relative(pair, ends, state - step)
        far = relative(pair, ends, state + 2 * step) - relative(pair, ends, state - 2 * step)
        turn = 2 * np.pi if kind.free_is_angle else np.inf
        near[-1], far[-1] = (np.remainder(v[-1] + np.pi, turn) - np.pi if turn < np.inf else v[-1] for v in (near, far))
        assert np.allclose(matrix[:, column], (8 * near - far) / 12e-3, atol=1e-8)


@every_kind
@given(seed=SEEDS)
def test_jacobian_is_that_of_the_series(kind: type[Pair], seed: int) -> None:
    """What a kind says for speed is what `Pair.jacobian` finds without it; a sharp hollow loses a digit or two."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    poses = random_poses(pair, rng, 2, (3,))
    ends = free_ends(pair, rng)
    assume_no_centre_of_curvature(pair, ends, poses)
    assert np.allclose(pair.jacobian(ends, poses), Pair.jacobian(pair, ends, poses), atol=1e-9)


@every_kind
@given(seed=SEEDS)
def test_centre_is_that_of_the_jacobian(kind: type[Pair], seed: int) -> None:
    """What a kind says is what `Pair.centre` finds without it; a point may be known where that finds a line only."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = pair.generic(rng)
    poses = (FIXED,) * len(ends)
    said, found = np.array(pair.centre(ends, poses)), np.array(Pair.centre(pair, ends, poses))
    if isinstance(pair.centre(ends, poses), Line):
        assert abs(abs(said @ found) / np.linalg.norm(said) / np.linalg.norm(found) - 1.0) < 1e-12
    elif isinstance(Pair.centre(pair, ends, poses), Line):
        assert abs(said @ found) < 1e-9
    else:
        assert np.allclose(said, found, atol=1e-9)


@every_kind
@given(seed=SEEDS)
def test_jacobian_of_arrays_is_that_of_each(kind: type[Pair], seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    poses = random_poses(pair, rng, 0, (5,))
    ends = free_ends(pair, rng)
    together = pair.jacobian(ends, poses)
    for k in range(5):
        one = tuple(Pose.of(p.z.c[0][k], p.u.c[0][k]).counted(p.angle.c[0][k]) for p in poses)
        alone = pair.jacobian(ends, one)
        assert np.allclose(np.broadcast_to(together, (5, *alone.shape))[k], alone, atol=1e-14)


@every_kind
@given(seed=SEEDS)
def test_rates_of_the_closure_are_jacobian_times_twist(kind: type[Pair], seed: int) -> None:
    """The series of closure and coordinate against the Jacobian, at first order."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    poses = random_poses(pair, rng, 1, ())
    ends = free_ends(pair, rng)
    assume_no_centre_of_curvature(pair, ends, poses)
    twist = np.concatenate([[p.z.c[1].real, p.z.c[1].imag, (p.u.c[1] / (1j * p.u.c[0])).real] for p in poses])
    rates = [*[c.c[1] for c in pair.closure(ends, poses)], pair.coordinate(ends, poses).c[1]]
    assert np.allclose(pair.jacobian(ends, still(poses)) @ twist, rates, atol=1e-12)


@every_kind
@given(seed=SEEDS)
def test_higher_coefficients_of_the_closure_against_differences(kind: type[Pair], seed: int) -> None:
    """Coefficients 1 to 3 of closure and coordinate, by a polynomial through the values at neighbouring times."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    poses = random_poses(pair, rng, 3, ())
    ends = free_ends(pair, rng)
    assume_no_centre_of_curvature(pair, ends, poses)
    times = np.linspace(-0.04, 0.04, 9)
    values = []
    for t in times:
        z = [sum(c * t**k for k, c in enumerate(p.z.c)) for p in poses]
        theta = [sum(c * t**k for k, c in enumerate(p.angle.c)) for p in poses]
        values.append(relative(pair, ends, np.ravel([[a.real, a.imag, b] for a, b in zip(z, theta, strict=True)])))
    fitted = np.linalg.solve(np.vander(times, increasing=True), np.unwrap(np.array(values), axis=0))
    found = [*pair.closure(ends, poses), pair.coordinate(ends, poses)]
    # what the last coefficients of the polynomial add at its ends: faster motions would need smaller times
    assume(np.max(np.abs(fitted[7:]) * (0.04 ** np.arange(4, 6))[:, None]) < 1e-6)
    for column, series in enumerate(found):
        for k in range(1, 4):
            c = series.c[k] if k < len(series.c) else 0.0
            assert abs(c - fitted[k, column]) < 1e-6 * max(1.0, float(np.max(np.abs(fitted[:5, column]))))


@every_drivable_kind
@given(seed=SEEDS)
def test_placed_closes_the_pair_at_the_coordinate_asked_for(kind: type[Pair], seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = free_ends(pair, rng)
    free = random_real(rng, 3, (6,))
    base = random_pose(rng, 3, (6,))
    poses = (base, base.compose(pair.placed(ends, free)))
    assert largest(c for closure in pair.closure(ends, poses) for c in closure.c) < 1e-11
    found = pair.coordinate(ends, poses)
    turns = np.round((found.c[0] - free.c[0]) / (2 * np.pi)) * 2 * np.pi if kind.free_is_angle else 0.0
    assert largest([found.c[0] - free.c[0] - turns]) < 1e-12
    assert largest(a - b for a, b in zip(found.c[1:], free.c[1:], strict=True)) < 1e-11


@every_kind
@given(seed=SEEDS)
def test_generic_ends_close_and_are_regular(kind: type[Pair], seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = pair.generic(rng)
    fixed = (FIXED,) * len(ends)
    closure = pair.closure(ends, fixed)
    assert len(closure) == kind.held
    assert largest(c.c[0] for c in closure) < 1e-12
    matrix = pair.jacobian(ends, fixed)
    assert np.linalg.matrix_rank(matrix[: kind.held]) == kind.held
    assert np.linalg.matrix_rank(matrix) == kind.held + 1
    # where its members are tells lengths but no angles
    places = np.delete(matrix[: kind.held], np.s_[2::3], axis=1)
    assert tuple(np.flatnonzero(np.all(np.abs(places) < 1e-12, axis=1))) == kind.held_angles
    assert pair.generic(rng) != ends
    hash(pair.rank_key)


@every_kind
@given(seed=SEEDS)
def test_motion_about_the_centre_keeps_the_pair_closed(kind: type[Pair], seed: int) -> None:
    """Whatever the pair leaves free turns about its centre, or about a point of the line that holds it."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = pair.generic(rng)
    fixed = (FIXED,) * len(ends)
    centre = pair.centre(ends, fixed)
    rows = pair.jacobian(ends, fixed)
    if isinstance(centre, Line):
        free = null_space(rows[: kind.held, 3:6])
        for column in free.T:  # the twist (vx, vy, w) has its centre at (-vy, vx, w)
            assert abs(centre.a * -column[1] + centre.b * column[0] + centre.c * column[2]) < 1e-9
    elif centre is not None and len(ends) == 2:
        x, y, w = (float(v) for v in centre)
        twist = np.zeros(3 * len(ends))
        twist[3:6] = y, -x, w
        assert np.allclose(rows @ twist, [*[0.0] * kind.held, 1.0], atol=1e-9)
    elif centre is not None:
        # relative to the carrier: the first turns at unit rate, the second as the closure asks; both about their axes
        free = null_space(np.vstack([rows[: kind.held, [2, 5]]]))[:, 0] / rows[-1, 2]
        free = free / free[0]
        twists = [np.array([e.point.imag, -e.point.real, 1.0]) * rate for e, rate in zip(ends[:2], free, strict=True)]
        x, y, w = (float(v) for v in centre)
        assert np.allclose(twists[1] - twists[0], [y, -x, w], atol=1e-9)


@every_kind
@given(seed=SEEDS)
def test_the_frame_of_reference_does_not_matter(kind: type[Pair], seed: int) -> None:
    """All links carried along by another motion: the same relative coordinates; pins turn with it."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = free_ends(pair, rng)
    poses = random_poses(pair, rng, 3, ())
    assume_no_centre_of_curvature(pair, ends, poses)
    carrier = random_pose(rng, 3, ())
    moved = tuple(carrier.compose(pose) for pose in poses)
    one, other = pair.coordinate(ends, poses), pair.coordinate(ends, moved)
    turns = 2 * np.pi * np.round((one.c[0] - other.c[0]) / (2 * np.pi)) if kind.free_is_angle else 0.0
    assert abs(one.c[0] - other.c[0] - turns) < 1e-11
    assert largest(a - b for a, b in zip(one.c[1:], other.c[1:], strict=True)) < 1e-10
    held = [sum(c * c for c in pair.closure(ends, p)) for p in (poses, moved)]
    assert largest(a - b for a, b in zip(held[0].c, held[1].c, strict=True)) < 1e-9


@every_kind
@given(seed=SEEDS)
def test_the_links_own_frames_do_not_matter(kind: type[Pair], seed: int) -> None:
    """The same pair with its links' axes laid elsewhere."""
    rng = np.random.default_rng(seed)
    pair = sample(kind)
    ends = free_ends(pair, rng)
    poses = random_poses(pair, rng, 2, ())
    assume_no_centre_of_curvature(pair, ends, poses)
    shift = random_poses(pair, rng, 0, ())
    if kind.free_is_angle or as_turn_counting(pair):  # an angle between links depends on their axes: shift all alike
        shift = tuple(Pose(p.z, shift[1].u, shift[1].theta) for p in shift)
    other_poses = tuple(p.compose(s) for p, s in zip(poses, shift, strict=True))
    other_ends = tuple(s.inverse().carry(e) for s, e in zip(shift, ends, strict=True))
    for a, b in zip(
        (*pair.closure(ends, poses), pair.coordinate(ends, poses)),
        (*pair.closure(other_ends, other_poses), pair.coordinate(other_ends, other_poses)),
        strict=True,
    ):
        assert largest([*[x - y for x, y in zip(a.c[1:], b.c[1:], strict=True)], np.sin(a.c[0] - b.c[0])]) < 1e-10


@every_drivable_kind
def test_driving_one_link_or_the_other(kind: type[Pair]) -> None:
    pair = sample(kind)
    one, two = pair.members
    assert pair.driven_by(two) == 1
    assert pair.driven_by(one) == (-1 if kind.free_is_angle else 1)


def crank_slider() -> ck.Mechanism:
    return ck.Mechanism(
        "m",
        ck.link("frame", A=(0, 0), Q=(1, 1)),
        ck.link("block", C=(0.5, 0.25)),
        ck.slide("block", on="frame", through="Q", angle=ck.deg(30), offset=0.2, turn=ck.deg(10)),
        ck.drive("block", values=0.0),
    )


def test_a_slide_lies_where_its_words_say() -> None:
    """`offset` to the left, x axis of the block turned by `turn`, displacement from `through`: by plain geometry."""
    along = np.exp(1j * np.pi / 6)
    for travel in (0.0, -2.0, 3.5):
        motion = ck.solve(crank_slider(), {"block": travel}, speed=2.0)
        block = motion.links["block"]
        assert abs(complex(motion.points["C"].position) - (1 + 1j + along * (travel + 0.2j))) < 1e-14
        assert abs(float(block.angle) - ck.deg(40)) < 1e-14
        assert abs(complex(motion.points["C"].velocity) - 2 * along) < 1e-14
        assert abs(float(motion.pairs["block/frame"].value) - travel) < 1e-14


def test_a_slide_toward_a_point() -> None:
    mechanism = ck.Mechanism(
        "m",
        ck.link("frame", A=(3, 1), B=(0, 5)),
        ck.link("block", C=0),
        ck.slide("block", on="frame", through="A", toward="B"),
        ck.drive("block", values=2.5),
    )
    motion = ck.solve(mechanism)
    assert abs(complex(motion.points["C"].position) - (3 + 1j + 2.5 * (-3 + 4j) / 5)) < 1e-14
    assert abs(float(motion.links["block"].angle) - np.arctan2(4, -3)) < 1e-14


@pytest.mark.parametrize(
    ("words", "place", "what"),
    [
        ({"link": "blck"}, "slides[0].link", "no link 'blck'"),
        ({"on": "fram"}, "slides[0].on", "no link 'fram'"),
        ({"through": "X"}, "slides[0].through", "has no point 'X'"),
        ({"at": "X"}, "slides[0].at", "has no point 'X'"),
        ({"toward": "X"}, "slides[0].toward", "has no point 'X'"),
        ({"toward": "Q"}, "slides[0].toward", "itself"),
        ({"link": "two", "at": ""}, "slides[0].at", "several points"),
        ({"link": "frame", "at": "Q"}, "slides[0].on", "cannot slide on itself"),
        ({"angle": np.nan}, "slides[0].angle", "not finite"),
        ({"offset": [1.0, np.inf]}, "slides[0].offset", "not finite"),
        ({"offset": "far"}, "slides[0].offset", "'far'"),
        ({"turn": []}, "slides[0].turn", "empty"),
    ],
)
def test_mistakes_in_a_slide_have_a_place(words: dict[str, object], place: str, what: str) -> None:
    links = [ck.link("frame", A=0, Q=1), ck.link("block", C=0), ck.link("two", D=0, E=1), ck.link("three", A=0, D=1)]
    given_words = {"link": "block", "on": "frame", "at": "C", "through": "Q", **words}
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *links, ck.slide(**given_words))  # type: ignore[arg-type]
    assert any(p.where == place and what in p.what for p in caught.value.problems), caught.value


def test_ends_of_a_slide_between_drawn_links() -> None:
    """Offset and turn are read off the drawing; what is stated goes before it."""
    letters = {"A": 0j, "B": 4 + 0j, "C": 1 + 2j, "D": 1 + 3j}
    stated: dict[str, float]
    for stated in ({}, {"offset": 0.5}, {"turn": 0.25}):
        mechanism = ck.Mechanism(
            "m",
            ck.link("frame", "A", "B"),
            ck.link("block", "C", "D"),
            ck.slide("block", on="frame", at="C", through="A", toward="B", **stated),
            ck.drive("block", values=1.0),
            ck.drawn(**letters),
        )
        motion = ck.solve(mechanism)
        assert abs(complex(motion.points["C"].position) - (1 + 1j * stated.get("offset", 2.0))) < 1e-14
        assert abs(float(motion.links["block"].angle) - stated.get("turn", np.pi / 2)) < 1e-14


def test_geometry_of_ends_is_taken_from_the_links() -> None:
    """Arrays of dimensions go through to the ends."""
    pair = ck.slide("b", on="a", at="P", through="Q", toward="R")
    points = {"a": {"Q": np.array([0j, 1j]), "R": np.array([2 + 0j, 1j + 3j])}, "b": {"P": 5 + 0j}}
    guide, block = pair.ends(Geometry(points, {}, frozenset(), {}))
    assert np.allclose(guide.direction, [1, 1j])
    assert np.allclose(guide.point, [0, 1j])
    assert block == End(5 + 0j, 1 + 0j)


def test_series_ends_belong_to_bodies_that_change() -> None:
    """A side of a pair may itself move in its link's frame."""
    rng = np.random.default_rng(1)
    for kind in KINDS.values():
        pair = sample(kind)
        local = random_poses(pair, rng, 2, ())
        if as_turn_counting(pair):  # an angle is that of the link itself
            local = tuple(Pose(p.z, FIXED.u, FIXED.theta) for p in local)
        ends = free_ends(pair, rng)
        poses = random_poses(pair, rng, 2, ())
        carried = tuple(p.carry(e) for p, e in zip(local, ends, strict=True))
        composed = tuple(p.compose(q) for p, q in zip(poses, local, strict=True))
        closure = zip(pair.closure(carried, poses), pair.closure(ends, composed), strict=True)
        assert largest(a - b for s, t in closure for a, b in zip(s.c, t.c, strict=True)) < 1e-12


def test_along_is_the_direction_as_a_series() -> None:
    rng = np.random.default_rng(0)
    moving = random_unit(rng, 2, ())
    assert End(0j, moving).along is moving
    assert End(random_planar(rng, 1, ()), 1j).along.c == (1j,)
    assert isinstance(End(0j, 1j).along, Series)
