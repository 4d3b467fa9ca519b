"""Overconstrained mechanisms that move are solved, and their redundant pairs hold; others are refused with reasons."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.structure import decompose
from compoundkin.structure.decomposition import decomposed
from tests.structure.redundancy.special import bars, cranks, guides, wedge, with_parallel_crank
from tests.support import examples

MOBILE = {
    "three cranks": cranks(ck.drive("crank")),
    "dixon": bars("dixon1_K33", "ae"),
    "roberts": bars("roberts_triple_cognate", "ad"),
    "wedge": wedge(ck.drive("wedge", values=np.linspace(0.0, 3.0, 31))),
    "two guides": guides(),
}


@pytest.mark.parametrize("name", MOBILE)
def test_is_solved_and_verified(name):
    motion = ck.solve(MOBILE[name])
    check = ck.verify(motion)
    assert motion.assembled.all()
    assert check.passed, [finding for finding in check.findings if not finding.passed]
    (line,) = [finding for finding in check.findings if finding.name == "redundant pairs, closure"]
    assert line.value < 1e-11


@pytest.mark.parametrize("name", MOBILE)
def test_as_much_is_left_out_as_is_redundant(name):
    mechanism = MOBILE[name]
    structure = decompose(mechanism)
    assert structure.faults == ()
    in_general = decomposed(mechanism)
    assert in_general.faults != ()
    found = ck.mobility_analysis(mechanism)
    kept = [part.kept.held if part.kept else 0 for part in structure.relaxation.dropped]
    assert 2 * len(kept) - sum(kept) == found.redundant
    # the user's own pairs are all there, and nothing else
    assert sorted(p.code for p in structure.pairs) == sorted(p.code for p in in_general.pairs)


@pytest.mark.parametrize("name", MOBILE)
def test_decomposing_gives_the_groups_that_solving_uses(name):
    mechanism = MOBILE[name]
    structure, used = decompose(mechanism), ck.solve(mechanism).structure
    assert [group.links for group in structure.groups] == [group.links for group in used.groups]
    assert [group.name for group in structure.groups] == [group.name for group in used.groups]
    assert [pair.name for pair in structure.redundant] == [pair.name for pair in used.redundant] != []
    assert ck.draw(mechanism, kind="groups").title == f"{mechanism.title}, taken apart"
    assert ck.draw(structure, kind="groups").description == ck.draw(mechanism, kind="groups").description


def test_without_dimensions_it_is_said_that_they_would_tell():
    letters = [ck.link(name, *item.points) for name, item in cranks().links.items()]
    (fault,) = decompose(ck.Mechanism("Three cranks", *letters, ck.drive("crank"))).faults
    assert (fault.kind, fault.amount) == ("over", 1)
    assert fault.remedy.endswith("or give dimensions at which it moves")


def test_what_is_not_overconstrained_is_not_looked_at_twice(monkeypatch):
    """The dimensions are asked for only where the count finds too much."""
    monkeypatch.setattr("compoundkin.structure.redundancy.diagnosis.diagnose", lambda *_: pytest.fail("diagnosed"))
    for name in ("six-bar", "four-bar-norton", "slider-crank"):
        assert decompose(ck.load(name)).relaxation is None


def test_the_third_crank_turns_as_the_first():
    motion = ck.solve(cranks(ck.drive("crank", speed=2.0)), order=3)
    for name in ("second", "third"):
        gap = motion.links[name].angle - motion.links["crank"].angle
        np.testing.assert_allclose(np.angle(np.exp(1j * gap)), 0.0, atol=1e-9)
        np.testing.assert_allclose(motion.links[name].angular_velocity, 2.0, rtol=1e-9)
        np.testing.assert_allclose(motion.links[name].angular_acceleration, 0.0, atol=1e-9)
    np.testing.assert_allclose(motion.links["coupler"].angular_velocity, 0.0, atol=1e-9)


def test_the_points_of_dixons_mechanism_stay_on_two_lines_at_right_angles():
    motion = ck.solve(bars("dixon1_K33", "ae"))
    a, b, c, d, e, f = (motion.points[letter].position for letter in "ABCDEF")
    for one, two, three in ((a, b, c), (d, e, f)):
        np.testing.assert_allclose(((two - one) * np.conj(three - one)).imag, 0.0, atol=1e-11)
    np.testing.assert_allclose(((b - a) * np.conj(e - d)).real, 0.0, atol=1e-11)
    np.testing.assert_allclose(np.abs(c - f), np.sqrt(18.0), rtol=1e-12)  # from (0, 3) to (-3, 0)


def test_roberts_cognates_turn_in_pairs():
    motion = ck.solve(bars("roberts_triple_cognate", "ad"), speed=1.0)
    # a parallelogram A0 A M A1 and another B0 B M B1 in every pose
    a0, b0, a, b, m, a1, b1 = (motion.points[letter].position for letter in "ABDEFGI")
    np.testing.assert_allclose(a1 - a0, m - a, atol=1e-9)
    np.testing.assert_allclose(b1 - b0, m - b, atol=1e-9)


def test_the_wedge_lifts_by_its_slope():
    motion = ck.solve(wedge(ck.drive("wedge")), {"wedge": [0.0, 1.0, 2.0]}, speed=3.0)
    # the sides of the triangle of displacements: the law of sines
    rise = np.sin(np.deg2rad(40)) / np.sin(np.deg2rad(60))
    np.testing.assert_allclose(np.abs(motion.points["R"].position - 5.0), rise * np.arange(3), atol=1e-12)
    np.testing.assert_allclose(motion.points["R"].speed, 3.0 * rise, rtol=1e-12)


def test_a_table_on_two_guides_moves_as_on_one():
    full = guides()
    kept = [item for item in full.items if getattr(item, "name", "") != "second"]
    one, two = ck.solve(ck.Mechanism("one", *kept)), ck.solve(full)
    np.testing.assert_allclose(two.points["T"].acceleration, one.points["T"].acceleration, atol=1e-12)


def test_without_a_drawing_an_assembled_pose_is_found():
    drawn = cranks(ck.drive("crank"))
    plain = ck.Mechanism("plain", *(item for item in drawn.items if not isinstance(item, type(ck.drawn(A=0)))))
    motion = ck.solve(plain, {"crank": np.linspace(0.4, 2.4, 9)})
    np.testing.assert_allclose(motion.links["third"].angle, np.linspace(0.4, 2.4, 9), atol=1e-9)
    assert ck.verify(motion).passed


BASE = ck.Mechanism(
    "Parallelogram",
    ck.link("frame", A=0, D=3),
    ck.link("crank", A=0, B=1.5),
    ck.link("coupler", B=0, C=3),
    ck.link("rocker", D=0, C=1.5),
    ck.drive("crank"),
    ck.drawn(B=1.5j, C=3 + 1.5j),
)


@settings(max_examples=examples(20), deadline=None)
@given(st.floats(-5, 5), st.floats(-5, 5))
def test_a_further_parallel_crank_changes_nothing(x, y):
    place = complex(x, y)
    assume(abs(place) > 0.2 and abs(place - 3) > 0.2 and abs(place.imag) > 0.05)
    plain, more = ck.solve(BASE, order=2), ck.solve(with_parallel_crank(BASE, "coupler", "crank", place), order=2)
    for link in ("coupler", "rocker"):
        for k in range(3):
            gap = more.links[link].origin.derivative(k) - plain.links[link].origin.derivative(k)
            assert np.max(np.abs(gap)) < 1e-7
    np.testing.assert_allclose(more.links["further"].angular_velocity, 1.0, rtol=1e-6)


def test_a_mode_in_which_the_redundant_crank_does_not_close_is_refused_by_name():
    leaving = {"B": 1 + 2j, "C": 3 - 2.2j}
    with pytest.raises(ck.errors.NotAssembled, match=r"E: the pair opens by \d"):
        # from the pose of the hint: where the cranks lie along the frame both modes are one
        ck.solve(cranks(ck.drive("crank")), {"crank": np.linspace(np.arctan2(2.0, 1.0), 2.0, 9)}, hint=leaving)


REFUSED = {
    "rigid": bars("prism_generic_rigid", "ad"),
    "shaky": bars("prism_parallel_infinitesimal", "ad"),
    "locked by its drivers": cranks(ck.drive("crank"), ck.drive("second")),
    "1 driver missing": cranks(),
    "is open by": guides(skew=0.01),
}


@pytest.mark.parametrize("reason", REFUSED)
def test_others_are_refused_with_the_reason(reason):
    with pytest.raises(ck.errors.NotDetermined, match=reason):
        ck.solve(REFUSED[reason])


def test_faults_that_remain_count_what_is_really_wrong():
    (fault,) = decompose(cranks(ck.drive("crank"), ck.drive("second"))).faults
    assert (fault.kind, fault.amount) == ("over", 1)
    assert fault.remedy.startswith("remove one of the drivers crank, second")
    (fault,) = decompose(wedge()).faults
    assert (fault.kind, fault.amount) == ("under", 1)
    (fault,) = decompose(wedge(ck.drive("wedge"), ck.drive("ram", pair="column"))).faults
    assert (fault.kind, fault.amount) == ("over", 1)


def test_faults_of_a_loop_of_slides_do_not_contradict_each_other():
    over, under = decomposed(wedge()).faults
    assert over.remedy == "nothing has to be changed: they move all the same"
    assert under.remedy.startswith("add a driver")


def test_sound_mechanisms_are_left_as_they_are():
    structure = decompose(ck.load("six-bar"))
    assert structure.relaxation is None
    assert structure.redundant == ()


def test_the_report_tells_the_numbers_and_what_is_left_out():
    from compoundkin.view.report import report

    text = " ".join(report(ck.solve(cranks(ck.drive("crank")))).text().split())
    assert "mobility 1 (0 by the count)" in text
    assert "verconstrained but mobile with 1 freedom, determined by its driver" in text
    assert "Left out is E along FE of third" in text
    assert "are not determined by equilibrium alone" in text


def planets(count: int) -> ck.Mechanism:
    """A planetary train with so many planets between a sun of 40 and a fixed annulus of 80 teeth."""
    arm, gears = {"O": 0j}, []
    for k in range(count):
        arm[f"P{k}"] = 30 * np.exp(2j * np.pi * k / count)
        on = {"carrier": "arm", "module": 1}
        gears += [
            ck.link(f"planet{k}", **{f"P{k}": 0}),
            ck.gear(f"planet{k}", "sun", teeth=(20, 40), name=f"s{k}", **on),
            ck.gear(f"planet{k}", "frame", teeth=(20, 80), internal=True, name=f"r{k}", **on),
        ]
    wheels = ck.link("frame", O=0), ck.link("arm", **arm), ck.link("sun", O=0)
    return ck.Mechanism("Planets", *wheels, *gears, ck.drive("arm"))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_further_planets_change_nothing(count):
    motion = ck.solve(planets(count), speed=2.0)
    # Willis: the sun makes 1 + 80 / 40 turns for one of the arm
    np.testing.assert_allclose(motion.links["sun"].angular_velocity, 6.0, rtol=1e-12)
    assert ck.mobility_analysis(planets(count)).redundant == count - 1
    assert ck.verify(motion).passed


@pytest.mark.parametrize("off", [0.0, 1e3 - 2e3j])
def test_a_third_crank_far_from_the_origin_is_redundant_too(off):
    cranks = [ck.link(f"crank-{k}", **{f"A{k}": 0, f"B{k}": 1j}) for k in range(3)]
    mechanism = ck.Mechanism(
        "three cranks", ck.link("frame", **{f"A{k}": 2.0 * k + off for k in range(3)}),
        ck.link("bar", **{f"B{k}": 2.0 * k for k in range(3)}), *cranks,
        ck.drive("crank-0", values=np.linspace(0.3, 1.2, 7)),
    )  # fmt: skip
    motion = ck.solve(mechanism)
    assert motion.assembled.all()
    expected = off + 2.0 + 1j * np.exp(1j * np.linspace(0.3, 1.2, 7))
    np.testing.assert_allclose(motion.points["B1"].position, expected, rtol=0.0, atol=1e-11 * (1.0 + abs(off)))
