"""The section of the forces: its numbers against closed forms, its assumptions, and where it is left out."""

from __future__ import annotations

import json

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.report.forces_section import forces_report
from tests.view.loaded import MASS, REACH, SPEED, UNITS, crank, crank_forces, six_bar_forces

WEIGHT, PULL = MASS * 9.81, MASS * SPEED**2 * REACH / 1000.0


def _rows(key: str) -> dict[str, list[object]]:
    """The rows of a table of the crank's report, by their first cells; each in the mechanism's own units."""
    blocks = json.loads(forces_report(crank_forces()).json())["sections"]["forces"]["blocks"]
    tables = [block for block in blocks if block["kind"] == "table" and block["columns"][0]["name"] == key]
    return {" ".join(map(str, row[:2])) if key == "driver" else row[0]: row for row in reversed(tables[0]["rows"])}


def test_extremes_are_those_of_the_closed_form_between_the_poses() -> None:
    # a crank at constant speed: the pin carries weight and centrifugal force, the driver the weight's moment
    force = _rows("pair")["A"]
    assert force[4:] == pytest.approx([abs(WEIGHT - PULL), 90.0, WEIGHT + PULL, 270.0], rel=1e-6)
    torque, power = _rows("driver")["crank torque"], _rows("driver")["crank power"]
    peak = WEIGHT * REACH
    assert torque[5:] == pytest.approx([-peak, 180.0, peak, 0.0], rel=1e-9, abs=1e-6)
    assert power[7] == pytest.approx(peak * SPEED)
    shaken = _rows("on the frame")
    assert shaken["force"][2:] == pytest.approx([abs(WEIGHT - PULL), 90.0, WEIGHT + PULL, 270.0], rel=1e-6)
    assert shaken["moment about A"][4] == pytest.approx(peak)


def test_torques_and_powers_are_in_newton_metres_and_watts_as_well() -> None:
    blocks = json.loads(forces_report(crank_forces()).json())["sections"]["forces"]["blocks"]
    (table,) = [block for block in blocks if block["kind"] == "table" and block["columns"][0]["name"] == "driver"]
    assert [row[2] for row in table["rows"]] == ["N mm", "N m", "mW", "W"]
    for own, other in zip(table["rows"][::2], table["rows"][1::2], strict=True):
        assert other[3:6] + other[7:8] == pytest.approx([value / 1000 for value in own[3:6] + own[7:8]])
        assert other[6] == own[6], "the place is the same"
    assert f"crank at {SPEED:g} rad/s ({SPEED * 60 / (2 * np.pi):.6g} rpm)" in blocks[0]["text"]


def test_means_are_over_the_way_of_the_driver() -> None:
    torque = _rows("driver")["crank torque"]
    angles = np.deg2rad(np.arange(0, 361, 40))
    square = np.trapezoid((WEIGHT * REACH * np.cos(angles)) ** 2, angles) / (2 * np.pi)
    assert torque[3] == pytest.approx(0.0, abs=1e-9 * WEIGHT * REACH)
    assert torque[4] == pytest.approx(np.sqrt(square))


def test_assumptions_come_first_and_statics_says_so() -> None:
    section = forces_report(six_bar_forces()).section("forces")
    assert section is not None
    first = section.blocks[0].text
    for part in (
        "lengths in mm",
        "forces in N",
        "gravity (0, -9.81) m/s^2",
        "inertia forces",
        "no friction",
        "crank at",
    ):
        assert part in first
    still = ck.force_analysis(crank_forces().motion, inertia=False)
    assert "statics: no inertia" in forces_report(still).text(80).replace("\n", " ")


def test_a_mechanism_without_loads_has_no_such_section() -> None:
    bare = ck.Mechanism("Crank", *crank().items[:3], units=UNITS)
    assert ck.report(bare).section("forces") is None
    found = ck.report(crank())
    assert found.section("forces") is not None
    assert [section.key for section in found.sections].index("forces") < [s.key for s in found.sections].index("checks")


def test_checks_of_forces_are_part_of_the_outcome_and_fail_it() -> None:
    from compoundkin.view.report.motion_report import check_report

    made = check_report(crank_forces().motion)
    section = made.section("force-checks")
    assert section is not None
    assert made.outcome.checks > len(section.blocks[1].rows) >= 5
    assert made.outcome.verified


def test_what_equilibrium_leaves_open_and_friction_are_told() -> None:
    bare = ck.load("parallelogram-third-crank")
    held = ck.Mechanism("Held", *bare.items, ck.force("coupler", (100, -300), at="P"), units=UNITS)
    told = forces_report(ck.force_analysis(ck.solve(held, {"crank": ck.deg([60, 90])}))).text(200)
    assert "Equilibrium does not determine the force along A B of crank in A" in told
    link, slide = ck.link("block", A=(0, 0)), ck.slide("block", name="guide", on="frame", at="A", through="O")
    items = ck.link("frame", O=(0, 0)), link, slide, ck.drive("block", values=[0.0, 1.0], speed=2.0)
    block = ck.Mechanism("Block", *items, ck.mass("block", 1.0, at="A"), ck.gravity(0, -10), ck.friction("guide", 0.2),
                         units={"length": "m", "mass": "kg", "force": "N"})  # fmt: skip
    told = forces_report(ck.force_analysis(ck.solve(block))).text(200)
    said = told.replace("\n", " ")
    # a block on the level: the driver pushes 0.2 of its weight, all of which is lost
    assert "Coulomb friction against the motion, coupled to the reactions: guide 0.2; none elsewhere" in said
    rows = [line.split() for line in told.splitlines() if line.startswith("guide")]
    assert ["guide", "force", "N", "-2", "-2", "always", "-2", "always"] in rows
    assert ["guide", "power", "W", "-4", "-4", "always", "-4", "always"] in rows


def test_motors_that_drive_it_are_those_of_sizing() -> None:
    """Where a speed is stated and power is taken: not of an engine, nor of a driver without a speed of its own."""
    shaper = ck.solve(ck.load("shaper-cutting-force"))
    section = ck.report(shaper).section("motors")
    needs, motors = (block for block in section.blocks if hasattr(block, "rows"))
    effort = np.asarray(ck.force_analysis(shaper).drives["crank"].effort)
    assert needs.rows[0][1] == pytest.approx(np.max(np.abs(effort)) / 1000, rel=1e-9)  # N mm
    does = [row[0] for row in motors.rows if row[-1] == "does"]
    assert section.blocks[-1].text.startswith(f"The smallest that does: {does[0]}")
    for other in (ck.load("engine-gas-pressure"), ck.load("crank-rocker"), crank()):
        assert "motors" not in [one.key for one in ck.report(ck.solve(other)).sections]
