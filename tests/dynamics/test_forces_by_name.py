"""Forces by name: on either link, of pins, of drivers, on links, on the frame."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import compoundkin as ck
from tests.dynamics import cases
from tests.support import reference


def test_all_that_acts_on_a_link_is_in_balance() -> None:
    """Named entries of a free body add up to zero, force and moment, about any point."""
    forces = cases.six_bar("dynamic", True).forces
    for link in set(forces.mechanism.links) - {"frame"}:
        body = forces.on(link)
        assert np.max(np.abs(body.force)) < 1e-13
        for point in ("G", (0.3, -0.2)):
            assert np.max(np.abs(body.moment_about(point))) < 1e-14
    bar = forces.on("bar")
    assert [(one.kind, one.name) for one in bar] == [
        ("pair", "F"), ("pair", "slot"), ("force", "force on bar"), ("weight", "bar"), ("inertia", "bar"),
    ]  # fmt: skip
    assert bar["F"].by == "frame"
    assert bar["force on bar"].at == "G"
    assert np.allclose(bar["force on bar"].place, forces.motion.points["G"].position, rtol=0, atol=1e-15)
    assert np.allclose(bar[3].force, 0.06 * -9.81j)
    crank = forces.on("crank")
    assert [one.kind for one in crank] == ["pair", "pair", "driver", "weight", "inertia"]
    assert np.max(np.abs(crank["E"].moment)) < 1e-15
    assert np.array_equal(crank["crank"].moment, forces.drives["crank"].effort)
    assert forces.on("bar") is bar


def test_a_pair_from_both_sides() -> None:
    forces = cases.six_bar("dynamic", True).forces
    slot = forces.pairs["slot"]
    assert (slot.link, slot.by, slot.at) == ("block", "bar", "C")
    other = slot.on("bar")
    assert np.array_equal(other.force, -slot.force)
    assert np.array_equal(other.moment, -slot.moment)
    about = slot.moment_about("F")
    arm = slot.place - forces.motion.points["F"].position
    assert np.allclose(about, slot.moment + np.imag(np.conj(arm) * slot.force), rtol=0, atol=1e-15)
    assert slot.force.xy.shape == (5, 2)
    with pytest.raises(ck.errors.UnknownName, match="known: bar and block"):
        slot.on("rocker")
    with pytest.raises(ck.errors.UnknownName, match="slot"):
        forces.pairs["slop"]
    with pytest.raises(ck.errors.UnknownName, match="no such link"):
        forces.on("beam")


def test_a_pin_of_three_links() -> None:
    """Its force on each link is that of the reference, whichever two pairs stand for it."""
    case, entry = cases.toggle_press(), reference("toggle_press_static", "forces")
    forces = case.forces
    pin = forces.pins["B"]
    assert pin.links == ("AB", "CB", "BD")
    for link in pin.links:
        expected = [complex(*row["pin_B_on"][link]) for row in entry["expected"]["rows"]]
        assert np.allclose(pin.on(link).force, expected, rtol=0, atol=1e-8)
    assert np.allclose(forces.pins["O"].on("crank").moment, forces.drives["crank"].effort, rtol=0, atol=1e-9)
    with pytest.raises(ck.errors.UnknownName, match="known: AB, CB, BD"):
        pin.on("crank")


def test_a_load_on_a_pin_is_passed_on_to_its_links() -> None:
    """The pin's forces on its links add up to the load, and do not depend on which of them carries it."""
    case, load = cases.toggle_press(), 3000.0 - 2000.0j
    on_pin = ck.force_analysis(ck.solve(case.mechanism.replace(ck.force("B", load)), case.values)).pins["B"]
    assert np.allclose(sum(on_pin.on(link).force for link in on_pin.links), load)
    for link in on_pin.links:
        at = case.mechanism.replace(ck.force(link, load, at="B"))
        other = ck.force_analysis(ck.solve(at, case.values)).pins["B"]
        for one in on_pin.links:
            carried = load if one == link else 0.0
            assert np.allclose(other.on(one).force + carried, on_pin.on(one).force, rtol=0, atol=1e-8)


