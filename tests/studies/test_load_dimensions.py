"""Masses, springs and friction as free dimensions, against closed forms of an arm, a slide and a pendulum."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import UnknownName

SI = {"length": "m", "mass": "kg", "force": "N"}
SWUNG = {"arm": np.deg2rad(np.linspace(-60.0, 60.0, 13))}


def arm(stiffness: float = 100.0, mass: float = 3.0) -> ck.Mechanism:
    """A weight 1 m from its pin, and a spring without free length between 0.4 m on the arm and 0.5 m above the pin.

    Its effort is (m g l - k a b) cos q: nothing where k a b = m g l, 147.15 N/m.
    """
    return ck.Mechanism(
        "Arm",
        ck.link("frame", O=0, S=0.5j),
        ck.link("arm", O=0, A=0.4),
        ck.drive("arm"),
        ck.mass("arm", mass, at=1.0, inertia=0.0),
        ck.gravity(0, -9.81),
        ck.spring("arm", "A", at="S", stiffness=stiffness, name="balancer"),
        units=SI,
    )


def test_a_study_of_a_spring_and_a_mass() -> None:
    free = {"balancer.stiffness": (50.0, 200.0), "arm.mass": (2.0, 4.0), "arm.at.x": (0.5, 1.5)}
    found = ck.study(arm(), free, ["arm.effort.greatest"], values=SWUNG, count=64).run()
    k, m, x = (np.asarray(found[name]) for name in free)
    exact = np.max(np.cos(SWUNG["arm"]) * (9.81 * m * x - 0.2 * k)[:, None], axis=1)
    np.testing.assert_allclose(np.asarray(found["arm.effort.greatest"]), exact, atol=1e-12)


@pytest.mark.parametrize("goal", ["arm.effort.stroke", ck.goals.even("arm.effort")], ids=["stroke", "even"])
def test_the_spring_that_balances_is_found(goal: object) -> None:
    found = ck.optimise(arm(), {"balancer.stiffness": (50.0, 400.0)}, goal, values=SWUNG, starts=4)
    assert found.dimensions["balancer.stiffness"] == pytest.approx(9.81 * 3.0 / 0.2, rel=1e-6)
    held = ck.force_analysis(ck.solve(found.mechanism, SWUNG)).drives["arm"].effort
    assert np.max(np.abs(held)) < 1e-5


def test_a_counterweight_is_placed() -> None:
    """A second arm of the link, whose weight balances it: its place is a dimension."""
    goal = ck.goals.least("arm.effort.stroke")
    found = ck.optimise(arm(0.0), {"arm.at.x": (-1.0, 2.0)}, goal, values=SWUNG, starts=4)
    assert abs(found.dimensions["arm.at.x"]) < 1e-6


def test_tolerances_of_springs_and_masses() -> None:
    """The greatest effort is m g l - k a b: by 0.2 for each N/m, by 9.81 for each kg."""
    found = ck.tolerance(arm(), {"balancer.stiffness": 5.0, "arm.mass": 0.1}, ["arm.effort.greatest"], values=SWUNG)
    shares = found["arm.effort.greatest"].contributions
    assert shares["balancer.stiffness"] == pytest.approx(1.0 / (1.0 + 0.981**2), rel=1e-6)


def test_friction_of_a_slide() -> None:
    """A block that is pushed along a level guide: mu m g."""
    level = ck.Mechanism(
        "Block",
        ck.link("frame", O=0),
        ck.link("block", P=0),
        ck.slide("block", on="frame", through="O", name="way"),
        ck.drive("block"),
        ck.mass("block", 2.0, at="P", inertia=0.1),
        ck.gravity(0, -9.81),
        ck.friction("way", 0.1),
        units=SI,
    )
    found = ck.study(level, {"way.coefficient": (0.0, 0.5)}, ["block.effort.greatest"], values=[0.0, 1.0], speed=1.0,
                     count=16).run()  # fmt: skip
    np.testing.assert_allclose(found["block.effort.greatest"], found["way.coefficient"] * 2.0 * 9.81, atol=1e-10)


def test_the_inertia_that_is_left_out_follows_the_mass() -> None:
    """That of a uniform bar is m l^2 / 3 about its end."""
    bar = ck.Mechanism(
        "Bar", ck.link("frame", O=0), ck.link("arm", O=0, A=2), ck.drive("arm"), ck.mass("arm", 3.0), units=SI
    )
    found = ck.study(bar, {"arm.mass": (1.0, 5.0)}, ["arm.effort.greatest"], values=[0.0, 1.0], speed=1.0,
                     acceleration=1.0, count=16).run()  # fmt: skip
    np.testing.assert_allclose(found["arm.effort.greatest"], np.asarray(found["arm.mass"]) * 4.0 / 3.0, rtol=1e-12)


def test_a_word_that_no_load_has_is_named() -> None:
    with pytest.raises(UnknownName, match=r"balancer\.stiffness"):
        ck.study(arm(), {"balancer.stifness": (1.0, 2.0)}, ["arm.effort.greatest"], values=SWUNG, count=4)
