"""Where special dimensions leave a curve of configurations that is said; and branches have a width."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.configurations.general_segments import _add
from compoundkin.view.report.configurations_section import configurations_report
from tests.configurations.mechanisms import four_bar

COGNATES = ck.load("roberts-cognates")
SEVEN = ("frame", "crank", "coupler", "rocker", "crank-2", "coupler-2", "rocker-2")


def seven_bar(drawn: bool, stretched: float = 1.0) -> ck.Mechanism:
    """Two of Roberts' cognates pinned at their common coupler point: rigid by the count, but they move."""
    letters = {name: COGNATES.links[name].letters for name in SEVEN}
    carried = {letter for link in letters.values() for letter in link}
    if drawn:
        places = {letter: place for letter, place in COGNATES.sketch.items() if letter in carried}
        return ck.Mechanism("Seven-bar", *(ck.link(n, *own) for n, own in letters.items()), ck.drawn(**places))
    points = {name: {k: COGNATES.geometry.points[name][k] for k in own} for name, own in letters.items()}
    points["rocker"] = {k: p * stretched for k, p in points["rocker"].items()}
    return ck.Mechanism("Seven-bar", *(ck.link(name, **own) for name, own in points.items()))


@pytest.mark.parametrize("drawn", [True, False])
def test_the_moving_seven_bar_of_roberts_has_a_curve(drawn: bool) -> None:
    mechanism = seven_bar(drawn)
    assert ck.decompose(mechanism).mobility.freedoms == 0
    found = ck.configurations(mechanism)
    assert found.curve is not None
    assert found.curve.links == SEVEN[1:]
    assert not found.certified
    # what is on the curve is assembled: both halves of every pin are at one place
    one = found.curve.through
    for letter, links in mechanism.pins.items():
        places = [one.poses[link].at(mechanism.geometry.points[link][letter]).c[0] for link in links]
        assert np.ptp(np.real(places)) + np.ptp(np.imag(places)) < 1e-8 * mechanism.geometry.size, letter
    text = " ".join(configurations_report(found).text().split())
    assert "there is a curve of configurations too: crank, coupler, rocker, crank-2, coupler-2 and rocker-2" in text


def test_nearly_the_same_seven_bar_has_none() -> None:
    try:
        found = ck.configurations(seven_bar(drawn=False, stretched=1.01))
    except ck.errors.NotAssembled:
        return
    assert found.curve is None


def test_ordinary_configurations_are_not_searched_for_curves(monkeypatch: pytest.MonkeyPatch) -> None:
    module = sys.modules["compoundkin.configurations.enumeration"]
    monkeypatch.setattr(module, "resting_curve", lambda *_: pytest.fail("searched"))
    assert ck.configurations(four_bar(1, 3, 3, 4), {"crank": 1.0}).curve is None
    assert ck.configurations(ck.load("stephenson-iii"), {}).curve is None


@pytest.mark.parametrize("size", [1e-3, 1.0, 7.0])
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
def test_the_unit_rhombus_has_no_branches_of_no_width(size: float, turn: float) -> None:
    """Two circuits of full turns; that the rocker may turn freely where B lies on D is no branch of the crank."""
    frame = ck.link("frame", A=0, D=size * np.exp(1j * turn))
    moving = [ck.link(name, **{letter: k * size for k, letter in enumerate(ends)}) for name, ends in RHOMBUS.items()]
    found = ck.circuits(ck.Mechanism("Rhombus", frame, *moving, ck.drive("crank")))
    assert [circuit.winding for circuit in found.circuits] == [1, 1]
    assert [round(branch.high - branch.low, 9) for branch in found.branches] == [round(2.0 * np.pi, 9)] * 2
    assert found.consistent


RHOMBUS = {"crank": "AB", "coupler": "BC", "rocker": "DC"}


def test_groups_that_no_search_can_cover_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["compoundkin.configurations.enumeration"], "MOST_BODIES", 3)
    with pytest.raises(ck.errors.InvalidInput, match="6 bodies in a group are too many"):
        ck.configurations(seven_bar(drawn=True))


def test_a_configuration_whose_arcs_are_both_lost_is_no_segment() -> None:
    """It stopped `circuits` with an error about the shapes of arrays."""
    pieces: list = []
    _add(pieces, 0, np.array([[0.0, 0.0, 1.0, 0.5]]), [], False)
    assert pieces == []
    _add(pieces, 0, np.array([[0.0, 0.0, 1.0, 0.5], [0.0, 0.0, 1.1, 0.6]]), [], False)
    assert len(pieces) == 1


DWELLING = ("oscillating-roller-follower", "oscillating-flat-follower", "disc-cam-roller-program")


@pytest.mark.parametrize("name", DWELLING)
def test_a_dwell_has_no_toggle_positions(name: str) -> None:
    """Their followers rise, dwell, fall and dwell: rounding of the rate in a dwell is no turning back."""
    assert ck.circuits(ck.load(name)).toggles == ()
