"""The figures of motions, by closed forms of textbooks and the mechanisms' own geometry."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")


def value(one: ck.results.Quantity | None) -> float:
    assert one is not None
    return float(one.values)


def test_stroke_and_time_ratio_of_an_offset_slider_crank() -> None:
    """r = 40, l = 120, e = 20: the piston turns back where crank and rod are in line."""
    ram = ck.characteristics(catalog.motion("slider-crank-offset"))["stroke.value"]
    far, near = np.sqrt(160.0**2 - 20.0**2), np.sqrt(80.0**2 - 20.0**2)
    assert value(ram.stroke) == pytest.approx(far - near, rel=1e-12)
    imbalance = np.arcsin(20 / 80) - np.arcsin(20 / 160)
    assert ram.quick_return is not None
    assert value(ram.quick_return.imbalance) == pytest.approx(imbalance, abs=1e-8)
    assert value(ram.time_ratio) == pytest.approx((np.pi + imbalance) / (np.pi - imbalance), abs=1e-8)
    # at the dead points the rod is in line with the crank, once folded and once stretched
    angles = sorted(value(point.at["crank"]) for point in ram.dead_points)
    assert angles == pytest.approx([np.pi - np.arcsin(20 / 80), 2 * np.pi - np.arcsin(20 / 160)], abs=1e-8)


def test_quick_returns_of_textbooks() -> None:
    """Whitworth: frame 20, crank 40: 240 degrees forth for 120 back; a crank-shaper of crank 10, frame 25."""
    whitworth = ck.characteristics(catalog.motion("whitworth-quick-return"))["ram"]
    assert value(whitworth.time_ratio) == pytest.approx(2.0, abs=1e-8)
    assert value(whitworth.stroke) == pytest.approx(2 * 75.0)  # twice the guide's arm
    found = ck.characteristics(catalog.motion("crank-shaper"))
    half = np.arccos(10 / 25)  # the lever is tangent to the crank's circle
    assert value(found["lever"].time_ratio) == pytest.approx((np.pi - half) / half, abs=1e-8)
    assert value(found["lever"].stroke) == pytest.approx(2 * np.arcsin(10 / 25), rel=1e-10)
    # the crank turns from 360 degrees downward, and so the dead points come in that order
    exact = [2 * np.pi - np.arcsin(0.4), np.pi + np.arcsin(0.4)]
    assert [value(point.at["crank"]) for point in found["lever"].dead_points] == pytest.approx(exact, abs=1e-8)


def test_a_drag_link_has_no_dead_points_and_the_ratio_of_its_extremes() -> None:
    """The follower of a double crank goes on and on: velocity ratios are positive throughout."""
    found = ck.characteristics(catalog.motion("double-crank"))
    (follower,) = found.outputs[:1]
    assert follower.dead_points == ()
    assert follower.time_ratio is None
    assert value(follower.stroke) == pytest.approx(2 * np.pi)
    (ratio,) = [one for one in found.advantages if one.owner == "follower"]
    assert ratio.ratio.least.number > 0
    assert ratio.greatest is not None
    assert ratio.greatest.number == pytest.approx(1 / ratio.ratio.least.number)


def test_transmission_angles_of_a_crank_rocker_are_those_of_its_triangles() -> None:
    """Norton's four-bar 100, 40, 120, 80: the diagonal is 60 and 140 long where crank and frame are in line."""
    found = ck.characteristics(catalog.motion("four-bar-norton"))
    (dyad,) = found.groups
    angles = [np.arccos((120**2 + 80**2 - d**2) / (2 * 120 * 80)) for d in (100 - 40, 100 + 40)]
    folded = [min(a, np.pi - a) for a in angles]
    assert dyad.is_angle
    assert dyad.range.least.number == pytest.approx(min(folded), abs=1e-9)
    assert dyad.is_poor == (min(folded) < np.deg2rad(40))
    assert found.warnings == (f"{dyad.name} falls to {np.rad2deg(min(folded)):.3g} degrees on the way to the output",)


