"""Velocity ratios, the Coriolis part of accelerations and pressure angles as quantities by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.mechanical_advantage import mechanical_advantage
from tests import catalog
from tests.scaled import scaled

WITH_GUIDES = ("oscillating-guide", "crank-shaper", "geneva-wheel", "six-bar", "hydraulic-crane", "oldham-coupling",
               "oscillating-cylinder", "disc-cam-roller-program", "whitworth-quick-return")  # fmt: skip


def values(motion: ck.results.Motion, name: str) -> Any:
    return ck.quantity(motion, name).values


# --- velocity ratio and mechanical advantage --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["crank-rocker", "slider-crank", "hydraulic-crane", "geared-five-bar"])
def test_ratios_of_everything_are_those_to_the_driver(name: str) -> None:
    motion = catalog.motion(name)
    (driver,) = motion.drives
    given = motion.drives[driver].rate
    for owner in set(motion.links) - set(motion.structure.translating_links):
        assert values(motion, f"{owner}.velocity_ratio") == pytest.approx(motion.links[owner].angular_velocity / given)
    for owner in set(motion.pairs) - set(motion.links):
        found, rate = values(motion, f"{owner}.advantage"), motion.pairs[owner].rate
        known = np.isfinite(found)
        assert found[known] * rate[known] == pytest.approx(np.broadcast_to(given, motion.shape)[known], rel=1e-9)
        port = mechanical_advantage(motion, owner, motion.structure.driven[driver].pair.name)
        assert np.abs(found) == pytest.approx(np.abs(port.advantage), rel=1e-9, nan_ok=True)


def test_power_is_conserved() -> None:
    """A press: the force at the slide times its speed is the torque at the crank times its angular velocity."""
    motion = catalog.motion("toggle-press")
    force = values(motion, "press.advantage") * 3.0  # for a torque of 3 at the crank
    known = np.isfinite(force)
    power = force * motion.pairs["press"].rate
    assert known.sum() > 60
    assert power[known] == pytest.approx((3.0 * motion.drives["crank"].rate)[known], rel=1e-9)


@pytest.mark.parametrize(
    ("mechanism", "name", "unit"),
    [
        ("slider-crank", "stroke.velocity_ratio", "m"),
        ("slider-crank", "stroke.advantage", "1/m"),
        ("slider-crank", "rod.advantage", ""),
        ("hydraulic-crane", "jib.velocity_ratio", "1/m"),
        ("hydraulic-crane", "jib.advantage", "m"),
        ("oscillating-guide", "slot.coriolis", "mm/s^2"),
        ("disc-cam-roller-program", "follower/cam.pressure_angle", "rad"),
    ],
)
def test_units(mechanism: str, name: str, unit: str) -> None:
    found = ck.quantity(catalog.motion(mechanism), name)
    assert found.unit == unit
    assert found.order == (2 if "coriolis" in name else 0)


def refused(motion: ck.results.Motion, name: str, error: type[Exception] = ck.errors.UnknownName) -> str:
    with pytest.raises(error) as told:
        ck.quantity(motion, name)
    return str(told.value)


def test_what_has_no_ratio_is_told_what_has() -> None:
    slider = catalog.motion("slider-crank")
    assert "the link 'piston' does not turn; name its slide 'stroke'" in refused(slider, "piston.advantage")
    assert "the frame does not move" in refused(slider, "frame.velocity_ratio")
    with pytest.raises(ck.errors.InvalidInput, match=r"output: the link 'piston' does not turn.*'stroke'.*ForcePort"):
        mechanical_advantage(slider, "piston", "crank")
    with pytest.raises(ck.errors.InvalidInput, match="input: the link 'piston' does not turn"):
        mechanical_advantage(slider, "crank", "piston")
    # of a parallelogram the coupler moves in a circle without turning
    told = refused(catalog.motion("parallelogram"), "coupler.advantage", ck.errors.InvalidInput)
    assert "does not turn in this motion" in told
    # rounding next to its change points, and in its accelerations, is larger in other units
    larger = ck.solve(scaled(catalog.mechanism("parallelogram"), 1e9))
    assert "does not turn in this motion" in refused(larger, "coupler.advantage", ck.errors.InvalidInput)
    # at a toggle position the rocker rests, and turns all the same
    alone = ck.solve(catalog.mechanism("slider-crank"), {"crank": [0.0]}, speed=1.0)
    assert np.isposinf(values(alone, "stroke.advantage")[0])
    five = catalog.motion("five-bar")
    assert "left: several drivers move (left, right)" in refused(five, "left.advantage", ck.errors.InvalidInput)
    resting = ck.solve(catalog.mechanism("crank-rocker"), {"crank": [1.0]}, speed=0.0)
    assert "no driver moves" in refused(resting, "rocker.advantage", ck.errors.InvalidInput)
    for name in ("rocker.advantage", "rocker.velocity_ratio"):
        at_rest = ck.solve(catalog.mechanism("crank-rocker"), order=0)
        assert "solve(..., order=1)" in refused(at_rest, name, ck.errors.InvalidInput)


def test_who_has_a_word_is_said_once() -> None:
    told = refused(catalog.motion("six-bar"), "G.advantage")
    assert "'G' has no 'advantage', which only links, pairs, drives have" in told


def test_one_of_two_drivers_may_move() -> None:
    mechanism = catalog.mechanism("five-bar")
    at = {"left": [1.0, 1.1], "right": [2.0, 2.0]}
    motion = ck.solve(mechanism, at, speed={"left": 1.0, "right": 0.0})
    assert values(motion, "outer-left.velocity_ratio") == pytest.approx(motion.links["outer-left"].angular_velocity)


# --- the Coriolis part of accelerations -------------------------------------------------------------------------


def turning_slot(speed: float, slide: float, along: float = 0.0) -> ck.results.Motion:
    """A disc that turns, and a slider moved along a straight slot in it."""
    mechanism = ck.Mechanism(
        "disc", ck.link("frame", O=0), ck.link("disc", O=0), ck.link("slider", A=0),
        ck.slide("slider", on="disc", at="A", through="O", name="slot"),
        ck.drive("disc", speed=speed, acceleration=-10.0),
        ck.drive("slider", on="disc", speed=slide, acceleration=along),
    )  # fmt: skip
    return ck.solve(mechanism, {"disc": [0.0], "slider": [6.0]})


def test_pin_in_a_slot_of_a_disc() -> None:
    """J. L. Meriam and L. G. Kraige, Dynamics, sample problem 5/16: 4 rad/s, slowing by 10 rad/s^2; 5 in/s, 81 in/s^2.

    Coriolis 40 in/s^2 across the slot; in all -15 along it and -20 across.
    """
    motion = turning_slot(4.0, 5.0, 81.0)
    assert values(motion, "slot.coriolis") == pytest.approx([40j], abs=1e-12)
    assert np.asarray(motion.points["A"].acceleration) == pytest.approx([-15 - 20j], abs=1e-12)
    assert values(motion, "slot.coriolis.length") == pytest.approx([40.0])


def test_crank_and_slotted_lever() -> None:
    """An examination question: 20 rad/s and 1.5 m/s have 60 m/s^2."""
    assert values(turning_slot(20.0, 1.5), "slot.coriolis.length") == pytest.approx([60.0])


def lever_with_a_curved_slot() -> ck.results.Motion:
    mechanism = ck.Mechanism(
        "curved", ck.link("frame", C=(0, 80), D=0), ck.link("crank", C=0, A=30), ck.link("lever", D=0, M=(80, 60)),
        ck.arc("crank", on="lever", at="A", centre_at="M", radius=70, name="slot"), ck.drive("crank", speed=2.0),
    )  # fmt: skip
    return ck.solve(mechanism, {"crank": ck.deg(np.arange(0.0, 360.0, 5.0))})


@pytest.mark.parametrize("name", [*WITH_GUIDES, ""])
def test_accelerations_are_the_sum_of_three(name: str) -> None:
    """That of the guide's own point, the one seen from the guide, and the Coriolis part."""
    motion = catalog.motion(name) if name else lever_with_a_curved_slot()
    found = [pair for pair in motion.pairs if has(motion, f"{pair}.coriolis")]
    assert found
    for pair in found:
        guide, link = motion.solving_order.pairs[pair].members[:2]
        point = motion.inputs.ends[pair][1].point
        place = np.asarray(motion.links[link].at(point).position)
        base = motion.poses[guide]
        seen = ck.figures.relative_point(motion, link, point, on=guide)
        own = motion.links[guide].at(motion.grid.known(np.conjugate(base.u.c[0]) * (place - base.z.c[0]))).acceleration
        relative = np.asarray(seen.acceleration) * motion.grid.known(base.u.c[0])
        whole = np.asarray(motion.links[link].at(point).acceleration)
        scale = np.nanmax(np.abs(whole[np.isfinite(whole)]))
        left = whole - np.asarray(own) - relative - values(motion, f"{pair}.coriolis")
        assert np.nanmax(np.abs(left[np.isfinite(left)])) < 1e-9 * scale, pair


