"""Forces against independent computation: `tests/reference/forces.json`, random mechanisms, verification, tables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.extremes import zeros
from compoundkin.results import Forces
from tests.dynamics import cases
from tests.dynamics.cases import CASES, arm, misfits, planetary_train, six_bar, toggle_press
from tests.dynamics.random_loads import SEED, check_of, loaded_motion
from tests.stress.trial import drawn_case
from tests.support import reference


@pytest.mark.parametrize("name", CASES)
def test_driver_pairs_and_frame(name: str) -> None:
    """Driver effort, force and moment of every pair, force and moment on the frame, to 1e-9."""
    assert misfits(CASES[name]()) == []


def test_pin_of_three_links() -> None:
    """The force of the pin on each of its links."""
    case = toggle_press()
    pin = case.forces.pins["B"]
    for pose, row in enumerate(case.rows):
        for link, force in row["pin_B_on"].items():
            assert abs(pin.on(link).force[pose] - complex(*force)) < 1e-9 * abs(complex(*force))


def test_spring_that_balances_an_arm() -> None:
    """A spring without free length takes all the torque in every position."""
    stiffness = reference("spring_balanced_arm", "forces")["dimensions"]["balance_stiffness"]
    case = arm(ck.spring("arm", "A", at="S", stiffness=stiffness))
    assert np.max(np.abs(case.forces.drives["arm"].effort)) < 1e-13 * stiffness
    assert ck.verify(case.forces).passed
    # so that its energy and that of the weight have one sum
    assert np.ptp(case.forces.power.potential) < 1e-13 * stiffness


def test_spring_and_damper() -> None:
    own = reference("spring_balanced_arm", "forces")["dimensions"]
    spring = ck.spring("arm", "A", at="S", stiffness=own["stiffness"], free_length=own["free_length"])
    damper = ck.damper("arm", "A", at="S", rate=own["damping"])
    case = arm(spring, damper, speed=own["speed"], acceleration=own["acceleration"])
    for pose, row in enumerate(case.rows):
        expected = row["spring_and_damper"]
        assert abs(case.forces.drives["arm"].effort[pose] / expected["driver"] - 1.0) < 1e-12
        force = complex(*expected["pin"]["force"])
        assert abs(case.forces.pairs["O"].on("arm").force[pose] - force) < 1e-12 * abs(force)
        # what each takes is its pull times the rate of its length
        rate, power = expected["spring_length_rate"], case.forces.power.loads
        assert abs(power["spring on arm"][pose] + expected["spring_tension"] * rate) < 1e-9
        assert abs(power["damper on arm"][pose] + expected["damper_tension"] * rate) < 1e-9


@pytest.mark.parametrize("number", range(4))
def test_planetary_train(number: int) -> None:
    """Tooth forces at the pitch points, the planet's pin, the driver; the flank changes with the load."""
    row = reference("planetary_train_torques", "forces")["expected"]["rows"][number]
    forces = planetary_train(row).forces
    assert abs(forces.drives["arm"].effort[0] - row["driver_torque_on_arm"]) < 1e-12 * abs(row["driver_torque_on_arm"])
    for name, key in (("sun gear", "sun"), ("ring", "ring")):
        force = complex(*row[f"tooth_force_on_planet_from_{key}"]["force"])
        assert abs(forces.pairs[name].on("planet").force[0] - force) < 1e-12 * abs(force)
    pin = complex(*row["planet_pin"]["force"])
    assert abs(forces.pairs["P"].on("planet").force[0] - pin) < 1e-12 * abs(pin)
    assert ck.verify(forces).passed


# `python -m tests.dynamics.random_loads 1000 small` tries many more.
COUNT, PARTS = 24, 3


@pytest.mark.parametrize("part", [0, *(pytest.param(part, marks=pytest.mark.full) for part in range(1, PARTS))])
def test_forces_of_random_mechanisms_balance(part: int) -> None:
    """By every finding of `verify`; a case is left out where no pose is assembled or a rack does not fit."""
    checks = {number: check_of(drawn_case(SEED, number, small=True)) for number in range(part, COUNT, PARTS)}
    there = {number: check for number, check in checks.items() if check is not None and check.poses}
    assert {number: check.failed for number, check in there.items() if check.failed} == {}
    assert len(there) > COUNT / PARTS / 2


