"""Cognates draw equal curves: each is solved by itself, and what theory says of their angles and lengths holds."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import compoundkin as ck

CRANK_ROCKER = (2.0, 5.0, 4.0, 5.0, 2 + 1.5j)
DOUBLE_CRANK = (4.0, 5.0, 4.5, 2.0, 1.5 + 2j)
TRIPLE_ROCKER = (4.0, 5.0, 3.0, 7.0, 2 + 1j)


def four_bar(crank, coupler, rocker, frame, point, **values):
    return ck.Mechanism(
        "Four-bar", ck.link("frame", A=0, D=frame), ck.link("crank", A=0, B=crank), ck.link("rocker", D=0, C=rocker),
        ck.link("coupler", B=0, C=coupler, P=point), ck.drive("crank", **values),
    )  # fmt: skip


@pytest.mark.parametrize("lengths", [CRANK_ROCKER, DOUBLE_CRANK], ids=["crank-rocker", "double-crank"])
def test_three_linkages_draw_one_curve(lengths):
    crank, coupler, rocker, frame, point = lengths
    found = ck.cognates(four_bar(*lengths), "P")
    assert len(found) == 3
    assert found.deviation < 1e-12
    first = found[0]
    for one in found:
        assert len(one.z) == len(first.z) == 73
        assert ck.verify(one.motion).passed
        assert np.max(np.abs(one.z - first.z)) < 1e-12
    # Cayley's triangle of fixed pivots is similar to the coupler
    a, b, c = found.triangle
    assert np.isclose((c - a) / (b - a), point / coupler)
    # S. Roberts: the lengths of the second are those of the first times |P - A| / |B - A|, in other places
    ratio = abs(point) / coupler
    second = found[1]
    lengths = [dyad.length for dyad in second.dyads]
    assert np.allclose(lengths, [abs(point), ratio * rocker])
    assert np.isclose(abs(second.dyads[0].moving - second.dyads[1].moving), ratio * crank)
    assert np.isclose(abs(second.pivots[0] - second.pivots[1]), ratio * frame)
    # its crank turns like the coupler of the first, and its coupler like the crank of the first
    inputs = [np.exp(1j * one.motion.links["input"].angle) for one in (second,)]
    couplers = np.exp(1j * first.motion.links["coupler"].angle)
    cranks = np.exp(1j * first.motion.links["crank"].angle)
    turned = np.exp(1j * second.motion.links["coupler"].angle)
    for one, other in ((inputs[0], couplers), (turned, cranks)):
        assert np.ptp(np.angle(one / other * np.conj(one[0] / other[0]))) < 1e-12


def test_a_rocker_over_its_range():
    found = ck.cognates(four_bar(*TRIPLE_ROCKER, values=np.linspace(-1.2, 1.2, 41)), "P")
    assert found.deviation < 1e-12
    assert len(found) == 3


def test_a_slider_crank_has_one_cognate_whose_guide_is_turned():
    links = ck.link("frame", O=0, S=(0, 0.5)), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3, P=(1, 1))
    guide = ck.slide("slider", on="frame", at="B", through="S", angle=0.3)
    mechanism = ck.Mechanism("Slider-crank", *links, ck.link("slider", B=0), guide, ck.drive("crank"))
    found = ck.cognates(mechanism, "P")
    assert len(found) == 2
    assert found.deviation < 1e-12
    angles = [np.angle(one.dyads[1].direction) for one in found]
    assert np.isclose(np.sin(angles[1] - angles[0] - np.angle(1 + 1j)), 0)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_plate_moves_along_the_curve_without_turning(number):
    found = ck.cognates(four_bar(*CRANK_ROCKER), "P")
    six_bar = found.parallel_motion(number)
    assert len(six_bar.links) == 6
    motion = ck.solve(six_bar)
    assert motion.assembled.all()
    assert np.ptp(motion.links["plate"].angle) < 1e-9
    moved = motion.points["Q"].position - motion.points["P"].position
    assert np.max(np.abs(moved - moved[0])) < 1e-9
    assert min(np.min(np.abs(found[0].z - p)) for p in motion.points["P"].position[:5]) < 1e-9


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_geared_five_bar_draws_the_curve(number):
    found = ck.cognates(four_bar(*CRANK_ROCKER), "P")
    five_bar = found.geared_five_bar(number)
    motion = ck.solve(five_bar)
    assert motion.assembled.all()
    assert np.max(np.abs(motion.points["P"].position - found[number].z)) < 1e-9
    turned = motion.links["input"].angle - motion.links["output"].angle
    assert max(abs(b - a) for a, b in pairwise(turned)) < 1e-9


def test_what_has_no_cognates():
    with pytest.raises(ck.errors.UnknownName):
        ck.cognates(four_bar(*CRANK_ROCKER), "Q")
    with pytest.raises(ck.errors.InvalidInput, match="no coupler point"):
        ck.cognates(four_bar(*CRANK_ROCKER), "A")
    with pytest.raises(ck.errors.InvalidInput, match="no coupler point"):
        ck.cognates(ck.load("six-bar"), "G")
    with pytest.raises(ck.errors.InvalidInput, match="there is no cognate 3"):
        ck.cognates(four_bar(*CRANK_ROCKER), "P").geared_five_bar(3)
    with pytest.warns(ck.errors.UnassembledPoses), pytest.raises(ck.errors.NotAssembled, match="no assembled pose"):
        ck.cognates(four_bar(1.0, 2.0, 2.0, 12.0, 1j), "P")