def test_shaking_force_is_that_of_the_masses() -> None:
    """Sum of weights and loads less that of masses times accelerations; about any point."""
    case = cases.six_bar("dynamic", True)
    forces = case.forces
    total = sum(
        one.force for link in forces.mechanism.links if link != "frame"
        for one in forces.on(link) if one.kind not in ("pair", "driver")
    )  # fmt: skip
    assert np.allclose(forces.shaking.force, total, rtol=0, atol=1e-13)
    expected = [row["on_frame"]["moment_about_origin"] for row in case.rows]
    assert np.allclose(forces.shaking.moment_about((0, 0)), expected, rtol=0, atol=1e-12)
    assert [one.name for one in forces.shaking.reactions] == ["crank"]
    assert forces.shaking.external == ()
    pushed = ck.force_analysis(ck.solve(case.mechanism.replace(ck.force("frame", (5, 0), at="B")), case.values))
    assert [one.name for one in pushed.shaking.external] == ["force on frame"]
    assert np.allclose(pushed.on("frame").force - pushed.shaking.force, 5.0)


def test_an_effort_along_a_pair_is_a_load_and_no_driver() -> None:
    forces = ck.force_analysis(ck.solve(ck.load("engine-gas-pressure"), {"crank": [1.0]}))
    assert [one.kind for one in forces.on("piston")] == ["pair", "pair", "effort", "inertia"]
    assert [one.name for one in forces.shaking.reactions] == ["crank"]
    drawn = ck.draw(forces, kind="free-bodies", link="piston").svg
    assert "gas " in drawn
    assert "loads and weights" in drawn


def test_power_and_units() -> None:
    forces = cases.six_bar("dynamic", True).forces
    crank = forces.drives["crank"]
    assert (crank.unit, forces.units.power) == ("N m", "W")
    assert np.allclose(crank.power, 10.0 * crank.effort)
    inches = ck.Mechanism("m", ck.link("frame", A=0), units={"length": "in", "mass": "blob", "force": "lbf"}).units
    assert inches is not None
    assert (inches.moment, inches.power) == ("lbf in", "lbf in/s")


def test_unassembled_poses_are_no_numbers() -> None:
    case = cases.engine()
    short = ck.Mechanism(
        "short", ck.link("frame", O=0), ck.link("crank", O=0, A=2), ck.link("rod", A=0, B=1), ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O"), ck.drive("crank"), ck.force("piston", (1, 0), at="B"),
        units=cases.SI,
    )  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(short, {"crank": ck.deg([0, 10, 90])})
    forces = ck.force_analysis(motion)
    for shown in (
        forces.pairs["B"].force,
        forces.pairs["B"].moment,
        forces.drives["crank"].effort,
        forces.on("rod").force,
    ):
        assert np.isnan(shown).tolist() == [False, False, True]
    assert case.motion.assembled.all()


def test_designs_copies_and_pickles() -> None:
    case = cases.six_bar("dynamic", True)
    several = case.mechanism.replace(ck.link("crank", E=(0, 0), D=(np.array([[0.014], [0.012]]), 0)))
    forces = ck.force_analysis(ck.solve(several, case.values, **case.rates))
    assert forces.pairs["F"].force.shape == (2, 5) == forces.on("bar")[3].moment.shape
    assert np.allclose(forces.pairs["F"].force[0], case.forces.pairs["F"].force, rtol=0, atol=1e-13)
    for other in (pickle.loads(pickle.dumps(forces)), copy.deepcopy(forces), copy.copy(forces)):
        assert np.array_equal(other.on("bar").force, forces.on("bar").force)
        assert np.array_equal(other.drives["crank"].power, forces.drives["crank"].power)
