"""`verify` next to kinks: where a group turns back by a hair, and where only the branch behind a pose is wrong."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from tests.kinematics.test_configuration_curve import hard_mechanism, parallelogram, quietly, tongs


@pytest.mark.parametrize("beyond", [1e-3, 1e-6, 1e-9, -1e-6])
@pytest.mark.parametrize("poses", [36, 73, pytest.param(1000, marks=pytest.mark.full)])
def test_a_parallelogram_whose_rods_differ_by_a_hair(beyond: float, poses: int) -> None:
    motion = quietly(parallelogram(beyond), {"crank": np.linspace(0.0, 2.0 * np.pi, poses)})
    assert ck.verify(motion).passed
    # the coupler is as long as it is, which the checks of pairs do not ask of a mode
    good, pins = motion.assembled, motion.points
    assert np.abs(np.abs(pins["C"].position - pins["B"].position) - (3.0 + beyond))[good].max() < 5e-13


@pytest.mark.parametrize("poses", [73, 361, 1000])
def test_a_crank_shaper_with_a_margin_of_a_hair(poses: int) -> None:
    motion = ck.solve(hard_mechanism("crank-shaper-near-its-limit"), {"crank": np.linspace(2.0 * np.pi, 0.0, poses)})
    assert motion.assembled.all()
    assert ck.verify(motion).passed


@pytest.mark.parametrize("poses", [7, 60, 61])
def test_a_stage_that_folds_down_behind_the_closed_pose_is_seen(poses: int) -> None:
    """The second stage of a scissor in its other mode on all poses behind the closed one, itself missing or not."""
    values = np.linspace(1.5, -1.5, poses)
    right = quietly(tongs(2), {"roller": values}, order=2)
    assert ck.verify(right).passed
    curve = right.followed.curve
    wrong_curve = replace(curve, flips={**curve.flips, 1: np.full((1, 1), np.inf)})
    followed = replace(right.followed, curve=wrong_curve)
    s, designs = np.arange(float(poses))[None], np.zeros((1, 1), dtype=int)
    with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        block = followed.run(right.inputs, 2, s, designs)
        failed = np.broadcast_to(block.failed, (1, poses))
        wrong = replace(right, followed=followed, poses=dict(block.world), failed=failed)
        behind = values < -0.1
        assert np.abs(wrong.points["M1"].position - right.points["M1"].position)[behind].min() > 0.5
        assert not ck.verify(wrong).passed
