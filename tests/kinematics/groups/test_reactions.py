"""The forces in dyads by their closed forms, against the transposed Jacobian, which knows no dyad."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

import compoundkin as ck
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.files import load
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import DYADS, DyadSolver
from compoundkin.kinematics.groups.force_transmission import reactions_of
from compoundkin.model.pairs import Pair, Revolute
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.structure.assur_groups import named_group
from compoundkin.structure.mobility_count import Body
from tests.kinematics.groups.test_contract import SEEDS, Case, closable, conditioned
from tests.kinematics.groups.test_solvers import SHOWN
from tests.support import random_planar, random_pose

DESIGNS, POSES = 6, 40
BODIES = (Body(("one", "tip of one")), Body(("two", "tip of two", "other tip of two")))
every_dyad = pytest.mark.parametrize("kind", DYADS.values(), ids=DYADS)


def joined(code: str, name: str, members: tuple[str, str]) -> Pair:
    if code == "R":
        return Revolute(name, name, *members)
    return Prismatic(members[1], on=members[0], at=name, through=f"{name}'", name=name)


def hung(rng: np.random.Generator, case: Case, bodies: tuple[Pose, Pose]) -> tuple[list[Pair], Block]:
    """The pairs of a dyad with members in random order on random links of its bodies, and the block they are in."""
    shape = (DESIGNS, POSES)
    world = {"frame": FIXED, "moving": random_pose(rng, 0, shape)}
    for body, pose in zip(BODIES, bodies, strict=True):
        for link in body.links:
            world[link] = pose if link == body.links[0] else pose.compose(random_pose(rng, 0, shape))
    out = [str(name) for name in rng.choice(["frame", "moving"], 2)]
    here, there = (str(rng.choice(body.links)) for body in BODIES)
    sides = [
        (out[0], str(rng.choice(BODIES[0].links)), case.first.world, bodies[0], case.first.local),
        (here, there, None, bodies[1], case.inner[1]),
        (out[1], str(rng.choice(BODIES[1].links)), case.second.world, bodies[1], case.second.local),
    ]
    pairs, ends = [], {}
    for k, (pair, (outside, inside, there, body, local)) in enumerate(zip(case.pairs, sides, strict=True)):
        other = bodies[0].carry(case.inner[0]) if there is None else there
        order = [(outside, other), (inside, body.carry(local))]
        if rng.integers(2):
            order.reverse()
        pairs.append(joined(pair.code, f"P{k}", (order[0][0], order[1][0])))
        ends[f"P{k}"] = tuple(world[link].inverse().carry(end) for link, end in order)
    return pairs, Block(shape, ends, world, {}, 0)


def loads(rng: np.random.Generator) -> dict[str, Wrench]:
    """Wrenches on some of the links: of every design and pose, of a design, and a number."""
    shapes: list[tuple[int, ...]] = [(DESIGNS, POSES), (DESIGNS, 1), (1, POSES), ()]
    return {
        link: Wrench(random_planar(rng, 0, shape).c[0], rng.standard_normal(shape))
        for body in BODIES
        for link, shape in zip(body.links, rng.permuted(np.array(shapes, dtype=object)), strict=False)
        if rng.integers(4)
    }


@every_dyad
@settings(max_examples=8)
@given(seed=SEEDS)
def test_closed_forms_and_the_transposed_jacobian_agree(kind: type[DyadSolver], seed: int) -> None:
    """Composite bodies, pairs either way round, arrays over designs and poses."""
    rng = np.random.default_rng(seed)
    case, poses = closable(kind, rng, 0, (DESIGNS * POSES,))
    good = conditioned(kind, case).reshape(DESIGNS, POSES)
    assert good.sum() > DESIGNS * POSES // 4

    def shaped(value: Any) -> Any:
        return value.reshape(DESIGNS, POSES)

    def laid(end: End) -> End:
        point, direction = (None if s is None else Series((shaped(s.c[0]),)) for s in end[:2])
        return End(point, direction)

    first, second = (type(pair)(*map(laid, pair)) for pair in (case.first, case.second))
    case = Case(case.pairs, first, (laid(case.inner[0]), laid(case.inner[1])), second)
    one, two = (pose.mapped(lambda s: Series((shaped(s.c[0]),))) for pose in poses)
    pairs, block = hung(rng, case, (one, two))
    group = named_group(list(BODIES), [pairs[1]], [pairs[0], pairs[2]])
    solver = kind.of(0, group, 1.0, block.ends)
    assert solver is not None
    given_loads = loads(rng)
    found, expected = solver.reactions(block, given_loads), reactions_of(group, block, given_loads, bars=False)
    assert found.keys() == expected.keys() == {"P0", "P1", "P2"}
    scale = sum(np.abs(w.force) + np.abs(w.moment) for w in expected.values()) + 1e-300
    for name, wrench in expected.items():
        assert np.max((np.abs(found[name].force - wrench.force) / scale)[good]) < 1e-12
        assert np.max((np.abs(found[name].moment - wrench.moment) / scale)[good]) < 1e-12


@every_dyad
def test_singular_denominators_raise_nothing(kind: type[DyadSolver]) -> None:
    """Plain numbers, all pairs at one place and all directions along x."""
    side, load = End(1 + 1j, 1 + 0j), Wrench(1 + 2j, 3.0)
    with np.errstate(all="ignore"):
        found = kind.first_reaction(side, side, side, (load, load))
    assert not (np.isfinite(found.force) and np.isfinite(found.moment))


@pytest.mark.parametrize("kind", SHOWN)
def test_every_way_agrees_with_the_transposed_jacobian(kind: str) -> None:
    """Bars left out, closed forms, teeth: all groups of whole motions, against all equations of all bodies."""
    for name in SHOWN[kind]:
        motion, rng = ck.solve(load(name)), np.random.default_rng(8)
        (at, *_) = loaded_blocks(motion)
        for solver in motion.solving_order.solvers:
            given_loads = {
                link: Wrench(complex(*rng.standard_normal(2)), rng.standard_normal() * motion.size)
                for link in solver.group.links
            }
            with np.errstate(all="ignore"):
                found = solver.reactions(at.block, given_loads)
                expected = reactions_of(solver.group, at.block, given_loads, bars=False)
            forces = [np.broadcast_to(np.abs(w.force), at.block.shape) for w in expected.values()]
            # near limit positions forces grow, and lose as many digits; beyond this there may be none
            fit = (np.max(forces, axis=0) < 1e3 * motion.size) & motion.regular
            assert fit.any()
            for pair, wrench in expected.items():
                scale = np.where(fit, np.max(forces, axis=0), np.inf)
                assert np.max(np.abs(np.where(fit, found[pair].force - wrench.force, 0.0)) / scale) < 1e-12
                off = np.where(fit, found[pair].moment - wrench.moment, 0.0)
                assert np.max(np.abs(off) / scale) < 1e-12 * motion.size
