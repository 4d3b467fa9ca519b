"""Motions of few poses, far apart: constraints hold between them too, and the answer is a motion that can be made."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.finding import Check, Finding
from compoundkin.studies.goals.goal import DesignConstraint
from compoundkin.studies.optimisation.design_optimisation import stated_problem
from compoundkin.studies.optimisation.optimum import Optimum

LINKAGE = ck.Mechanism(
    "Four-bar",
    ck.link("frame", A=(0, 0), D=(5, 0)),
    ck.link("crank", A=(0, 0), B=(2, 0)),
    ck.link("coupler", B=(0, 0), C=(5, 0), P=(2.5, 1.5)),
    ck.link("rocker", D=(0, 0), C=(4, 0)),
    ck.drive("crank"),
)
# the crank passes the frame, where a linkage near Grashof's limit nearly folds, between two poses
FEW = ck.deg([-80.0, -50.0, -30.0, 25.0, 50.0, 65.0])
PLACES = np.array([-0.35 - 3.53j, 1.35 - 3.44j, 2.47 - 2.56j, 7.88 + 1.25j, 6.61 + 4.75j, 5.27 + 5.82j])
FREE = {"crank.B.x": (1, 8), "coupler.P": ((1, 1), (4, 4)), "rocker.C.x": (2, 6)}


@pytest.mark.parametrize(
    ("asked", "name", "value"),
    [
        (ck.goals.assembles(), "coupler.transmission_index.least", 0.05),
        (ck.goals.transmits("coupler", 0.1), "coupler.transmission_angle.least", 0.1),
        (ck.goals.distance("C", "A", at_least=1.0), "C.length.least", 1.0),
    ],
)
def test_constraints_look_between_poses_far_apart(asked: DesignConstraint, name: str, value: float) -> None:
    problem = stated_problem(LINKAGE, {"rocker.C.x": (2, 6)}, ck.goals.path("P", PLACES), (asked,), values=FEW)
    parts = np.array([0.3, 0.6])
    found = problem.at(parts[:, None])
    for size, margin in zip(2.0 + 4.0 * parts, found.margins[:, 0], strict=True):
        made = LINKAGE.replace(ck.link("rocker", D=(0, 0), C=(size, 0)))
        fine = ck.solve(made, ck.deg(np.arange(-80, 65.1, 1.0)))
        least = float(np.ravel(ck.quantity(fine, name).values)[0])
        assert abs(margin - (least - value)) < 2e-2 * least


def test_a_path_of_few_places_ends_at_a_motion_that_can_be_made() -> None:
    found = ck.optimise(LINKAGE, FREE, ck.goals.path("P", PLACES), ck.goals.assembles(), values=FEW, starts=4)
    fine = ck.solve(found.mechanism, ck.deg(np.arange(-80, 65.1, 0.5)))
    assert found.check.passed
    assert ck.quantity(fine, "coupler.transmission_index").values.min() > 0.05 - 1e-6
    assert found.constraints[0].binds


def test_a_design_that_is_lost_between_places_is_told() -> None:
    with pytest.warns(ck.errors.UnassembledPoses, match="all along the motion.*assembles"):
        found = ck.optimise(LINKAGE, FREE, ck.goals.path("P", PLACES), values=FEW, starts=2)
    with warnings.catch_warnings(action="ignore"):
        fine = ck.solve(found.mechanism, ck.deg(np.arange(-80, 65.1, 1.0)))
    assert not fine.assembled.all()
    assert not found.is_whole
    assert "It cannot be assembled all along the motion" in ck.report(found).text()


@pytest.mark.parametrize("step", [120.0, 90.0, 40.0])
def test_figures_do_not_depend_on_the_step(step: float) -> None:
    name = "coupler.transmission_angle.least"
    asked = {"count": 8, "sample": "grid", "values": ck.deg(np.arange(0.0, 360.1, step))}
    found = ck.study(LINKAGE, {"rocker.C.x": (3.6, 4.6)}, [name, "P.x.stroke"], **asked).run(threads=1)
    for row in (0, 3, 7):
        fine = ck.solve(found.mechanism(row), ck.deg(np.arange(0.0, 360.1, 1.0)))
        for figure in (name, "P.x.stroke"):
            assert abs(found[figure][row] - float(np.ravel(ck.quantity(fine, figure).values)[0])) < 1e-8


@pytest.mark.full
def test_an_answer_next_to_a_change_point_passes_its_verification() -> None:
    """It keeps a margin of 0.0008: the motion is right at any grid, and so is what verifies it."""
    shaper = ck.load("crank-shaper")
    found = ck.optimise(shaper, {"slot.angle": (-3.5, 3.5)}, "ram.value.stroke", starts=1)
    assert found.check.passed
    for poses in (73, 361):
        fine = ck.solve(found.mechanism, np.linspace(0, 2 * np.pi, poses))
        assert ck.verify(fine).passed
    assert found.value == pytest.approx(ck.quantity(fine, "ram.value.stroke").values.ravel()[0], rel=1e-6)


def test_an_answer_that_fails_its_verification_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """None that fails is known any more: the optimum of a plain four-bar, with a finding that does not pass."""
    failing = Check((Finding("continuity", 1.0, 1e-7, "rocker", (0,)),), 73, 0)
    monkeypatch.setattr(Optimum, "check", failing)
    with pytest.warns(ck.errors.UnassembledPoses, match="does not pass its verification .continuity.*assembles"):
        ck.optimise(LINKAGE, {"rocker.C.x": (3.5, 4.5)}, "P.y.stroke", values=FEW, starts=1)
