"""Four-bars and slider-cranks against the closed criteria of textbooks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import compoundkin as ck
from tests.configurations.mechanisms import four_bar, slider_crank
from tests.support import examples

LENGTHS = st.tuples(*[st.floats(1.0, 9.0)] * 4)
# Nearer to a change point than this a linkage is left out: it would be one to rounding.
CLEAR = 0.05


@settings(max_examples=examples(60), deadline=None)
@given(LENGTHS)
def test_grashof(lengths: tuple[float, float, float, float]) -> None:
    """Two circuits if and only if the shortest and longest are shorter than the others together; the crank turns fully
    if besides it or the frame is the shortest (F. Grashof; see R. L. Norton, Design of Machinery, section 2.12)."""
    a, b, c, d = lengths
    short, p, q, long = sorted(lengths)
    assume(
        abs(short + long - p - q) > CLEAR and q - short > CLEAR and long < short + p + q - CLEAR and p - short > CLEAR
    )
    found = ck.circuits(four_bar(*lengths))
    grashof = short + long < p + q
    turns = grashof and short in (a, d)
    assert found.consistent
    assert len(found.circuits) == (2 if grashof else 1)
    assert all(circuit.turns_fully == turns for circuit in found.circuits)
    limits = sorted(limit.value for limit in found.limits)
    # the cosine rule at the two folded and stretched positions of coupler and rocker
    cosines = [(a * a + d * d - (b + s * c) ** 2) / (2 * a * d) for s in (1, -1)]
    expected = sorted(sense * np.arccos(x) for x in cosines if abs(x) < 1 for sense in (1, -1))
    assert limits == pytest.approx(expected, abs=1e-9)


@settings(max_examples=examples(40), deadline=None)
@given(st.floats(0.5, 3.0), st.floats(0.5, 6.0), st.floats(-2.0, 2.0))
def test_slider_cranks(r: float, rod: float, offset: float) -> None:
    """The crank turns fully if and only if the rod is longer than crank and offset together."""
    e = abs(offset)
    assume(abs(rod - r - e) > CLEAR and abs(abs(r - e) - rod) > CLEAR and rod > e - r + CLEAR and e > CLEAR)
    found = ck.circuits(slider_crank(r, rod, offset))
    sines = [(offset + s * rod) / r for s in (1, -1)]
    expected = sorted(float(np.arcsin(x)) for x in sines if abs(x) < 1 for _ in (0,))
    expected = sorted([*expected, *(np.angle(np.exp(1j * (np.pi - x))) for x in expected)])
    assert all(circuit.turns_fully == (rod > r + e) for circuit in found.circuits)
    assert sorted(limit.value for limit in found.limits) == pytest.approx(expected, abs=1e-9)


def test_a_piston_that_drives_has_its_two_dead_points() -> None:
    found = ck.circuits(slider_crank(1.0, 3.0, 0.5, driver="piston"))
    expected = sorted(s * np.sqrt((3.0 + t) ** 2 - 0.25) for s in (1, -1) for t in (1, -1))
    assert sorted(limit.value for limit in found.limits) == pytest.approx(expected, abs=1e-9)
    assert [len(circuit.branches) for circuit in found.circuits] == [2, 2]
    assert all(limit.links == ("crank", "rod") for limit in found.limits)


def test_toggle_positions_of_a_crank_rocker() -> None:
    """The rocker stands still where crank and coupler are in line: Norton, section 3.3."""
    a, b, c, d = 2.0, 5.0, 4.0, 5.5
    found = ck.circuits(four_bar(a, b, c, d))
    angles = [np.arccos(((b + s * a) ** 2 + d * d - c * c) / (2 * (b + s * a) * d)) for s in (1, -1)]
    expected = sorted([angles[0], angles[1] - np.pi, -angles[0], np.pi - angles[1]])
    assert sorted(t.value for t in found.toggles) == pytest.approx(expected, abs=1e-9)
    assert {t.link for t in found.toggles} == {"rocker"}


def test_a_triple_rocker_goes_from_one_branch_to_the_other_through_its_limit() -> None:
    found = ck.circuits(four_bar(4.0, 5.0, 3.0, 7.0))
    way = found.path(1, 2)
    assert way.branches == (1, 2)
    # the crank goes to the limit and back; every pose closes
    assert np.abs(way.values).max() == pytest.approx(np.arccos((16 + 49 - 64) / 56), abs=1e-9)
    bar = np.abs(way.point("C") - way.point("B"))
    rocker = np.abs(way.point("C") - 7.0)
    assert bar == pytest.approx(np.full(len(bar), 5.0), abs=1e-9)
    assert rocker == pytest.approx(np.full(len(bar), 3.0), abs=1e-9)
    assert np.max(np.diff(way.along)) < 0.2
    ends = [found.branches[k].configuration.points["C"] for k in (0, 1)]
    assert [way.point("C")[0], way.point("C")[-1]] == pytest.approx(ends, abs=1e-9)


@pytest.mark.parametrize(("a", "b"), [(2.0, 5.0), (3.0, 4.0)])
def test_change_points_of_parallelogram_and_antiparallelogram(a: float, b: float) -> None:
    """Two circuits of full turns cross where all links are in line; neither turns back there."""
    found = ck.circuits(four_bar(a, b, a, b))
    assert [circuit.winding for circuit in found.circuits] == [1, 1]
    assert not found.limits
    assert found.consistent
    for circuit in found.circuits:
        values = sorted(abs(change.value) for change in circuit.changes)
        assert values == pytest.approx([0.0, np.pi], abs=1e-9)
        assert all(change.links == ("coupler", "rocker") for change in circuit.changes)
    # straight through: on one circuit the coupler never turns, on the other it does
    values = np.linspace(0.3, 2 * np.pi - 0.3, 24)
    every = [one for value in values for one in ck.configurations(found.structure, {"crank": value})]
    on = {n: [one.angles["coupler"] for one in every if found.at(one).circuit == n] for n in (1, 2)}
    assert [len(angles) for angles in on.values()] == [24, 24]
    ranges = sorted(float(np.ptp(angles)) for angles in on.values())
    assert ranges[0] < 1e-9
    assert ranges[1] > 0.1


def test_an_elliptic_trammel_driven_by_its_slider() -> None:
    """A bar of length 2 between two slides at right angles: the driven slider goes from -2 to 2 and back."""
    trammel = ck.Mechanism(
        "Trammel",
        ck.link("frame", O=(0, 0)),
        ck.link("bar", A=(0, 0), B=(2, 0)),
        ck.link("x-block", A=(0, 0)),
        ck.link("y-block", B=(0, 0)),
        ck.slide("x-block", on="frame", at="A", through="O", angle=0.0),
        ck.slide("y-block", on="frame", at="B", through="O", angle=np.pi / 2),
        ck.drive("x-block"),
    )
    found = ck.circuits(trammel)
    assert [len(circuit.branches) for circuit in found.circuits] == [2]
    assert sorted(limit.value for limit in found.limits) == pytest.approx([-2.0, 2.0], abs=1e-12)
