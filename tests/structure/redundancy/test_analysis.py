"""Mobility by three numbers: published cases, properties, and random mechanisms in which all agree."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.structure.redundancy import mobility_analysis
from tests.structure.redundancy.special import bars, cranks, guides, wedge
from tests.support import KINDS_OF_DYAD, examples, random_sketch, reference

CASES = {
    "parallelogram_extra_crank": cranks(),
    "dixon1_K33": bars("dixon1_K33"),
    "prism_parallel_infinitesimal": bars("prism_parallel_infinitesimal"),
    "prism_generic_rigid": bars("prism_generic_rigid"),
    "wedge_PPP": wedge(),
    "roberts_triple_cognate": bars("roberts_triple_cognate"),
}


@pytest.mark.parametrize("name", CASES)
def test_reference_cases(name):
    expected, found = reference(name, "overconstrained")["expected"], mobility_analysis(CASES[name])
    assert found.gruebler == expected["gruebler_F"]
    assert found.at_pose == expected.get("nullity_here", expected.get("nullity"))
    assert found.finite == expected["finite_mobility"]
    if "generic_nullity" in expected:
        assert found.generic == expected["generic_nullity"]
    # rank and nullity: F counts the rows that are redundant as if they held something
    assert found.redundant == found.at_pose - found.gruebler
    assert found.redundant_generic == found.generic - found.gruebler


def test_a_loop_of_slides_is_redundant_at_any_dimensions():
    found = mobility_analysis(wedge(ck.drive("wedge")))
    assert (found.gruebler, found.generic, found.at_pose, found.redundant_generic) == (0, 1, 1, 1)
    assert found.undetermined == ("bed", "slope", "column")


KINDS = {
    "overconstrained but mobile": cranks(ck.drive("crank")),
    "locked by its drivers": cranks(ck.drive("crank"), ck.drive("second")),
    "rigid": bars("prism_generic_rigid"),
    "shaky (infinitesimally movable only)": bars("prism_parallel_infinitesimal"),
    "not assembled": guides(skew=0.01),
    "mobile": ck.load("six-bar"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_verdicts(kind):
    found = mobility_analysis(KINDS[kind])
    assert found.kind == kind
    assert found.agrees == (kind in ("mobile", "rigid"))
    assert found.is_determinate == (kind in ("mobile", "overconstrained but mobile"))


def test_what_is_missing_and_what_is_too_much_is_counted():
    assert "1 driver missing" in mobility_analysis(cranks()).verdict
    assert "1 driver too many" in mobility_analysis(cranks(ck.drive("crank"), ck.drive("second"))).verdict
    assert "1 coordinate held twice" in mobility_analysis(cranks(ck.drive("crank"))).verdict


def test_a_gap_names_the_pair_and_its_size():
    gap = mobility_analysis(guides(skew=0.01)).gap
    assert gap is not None
    assert gap.pair in ("first", "second")
    assert gap.amount == pytest.approx(np.sin(0.01) / 2, rel=1e-3)  # shared by two guides


def test_a_third_crank_of_another_length_locks_the_parallelogram():
    # it is assembled nowhere near the drawing, or cannot leave the pose where it is
    assert not mobility_analysis(cranks(ck.drive("crank"), off=1e-2)).moves


def test_rounded_dimensions_are_taken_to_fit():
    found = mobility_analysis(cranks(ck.drive("crank"), off=1e-6))
    assert found.rounded
    assert found.kind == "overconstrained but mobile"
    assert not mobility_analysis(cranks(ck.drive("crank"))).rounded


def test_drawn_at_a_change_point_the_mobility_is_that_of_the_motion():
    flat = ck.Mechanism(
        "Parallelogram in line",
        ck.link("frame", A=0, D=3),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3),
        ck.link("rocker", D=0, C=1),
        ck.drive("crank"),
        ck.drawn(B=1, C=4),
    )
    found = mobility_analysis(flat)
    assert (found.gruebler, found.generic, found.at_pose, found.finite) == (1, 1, 2, 1)


def test_a_block_in_a_single_slot_is_passive():
    mechanism = ck.Mechanism(
        "Block on two pins",
        ck.link("frame", A=0, S=(2, 0)),
        ck.link("crank", A=0, B=1),
        ck.link("block", P=0, Q=1),
        ck.slot("block", on="frame", at="P", through="S", name="one"),
        ck.slot("block", on="frame", at="Q", through="S", name="two"),
        ck.drive("crank"),
    )
    (passive,) = mobility_analysis(mechanism).passive
    assert str(passive) == "block may slide along a line at 0 degrees without moving anything else"
    assert mobility_analysis(mechanism).useful == 1


def test_rollers_are_counted_once():
    cam = ck.load("disc-cam-offset-roller")
    found = mobility_analysis(cam)
    assert (found.gruebler, found.at_pose, found.passive) == (1, 1, ())


@settings(max_examples=examples(25), deadline=None)
@given(st.integers(0, 10_000), st.lists(st.sampled_from(KINDS_OF_DYAD), min_size=1, max_size=4))
def test_random_mechanisms_agree_in_all_numbers(seed, kinds):
    mechanism = random_sketch(np.random.default_rng(seed), kinds).mechanism()
    found = mobility_analysis(mechanism)
    assert found.agrees, found
    assert (found.finite, found.redundant, found.determined) == (1, 0, 1)


@settings(max_examples=examples(9), deadline=None)
@given(st.floats(0, 6.28), st.complex_numbers(max_magnitude=10), st.floats(0.1, 20), st.permutations(range(9)))
def test_moving_scaling_and_reordering_change_nothing(angle, shift, scale, order):
    plain = bars("dixon1_K33", "ae")
    turn = scale * np.exp(1j * angle)
    places = {letter: complex(turn * place + shift) for letter, place in plain.sketch.items()}
    links = [plain.links[name] for name in plain.links]
    moved = ck.Mechanism("moved", *(links[k] for k in order), ck.drive("ae"), ck.drawn(**places))
    before, after = mobility_analysis(plain), mobility_analysis(moved)
    assert (after.generic, after.at_pose, after.finite, after.redundant) == (0, 1, 1, 1)
    assert after.kind == before.kind
    assert len(after.undetermined) == len(before.undetermined)


@pytest.mark.parametrize("count", [40])
def test_a_long_chain_is_examined(count):
    rng = np.random.default_rng(3)
    mechanism = random_sketch(rng, ["RRR"] * count).mechanism()
    assert mobility_analysis(mechanism).agrees
