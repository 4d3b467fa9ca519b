"""The checks must fail when a motion is wrong: every kind of corruption is caught."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series

FOUR_BAR = ck.Mechanism(
    "Four-bar",
    ck.link("frame", A=(0, 0), D=(4, 0)),
    ck.link("crank", A=0, B=1),
    ck.link("coupler", B=0, C=3, P=(1, 1)),
    ck.link("rocker", D=0, C=3),
    ck.drive("crank", speed=2.0, acceleration=-3.0, jerk=1.0),
)


def corrupted(motion, link, what, k, change):
    """The motion with one coefficient of one link's pose changed at one pose."""
    pose = motion.poses[link]
    coefficients = list(getattr(pose, what).c)
    coefficients += [0j] * (motion.order + 1 - len(coefficients))
    array = np.array(np.broadcast_to(coefficients[k], (1, *motion.shape)), dtype=complex)
    array[0, 7] = change(array[0, 7])
    coefficients[k] = array
    parts = {"z": pose.z, "u": pose.u, what: Series(tuple(coefficients))}
    return replace(motion, poses={**motion.poses, link: Pose(parts["z"], parts["u"])})


def test_a_sound_motion_passes_in_every_order():
    check = ck.verify(ck.solve(FOUR_BAR, order=3))
    assert check.passed
    assert check.poses == 73
    assert check.singular == 0
    assert {f.name for f in check.findings} >= {"closure", "velocity", "acceleration", "jerk"}
    exact = [f for f in check.findings if "differences" not in f.name and "continuity" not in f.name]
    assert max(f.value for f in exact) < 1e-13
    assert {f.name for f in check.findings} >= {
        "velocities from centres",
        "Kennedy collinearity",
        "velocity, differences",
        "acceleration, differences",
        "jerk, differences",
        "continuity",
    }


@pytest.mark.parametrize(("k", "order"), [(0, "closure"), (1, "velocity"), (2, "acceleration"), (3, "jerk")])
@pytest.mark.parametrize("what", ["z", "u"])
@pytest.mark.parametrize("link", ["crank", "coupler", "rocker"])
def test_a_wrong_coefficient_is_found_in_its_order_at_its_pose(link, what, k, order):
    motion = ck.solve(FOUR_BAR, order=3)
    wrong = corrupted(motion, link, what, k, lambda c: c + 1e-4 * (1 + 2j))
    failed = [f for f in ck.verify(wrong).findings if not f.passed]
    assert any(f.name.endswith(order) and f.pose == (7,) for f in failed)


def test_a_wrong_driver_is_found():
    motion = ck.solve(FOUR_BAR, {"crank": [0.3, 0.4]})
    other = ck.solve(FOUR_BAR, {"crank": [0.3, 0.41]})
    failed = [f for f in ck.verify(replace(motion, poses=other.poses)).findings if not f.passed]
    assert failed[0].name == "drivers, closure"
    assert {f.pose for f in failed} == {(1,)}


def test_a_leap_to_the_other_branch_is_found():
    motion, other = ck.solve(FOUR_BAR, modes={"rocker": 1}), ck.solve(FOUR_BAR, modes={"rocker": -1})
    poses = {}
    for link, pose in motion.poses.items():
        parts = []
        for what in ("z", "u"):
            pair = zip(getattr(pose, what).c, getattr(other.poses[link], what).c, strict=True)
            parts.append(Series(tuple(np.where(np.arange(73)[None] < 40, a, b) for a, b in pair)))
        poses[link] = Pose(*parts)
    failed = [f for f in ck.verify(replace(motion, poses=poses)).findings if not f.passed]
    assert ("continuity", (40,)) in [(f.name, f.pose) for f in failed]


def test_differences_alone_find_a_wrong_acceleration():
    """A link that no pair holds in its second derivative: only the differences can tell."""
    motion = ck.solve(FOUR_BAR)
    wrong = corrupted(motion, "crank", "u", 2, lambda c: c + 1e-3j)
    failed = {f.name for f in ck.verify(wrong).findings if not f.passed}
    assert "acceleration, differences" in failed


def test_not_a_number_does_not_pass():
    motion = corrupted(ck.solve(FOUR_BAR), "coupler", "u", 0, lambda c: complex(np.nan))
    assert not ck.verify(motion).passed