@pytest.mark.filterwarnings("ignore")
def test_home_a_hair_beyond_the_last_sample() -> None:
    """The way from the drawn pose to the first one ended 4e-15 beyond its samples: an IndexError."""
    case = drawn_case(SEED, 762, small=True)
    assert loaded_motion(case).shape == (case.way.poses,)


LINKS, PINS, FRAME = "balance of links", "balance of pins", "balance of the frame"
CARRIED, WORK, POWER, LEAK = "what pairs can carry", "efforts by virtual work", "balance of power", "work of pairs"


@pytest.mark.parametrize("name", CASES)
def test_right_forces_pass(name: str) -> None:
    check = ck.verify(CASES[name]().forces)
    assert check.passed
    assert {finding.name for finding in check.findings} == {LINKS, PINS, FRAME, CARRIED, WORK, POWER, LEAK}
    assert all(finding.value < 1e-13 for finding in check.findings)


def changed(forces: Forces, pair: str, change: Callable[[Wrench], Wrench]) -> Forces:
    """Return forces with another wrench in one pair."""
    return replace(forces, wrenches={**forces.wrenches, pair: change(forces.wrenches[pair])})


def without_mass(forces: Forces, link: str) -> Forces:
    """Return the forces of a mechanism in which one mass is forgotten, as if they were those of the whole one."""
    mechanism = forces.mechanism
    items = [item for item in mechanism.items if item is not mechanism.masses[link]]
    other = ck.Mechanism(mechanism.title, *items, units=mechanism.units)
    found = ck.force_analysis(ck.solve(other, forces.motion.drives["crank"].value, speed=10, acceleration=20))
    return replace(found, motion=forces.motion)


def at_another_place(wrench: Wrench) -> Wrench:
    return Wrench(wrench.force, wrench.moment + 1e-3 * np.abs(wrench.force) * 0.05)


