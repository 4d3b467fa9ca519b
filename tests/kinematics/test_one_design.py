"""One design of many: its motion by itself, with all that was chosen and tracked of it."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.block import places
from compoundkin.kinematics.one_design import motion_of_design
from tests import catalog
from tests.scaled import scaled

SIZES = np.array([[1.0], [1.5], [0.75]])


@pytest.mark.parametrize(
    "name", ["six-bar", "class-iii-six-bar", "geared-five-bar", "parallelogram", "hydraulic-crane", "planetary-train"]
)
def test_one_design_is_what_was_solved_of_it(name: str) -> None:
    """Signs, tracked groups, counted turns and change points are its own: at its poses, and solved by itself."""
    many = ck.solve(scaled(catalog.mechanism(name), SIZES))  # type: ignore[arg-type]
    for design in range(3):
        one = motion_of_design(many, design)
        alone = ck.solve(scaled(catalog.mechanism(name), float(SIZES[design, 0])))
        again = one.block(one.inputs, 0, *places(slice(0, 1), slice(0, one.inputs.poses))).world
        assert one.shape == alone.shape
        assert np.array_equal(one.assembled, many.assembled[design])
        assert repr(one.modes) == repr(alone.modes)
        for letter in one.mechanism.carriers:
            place = many.points[letter].position[design]
            assert np.array_equal(one.points[letter].position, place)
            assert np.allclose(alone.points[letter].position, place, rtol=0.0, atol=1e-9 * one.size)
        for link, pose in one.poses.items():
            assert np.allclose(again[link].u.c[0], pose.u.c[0], rtol=0.0, atol=1e-9)
        assert ck.verify(one).passed


def test_shapes_of_designs_times_and_loads() -> None:
    """Two axes of designs, a law in time, masses and loads of each design."""
    rocker, weights = np.array([[[3.0]], [[3.2]]]), np.array([[0.5], [1.0], [2.0]])
    plan = ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=0, D=4),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3),
        ck.link("rocker", D=0, C=rocker),
        ck.drive("crank", law=ck.laws.constant_speed(2.0)),
        ck.mass("rocker", weights, at=(1, 0), inertia=0.3),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    many = ck.solve(plan, time=np.linspace(0.0, 1.0, 9))
    assert many.shape == (2, 3, 9)
    one = motion_of_design(many, 4)
    assert one.mechanism.link("rocker").points["C"] == 3.2
    assert np.array_equal(one.points["C"].acceleration, many.points["C"].acceleration[1, 1])
    assert np.array_equal(np.asarray(one.time), np.linspace(0.0, 1.0, 9))
    forces, of_one = ck.force_analysis(many), ck.force_analysis(one)
    assert np.allclose(of_one.drives["crank"].effort, forces.drives["crank"].effort[1, 1], rtol=1e-12)
