"""Forces as quantities by name: in tables, over whole motions, in plots, in files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.extremes import zeros
from tests.dynamics import cases


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