def has(motion: ck.results.Motion, name: str) -> bool:
    try:
        ck.quantity(motion, name)
    except ck.errors.UnknownName:
        return False
    return True


def test_what_has_no_coriolis_part_is_told_why() -> None:
    assert "its guide on 'frame' does not turn" in refused(catalog.motion("slider-crank"), "stroke.coriolis")
    assert "no point of a revolute pair slides" in refused(catalog.motion("slider-crank"), "A.coriolis")
    still = ck.solve(catalog.mechanism("oscillating-guide"), order=0)
    assert "solve(..., order=1)" in refused(still, "slot.coriolis", ck.errors.InvalidInput)


# --- pressure angles of cams ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "pair", "follower"),
    [
        ("disc-cam-roller-program", "follower/cam", "follower"),
        ("disc-cam-offset-roller", "roller/cam", "follower"),
        ("flat-faced-follower", "follower/cam", "follower"),
        ("oscillating-roller-follower", "follower/cam", "follower"),
        ("oscillating-flat-follower", "follower/cam", "follower"),
    ],
)
def test_pressure_angles_of_cams(name: str, pair: str, follower: str) -> None:
    """As the analysis of the cam has them; for the one body of a follower they are 90 degrees less its transmission."""
    motion = catalog.motion(name)
    found = values(motion, f"{pair}.pressure_angle")
    np.testing.assert_array_equal(found, ck.figures.cam_analysis(motion, pair).pressure_angle)
    assert np.pi / 2 - np.abs(found) == pytest.approx(values(motion, f"{follower}.transmission_angle"), abs=1e-7)
    alone = ck.solve(catalog.mechanism(name), order=0)
    assert values(alone, f"{pair}.pressure_angle") == pytest.approx(found, abs=1e-9)


def test_what_has_no_pressure_angle_is_told_what_has() -> None:
    assert "a gear pair has no profile" in refused(catalog.motion("planetary-train"), "planet on sun.pressure_angle")


# --- in files ---------------------------------------------------------------------------------------------------


def test_figures_are_outputs_and_published_numbers_in_degrees() -> None:
    (found,) = [
        e for e in catalog.mechanism("four-bar-norton").expectations if e.quantity == "rocker.transmission_angle"
    ]
    assert np.rad2deg(found.value.real) == pytest.approx(57.325 - 20.298)
    text = catalog.report_of("four-bar-norton").text()
    assert "7 of 7 published numbers found" in text
    assert "37.02" in text