def test_only_groups_on_the_way_to_an_output_are_warned_of() -> None:
    """The second dyad of a Watt II does not matter to an output of the first."""
    motion = catalog.motion("watt-ii-driven-at-ternary")
    assert [one.on_the_way for one in ck.characteristics(motion, ["AB"]).groups] == [True, False]
    index = ck.characteristics(catalog.motion("class-iii-six-bar"))
    assert not index.groups[0].is_angle
    assert index.warnings == ()


def test_advantage_is_least_where_the_output_is_fastest_and_has_no_limit_at_dead_points() -> None:
    found = ck.characteristics(catalog.motion("slider-crank"))
    (ram,) = [one for one in found.advantages if one.owner == "stroke"]
    assert ram.toggles
    assert ram.greatest is None
    fastest = found["stroke"].speed
    assert fastest is not None
    speed = catalog.motion("slider-crank").drives["crank"].rate[0]
    assert abs(ram.least.number) == pytest.approx(abs(speed / fastest.number), rel=1e-9)


def test_ratios_by_rates_are_those_by_name() -> None:
    """A driver of changing speed has ratios searched by name, one of steady speed those of its rates."""
    mechanism = catalog.mechanism("crank-rocker")
    steady = ck.solve(mechanism, speed=2.0)
    turning = ck.solve(mechanism, {"crank": 0.3}, time=np.linspace(0.5, 1.7, 40), speed=1.0, acceleration=0.4)
    for motion in (steady, turning):
        (one,) = ck.characteristics(motion, ["rocker"]).advantages
        ratios = ck.quantity(motion, "rocker.velocity_ratio").values
        assert one.ratio.least.number <= np.min(ratios) + 1e-9
        assert one.ratio.greatest.number >= np.max(ratios) - 1e-9
        assert np.ptp(ratios) == pytest.approx(one.ratio.greatest.number - one.ratio.least.number, rel=0.02)


def test_the_coriolis_part_on_a_moving_guide() -> None:
    """Twice the lever's rate times the block's velocity along it, at each of 3600 poses solved by themselves."""
    motion = catalog.motion("crank-shaper")
    greatest = ck.characteristics(motion).coriolis["slot.coriolis.length"].greatest
    fine = ck.solve(motion.mechanism, {"crank": np.linspace(0, -2 * np.pi, 3601)})
    part = 2 * fine.links["lever"].angular_velocity * fine.pairs["slot"].rate
    assert greatest.number == pytest.approx(np.max(np.abs(part)), rel=1e-5)
    assert greatest.number >= np.max(np.abs(part)) * (1 - 1e-12)


def test_a_long_dwell_of_a_six_bar() -> None:
    """The output link of the Watt II stays within 1 % of its stroke for the interval that a fine solution shows."""
    motion = catalog.motion("watt-ii")
    follower = ck.characteristics(motion)["FG"]
    dwell = max(follower.dwells, key=lambda one: one.poses)
    crank = np.linspace(0, 2 * np.pi, 36001)
    angle = ck.solve(motion.mechanism, {"crank": crank}, order=0).links["FG"].angle
    low, high = value(dwell.begin["crank"]), value(dwell.end["crank"])
    inside = angle[(crank >= low) & (crank <= high)]
    band = 0.01 * np.ptp(angle)
    assert np.ptp(inside) == pytest.approx(band, rel=1e-3)
    assert value(dwell.span) == pytest.approx(high - low)
    # a little longer it would be more
    assert np.ptp(angle[(crank >= low - 0.003) & (crank <= high + 0.003)]) > band


def test_gaps_are_told_with_the_dead_points_of_the_driver() -> None:
    """Frame 7, crank 4, coupler 5, rocker 3: stretched, coupler and rocker reach 8."""
    with warnings.catch_warnings(action="ignore"):
        motion = ck.solve(catalog.mechanism("triple-rocker"), {"driver": ck.deg(np.arange(0, 361, 5))})
    found = ck.characteristics(motion)
    limit = np.arccos((7**2 + 4**2 - 8**2) / (2 * 7 * 4))
    assert [value(one.at["driver"]) for one in found.dead_points] == pytest.approx([limit, 2 * np.pi - limit], abs=1e-8)
    assert "8 > " in found.dead_points[0].reason or "> |BC| + |CD|" in found.dead_points[0].reason
    assert any("cannot be assembled" in note for note in found.notes)
    assert all(one.time_ratio is None for one in found.outputs)


