"""Mechanisms held by too much: what equilibrium determines is right, the rest is named and never a number."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant
from compoundkin.structure.redundancy.constraint_equations import ROUNDED, ConstraintEquations
from compoundkin.structure.redundancy.diagnosis import stresses
from tests import catalog
from tests.dynamics.cases import SI
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
