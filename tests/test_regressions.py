"""Failures that were found by trying to break things, each under its own name."""

import warnings

import numpy as np
import pytest

import compoundkin as ck

FOUR_BAR = ck.Mechanism(
    "Four-bar",
    ck.link("frame", A=(0, 0), D=(7, 0)),
    ck.link("crank", A=0, B=4),
    ck.link("coupler", B=0, C=5),
    ck.link("rocker", D=0, C=3),
    ck.drive("crank"),
)


def test_both_components_of_an_unassembled_pose_are_not_a_number():
    with pytest.warns(ck.UnassembledPoses):
        motion = ck.solve(FOUR_BAR, {"crank": ck.deg([0.0, 80.0, 120.0])})
    assert motion.assembled.tolist() == [True, True, False]
    for array in (motion.points["C"].y, motion.points["C"].x, motion.points["C"].velocity.xy[:, 1]):
        assert np.isnan(array).tolist() == [False, False, True]
    assert np.isnan(motion.links["rocker"].angle[2])
    assert motion.drives["crank"].value[2] == ck.deg(120.0)


def test_two_letters_drawn_at_one_place_show_no_direction():
    good = ck.drawn(A=(0, 0), B=(0, 0), C=(3, 4))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = ck.solve(FOUR_BAR.replace(good), {"crank": 0.5})
    assert motion.points["C"].position.imag > 0


def test_a_guide_toward_its_own_point_is_refused():
    mechanism = ck.Mechanism(
        "Guide without direction",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=1, Z=0),
        ck.link("block", S=0),
        ck.slide("block", on="crank", through="A", toward="Z"),
        ck.drive("crank"),
        ck.drive("block", on="crank", values=1.0),
    )
    with pytest.raises(ck.InvalidMechanism, match="no direction"):
        ck.solve(mechanism)


def test_the_only_driver_needs_no_name():
    assert np.array_equal(ck.solve(FOUR_BAR, [0.1, 0.2]).drives["crank"].value, [0.1, 0.2])


@pytest.mark.parametrize(
    ("mechanism", "options"),
    [
        (FOUR_BAR, {"order": 2.0}),
        (FOUR_BAR, {"modes": -1}),
        (FOUR_BAR, {"modes": {"crank": 1}}),
        (FOUR_BAR, {"modes": {"coupler": 1, "rocker": -1}}),
        (FOUR_BAR, {"hint": {"C": (0, np.nan)}}),
        ("six-bar", {}),
    ],
)
def test_mistakes_of_a_call_are_told(mechanism, options):
    with pytest.raises(ck.InvalidInput):
        ck.solve(mechanism, **options)


def test_outputs_of_what_there_is_not_are_found_at_once():
    items = [*FOUR_BAR.items, ck.expect("Q.velocity", 1.0, 0.1)]
    with pytest.raises(ck.InvalidMechanism) as caught:
        ck.Mechanism("m", *items, outputs=("Z.x", "C.x", "crank.angle"))
    assert [problem.where for problem in caught.value.problems] == ["outputs[0]", "expected[0].quantity"]


@pytest.mark.parametrize("quantity", ["rocker", "C", "C.value"])
def test_a_published_number_says_whether_it_is_an_angle(quantity):
    with pytest.raises(ck.InvalidMechanism, match="does not say of what kind"):
        FOUR_BAR.replace(ck.expect(quantity, 1.0, 0.1))


def test_the_angle_in_a_pin_is_written_in_degrees(tmp_path):
    mechanism = FOUR_BAR.replace(ck.expect("C.angle", ck.deg(30.0), 0.1, crank=0.5))
    ck.save(mechanism, tmp_path / "m.toml")
    assert "value = 30" in (tmp_path / "m.toml").read_text()
    assert ck.load(tmp_path / "m.toml") == mechanism
    motion = ck.solve(mechanism, {"crank": [0.1, 0.2]})
    assert np.array_equal(ck.quantity(motion, "C.angle").values, motion.pairs["C"].value)
