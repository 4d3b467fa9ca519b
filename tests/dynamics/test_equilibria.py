"""Equilibrium positions against closed forms: pendulums, a lamp, a spring that snaps a toggle through."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests.dynamics.test_equivalent_inertia import UNITS, slider_crank

DOWN = ck.gravity(0, -9.81)


def arm(*items: object) -> ck.Mechanism:
    """Return the arm of case spring_balanced_arm of the reference."""
    parts = (ck.link("frame", O=(0, 0), S=(0, 0.5)), ck.link("arm", O=0, A=(0.3, 0)), ck.drive("arm"))
    return ck.Mechanism("m", *parts, ck.mass("arm", 5, at=(0.45, 0), inertia=0.4), DOWN, *items, units=UNITS)  # type: ignore[arg-type]


def test_a_pendulum_hangs_and_stands() -> None:
    """At 270 degrees stable, at 90 not, with a stiffness of m g l; poses beside the positions and at them."""
    for first in (0.0, 7.0):
        hangs, stands = sorted(
            ck.figures.equilibria(arm(), {"arm": ck.deg(first + np.arange(0.0, 361.0, 15.0))}),
            key=lambda one: one.stability,
        )
        assert (hangs.stability, stands.stability) == ("stable", "unstable")
        np.testing.assert_allclose(np.rad2deg([hangs.values["arm"], stands.values["arm"]]), [270.0, 90.0], rtol=1e-13)
        np.testing.assert_allclose([hangs.stiffness[0, 0], stands.stiffness[0, 0]], [22.0725, -22.0725], rtol=1e-11)


def test_a_lamp_balanced_by_a_spring_without_length_stays_everywhere() -> None:
    found = ck.figures.equilibria(arm(ck.spring("arm", "A", to="frame", at="S", stiffness=147.15)))
    assert found.indifferent
    assert not found.positions
    assert found.text().startswith("Indifferent equilibrium: arm")


def test_a_spring_of_length_holds_an_arm_where_its_moment_is_that_of_the_weight() -> None:
    """With k (1 - l0 / l) b h = m g c: l = l0 / (1 - 147.15 / 900); cosine theorem for the angle; either side of 90."""
    found = ck.figures.equilibria(arm(ck.spring("arm", "A", to="frame", at="S", stiffness=900, free_length=0.2)))
    length = 0.2 / (1.0 - 147.15 / 900.0)
    away = np.rad2deg(np.arccos((0.3**2 + 0.5**2 - length**2) / (2.0 * 0.3 * 0.5)))
    values = np.rad2deg([one.values["arm"] for one in found])
    np.testing.assert_allclose(values, [90.0 - away, 90.0, 90.0 + away, 270.0], rtol=1e-12)
    assert [one.stability for one in found] == ["stable", "unstable", "stable", "unstable"]
    np.testing.assert_allclose(found[3].stiffness, -900.0 * 0.15 * (1 - 0.2 / 0.8) + 22.0725, rtol=1e-10)


def test_a_toggle_is_snapped_through_by_its_spring() -> None:
    """Free where the piston is at x0: stable at both sides of the toggle positions, of which none is."""
    free = float(0.05 * np.cos(0.7) + np.sqrt(0.2**2 - (0.05 * np.sin(0.7)) ** 2))
    mechanism = slider_crank(ck.spring("piston", "B", to="frame", at="O", stiffness=1e4, free_length=free))
    found = ck.figures.equilibria(mechanism, {"crank": np.linspace(-1.0, 2.0 * np.pi - 1.0, 50)})
    np.testing.assert_allclose([one.values["crank"] for one in found], [-0.7, 0.0, 0.7, np.pi], atol=1e-12)
    assert [one.is_stable for one in found] == [True, False, True, False]
    slope = -0.05 * np.sin(0.7) - 0.05**2 * np.sin(0.7) * np.cos(0.7) / np.sqrt(0.2**2 - (0.05 * np.sin(0.7)) ** 2)
    np.testing.assert_allclose(found[0].stiffness, 1e4 * slope**2, rtol=1e-10)


def test_a_double_pendulum_has_four_positions_of_which_one_is_stable() -> None:
    """The stiffness is the closed form of m g (2 sin a + sin(a + b)), which has two saddles."""
    bars = ck.link("upper", A=0, B=1), ck.link("fore", B=0, P=1)
    masses = ck.mass("upper", 1.0, at="B"), ck.mass("fore", 1.0, at="P")
    drives = ck.drive("upper"), ck.drive("fore", on="upper")
    mechanism = ck.Mechanism("m", ck.link("frame", A=0), *bars, *drives, *masses, DOWN, units=UNITS)
    grid = ck.deg(range(-180, 181, 30))
    found = ck.figures.equilibria(mechanism, {"upper": grid, "fore": grid})
    kinds = {tuple(np.round(np.rad2deg(list(one.values.values())) % 360.0 % 360.0, 6)): one for one in found}
    assert {at: one.stability for at, one in kinds.items()} == {
        (270.0, 0.0): "stable", (90.0, 0.0): "unstable", (270.0, 180.0): "saddle", (90.0, 180.0): "saddle"
    }  # fmt: skip
    np.testing.assert_allclose(kinds[270.0, 0.0].stiffness, 9.81 * np.array([[3.0, 1.0], [1.0, 1.0]]), rtol=1e-9)
    straight = ck.figures.equilibria(mechanism, {"upper": grid, "fore": 0.0})
    assert [one.stability for one in straight] == ["stable", "unstable"]


def test_what_has_no_equilibrium_positions_says_why() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="nothing acts on the mechanism"):
        ck.figures.equilibria(slider_crank())
    with pytest.raises(ck.errors.InvalidInput, match="no driver is released"):
        ck.figures.equilibria(arm(), {"arm": 1.0})
    none = ck.figures.equilibria(arm(), {"arm": ck.deg([0, 40])})
    assert (len(none), none.indifferent, none.text()) == (0, False, "No equilibrium position in the range.")
