"""Strokes, time ratios and dead points held against closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.kinematics.extremes import dead_points, driver_dead_points, extremes, pieces, zeros
from compoundkin.view.report import report
from compoundkin.view.report.verification_sections import comparisons
from tests.catalog import mechanism
from tests.catalog import motion as solved

CRANK, ROD, OFFSET = 40.0, 120.0, 20.0


def figure(motion: ck.results.Motion, name: str) -> float:
    """A figure of the whole motion, angles in degrees; the same at all poses."""
    found = ck.quantity(motion, name).shown.values
    assert np.shape(found) == motion.shape
    assert np.ptp(found) == 0.0
    return float(found.flat[0])


def test_an_offset_slider_crank_returns_faster() -> None:
    """The rod in line with the crank. Source: R. L. Norton, Design of Machinery, section 3.6."""
    motion = solved("slider-crank-offset")
    ends = [np.sqrt((ROD + sign * CRANK) ** 2 - OFFSET**2) for sign in (-1.0, 1.0)]
    turned = np.rad2deg(np.arcsin(OFFSET / (ROD - CRANK)) - np.arcsin(OFFSET / (ROD + CRANK)))
    assert figure(motion, "B.x.stroke") == pytest.approx(ends[1] - ends[0], rel=1e-13)
    assert figure(motion, "B.x.imbalance_angle") == pytest.approx(turned, abs=1e-8)
    assert figure(motion, "B.x.time_ratio") == pytest.approx((180.0 + turned) / (180.0 - turned), abs=1e-10)


def test_a_crank_shaper_by_the_swing_of_its_lever() -> None:
    """The lever touches the crank's circle at asin(10 / 25); the ram's stroke is 2 * 65 * 10 / 25."""
    motion, swing = solved("crank-shaper"), np.rad2deg(np.arcsin(10.0 / 25.0))
    assert figure(motion, "ram.value.time_ratio") == pytest.approx((90.0 + swing) / (90.0 - swing), rel=1e-9)
    assert figure(motion, "lever.angle.stroke") == pytest.approx(2.0 * swing, rel=1e-12)
    # the rod is as oblique at both ends, for the lever's ends are as high
    assert figure(motion, "ram.value.stroke") == pytest.approx(52.0, rel=1e-12)


def test_a_whitworth_quick_return_as_published() -> None:
    """Stroke 150 mm and time ratio 2, the textbook exercise that the file names; its ends at crank 210 and 330."""
    motion = solved("whitworth-quick-return")
    assert figure(motion, "ram.value.stroke") == pytest.approx(150.0, abs=1e-9)
    assert figure(motion, "ram.value.time_ratio") == pytest.approx(2.0, abs=1e-9)
    assert figure(motion, "ram.value.imbalance_angle") == pytest.approx(60.0, abs=1e-8)
    found = dead_points(motion, "ram.value")
    assert np.allclose(np.sort(np.mod(np.rad2deg(found.at.drives["crank"]), 360.0)), [210.0, 330.0], atol=1e-9)
    assert np.allclose(np.sort(found.value), [125.0, 275.0], atol=1e-9)


def test_a_drag_link_turns_twice_as_fast_and_as_slow() -> None:
    """The speeds of a turning guide: with crank r and distance e, r / (r + e) to r / (r - e) times the crank's."""
    motion = solved("whitworth-turning-guide")
    frame, crank = motion.mechanism.links["frame"], motion.mechanism.links["crank"]
    places: list[complex] = [complex(p) for p in frame.points.values() if p is not None]
    radius = max(abs(complex(p)) for p in crank.points.values() if p is not None)
    apart, speed = abs(places[0] - places[1]), float(motion.drives["crank"].rate.flat[0])
    (found,) = extremes(motion, "guide.angular_velocity")
    assert found.least.value[0] == pytest.approx(speed * radius / (radius + apart), rel=1e-12)
    assert found.greatest.value[0] == pytest.approx(speed * radius / (radius - apart), rel=1e-12)


def test_a_crank_rocker_is_dead_where_crank_and_coupler_are_in_line() -> None:
    motion = solved("crank-rocker")
    found = dead_points(motion, "rocker.angle")
    assert found.is_greatest.tolist() in ([True, False], [False, True])
    at = np.rad2deg(found.at.drives["crank"])
    there = ck.solve(motion.mechanism, {"crank": np.deg2rad(at)}, modes=None)
    crank, coupler = (there.points[k].position for k in ("B", "C"))
    arm = crank - there.points["A"].position
    assert np.abs(np.imag(np.conj(arm) * (coupler - crank))).max() < 1e-8 * motion.size**2


