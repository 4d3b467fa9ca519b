"""Forces that equilibrium does not determine, and forces at singular poses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant
from compoundkin.structure.redundancy.constraint_equations import ROUNDED, ConstraintEquations
from compoundkin.structure.redundancy.diagnosis import stresses
from compoundkin.view.report.forces_section import forces_report
from tests import catalog
from tests.dynamics.cases import SI, toggle_press
from tests.support import reference

HELD_BY_TOO_MUCH = (
    "parallelogram-third-crank",
    "double-parallelogram-lift",
    "roberts-cognates",
    "dixon-mechanism",
    "wedge-press",
    "conjugate-cams",
    "constant-breadth-yoke",
)


def three_cranks() -> ck.Mechanism:
    """Return the parallelogram of the reference: cranks at O, P, Q, the coupler pinned to them at A, B, D."""
    own = reference("parallelogram_third_crank_reactions", "forces")["dimensions"]
    pivots, long, load = own["pivots"], own["crank"], own["load"]
    return ck.Mechanism(
        "Three cranks",
        ck.link("frame", O=pivots[0], P=pivots[1], Q=pivots[2]),
        *(
            ck.link(name, **{a: (0, 0), b: (long, 0)})
            for name, a, b in (("one", "O", "A"), ("two", "P", "B"), ("three", "Q", "D"))
        ),
        ck.link("coupler", A=(0, 0), **{name: (own["coupler"][name], 0) for name in "BD"}, L=load["at"]),
        ck.drawn(A=(0.1, 0.17), B=(0.4, 0.17), D=(0.7, 0.17)),
        ck.drive("one"),
        ck.force("coupler", load["force"], at="L"),
        units=SI,
    )


def test_three_cranks() -> None:
    """Driver, what is determined, the state of self-stress, and the values under the named assumption."""
    rows = reference("parallelogram_third_crank_reactions", "forces")["expected"]["rows"]
    angle = ck.deg([row["crank_deg"] for row in rows])
    forces = ck.force_analysis(ck.solve(three_cranks(), {"one": angle}))
    told = {found.pair: found for found in forces.undetermined}
    assert set(told) == set("OPQABD")
    assert str(told["D"]) == "D: the force along D Q of three, balanced by forces in O, P, Q, A, B"
    assert [str(freed) for freed in told["A"].freed] == ["Q along DQ of three"]
    assert ck.verify(forces).passed
    (state,) = forces.self_stress.states
    for k, row in enumerate(rows):
        assert abs(forces.drives["one"].effort[k] - row["driver"]) < 1e-12 * abs(row["driver"])
        freed = row["force_on_coupler"]["with D freed (third crank carries nothing)"]
        stress = {name: complex(*pull) for name, pull in row["force_on_coupler"]["self_stress"].items()}
        on_coupler = {name: state[name].force[0, k] for name in "ABD"}
        for name in "ABD":
            # the pairs' second member is the crank or the coupler: on the coupler
            sign = 1.0 if forces.pairs[name].link == "coupler" else -1.0
            assert np.isnan(forces.pairs[name].on("coupler").force[k])
            assumed = forces.assuming_freed.pairs[name].on("coupler").force[k]
            assert abs(assumed - complex(*freed[name])) < 1e-11
            ratio = sign * on_coupler[name] / stress[name]
            assert abs(abs(ratio) - 1.0) < 1e-12
            # along the crank, so that what is across it is determined
            assert (
                abs(abs(told[name].line[k].conjugate() * np.exp(1j * angle[k]).real) - abs(np.exp(1j * angle[k]).real))
                < 1e-9
            )
        # on the frame are the driver's torque and the load
        assert abs(forces.shaking.force[k] - complex(-20, -100)) < 1e-11
    assert "assuming freed Q along DQ of three" in repr(forces.assuming_freed)


def state_at(equations: ConstraintEquations, poses: Mapping[str, Pose]) -> np.ndarray:
    """Return the state of the equations in which links have the poses of a motion of one pose."""

    def number(series: Series) -> Series:
        return constant(np.ravel(series.c[0])[0])

    fixed = {name: Pose(number(pose.z), number(pose.u), number(pose.angle)) for name, pose in poses.items()}
    return equations.state(fixed)


@pytest.mark.parametrize("name", HELD_BY_TOO_MUCH)
def test_the_states_are_those_of_the_constraint_jacobian(name: str) -> None:
    """Open is what has a part in the left null space of the Jacobian of all pairs, at a pose like any other."""
    mechanism = catalog.mechanism(name).replace(unit="", units=SI)
    values = {drive.name: [np.ravel(drive.values)[7]] for drive in mechanism.drives}
    forces = ck.force_analysis(ck.solve(mechanism, values))
    equations = ConstraintEquations(mechanism, ROUNDED)
    null = stresses(equations, state_at(equations, forces.motion.poses))
    assert null.shape[1] == len(forces.self_stress.states)
    # at a pin of several links the equations have other pairs
    stressed = {
        row.pair.name.split("(")[0] for row in equations.rows if np.any(np.abs(null[row.first : row.last]) > 1e-4)
    }
    assert stressed == {found.pair.split("(")[0] for found in forces.undetermined}
    assert ck.verify(forces).passed
    assert not any(np.any(np.isnan(drive.effort)) for drive in forces.drives.values())
    assert not np.any(np.isnan(forces.shaking.force))


LONG, CRANK, AT = 3.0, 1.0, 1.2


def parallelogram(*loads: Any) -> ck.Mechanism:
    """Return cranks of the length 1, three apart; the coupler carries a point P."""
    return ck.Mechanism(
        "Parallelogram",
        ck.link("frame", A=(0, 0), D=(LONG, 0)),
        ck.link("crank", A=(0, 0), B=(CRANK, 0)),
        ck.link("coupler", B=(0, 0), C=(LONG, 0), P=(AT, 0)),
        ck.link("follower", D=(0, 0), C=(CRANK, 0)),
        ck.drawn(B=(0, 1), C=(3, 1)),
        ck.drive("crank"),
        *loads,
        units=SI,
    )


@pytest.mark.parametrize("degrees", [(-10, 30, 10), (0, 360, 30)])
def test_forces_that_are_finite_at_change_points(degrees: tuple[int, int, int]) -> None:
    """A force along the cranks is shared between them by its lever at every pose, where all is in one line too."""
    first, last, step = degrees
    pull = ck.force("coupler", (5.0, 0.0), at="P", fixed_in="crank")
    motion = ck.solve(parallelogram(pull), {"crank": ck.deg(np.arange(first, last + 1, step))})
    forces = ck.force_analysis(motion)
    along = np.exp(1j * motion.drives["crank"].value)
    assert np.max(np.abs(forces.pairs["B"].on("coupler").force + 5.0 * (1.0 - AT / LONG) * along)) < 1e-9
    assert np.max(np.abs(forces.pairs["C"].on("coupler").force + 5.0 * AT / LONG * along)) < 1e-9
    assert np.max(np.abs(forces.drives["crank"].effort)) < 1e-9
    flat = [k for k, angle in enumerate(range(first, last + 1, step)) if angle % 180 == 0]
    assert [(one.pose, one.kind, one.forces) for one in forces.singular] == [
        ((k,), "change point", "finite") for k in flat
    ]
    assert ck.verify(forces).passed


def test_forces_without_limit_at_change_points() -> None:
    """Weight across the flat parallelogram: the effort goes on as a cosine, and no reaction is a number there."""
    weight = ck.force("coupler", (0.0, -5.0), at="P")
    motion = ck.solve(parallelogram(weight), {"crank": ck.deg(np.arange(0, 361, 15))})
    forces = ck.force_analysis(motion)
    assert [str(one) for one in forces.singular] == [
        f"pose {k}: change point of coupler, follower, forces infinite" for k in (0, 12, 24)
    ]
    angle = motion.drives["crank"].value
    assert np.max(np.abs(forces.drives["crank"].effort - 5.0 * CRANK * np.cos(angle))) < 1e-9
    assert np.max(np.abs(forces.shaking.force + 5.0j)) < 1e-9
    for name in "ABCD":
        assert np.isnan(forces.pairs[name].force)[[0, 12, 24]].all()
        assert np.isfinite(forces.pairs[name].force[1:12]).all()
    check = ck.verify(forces)
    assert check.passed
    assert check.singular == 3


def test_a_change_point_that_is_the_only_pose_is_left_open() -> None:
    motion = ck.solve(parallelogram(ck.force("coupler", (0.0, -5.0), at="P")), {"crank": [0.0]})
    forces = ck.force_analysis(motion)
    assert [one.forces for one in forces.singular] == ["undetermined"]
    assert np.isnan(forces.pairs["B"].force).all()
    assert abs(forces.drives["crank"].effort[0] - 5.0) < 1e-9


def test_the_toggle_of_the_driver_is_a_pose_like_others() -> None:
    """Where the slide rests the effort is zero and the forces are finite; beside it they are those of the reference."""
    entry, case = reference("toggle_press_static", "forces")["expected"], toggle_press()
    at = entry["at_the_toggle"]
    beside = [at["crank_deg"] + row["crank_from_toggle_deg"] for row in entry["near_the_toggle"]]
    forces = ck.force_analysis(ck.solve(case.mechanism, {"crank": ck.deg([at["crank_deg"], *beside])}), inertia=False)
    assert forces.singular == ()
    efforts = [at["driver"], *(row["driver"] for row in entry["near_the_toggle"])]
    assert np.max(np.abs(forces.drives["crank"].effort - efforts)) < 1e-6
    for link, letter in (("CB", "C"), ("BD", "D")):
        assert abs(np.abs(forces.pairs[letter].force[0]) - abs(at["tension"][link])) < 1e-6


@pytest.mark.parametrize(("load", "expected"), [(7.0, "infinite"), (0.0, "finite")])
def test_limit_positions(load: float, expected: str) -> None:
    """A crank driven by its piston at the end of the stroke: no thrust turns it, but where nothing has to be turned."""
    mechanism = ck.Mechanism(
        "Slider-crank driven by its piston",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(1, 0)),
        ck.link("rod", A=(0, 0), B=(3, 0)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", at="B", through="O", angle=0, name="stroke"),
        ck.drawn(A=(0, 1), B=(np.sqrt(8.0), 0)),
        ck.drive("piston"),
        ck.torque("crank", load),
        units=SI,
    )
    motion = ck.solve(mechanism, {"piston": [3.6, 3.8, 4.0]})
    forces = ck.force_analysis(motion, inertia=False)
    assert [(one.pose, one.kind, one.forces) for one in forces.singular] == [((2,), "limit position", expected)]
    assert np.isnan(forces.pairs["A"].force[2]) == (expected == "infinite")
    assert np.isfinite(forces.pairs["A"].force[:2]).all()
    assert ck.verify(forces).passed


def test_change_points_of_the_catalog() -> None:
    """Where a mechanism is held by too much nothing of the assumed forces shows at its change points either."""
    mechanism = catalog.mechanism("parallelogram-third-crank").replace(
        ck.mass("coupler", 1.0, at=(50, 20), inertia=0.0), ck.gravity(0, -9.81), unit="", units={**SI, "length": "mm"}
    )
    forces = ck.force_analysis(ck.solve(mechanism))
    assert {one.pose for one in forces.singular} == {(0,), (36,), (72,)}
    assert all(np.isnan(forces.pairs[name].force).all() for name in "ABCDEF")
    assert np.isfinite(forces.drives["crank"].effort).all()


def test_the_report_tells_singular_poses() -> None:
    weight = ck.force("coupler", (0.0, -5.0), at="P")
    forces = ck.force_analysis(ck.solve(parallelogram(weight), {"crank": ck.deg(np.arange(0, 361, 30))}))
    assert "pose 6, change point of coupler and follower: infinite" in " ".join(forces_report(forces).text().split())