WRONG: dict[str, tuple[Callable[[Forces], Forces], set[str]]] = {
    "a pin off by 0.1 %": (lambda f: changed(f, "A", lambda w: w.times(1.001)), {LINKS}),
    "a slot off by 0.1 %": (lambda f: changed(f, "slot", lambda w: w.times(1.001)), {LINKS}),
    "a wrong sign": (lambda f: changed(f, "D", lambda w: -w), {LINKS}),
    "a pin on the frame": (lambda f: changed(f, "B", lambda w: w.times(1.001)), {LINKS, FRAME}),
    "a pin with a moment": (lambda f: changed(f, "A", at_another_place), {LINKS, CARRIED, LEAK}),
    "a force along a slot": (
        lambda f: changed(f, "slot", lambda w: Wrench(w.force * np.exp(1e-3j), w.moment)),
        {LINKS, CARRIED, LEAK},
    ),
    "a driver off by 0.1 %": (
        lambda f: changed(f, "E", lambda w: Wrench(w.force, w.moment * 1.001)),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a driver's sign": (
        lambda f: changed(f, "E", lambda w: Wrench(w.force, -w.moment)),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a forgotten mass": (lambda f: without_mass(f, "block"), {LINKS, FRAME, WORK, POWER}),
    "forgotten inertia": (
        lambda f: replace(ck.force_analysis(f.motion, inertia=False), inertia=True),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a sum on the frame": (lambda f: replace(f, on_frame=f.on_frame.times(1.001)), {FRAME}),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_forces_are_found(name: str) -> None:
    spoil, expected = WRONG[name]
    failed = set(ck.verify(spoil(six_bar("dynamic", True).forces)).failed)
    assert failed == expected


def round_six_bar() -> ck.results.Motion:
    case = cases.six_bar("dynamic", True)
    return ck.solve(case.mechanism, {"crank": ck.deg(np.arange(0, 361, 5.0))}, **case.rates)


def test_what_is_read_by_name_is_what_is_read_by_member() -> None:
    motion = round_six_bar()
    forces = ck.force_analysis(motion)
    expected = {
        "crank.effort": (forces.drives["crank"].effort, "N m"),
        "crank.power": (forces.drives["crank"].power, "W"),
        "A.force": (forces.pairs["A"].force, "N"),
        "A.force.length": (np.abs(forces.pairs["A"].force), "N"),
        "slot.moment": (forces.pairs["slot"].moment, "N m"),
        "frame.shaking_force": (forces.shaking.force, "N"),
        "frame.shaking_moment": (forces.shaking.moment_about((0, 0)), "N m"),
        "G.velocity": (motion.points["G"].velocity, "m/s"),
    }
    for name, (values, unit) in expected.items():
        for whole in (forces, motion):
            found = ck.quantity(whole, name)
            assert (found.unit, np.array_equal(found.values, values)) == (unit, True), name
    still = ck.quantity(ck.force_analysis(motion, inertia=False), "crank.effort").values
    assert np.max(np.abs(still - expected["crank.effort"][0])) > 1e-3


def test_figures_of_a_whole_course_are_found_between_the_poses() -> None:
    """The greatest torque, and where it is none, are those of a motion of a hundred times as many poses."""
    motion = round_six_bar()
    case = cases.six_bar("dynamic", True)
    fine = ck.solve(case.mechanism, {"crank": ck.deg(np.linspace(0, 360, 36001))}, **case.rates)
    effort = ck.force_analysis(fine).drives["crank"].effort
    assert ck.quantity(motion, "crank.effort.greatest").values[0] == pytest.approx(effort.max(), rel=1e-8)
    still = ck.force_analysis(motion, inertia=False)
    assert ck.quantity(still, "crank.effort.greatest").values[0] == pytest.approx(
        ck.force_analysis(fine, inertia=False).drives["crank"].effort.max(), rel=1e-8
    )
    changes = np.flatnonzero(effort[1:] * effort[:-1] < 0)
    found = zeros(motion, "crank.effort").at.drives["crank"]
    assert np.allclose(np.rad2deg(found), changes / 100.0, atol=0.011)


def test_tables_and_files(tmp_path: Path) -> None:
    forces = ck.force_analysis(round_six_bar())
    whole = forces.table()
    assert whole.names[:4] == ("crank.value", "crank.effort", "crank.power", "E.force.x")
    assert whole.units["slot.moment"] == "N m"
    ck.save(forces.table("A.force", "G.velocity"), tmp_path / "f.csv")
    head = (tmp_path / "f.csv").read_text().splitlines()[0]
    assert "A.force.x [N]" in head
    assert "G.velocity.y [m/s]" in head
    ck.save(forces, tmp_path / "whole.csv")
    frame = forces.to_pandas("crank.effort")
    assert frame.attrs["units"]["crank.effort"] == "N m"
    assert np.array_equal(frame["crank.effort"], forces.drives["crank"].effort)


def test_outputs_of_a_mechanism(tmp_path: Path) -> None:
    case = cases.six_bar("dynamic", True)
    written = case.mechanism.replace(outputs=("crank.effort", "A.force"))
    motion = ck.solve(written, {"crank": ck.deg(np.arange(0, 361, 5.0))}, **case.rates)
    ck.save(ck.report(motion), tmp_path / "report.md")
    text = (tmp_path / "report.md").read_text()
    assert "crank.effort" in text
    assert "A.force" in text


def test_names_that_there_are_not() -> None:
    forces = ck.force_analysis(round_six_bar())
    for name, told in {
        "A.forc": "did you mean 'A.force'",
        "bar.force": "which only pairs have",
        "plate.shaking_force": "take frame.shaking_force",
    }.items():
        with pytest.raises(ck.errors.UnknownName, match=told):
            ck.quantity(forces, name)
    weightless = ck.solve(ck.load("six-bar"))
    with pytest.raises(ck.errors.UnknownName, match="no units of mass and force"):
        ck.quantity(weightless, "A.force")
    slow = replace(round_six_bar(), order=1)
    with pytest.raises(ck.errors.InvalidInput, match="inertia takes accelerations"):
        ck.quantity(slow, "A.force")


def test_plots() -> None:
    forces = ck.force_analysis(round_six_bar())
    axes = ck.plot(forces, "crank.effort", "A.force.length").figure.axes
    assert [one.get_ylabel() for one in axes] == ["crank.effort [N m]", "A.force.length [N]"]
    effort = forces.drives["crank"].effort
    drawn = axes[0].get_lines()[0].get_ydata()
    assert np.allclose(np.sort(drawn)[[0, -1]], [effort.min(), effort.max()], rtol=0.1)
    assert ck.plots.polar(forces, "A.force").figure.axes[0].name == "polar"
    assert ck.plots.hodograph(forces, "A.force").figure.axes[0].get_xlabel() == "A.force, x [N]"
