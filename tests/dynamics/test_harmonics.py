"""Harmonics of shaking forces against published series, and ratios of forces against ratios of rates."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog
from tests.dynamics.test_equivalent_inertia import slider_crank

TURN = np.deg2rad(np.arange(10.0, 371.0, 10.0))


def test_a_piston_shakes_by_the_series_of_the_slider_crank() -> None:
    """cos t + A2 cos 2t - A4 cos 4t + A6 cos 6t; Den Hartog, Mechanical Vibrations, section 5.1, with l = r / rod."""
    forces = ck.force_analysis(ck.solve(slider_crank(ck.mass("piston", 0.5)), TURN, speed=150))
    found = ck.figures.harmonics(forces)
    ratio = 0.25
    second = ratio + ratio**3 / 4 + 15 * ratio**5 / 128
    fourth, sixth = ratio**3 / 4 + 3 * ratio**5 / 16, 9 * ratio**5 / 128
    along = found.part("x")
    signed = along.amplitude * np.cos(along.phase) / (0.5 * 0.05 * 150**2)
    np.testing.assert_allclose(signed, [[0.0, 1.0, second, 0.0, -fourth, 0.0, sixth]], atol=1e-5)
    np.testing.assert_allclose(signed[0, 1], 1.0, rtol=1e-13)
    np.testing.assert_allclose(found.part("y").amplitude, 0.0, atol=1e-11)
    # to and fro is half with the crank, half against it
    np.testing.assert_allclose(found.forward, np.conj(found.backward), atol=1e-11)
    effort = ck.figures.harmonics(forces, "crank.effort", orders=2)
    values = np.asarray(forces.drives["crank"].effort)[:-1]
    np.testing.assert_allclose(effort.amplitude[0, 2], 2 * np.abs(np.mean(values * np.exp(-2j * TURN[:-1]))), rtol=1e-9)


def test_a_crank_pulls_with_a_vector_that_turns_forward() -> None:
    mechanism = slider_crank(ck.mass("crank", 2.0, at=(0.03, 0.04), inertia=0.1))
    found = ck.figures.harmonics(ck.force_analysis(ck.solve(mechanism, TURN, speed=10)))
    np.testing.assert_allclose(found.forward[0, :3], [0.0, 200.0 * (0.03 + 0.04j), 0.0], atol=1e-12)
    np.testing.assert_allclose(found.backward, 0.0, atol=1e-12)
    with pytest.raises(ck.errors.InvalidInput, match="a vector has no amplitude"):
        _ = found.amplitude
    with pytest.raises(ck.errors.InvalidInput, match="closed cycle"):
        ck.figures.harmonics(ck.solve(mechanism, TURN[:9]), "A.x")


def test_forces_without_friction_are_in_the_inverse_ratio_of_rates() -> None:
    """The reverse pass against velocities, for links, slides, points and drivers; units do not matter."""
    for name, outputs in {
        "crank-rocker": ("rocker", ck.figures.TorquePort("coupler"), ck.figures.ForcePort("coupler", "C", 0.3)),
        "slider-crank-offset": ("stroke", ck.figures.ForcePort("rod", "B", 0.0)),
        "six-bar": ("bar", ck.figures.TorquePort("bar", "rocker")),
    }.items():
        mechanism = catalog.mechanism(name)
        motion = ck.solve(mechanism, np.deg2rad(np.arange(20.0, 380.0, 24.0)))
        for output in outputs:
            by_rates = ck.figures.mechanical_advantage(motion, output, next(iter(motion.drives))).advantage
            np.testing.assert_allclose(ck.figures.force_ratio(motion, output), by_rates, rtol=1e-9)


def test_friction_takes_its_share_of_the_ratio_of_forces() -> None:
    """In the guide of a slider-crank 1 - mu tan of the rod's angle, whichever way the piston goes; weights are none."""
    rubbed = slider_crank(ck.friction("cylinder", 0.2), ck.mass("piston", 3.0), ck.gravity(0, -9.81))
    for speed in (2.0, -2.0):
        motion = ck.solve(rubbed, np.deg2rad(np.arange(15.0, 360.0, 30.0)), speed=speed)
        by_rates = ck.figures.mechanical_advantage(motion, "cylinder", "crank").advantage
        share = 1.0 - 0.2 * np.abs(np.tan(motion.links["rod"].angle))
        np.testing.assert_allclose(ck.figures.force_ratio(motion, "cylinder"), by_rates * share, rtol=1e-9)
