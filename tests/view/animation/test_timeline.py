"""The timeline of an animation: which poses are shown, in which order, for how long."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.animation.timeline import MOST_FRAMES


def crank(poses: int = 73, **more: object) -> ck.results.Motion:
    mechanism = ck.Mechanism(
        "Crank", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.link("rod", B=0, C=5), ck.link("block", C=0),
        ck.slide("block", on="frame", at="C", through="A", angle=0), ck.drive("crank"),
    )  # fmt: skip
    return ck.solve(mechanism, {"crank": np.linspace(0.0, 2.0 * np.pi, poses)}, **more)


def rocking() -> ck.results.Motion:
    """A rocker driven over a full turn, of which two intervals can be assembled."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(load("double-rocker"), {"driver": ck.deg(np.arange(0.0, 361.0))})


def indices(animation: ck.results.Animation) -> np.ndarray:
    """The poses of the frames as indices of the motion."""
    return animation.sketch.scene.known[animation.timeline.poses[animation.timeline.frames]]


def test_a_full_turn_goes_on_for_ever_and_shows_its_end_once() -> None:
    animation = crank().animate()
    assert animation.timeline.returns
    assert indices(animation).tolist() == list(range(72))


def test_what_does_not_end_as_it_began_goes_back_the_way_it_came() -> None:
    animation = ck.animate(ck.solve(load("six-bar"), {"crank": ck.deg(np.arange(0.0, 91.0, 3.0))}))
    found = indices(animation)
    assert found.tolist() == [*range(31), *range(29, 0, -1)]
    forced = indices(crank().animate(back=True))
    assert np.array_equal(forced[1:], forced[:0:-1])
    assert not ck.animate(animation.sketch.motion, back=False).timeline.returns


@pytest.mark.parametrize(("poses", "frames"), [(361, 90), (721, 90), (36_001, 100), (12, 11)])
def test_frames_are_even_and_no_more_than_asked_for(poses: int, frames: int) -> None:
    animation = crank(poses).animate()
    steps = np.diff(indices(animation))
    assert len(animation) == frames
    assert np.ptp(steps) == 0
    assert len(animation) <= animation.seconds * 25.0 + 1e-9


@given(st.integers(20, 400), st.floats(0.5, 5.0), st.floats(5.0, 50.0))
def test_frames_of_any_number_are_at_most_one_pose_off(poses: int, seconds: float, fps: float) -> None:
    animation = crank(poses).animate(seconds=seconds, fps=fps)
    assert animation.seconds == pytest.approx(seconds)
    assert len(animation) <= seconds * fps + 1e-5
    even = np.arange(len(animation)) / len(animation) * (poses - 1)
    assert np.max(np.abs(indices(animation) - even)) <= 0.5 + 1e-9


def test_uneven_poses_are_shown_evenly_in_the_driver() -> None:
    values = 2.0 * np.pi * np.linspace(0.0, 1.0, 2001) ** 2
    motion = ck.solve(load("six-bar"), {"crank": values})
    shown = values[indices(motion.animate())]
    # poses are at most 0.0063 apart, frames 0.105
    assert np.ptp(np.diff(shown)) < 0.08 * np.mean(np.diff(shown))


def test_a_motion_in_time_is_as_fast_as_it_is() -> None:
    mechanism = load("crank-rocker")
    motion = ck.solve(mechanism, {"crank": 0.0}, speed=np.pi, time=np.linspace(0.0, 2.0, 401))
    animation = motion.animate()
    assert animation.timeline.returns
    assert animation.seconds == pytest.approx(2.0)
    assert len(animation) == 50
    half = ck.solve(mechanism, {"crank": 0.0}, speed=np.pi, time=np.linspace(0.0, 1.0, 201)).animate()
    assert half.seconds == pytest.approx(2.0)
    assert motion.animate(seconds=5).seconds == pytest.approx(5.0)


def test_intervals_that_can_be_assembled_are_shown_each_there_and_back() -> None:
    motion = rocking()
    animation = motion.animate()
    assert motion.assembled[indices(animation)].all()
    known = np.flatnonzero(motion.assembled)
    low, high = known[known < 180], known[known > 180]
    shown = [animation.sketch.scene.known[leg.poses] for leg in animation.timeline.legs]
    assert [(leg[0], leg[-1]) for leg in shown] == [
        (low[0], low[-1]), (low[-1], low[0]), (high[0], high[-1]), (high[-1], high[0]),
    ]  # fmt: skip


def test_an_interval_across_the_end_of_a_turn_is_one() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        motion = ck.solve(load("triple-rocker"), {"driver": ck.deg(np.arange(0.0, 361.0, 2.0))})
    animation = motion.animate()
    there = animation.sketch.scene.known[animation.timeline.legs[0].poses]
    turned = np.unwrap(ck.deg(2.0 * there))
    assert np.all(np.diff(turned) > 0)
    assert np.max(np.diff(turned)) < ck.deg(2.001)
    places = motion.points["C"].position[indices(animation)]
    assert np.max(np.abs(np.diff(places))) < 1.0


def test_one_pose_is_one_frame() -> None:
    animation = crank(1).animate()
    assert len(animation) == 1
    assert "animate" not in animation.svg


@pytest.mark.parametrize(
    ("options", "where"),
    [
        ({"seconds": 0}, "seconds"), ({"seconds": "4"}, "seconds"), ({"fps": 0}, "fps"), ({"fps": 1000}, "fps"),
        ({"back": 1}, "back"), ({"seconds": MOST_FRAMES, "fps": 2}, "seconds"), ({"vectors": "speed"}, "vectors"),
        ({"labels": "names"}, "labels"), ({"size": 1}, "size"), ({"design": 1}, "design"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_said(options: dict[str, object], where: str) -> None:
    with pytest.raises(ck.errors.InvalidInput) as caught:
        crank().animate(**options)
    assert caught.value.problems[0].where == where


def test_unknown_points_and_other_things_are_said() -> None:
    with pytest.raises(ck.errors.UnknownName, match="no such point"):
        crank().animate(paths="X")
    with pytest.raises(ck.errors.InvalidInput, match="no motion or mechanism"):
        ck.animate("six-bar")  # type: ignore[arg-type]
    with pytest.raises(ck.errors.InvalidInput, match="no frame 72"):
        crank().animate().frame(72)
    with pytest.raises(ck.errors.InvalidInput, match="order 0"):
        crank(order=0).animate(vectors="velocity")


def test_the_own_range_of_a_mechanism_is_shown_finely_enough() -> None:
    mechanism = load("five-bar")
    motion = ck.solve(mechanism)
    animation = ck.animate(mechanism)
    fine = animation.sketch.motion
    assert motion.inputs.poses < 72 < fine.inputs.poses <= 2 * 73
    every = (fine.inputs.poses - 1) // (motion.inputs.poses - 1)
    for letter in mechanism.carriers:
        assert fine.points[letter].position[::every] == pytest.approx(motion.points[letter].position, abs=1e-9)
    assert len(motion.animate()) < len(animation) == 80
    # what changes along the motion together with the values stays as it is
    quick = ck.solve(mechanism, speed={"left": 1.0, "right": 2.0})
    assert quick.animate().sketch.motion is quick
