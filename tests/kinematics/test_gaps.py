"""Where a motion cannot be assembled: the limits against trigonometry, the reasons against the geometry."""

import warnings

import numpy as np
import pytest

import compoundkin as ck


def solved(mechanism, *args, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(mechanism, *args, **options)


def four_bar(ground, crank, coupler, rocker):
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=0, D=ground),
        ck.link("crank", A=0, B=crank),
        ck.link("coupler", B=0, C=coupler),
        ck.link("rocker", D=0, C=rocker),
        ck.drive("crank"),
    )


def test_the_limits_of_a_triple_rocker_are_those_of_the_law_of_cosines():
    (gap,) = ck.gaps(solved(four_bar(7.0, 4.0, 5.0, 3.0)))
    limit = np.arccos((7**2 + 4**2 - 8**2) / (2 * 7 * 4))
    assert gap.begin["crank"] == pytest.approx(limit, abs=1e-9)
    assert gap.end["crank"] == pytest.approx(2 * np.pi - limit, abs=1e-9)
    assert gap.reason == "|BD| = 11 > |BC| + |CD| = 5 + 3"
    assert (gap.group, gap.links) == ("RRR", ("coupler", "rocker"))


def test_a_group_too_near_says_so():
    motion = solved(four_bar(3.2, 3.0, 6.5, 7.2), {"crank": np.linspace(-0.5, 0.5, 21)})
    (gap,) = ck.gaps(motion)
    limit = np.arccos((3.2**2 + 3**2 - 0.7**2) / (2 * 3.2 * 3))
    assert gap.begin["crank"] == pytest.approx(-limit, abs=1e-9)
    assert "< ||BC| - |CD||" in gap.reason


def test_gaps_at_the_ends_of_a_motion_are_open():
    first, last = ck.gaps(solved(four_bar(7.0, 4.0, 5.0, 3.0), {"crank": np.linspace(-2.0, 2.0, 41)}))
    assert (first.open_begin, first.open_end) == (True, False)
    assert (last.open_begin, last.open_end) == (False, True)
    assert first.begin["crank"] == -2.0
    assert last.end["crank"] == 2.0


def test_every_design_has_its_own_gaps():
    lengths = np.array([4.0, 3.0, 1.5])
    motion = solved(four_bar(7.0, lengths[:, None], 5.0, 3.0))
    found = ck.gaps(motion)
    assert [gap.design for gap in found] == [(0,), (1,), (2,)]
    for gap, crank in zip(found, lengths, strict=True):
        limit = np.arccos((7**2 + crank**2 - 8**2) / (2 * 7 * crank))
        assert gap.begin["crank"] == pytest.approx(limit, abs=1e-9)


def test_a_slider_crank_that_does_not_reach():
    mechanism = ck.Mechanism(
        "Slider-crank",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=2),
        ck.link("rod", B=0, C=1.5),
        ck.link("slider", C=0),
        ck.slide("slider", on="frame", through="A"),
        ck.drive("crank"),
    )
    first, _ = ck.gaps(solved(mechanism))
    assert first.begin["crank"] == pytest.approx(np.arcsin(0.75), abs=1e-9)
    assert first.reason.startswith("B is 2 from the line on which C runs > |BC| = 1.5")


def test_the_limit_of_a_class_iii_group_is_a_singular_pose():
    joints = {"A": (7, 4), "B": (5, 16), "C": (25, 25), "D": (23, 10), "E": (18, 35), "F": (43, 32), "G": (45, 17)}
    mechanism = ck.Mechanism(
        "Stephenson III, driven between its plate and its rod",
        ck.link("frame", "A", "D", "G"),
        ck.link("AB", "A", "B"),
        ck.link("BCE", "B", "C", "E"),
        ck.link("CD", "C", "D"),
        ck.link("EF", "E", "F"),
        ck.link("FG", "F", "G"),
        ck.drawn(**joints),
        ck.drive("EF", on="BCE", values=np.linspace(-2.5, 0.5, 31)),
    )
    motion = solved(mechanism)
    found = [gap for gap in ck.gaps(motion) if not (gap.open_begin and gap.open_end)]
    assert found
    for gap in found:
        for open_, value in ((gap.open_begin, gap.begin["EF"]), (gap.open_end, gap.end["EF"])):
            if open_:
                continue
            inner = value + 1e-9 if gap.open_begin or value > gap.begin["EF"] else value - 1e-9
            approach = [mechanism_value(motion), inner]
            near = solved(mechanism, {"EF": np.linspace(*approach, 50)})
            assert near.assembled.all()
            # the rate grows as the inverse square root of the distance from a limit
            assert abs(near.links["AB"].angular_velocity[-1]) > 1e2


def mechanism_value(motion):
    """The driver's value in the middle of what is assembled."""
    good = np.flatnonzero(motion.assembled)
    return float(motion.drives["EF"].value[good[len(good) // 2]])