def test_strokes_are_told_piece_by_piece() -> None:
    """From 0 to 600 degrees the triple rocker moves in two parts; the second has both limits."""
    motion = ck.solve(catalog.mechanism("triple-rocker"), {"driver": ck.deg(np.arange(0, 601, 5))})
    (rocker,) = ck.characteristics(motion, ["rocker"]).outputs
    limit = np.arccos((7**2 + 4**2 - 8**2) / (2 * 7 * 4))
    begins = [value(piece.begin["driver"]) for piece in rocker.pieces]
    assert begins == pytest.approx([0.0, 2 * np.pi - limit], abs=1e-8)
    assert value(rocker.pieces[1].end["driver"]) == pytest.approx(2 * np.pi + limit, abs=1e-8)
    # next to a limit the rocker goes with the square root: 1e-9 of the driver is 4e-5 of the rocker
    part = ck.solve(motion.mechanism, {"driver": np.linspace(-limit + 1e-9, limit - 1e-9, 4001)}, order=0)
    assert value(rocker.pieces[1].stroke) == pytest.approx(np.ptp(part.links["rocker"].angle), abs=1e-4)


def test_a_single_pose_and_several_drivers_say_what_is_not_defined() -> None:
    pose = ck.characteristics(ck.solve(catalog.mechanism("four-bar-norton"), {"crank": [1.0]}))
    assert pose.notes[0].startswith("A single pose")
    assert pose.outputs[0].stroke is None
    assert pose.outputs[0].dead_points == ()
    assert pose.groups[0].range.is_constant
    several = ck.characteristics(catalog.motion("five-bar"))
    assert "Several drivers move (left, right)" in several.notes[0]
    assert several.advantages == ()
    assert several.outputs[0].speed is not None


def test_outputs_are_had_by_their_names_and_unknown_ones_told() -> None:
    found = ck.characteristics(catalog.motion("crank-shaper"))
    assert found["ram"] is found["ram.value"] is found["ram.rate"]
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'ram'"):
        found["rma"]
    with pytest.raises(ck.errors.UnknownName, match="none of the outputs"):
        found["rod.angle"]
    with pytest.raises(ck.errors.UnknownName, match="no point, link, pair or driver"):
        ck.characteristics(found.motion, ["nobody.angle"])
    with pytest.raises(ck.errors.InvalidInput, match="no part of a stroke"):
        ck.characteristics(found.motion, dwell=2.0)
    assert repr(found).startswith("Characteristics('Crank-shaper quick return': 3 outputs")


def test_designs_have_figures_of_their_own() -> None:
    """Two cranks of a slider-crank without offset: the stroke is twice the crank."""
    links = ck.link("frame", A=0), ck.link("crank", A=0, B=([[1.0], [1.5]], 0)), ck.link("rod", B=0, C=4)
    m = ck.Mechanism("m", *links, ck.link("block", C=0), ck.slide("block", on="frame", through="A"), ck.drive("crank"))
    motion = ck.solve(m, {"crank": ck.deg(np.arange(0, 361, 5))})
    strokes = [value(ck.characteristics(motion, ["block/frame"], design)["block/frame"].stroke) for design in (0, 1)]
    assert strokes == pytest.approx([2.0, 3.0])


def test_vectors_and_ratios_are_outputs_too() -> None:
    """The Coriolis part goes by its length, as a velocity does; an advantage that passes infinity has no stroke."""
    coriolis = ck.characteristics(catalog.motion("six-bar"), outputs=["slot.coriolis"])["slot.coriolis"]
    longest = np.abs(ck.quantity(catalog.motion("six-bar"), "slot.coriolis").values).max()
    assert value(coriolis.stroke) == pytest.approx(longest, rel=1e-2)
    for name, owner in (("slider-crank", "stroke"), ("crank-rocker", "rocker")):
        through = ck.characteristics(catalog.motion(name), outputs=[f"{owner}.advantage"])[f"{owner}.advantage"]
        assert (through.stroke, through.dwells) == (None, ())
    with pytest.raises(ck.errors.UnknownName, match="has no 'z'"):
        ck.characteristics(catalog.motion("six-bar"), outputs=["slot.coriolis.z"])