def test_a_driver_is_dead_at_its_limit_positions() -> None:
    """B and D are |BC| + |CD| apart: the triple rocker's limits, by the law of cosines."""
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism("triple-rocker"), ck.deg(np.arange(0.0, 361.0, 5.0)))
    at = np.rad2deg(driver_dead_points(motion).drives["driver"])
    assert np.allclose(np.sort(at), [88.97680670, 360.0 - 88.97680670], atol=1e-7)
    (piece,) = pieces(motion).begin.place  # one piece, through the end of the cycle
    assert piece > pieces(motion).end.place[0]


def test_a_program_in_time_rests_at_its_dead_points() -> None:
    law = ck.laws.program(ck.laws.rise(10.0, over=1.0), ck.laws.dwell(0.5), ck.laws.fall(10.0, over=1.0), repeat=True)
    slide = ck.slide("block", on="frame", through="A", angle=0)
    block = ck.Mechanism("block", ck.link("frame", A=0), ck.link("block", B=0), slide, ck.drive("block", law=law))
    motion = ck.solve(block, time=np.linspace(0.0, 2.5, 51))
    found = dead_points(motion, "B.x")
    assert found.is_greatest.tolist()[-1:] == [True]
    (still,) = extremes(motion, "B.x")
    times: Number = still.greatest.at.time
    assert (times[0], still.greatest.until[0]) == (pytest.approx(1.0), pytest.approx(30.0))
    with pytest.raises(ck.errors.InvalidInput, match="rests at an end of its stroke"):
        ck.quantity(motion, "B.x.time_ratio")
    rate = zeros(motion, "B.velocity.x", 5.0)
    assert len(rate.at.place) == 2


def test_designs_have_a_stroke_each() -> None:
    rods = ck.Mechanism(
        "rods", ck.link("frame", O=0), ck.link("crank", O=0, A=CRANK),
        ck.link("rod", A=0, B=np.array([[100.0], [120.0]])), ck.link("piston", B=0),
        ck.slide("piston", on="frame", through="O", angle=0), ck.drive("crank"),
    )  # fmt: skip
    found = ck.quantity(ck.solve(rods), "B.x.stroke")
    assert np.allclose(found.values, 2.0 * CRANK, rtol=1e-13)
    assert found.values.shape == (2, 73)


def test_figures_are_expected_tabulated_and_told() -> None:
    shaper = mechanism("crank-shaper")
    numbers = ck.expect("ram.value.stroke", 52.0, 1e-9), ck.expect("lever.angle.stroke", 2.0 * np.arcsin(0.4), 1e-9)
    expected = shaper.replace(*numbers)
    assert all(one.passed for one in comparisons(ck.decompose(expected)))
    motion = solved("crank-shaper")
    assert np.ptp(motion.table("ram.value.stroke")["ram.value.stroke"].values) == 0.0
    told = report(motion, ["ram.value", "ram.value.stroke", "ram.value.time_ratio"]).text()
    assert "Over the whole motion" in told
    assert "1.70995" in told


def test_figures_of_what_has_none_say_why() -> None:
    half = ck.solve(mechanism("crank-rocker"), ck.deg(np.arange(0.0, 91.0, 5.0)))
    with pytest.raises(ck.errors.InvalidInput, match="no closed cycle; solve it over a full turn"):
        ck.quantity(half, "rocker.angle.time_ratio")
    with pytest.raises(ck.errors.InvalidInput, match="a single pose does not tell it"):
        ck.quantity(ck.solve(mechanism("crank-rocker"), {"crank": [1.0]}), "rocker.angle.stroke")
    with pytest.raises(ck.errors.UnknownName, match="rocker"):
        ck.quantity(half, "rokcer.angle.stroke")
    with pytest.raises(ck.errors.InvalidInput, match="a rate has no dead points"):
        dead_points(half, "rocker.angular_velocity")
    with pytest.raises(ck.errors.InvalidInput, match="3 drivers move"):
        dead_points(solved("excavator-arm"), "boom.angle")


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("crank-shaper", "crank.time_ratio"),
        ("double-crank", "follower.time_ratio"),
        ("triple-rocker", "rocker.time_ratio"),
    ],
)
def test_what_does_not_go_to_and_fro_has_no_time_ratio(name: str, what: str) -> None:
    """Cranks and drag links turn on; of a motion with gaps the way back is not known."""
    motion = ck.solve(mechanism(name), ck.deg(np.arange(0, 361, 5)))
    with pytest.raises(ck.errors.InvalidInput, match=r"to and fro|cannot be assembled"):
        ck.quantity(motion, what)
