"""What every kind of dyad must do: `DYADS` is iterated, so that a new kind is tested the day it arrives."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.block import Block, Root, clipped_root, nearest_root
from compoundkin.kinematics.groups import DYADS, DyadSolver
from compoundkin.kinematics.groups.dyad import OuterPair
from compoundkin.kinematics.groups.group_equations import GroupEquations, Member
from compoundkin.model.pairs import KINDS, Pair
from tests.support import examples, largest, random_planar, random_pose, random_unit, sample

ORDER = 3
MANY = 200
SEEDS = st.integers(0, 2**32 - 1)

every_dyad = pytest.mark.parametrize("kind", DYADS.values(), ids=DYADS)


@dataclass
class Case:
    """A batch of dyads: the sides of their pairs (moving, of bodies that change their shape)."""

    pairs: tuple[Pair, Pair, Pair]  # first outer, inner, second outer
    first: OuterPair
    inner: tuple[End, End]
    second: OuterPair

    @property
    def arguments(self) -> tuple[OuterPair, tuple[End, End], OuterPair]:
        return self.first, self.inner, self.second

    def residuals(self, poses: tuple[Pose, Pose]) -> list[Series]:
        """The closures of the three pairs by the pairs' own equations."""
        one, two = poses
        outer_first = self.pairs[0].closure((self.first.world, self.first.local), (FIXED, one))
        outer_second = self.pairs[2].closure((self.second.world, self.second.local), (FIXED, two))
        return [*outer_first, *self.pairs[1].closure(self.inner, poses), *outer_second]


def directed(pair: Pair) -> bool:
    return pair.generic(np.random.default_rng(0))[0].direction is not None


def random_end(rng: np.random.Generator, pair: Pair, order: int, shape: tuple[int, ...]) -> End:
    return End(random_planar(rng, order, shape), random_unit(rng, order, shape) if directed(pair) else None)


def loose(kind: type[DyadSolver], rng: np.random.Generator, order: int, shape: tuple[int, ...]) -> Case:
    """Sides with nothing in common: it may or may not close."""
    pairs = tuple(sample(KINDS[code], str(k)) for k, code in enumerate(kind.name))
    outer = [OuterPair(random_end(rng, p, order, shape), random_end(rng, p, order, shape)) for p in pairs[::2]]
    inner = (random_end(rng, pairs[1], order, shape), random_end(rng, pairs[1], order, shape))
    return Case(pairs, outer[0], inner, outer[1])  # type: ignore[arg-type]


def closable(
    kind: type[DyadSolver], rng: np.random.Generator, order: int, shape: tuple[int, ...]
) -> tuple[Case, tuple[Pose, Pose]]:
    """Sides that close at known poses: two random motions, and pairs put between them."""
    poses = (random_pose(rng, order, shape), random_pose(rng, order, shape))
    case = loose(kind, rng, order, shape)
    attachments = []
    for pair, attachment, pose in zip(case.pairs[::2], (case.first, case.second), poses, strict=True):
        attachments.append(
            OuterPair(moved_along(rng, pair, pose.carry(attachment.local), order, shape), attachment.local)
        )
    here = poses[0].carry(case.inner[0])
    there = poses[1].inverse().carry(moved_along(rng, case.pairs[1], here, order, shape))
    return Case(case.pairs, attachments[0], (case.inner[0], there), attachments[1]), poses


def moved_along(rng: np.random.Generator, pair: Pair, end: End, order: int, shape: tuple[int, ...]) -> End:
    """Another side of the pair in the same place but for a displacement in its free direction."""
    if not directed(pair):
        return end
    return End(end.point + end.along * random_planar(rng, order, shape).real, end.along)