def test_a_motion_without_any_assembled_pose_does_not_pass():
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(FOUR_BAR.replace(ck.link("rocker", D=0, C=30)))
    assert not ck.verify(motion).passed


def test_a_mechanism_at_rest_passes():
    assert ck.verify(ck.solve(FOUR_BAR, speed=0.0, acceleration=0.0, jerk=0.0, order=3)).passed


def test_scale_does_not_matter():
    small = FOUR_BAR.replace(
        ck.link("frame", A=(0, 0), D=(4e-6, 0)),
        ck.link("crank", A=0, B=1e-6),
        ck.link("coupler", B=0, C=3e-6, P=(1e-6, 1e-6)),
        ck.link("rocker", D=0, C=3e-6),
    )
    motion = ck.solve(small, speed=1e4, order=3)
    assert ck.verify(motion).passed
    wrong = corrupted(motion, "coupler", "z", 1, lambda c: c * (1 + 1e-4))
    assert not ck.verify(wrong).passed


@pytest.mark.full
def test_fast_links_pass_after_many_turns_too():
    mechanism = ck.chains.random_mechanism(5, 920187, kinds=("RRR", "RRP", "RPR", "PRP", "RPP"), multiple=0.3412)
    motion = ck.solve(mechanism, np.linspace(-0.702, -0.698, 9) + 80.0 * np.pi, speed=2.0)
    assert ck.verify(motion).passed
    wrong = corrupted(motion, "4-1", "z", 1, lambda c: c * (1 + 1e-6))
    assert "velocity, differences" in ck.verify(wrong).failed


def test_links_that_turn_back_pass_after_a_million_turns():
    """At a dead point a link has no speed, by which rounding of the driver's value would be allowed for."""
    motion = ck.solve(ck.load("scott-russell"), np.pi * 2e6 + np.linspace(0.0, np.pi, 9), speed=1.0)
    assert ck.verify(motion).passed
    wrong = corrupted(motion, "rod", "z", 2, lambda c: c * (1 + 1e-5))
    assert not ck.verify(wrong).passed


def test_a_rack_that_fits_at_one_place_of_a_yoke_that_moves_is_found():
    """Velocities from centres are wrong there: the cause is that nothing keeps the pinion at its distance."""
    mechanism = ck.Mechanism(
        "Rack",
        ck.link("frame", A=(0, 2), Q=(0, 0)),
        ck.link("yoke", A=0, C=3),
        ck.link("pinion", C=0, P=1),
        ck.link("bar", R=(0, 0)),
        ck.slide("bar", on="frame", at="R", through="Q", angle=0.0),
        ck.rack("bar", "pinion", through="R", at="C", radius=2.0),
        ck.drive("bar", values=np.linspace(0.0, 1.0, 5), speed=1.0),
        ck.drive("yoke", values=np.zeros(5), speed=0.0),
    )
    assert ck.verify(ck.solve(mechanism)).passed
    check = ck.verify(ck.solve(mechanism, speed={"bar": 1.0, "yoke": 0.5}))
    fit = next(f for f in check.findings if f.name == "fit of racks and wheels")
    assert not fit.passed
    assert fit.pair.endswith("its rate")
    # the axis leaves the line at 3 * 0.5
    assert 0.1 < fit.value < 1.5


@pytest.mark.parametrize("by", [0.0, 1e-7, -1e-9])
def test_a_motion_through_change_points_passes(by):
    """Poses that are solved through the double root: their neighbours are, too."""

    def half_turn(angle):
        return ck.laws.rise(angle, 1.0, "4-5-6-7")

    law = ck.laws.program(half_turn(np.pi + by), ck.laws.dwell(0.5), half_turn(np.pi - by))
    mechanism = ck.load("parallelogram").replace(ck.drive("crank", law=law))
    with warnings.catch_warnings(action="ignore", category=ck.errors.ChangePointWarning):
        motion = ck.solve(mechanism, time=np.linspace(0.0, 2.5, 251), order=3)
    check = ck.verify(motion)
    assert check.failed == ()
    jerk = corrupted(motion, "follower", "u", 3, lambda c: c + 0.1)
    assert "jerk, differences" in ck.verify(jerk).failed
