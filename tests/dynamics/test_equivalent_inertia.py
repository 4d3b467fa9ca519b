"""Equivalent inertia against the closed forms of an arm of two links and of a slider-crank."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck

UNITS = {"length": "m", "mass": "kg", "force": "N"}
ANGLES = np.deg2rad(np.arange(0.0, 360.0, 15.0))


def slider_crank(*items: Any, units: dict[str, str] = UNITS) -> ck.Mechanism:
    """Return an in-line slider-crank of radius 0.05 and rod 0.2, with what else is given."""
    frame, crank = ck.link("frame", O=(0, 0)), ck.link("crank", O=(0, 0), A=(0.05, 0))
    rod, piston = ck.link("rod", A=(0, 0), B=(0.2, 0)), ck.link("piston", B=(0, 0))
    guide = ck.slide("piston", on="frame", through="O", name="cylinder")
    return ck.Mechanism("m", frame, crank, rod, piston, guide, ck.drive("crank"), *items, units=units)


def test_an_arm_of_two_links_has_the_matrix_of_the_textbook() -> None:
    """M11 = J1 + J2 + m1 r1^2 + m2 (l1^2 + r2^2 + 2 l1 r2 cos q2); Spong, Hutchinson and Vidyasagar, section 7.4."""
    bars = ck.link("upper", A=0, B=2), ck.link("fore", B=0, P=1)
    drives = ck.drive("upper"), ck.drive("fore", on="upper")
    masses = ck.mass("upper", 3.0, at=(0.8, 0), inertia=0.7), ck.mass("fore", 2.0, at=(0.5, 0), inertia=0.3)
    arm = ck.Mechanism("arm", ck.link("frame", A=0), *bars, *drives, *masses, units=UNITS)
    found = ck.figures.equivalent_inertia(ck.solve(arm, {"upper": 0.3, "fore": ANGLES}))
    h, zero = 2.0 * 2.0 * 0.5 * np.cos(ANGLES), 0.0 * ANGLES
    both = 0.3 + 2.0 * 0.25 + h
    first = 0.7 + 0.3 + 3.0 * 0.64 + 2.0 * (4.0 + 0.25) + 2.0 * h
    expected = np.array([[first, both], [both, zero + 0.3 + 0.5]])
    np.testing.assert_allclose(np.moveaxis(found.matrix, 0, -1), expected, atol=1e-13)
    slope = -2.0 * 2.0 * 0.5 * np.sin(ANGLES)
    np.testing.assert_allclose(
        np.moveaxis(found.slopes, 0, -1)[..., 1, :], [[2 * slope, slope], [slope, zero]], atol=1e-13
    )
    np.testing.assert_allclose(found.slopes[..., 0], 0.0, atol=1e-13)
    with pytest.raises(ck.errors.InvalidInput, match="matrix and"):
        _ = found.inertia


def test_a_piston_is_felt_by_its_crank_as_its_mass_by_the_square_of_its_rate() -> None:
    """x' and x'' of an in-line slider-crank by its closed form; designs of the piston's mass side by side."""
    mechanism = slider_crank(ck.mass("piston", np.array([[0.5], [1.5]])))
    found = ck.figures.equivalent_inertia(ck.solve(mechanism, np.tile(ANGLES, (2, 1))))
    r, rod, sin, cos = 0.05, 0.2, np.sin(ANGLES), np.cos(ANGLES)
    root = np.sqrt(rod**2 - (r * sin) ** 2)
    first = -r * sin - r**2 * sin * cos / root
    second = -r * cos - r**2 * (cos**2 - sin**2) / root - (r**2 * sin * cos) ** 2 / root**3
    np.testing.assert_allclose(found.inertia, np.array([[0.5], [1.5]]) * first**2, atol=1e-17)
    np.testing.assert_allclose(found.slope, np.array([[1.0], [3.0]]) * first * second, atol=1e-17)


def test_masses_are_wanted() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="no link has a mass"):
        ck.figures.equivalent_inertia(ck.solve(slider_crank(), [0.0]))