def at_pins(case: Case, poses: tuple[Pose, Pose]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the outer, inner and outer pairs are."""
    one, two = poses
    return (
        one.at(case.first.local.point).c[0],
        one.at(case.inner[0].point).c[0],
        two.at(case.second.local.point).c[0],
    )


def counterclockwise(case: Case, poses: tuple[Pose, Pose]) -> np.ndarray:
    a, b, c = at_pins(case, poses)
    return np.sign((np.conj(b - a) * (c - b)).imag)


def beyond_the_other(case: Case, poses: tuple[Pose, Pose]) -> np.ndarray:
    """Whether the inner pin lies beyond the foot of the perpendicular from the outer pin on its line."""
    a, b, _ = at_pins(case, poses)
    return np.sign((np.conj(case.second.world.along.c[0]) * (b - a)).real)


def block_beyond_guide(case: Case, poses: tuple[Pose, Pose]) -> np.ndarray:
    a, _, c = at_pins(case, poses)
    return np.sign((np.conj(poses[0].carry(case.inner[0]).along.c[0]) * (c - a)).real)


# What `sign_means` says, once more and in plain geometry.
MEANINGS: dict[str, Callable[[Case, tuple[Pose, Pose]], np.ndarray]] = {
    "RRR": counterclockwise,
    "RRP": beyond_the_other,
    "RPR": block_beyond_guide,
}


def close(
    kind: type[DyadSolver], case: Case, sign: float | np.ndarray, root: Root = clipped_root
) -> tuple[tuple[Pose, Pose], np.ndarray]:
    with np.errstate(all="ignore"):
        return kind.assemble(*case.arguments, sign, root)[:2]


def finite(poses: tuple[Pose, Pose]) -> np.ndarray:
    return np.isfinite(sum(s.c[0] for p in poses for s in (p.z, p.u)))


def coefficients(poses: tuple[Pose, Pose]) -> list[np.ndarray]:
    return [c for p in poses for s in (p.z, p.u) for c in s.c]


def conditioned(kind: type[DyadSolver], case: Case) -> np.ndarray:
    """Dyads away from a limit position in both modes, where rounding is not magnified: by their Jacobians."""
    general, setting = as_general(case)
    fit: np.ndarray = np.array(True)
    for sign in (1.0, -1.0):
        matrix = general.matrix(general.state(list(close(kind, case, sign)[0])), setting)
        fit = fit & (np.linalg.cond(matrix) < 20.0)
    return fit


def test_every_kind_with_two_modes_has_a_meaning_here() -> None:
    assert set(MEANINGS) == {name for name, kind in DYADS.items() if kind.modes == 2}
    assert all(name == kind.name for name, kind in DYADS.items())
    assert all(kind.modes in (1, 2) and kind.sign_means for kind in DYADS.values())


@every_dyad
@settings(max_examples=examples(12))
@given(seed=SEEDS)
def test_closes_by_the_pairs_own_equations_in_every_coefficient(kind: type[DyadSolver], seed: int) -> None:
    rng = np.random.default_rng(seed)
    case, _ = closable(kind, rng, ORDER, (MANY,))
    good = conditioned(kind, case)
    assert good.sum() > MANY // 4
    for sign in (1.0, -1.0):
        poses, margin = close(kind, case, sign)
        assert np.all(margin >= 0)
        scale = 1.0 + sum(np.abs(c) for p in poses for s in (p.z, p.u) for c in s.c)
        for residual in case.residuals(poses):
            for c in residual.c:
                assert np.max((np.abs(c) / scale)[good]) < 1e-12
        for pose in poses:
            modulus = pose.u.abs2()
            assert np.max(np.abs(modulus.c[0] - 1)[good]) < 1e-12
            assert largest((c / scale**2)[good] for c in modulus.c[1:]) < 1e-12


@every_dyad
@given(seed=SEEDS)
def test_finds_the_motion_it_was_built_from(kind: type[DyadSolver], seed: int) -> None:
    rng = np.random.default_rng(seed)
    case, true = closable(kind, rng, ORDER, (MANY,))
    good = conditioned(kind, case)
    sign = MEANINGS[kind.name](case, true) if kind.modes == 2 else 1.0
    poses, _ = close(kind, case, sign)
    for pose, known in zip(poses, true, strict=True):
        for found, expected in ((pose.z, known.z), (pose.u, known.u)):
            for k in range(ORDER + 1):
                assert np.max(np.abs(found.c[k] - expected.c[k])[good]) < 1e-7
                assert np.median(np.abs(found.c[k] - expected.c[k])) < 1e-11


@every_dyad
@given(seed=SEEDS)
def test_the_sign_means_what_it_says(kind: type[DyadSolver], seed: int) -> None:
    case, _ = closable(kind, np.random.default_rng(seed), 0, (MANY,))
    plus, _ = close(kind, case, 1.0)
    minus, _ = close(kind, case, -1.0)
    apart = np.max(
        [np.abs(p.z.c[0] - m.z.c[0]) + np.abs(p.u.c[0] - m.u.c[0]) for p, m in zip(plus, minus, strict=True)],
        axis=0,
    )
    if kind.modes == 1:
        assert np.all(apart == 0.0)
        return
    assert np.min(apart) > 0.0
    assert np.all(MEANINGS[kind.name](case, plus) == 1.0)
    assert np.all(MEANINGS[kind.name](case, minus) == -1.0)


@every_dyad
def test_signs_may_be_an_array_of_both(kind: type[DyadSolver]) -> None:
    case, _ = closable(kind, np.random.default_rng(5), 2, (2, 60))
    both, _ = close(kind, case, np.array([[1.0], [-1.0]]))
    for row, sign in enumerate((1.0, -1.0)):
        alone, _ = close(kind, case, sign)
        for a, b in zip(coefficients(both), coefficients(alone), strict=True):
            assert np.array_equal(a[row], b[row])


@every_dyad
@settings(max_examples=examples(12))
@given(seed=SEEDS)
def test_agrees_with_newton_and_the_series_step(kind: type[DyadSolver], seed: int) -> None:
    """Against `GroupEquations`: outside links and links inside composite bodies that move, a perturbed start."""
    rng = np.random.default_rng(seed)
    case, _ = closable(kind, rng, ORDER, (MANY,))
    good = conditioned(kind, case)
    general, setting = as_general(case)
    for sign in (1.0, -1.0):
        poses, _ = close(kind, case, sign)
        state = general.state(list(poses))
        start = state + 1e-4 * rng.standard_normal(state.shape)
        solution = general.newton(start, setting)
        near = good & (solution.moved < 2e-3)
        assert near.sum() > MANY // 4
        assert np.all(solution.closed[near])
        for pose, newton in zip(poses, general.series(solution.state, setting, ORDER), strict=True):
            for closed, stepped in ((pose.z, newton.z), (pose.u, newton.u)):
                for a, b in zip(closed.c, stepped.c, strict=True):
                    error = (np.abs(a - b) / (1.0 + np.abs(a)))[near]
                    assert np.max(error) < 1e-7
                    assert np.quantile(error, 0.95) < 1e-10


def as_general(case: Case) -> tuple[GroupEquations, Block]:
    """The same dyad as a group of two bodies without closed form; every moving side is a link of its own."""
    world, local, ends = {}, {}, {}
    sides = {
        0: (("out", case.first.world, None), ("in", case.first.local, 0)),
        1: (("in", case.inner[0], 0), ("in", case.inner[1], 1)),
        2: (("out", case.second.world, None), ("in", case.second.local, 1)),
    }
    members = []
    for k, pair in enumerate(case.pairs):
        found = []
        for number, (where, end, body) in enumerate(sides[k]):
            link = f"{where}{k}{number}"
            u = end.direction if end.direction is not None else Series((1 + 0j, *[0j] * ORDER))
            (world if where == "out" else local)[link] = Pose(as_series(end.point), u)
            found.append(Member(link, body))
        members.append((found[0], found[1]))
        side = End(0j, None if not directed(pair) else 1 + 0j)
        ends[pair.name] = (side, side)
    return GroupEquations(2, case.pairs, tuple(members), 1.0, bars=False), Block((MANY,), ends, world, local, ORDER)


@every_dyad
@settings(max_examples=3)
@given(seed=SEEDS)
def test_the_margin_is_negative_exactly_where_it_cannot_close(kind: type[DyadSolver], seed: int) -> None:
    """Against Newton from many random starts, which knows nothing of the formula."""
    rng = np.random.default_rng(seed)
    count = 20
    case = loose(kind, rng, 0, (count,))
    poses, margin = close(kind, case, 1.0)
    general, setting = as_general(case)
    starts = rng.uniform(-4.0, 4.0, (100, 1, general.width))
    with np.errstate(all="ignore"):
        solution = general.newton(np.broadcast_to(starts, (100, count, general.width)), setting, steps=60)
    can = solution.closed.any(axis=0)
    clear = np.abs(margin) > 1e-3  # nearer to a limit position Newton may fail
    assert clear.sum() > count // 2
    assert np.array_equal((margin >= 0)[clear], can[clear])
    assert np.array_equal(margin >= 0, finite(poses))


@every_dyad
def test_only_poses_that_cannot_close_are_not_numbers(kind: type[DyadSolver]) -> None:
    case = loose(kind, np.random.default_rng(11), ORDER, (3, 500))
    for sign in (1.0, -1.0):
        poses, margin = close(kind, case, sign)
        assert np.array_equal(np.broadcast_to(margin >= 0, (3, 500)), finite(poses))
        for pose in poses:
            for c in (*pose.z.c, *pose.u.c):
                assert np.all(np.isfinite(np.broadcast_to(c, (3, 500))[margin >= 0]))
        if kind.modes == 2:
            assert 0.05 < np.mean(margin < 0) < 0.95
        else:
            assert np.all(margin >= 0)


@every_dyad
def test_works_with_plain_numbers_as_with_arrays(kind: type[DyadSolver]) -> None:
    case, _ = closable(kind, np.random.default_rng(2), 2, (7,))

    def one(value: Series | None, k: int) -> Series | None:
        return None if value is None else Series(tuple([c[k].item() for c in value.c]))

    def end(e: End, k: int) -> End:
        return End(one(e.point, k), one(e.direction, k))  # type: ignore[arg-type]

    poses, margin = close(kind, case, -1.0)
    for k in range(7):
        single = Case(
            case.pairs,
            OuterPair(*[end(e, k) for e in case.first]),
            (end(case.inner[0], k), end(case.inner[1], k)),
            OuterPair(*[end(e, k) for e in case.second]),
        )
        alone, its = close(kind, single, -1.0)
        assert np.isclose(its, margin[k], rtol=1e-12)
        for a, b in zip(coefficients(alone), coefficients(poses), strict=True):
            assert abs(a - b[k]) < 1e-9 * (1 + abs(a))


@every_dyad
def test_nearest_approach_where_it_cannot_close(kind: type[DyadSolver]) -> None:
    """With the nearest root the outer pairs stay closed and both modes are the same pose: touching."""
    case = loose(kind, np.random.default_rng(3), 0, (300,))
    plus, margin = close(kind, case, 1.0, nearest_root)
    minus, _ = close(kind, case, -1.0, nearest_root)
    _, strict = close(kind, case, 1.0)
    if kind.modes == 1:
        return
    apart = strict < 0
    assert apart.sum() > 20
    assert np.all(margin >= 0)
    assert np.all(finite(plus) & finite(minus))
    for p, m in zip(plus, minus, strict=True):
        assert largest([(p.z.c[0] - m.z.c[0])[apart], (p.u.c[0] - m.u.c[0])[apart]]) < 1e-12


# --- limit positions, parallel guides, and what is said about them -----------------------------------------


def pin(point: complex | np.ndarray) -> End:
    return End(point)


def rrr(first: float, second: float, apart: complex | np.ndarray) -> Case:
    pairs = tuple(sample(KINDS["R"], str(k)) for k in range(3))
    return Case(
        pairs,
        OuterPair(pin(0j), pin(0j)),
        (pin(first + 0j), pin(second + 0j)),
        OuterPair(pin(apart), pin(0j)),
    )  # type: ignore[arg-type]


def rrp(rod: float, height: complex) -> Case:
    """A rod about the origin, its other pin on a block of a guide along x at some height."""
    pairs = (sample(KINDS["R"], "0"), sample(KINDS["R"], "1"), sample(KINDS["P"], "2"))
    guide = End(1j * height, 1 + 0j)
    return Case(pairs, OuterPair(pin(0j), pin(0j)), (pin(rod + 0j), pin(0j)), OuterPair(guide, End(0j, 1 + 0j)))


def rpr(across: float, apart: complex) -> Case:
    pairs = (sample(KINDS["R"], "0"), sample(KINDS["P"], "1"), sample(KINDS["R"], "2"))
    return Case(
        pairs,
        OuterPair(pin(0j), pin(0j)),
        (End(0j, 1 + 0j), End(1j * across, 1 + 0j)),
        OuterPair(pin(apart), pin(0j)),
    )


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.0, 41))
def test_stretched_and_folded_dyads_are_valid_positions(turn: float) -> None:
    """Touching up to the rounding of the surroundings, in every direction."""
    away = np.exp(1j * turn)
    scale = 10.0 ** (4 * np.sin(7 * turn))
    a, b = 0.7 * scale, 0.4 * scale
    touching = (
        (DYADS["RRR"], rrr(a, b, (a + b) * away)),
        (DYADS["RRR"], rrr(a, b, (a - b) * away)),
        (DYADS["RPR"], rpr(a, a * away)),
    )
    for kind, case in touching:
        poses, margin = close(kind, case, 1.0)
        assert margin >= 0
        assert largest(r.c[0] for r in case.residuals(poses)) < 1e-6 * scale
        assert largest(r.c[0] for r in case.residuals(poses)) < 1e-12 * scale
    poses, margin = close(DYADS["RRP"], rrp(a, a), 1.0)
    assert margin >= 0
    assert largest(r.c[0] for r in rrp(a, a).residuals(poses)) < 1e-12 * scale


@pytest.mark.parametrize("miss", [1e-12, 1e-9, 1e-3])
def test_a_dyad_that_misses_by_more_than_rounding_is_not_closed(miss: float) -> None:
    """A gap of 1e-12 of the size is beyond rounding; one the other way is within reach."""
    for sign in (1.0, -1.0):
        for kind, short, long in (
            (DYADS["RRR"], rrr(3, 2, 5 * (1 + miss) + 0j), rrr(3, 2, 5 * (1 - miss) + 0j)),
            (DYADS["RRR"], rrr(3, 2, 1 * (1 - miss) + 0j), rrr(3, 2, 1 * (1 + miss) + 0j)),
            (DYADS["RRP"], rrp(2, 2 * (1 + miss)), rrp(2, 2 * (1 - miss))),
            (DYADS["RPR"], rpr(2 * (1 + miss), 2 + 0j), rpr(2 * (1 - miss), 2 + 0j)),
        ):
            poses, margin = close(kind, short, sign)
            assert margin < 0
            assert not finite(poses)
            poses, margin = close(kind, long, sign)
            assert margin >= 0
            assert largest(r.c[0] for r in long.residuals(poses)) < 1e-14 * 30


@pytest.mark.parametrize("name", [name for name, kind in DYADS.items() if kind.modes == 1])
def test_parallel_guides_are_not_closed(name: str) -> None:
    kind = DYADS[name]
    case, _ = closable(kind, np.random.default_rng(4), 1, (50,))
    direction = case.second.world.along
    if directed(case.pairs[0]):
        first = OuterPair(End(case.first.world.point, direction), case.first.local)
        inner = case.inner
    else:
        first = case.first
        inner = (case.inner[0], End(case.inner[1].point, case.second.local.along))
    case = Case(case.pairs, first, inner, case.second)
    poses, margin = close(kind, case, 1.0)
    assert np.all(margin < 0)
    assert not finite(poses).any()
    assert "parallel" in kind.explain(*case.arguments, 7, ("A", "B", "C"))


def numbers(sentence: str) -> list[float]:
    return [float(x) for x in re.findall(r"(?<![A-Za-z])\d+\.?\d*(?:e[+-]?\d+)?", sentence)]


@given(seed=SEEDS)
def test_the_explanation_of_circles_tells_true_lengths(seed: int) -> None:
    case = loose(DYADS["RRR"], np.random.default_rng(seed), 0, (40,))
    _, margin = close(DYADS["RRR"], case, 1.0)
    a = np.abs(case.inner[0].point.c[0] - case.first.local.point.c[0])
    b = np.abs(case.inner[1].point.c[0] - case.second.local.point.c[0])
    line = np.abs(case.first.world.point.c[0] - case.second.world.point.c[0])
    for at in np.flatnonzero(margin < 0):
        sentence = DYADS["RRR"].explain(*case.arguments, int(at), ("K", "L", "M"))
        assert np.allclose(numbers(sentence), [line[at], a[at], b[at]], rtol=1e-5)
        if line[at] > a[at] + b[at]:
            assert re.fullmatch(r"\|KM\| = \S+ > \|KL\| \+ \|LM\| = \S+ \+ \S+", sentence)
        else:
            assert re.fullmatch(r"\|KM\| = \S+ < \|\|KL\| - \|LM\|\| = \|\S+ - \S+\|", sentence)


@given(seed=SEEDS)
def test_the_explanation_of_a_circle_and_a_line_tells_true_lengths(seed: int) -> None:
    case = loose(DYADS["RRP"], np.random.default_rng(seed), 0, (40,))
    poses, margin = close(DYADS["RRP"], case, 1.0, nearest_root)
    for at in np.flatnonzero(close(DYADS["RRP"], case, 1.0)[1] < 0):
        sentence = DYADS["RRP"].explain(*case.arguments, int(at), ("K", "L", "M"))
        rod = abs(case.inner[0].point.c[0][at] - case.first.local.point.c[0][at])
        # at the nearest approach the block's side of the inner pin is at the foot of the perpendicular
        foot = poses[1].at(case.inner[1].point).c[0][at]
        distance = abs(foot - case.first.world.point.c[0][at])
        assert np.allclose(numbers(sentence), [distance, rod], rtol=1e-5)
        assert distance > rod
    assert np.all(margin >= 0)


@given(seed=SEEDS)
def test_the_explanation_of_a_guide_tells_true_lengths(seed: int) -> None:
    case = loose(DYADS["RPR"], np.random.default_rng(seed), 0, (40,))
    _, margin = close(DYADS["RPR"], case, 1.0)
    line = np.abs(case.first.world.point.c[0] - case.second.world.point.c[0])
    across = [
        (np.conj(end.along.c[0]) * (end.point.c[0] - at.local.point.c[0])).imag
        for end, at in zip(case.inner, (case.first, case.second), strict=True)
    ]
    for at in np.flatnonzero(margin < 0):
        sentence = DYADS["RPR"].explain(*case.arguments, int(at), ("K", "L", "M"))
        assert np.allclose(numbers(sentence), [line[at], abs(across[0][at] - across[1][at])], rtol=1e-5)


def test_outer_pins_that_coincide_leave_the_direction_open() -> None:
    """A rhombus folded on itself, a guide pinned in its own block: nothing says which way the links point."""
    for kind, case in ((DYADS["RRR"], rrr(2, 2, 0j)), (DYADS["RPR"], rpr(0.0, 0j))):
        for apart in (0j, np.array([0j, 1.0 + 0j])):
            case.second = OuterPair(pin(apart), pin(0j))
            poses, margin = close(kind, case, 1.0)
            assert np.array_equal(np.ravel(margin >= 0), np.ravel(finite(poses)))
            assert np.ravel(margin >= 0).tolist() == [False, True][: np.size(apart)]
            assert "coincide" in kind.explain(*case.arguments, 0, ("A", "B", "C"))
    poses, margin = close(DYADS["RRR"], rrr(2, 2, 1e-16 + 1e-16j), 1.0)
    assert not margin >= 0