@pytest.mark.parametrize("profile", ["parabolic", "harmonic", "cycloidal"])
def test_a_law_that_begins_at_a_corner_turns_back_at_the_seam_of_its_cycle(profile: str) -> None:
    """One second forth, half a second of rest, one second back: forth 1 s of 2.5 s, whatever the profile."""
    law = ck.laws.program(ck.laws.rise(1, 1, profile), ck.laws.dwell(0.5), ck.laws.fall(1, 1, profile))
    m = ck.Mechanism("m", ck.link("frame", O=0), ck.link("arm", O=0, A=1), ck.drive("arm", law=law))
    arm = ck.characteristics(ck.solve(m, time=np.linspace(0, 2.5, 26)), ["arm.angle"])["arm"]
    assert [value(one.at["time"]) for one in arm.dead_points] == pytest.approx([0.0, 1.0], abs=1e-9)
    assert arm.time_ratio is None  # the rest belongs neither to the way forth nor to that back
    back = ck.laws.program(ck.laws.rise(1, 1, profile), ck.laws.fall(1, 2, profile))
    quicker = ck.solve(m.replace(ck.drive("arm", law=back)), time=np.linspace(0, 3, 31))
    arm = ck.characteristics(quicker, ["arm.angle"])["arm"]
    assert value(arm.time_ratio) == pytest.approx(2.0, abs=1e-9)


def test_rounding_is_no_figure() -> None:
    """The coupler of a parallelogram stays parallel, also where it passes its change points."""
    found = ck.characteristics(catalog.motion("parallelogram"))
    coupler = found["coupler"]
    assert value(coupler.stroke) == 0.0
    assert coupler.acceleration is not None
    assert abs(coupler.acceleration.number) < 1e-6  # of the driver's 1 rad/s
    assert found.warnings[0].startswith("coupler.transmission_angle falls to 0 degrees")


def test_advantage_has_no_limit_where_the_output_rests_at_an_end_of_the_motion() -> None:
    """The pin of a Geneva wheel enters and leaves its slot in the slot's direction."""
    (wheel,) = ck.characteristics(catalog.motion("geneva-wheel")).advantages
    assert wheel.toggles
    assert wheel.greatest is None
    assert abs(wheel.least.number) == pytest.approx(np.sqrt(2) - 1)  # (c - r) / r with c = sqrt(2) r


def test_names_that_mean_nothing_are_told() -> None:
    motion = catalog.motion("slider-crank-offset")
    with pytest.raises(ck.errors.UnknownName, match="zz"):
        ck.characteristics(motion, ["B.velocity.zz"])
    with pytest.raises(ck.errors.UnknownName, match="no vector"):
        ck.characteristics(motion, ["rod.angle.x"])
    with pytest.raises(ck.errors.UnknownName, match="no name of an output"):
        ck.characteristics(motion)[5]  # type: ignore[index]
    still = ck.characteristics(ck.solve(motion.mechanism, speed=0.0))
    assert still.notes[0].startswith("No driver has a speed")


def test_full_turns_are_those_of_grashof_and_none_of_an_open_motion() -> None:
    # the crank of a crank-rocker turns alone; of a drag link all turn, and backwards with the crank
    assert ck.characteristics(catalog.motion("crank-rocker")).full_turns == {"crank": 1, "coupler": 0, "rocker": 0}
    drag = ck.solve(catalog.mechanism("double-crank"), ck.deg(np.arange(0, -721, -5)))
    assert ck.characteristics(drag).full_turns == {"crank": -2, "coupler": -2, "follower": -2}
    half = ck.solve(catalog.mechanism("double-crank"), ck.deg(np.arange(0, 181, 5)))
    assert ck.characteristics(half).full_turns == {}
