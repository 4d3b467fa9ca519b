"""Motions solved in several blocks: one buffer for all results, and the numbers of one block."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import solution
from compoundkin.kinematics.block import Block, JoinedBlocks


def coefficients(motion: ck.results.Motion) -> list[np.ndarray]:
    series = (one for pose in motion.poses.values() for one in (pose.z, pose.u, pose.theta) if one is not None)
    return [c for one in series for c in one.c if isinstance(c, np.ndarray)]


def test_results_of_several_blocks_share_one_buffer(monkeypatch: pytest.MonkeyPatch) -> None:
    """All arrays are parts of one piece of memory, each aligned and apart from the others; the values are the same."""
    six_bar, crank = ck.load("catalog/six-bar.toml"), np.linspace(0.0, 2.0 * np.pi, 2001)
    at_once = ck.solve(six_bar, {"crank": crank}, speed=10.0, order=3)
    monkeypatch.setattr(solution, "WHOLE", 0)
    monkeypatch.setattr(solution, "BLOCK", 500)
    joined = ck.solve(six_bar, {"crank": crank}, speed=10.0, order=3)
    found = {id(c): c for c in coefficients(joined)}.values()
    assert len({id(c.base) for c in found}) == 1
    starts = sorted((c.ctypes.data, c.nbytes) for c in found)
    assert all(start % 64 == 0 for start, _ in starts)
    assert all(a + size <= b for (a, size), (b, _) in pairwise(starts))
    # links whose origin or orientation is the same array share it still
    assert len(found) == len({id(c) for c in coefficients(at_once)})
    for one, other in zip(coefficients(joined), coefficients(at_once), strict=True):
        assert np.allclose(one, other, rtol=0.0, atol=1e-13 * np.max(np.abs(other)))


def test_arrays_that_links_share_in_one_block_only_are_two() -> None:
    """A later block may tell two links apart, change a number into an array, or bring a link of its own."""
    shared = np.array([[1j, 2j]])
    first = {"a": Pose(Series((shared,)), FIXED.u), "b": Pose(Series((shared,)), FIXED.u)}
    one, other, turned = np.array([[3j, 4j]]), np.array([[5j, 6j]]), np.array([[1j, -1j]])
    second = {"a": Pose(Series((one,)), Series((turned,))), "b": Pose(Series((other,)), FIXED.u)}
    joined = JoinedBlocks(1, 4)
    for world, m in ((first, slice(0, 2)), (second, slice(2, 4))):
        joined.take(Block((1, 2), {}, world, {}, 0), slice(0, 1), m)
    found = joined.poses()
    assert found["a"].z.c[0].tolist() == [[1j, 2j, 3j, 4j]]
    assert found["b"].z.c[0].tolist() == [[1j, 2j, 5j, 6j]]
    assert found["a"].u.c[0].tolist() == [[1, 1, 1j, -1j]]
    assert found["b"].u.c == (1 + 0j,)
