"""Poses: points, composition and inverse, as series."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series, constant
from tests.support import largest, random_planar, random_pose, random_unit

SEEDS = st.integers(0, 2**32 - 1)


def apart(a: Series, b: Series) -> float:
    return largest(x - y for x, y in zip(a.c, b.c, strict=True))


@given(seed=SEEDS)
def test_composition_and_inverse(seed: int) -> None:
    rng = np.random.default_rng(seed)
    outer, inner, p = random_pose(rng, 3, (4,)), random_pose(rng, 3, (4,)), random_planar(rng, 3, (4,))
    assert apart(outer.compose(inner).at(p), outer.at(inner.at(p))) < 1e-11
    assert apart(outer.inverse().at(outer.at(p)), p) < 1e-11
    assert apart(outer.compose(outer.inverse()).at(p), p) < 1e-11
    assert apart(outer.inverse().inverse().at(p), outer.at(p)) < 1e-11


@given(seed=SEEDS)
def test_a_point_moves_as_rotation_and_translation(seed: int) -> None:
    """Velocity v0 + i w r, acceleration a0 + (i alpha - w^2) r."""
    rng = np.random.default_rng(seed)
    pose, p = random_pose(rng, 2, (4,)), 0.7 - 1.2j
    theta, r = pose.u.angle(), pose.u.c[0] * p
    w, alpha = theta.derivative(1), theta.derivative(2)
    point = pose.at(p)
    assert np.allclose(point.derivative(1), pose.z.derivative(1) + 1j * w * r)
    assert np.allclose(point.derivative(2), pose.z.derivative(2) + (1j * alpha - w**2) * r)


def test_the_fixed_pose_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    pose, p = random_pose(rng, 2, ()), random_planar(rng, 2, ())
    end = End(p, random_unit(rng, 2, ()))
    assert FIXED.compose(pose) is pose
    assert FIXED.at(p) is p
    assert FIXED.at(2 + 1j).c == (2 + 1j,)
    assert FIXED.carry(end).point is p
    assert FIXED.carry(end).direction is end.direction
    assert FIXED.inverse().at(1 + 1j).c == (1 + 1j,)


def test_the_origin_is_the_origin() -> None:
    pose = Pose(constant(3j), constant(1j))
    for zero in (0, 0.0, 0j):
        assert pose.at(zero) is pose.z
    assert pose.at(np.zeros(2)).c[0].tolist() == [3j, 3j]


@given(seed=SEEDS)
def test_carrying_a_side_of_a_pair(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose, end = random_pose(rng, 2, ()), End(1 - 2j, 1j)
    carried = pose.carry(end)
    assert apart(carried.along, pose.at(1j + end.point) - pose.at(end.point)) < 1e-12
    assert apart(carried.point, pose.at(end.point)) == 0.0
    assert pose.carry(End(1j)).direction is None
