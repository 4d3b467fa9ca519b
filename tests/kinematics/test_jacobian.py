"""The Jacobian from drivers to outputs: closed forms, the chain rule, and the two kinds of singular poses."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.kinematics.quantities import quantity
from tests.catalog import NAMES, each
from tests.catalog import mechanism as loaded

UPPER, FORE = 1.0, 0.7


def arm() -> ck.Mechanism:
    upper, fore = ck.link("upper", A=0, B=UPPER), ck.link("fore", B=0, P=FORE)
    return ck.Mechanism("Arm", ck.link("frame", A=0), upper, fore, ck.drive("upper"), ck.drive("fore", on="upper"))


def test_the_arm_of_two_links_has_its_closed_form() -> None:
    """J. J. Craig, Introduction to Robotics, 3rd ed., example 5.3; det J = l1 l2 sin q2, example 5.4."""
    q = np.random.default_rng(1).uniform(-3.0, 3.0, (2, 4, 5))
    found = ck.solve(arm(), {"upper": q[0], "fore": q[1]}, order=0).jacobian("P", "fore.angle")
    one, both = UPPER * np.exp(1j * q[0]), FORE * np.exp(1j * (q[0] + q[1]))
    columns = 1j * np.stack([one + both, both], axis=-1)
    assert found.rows == ("P.x", "P.y", "fore.angle")
    assert found.units == (("length/rad",) * 2, ("length/rad",) * 2, ("", ""))
    np.testing.assert_allclose(found.matrix[..., 0, :], columns.real, atol=1e-14)
    np.testing.assert_allclose(found.matrix[..., 1, :], columns.imag, atol=1e-14)
    np.testing.assert_allclose(found.matrix[..., 2, :], 1.0, atol=1e-14)
    square = ck.solve(arm(), {"upper": q[0], "fore": q[1]}).jacobian("P")
    np.testing.assert_allclose(square.determinant, UPPER * FORE * np.sin(q[1]), atol=1e-14)
    np.testing.assert_allclose(square.manipulability, np.abs(square.determinant), atol=1e-14)
    np.testing.assert_allclose(square.condition, np.linalg.cond(square.matrix), rtol=1e-9)
    np.testing.assert_allclose(square.scaled(2.0).matrix, square.matrix / 2.0)
    with pytest.raises(InvalidInput, match="3 rows by 2 drivers"):
        _ = found.determinant


def test_the_best_pose_of_an_arm_is_isotropic() -> None:
    """J. K. Salisbury and J. J. Craig, Articulated hands (1982): l1 = sqrt(2) l2, elbow at 135 degrees."""
    links = ck.link("upper", A=0, B=np.sqrt(2.0)), ck.link("fore", B=0, P=1.0)
    two = ck.Mechanism("Arm", ck.link("frame", A=0), *links, ck.drive("upper"), ck.drive("fore", on="upper"))
    found = ck.solve(two, {"upper": [0.3], "fore": [np.deg2rad(135.0)]}).jacobian("P")
    np.testing.assert_allclose(found.condition, 1.0, atol=1e-12)


def test_stretched_and_folded_arms_are_singular() -> None:
    found = ck.solve(arm(), {"upper": 0.4, "fore": np.array([-1.0, 0.0, 1.0, np.pi, 4.0])}).jacobian("P")
    assert found.singular.tolist() == [False, True, False, True, False]
    assert np.isinf(found.condition[1])
    assert not found.at_limit.any()
    coarse = ck.solve(arm(), {"upper": 0.4, "fore": np.array([[-1.0, 0.5, 4.0], [0.1, 0.2, 0.3]])}).jacobian("P")
    np.testing.assert_allclose(coarse.crossings[0], [1.0 / 1.5, 1.0 + (np.pi - 0.5) / 3.5], atol=1e-12)
    assert len(coarse.crossings[1]) == 0


@each(NAMES)
def test_speeds_of_drivers_times_the_jacobian_are_the_rates_of_outputs(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(loaded(name), order=1)
    if not motion.drives:
        return
    links = [link for link in motion.links if link != "frame"]
    points = [point for point in motion.points if point not in loaded(name).links["frame"].points]
    found = motion.jacobian(*(f"{link}.angle" for link in links), *(f"{point}.position" for point in points))
    rates = found.times({driver: drive.rate for driver, drive in motion.drives.items()})
    true = [motion.links[link].angular_velocity for link in links]
    true += [part for point in points for part in motion.points[point].velocity.xy.T]
    known = motion.regular.reshape(motion.shape)
    assert np.isnan(found.matrix[~known]).all()
    scale = np.where(found.lengths[:, 0] > found.lengths[:, 0].min(), motion.size, 1.0)
    gap = np.abs(rates - np.stack([np.broadcast_to(one.T, motion.shape) for one in true], axis=-1)) / scale
    fastest = 1.0 + np.max(np.abs(rates[known]) / scale, axis=-1)
    assert np.max(gap[known] / fastest[:, None], initial=0.0) < 1e-9


def test_the_five_bar_obeys_its_loop_equations_and_central_differences() -> None:
    """(P - B) . P' = (P - B) . B' on either side; C. Gosselin and J. Angeles (1990), equation (3)."""
    robot = loaded("five-bar")
    left, right = (grid.ravel() for grid in np.meshgrid(np.linspace(1.4, 2.0, 5), np.linspace(1.3, 1.7, 4)))
    motion = ck.solve(robot, {"left": left, "right": right})
    found = motion.jacobian("P").matrix
    p, b, d = (np.asarray(motion.points[name].position) for name in "PBD")
    outer = np.stack([p - b, p - d], axis=-1)
    held = np.stack([outer.real, outer.imag], axis=-1)
    turned = 1j * np.stack([b - 0.0, d - 118.0], axis=-1)
    driven = (outer.conjugate() * turned).real
    loops = np.linalg.solve(held, driven[..., None] * np.eye(2))
    np.testing.assert_allclose(found, loops, rtol=1e-10, atol=1e-9)
    step = 1e-5
    for k, name in enumerate(("left", "right")):
        ends = [
            np.asarray(ck.solve(robot, {"left": left, "right": right, name: value}).points["P"].position)
            for value in ((left, right)[k] + step, (left, right)[k] - step)
        ]
        slope = (ends[0] - ends[1]) / (2.0 * step)
        np.testing.assert_allclose(found[:, 0, k] + 1j * found[:, 1, k], slope, rtol=1e-5)


def test_limit_positions_are_singular_of_the_second_kind() -> None:
    """A slider-crank driven by its piston: at the dead point the crank is fast beyond measure."""
    links = ck.link("frame", A=0), ck.link("crank", A=0, B=1.0), ck.link("rod", B=0, C=3.0), ck.link("piston", C=0)
    guide = ck.slide("piston", on="frame", at="C", through="A", angle=0.0)
    pump = ck.Mechanism("Pump", *links, guide, ck.drive("piston"))
    with pytest.warns(ck.errors.UnassembledPoses):
        found = ck.solve(pump, {"piston": np.array([3.0, 4.0, 5.0])}).jacobian("crank.angle", "rod.angle")
    assert found.at_limit.tolist() == [False, True, False]
    assert found.assembled.tolist() == [True, True, False]
    assert not found.singular.any()


def test_what_has_no_rate_is_refused() -> None:
    motion = ck.solve(loaded("five-bar"))
    for name, told in (("P.velocity", "it is a rate itself"), ("P.position.length", "no rate by name")):
        with pytest.raises(InvalidInput, match=told):
            motion.jacobian(name)
    with pytest.raises(UnknownName, match="no point, link, pair or driver 'Q'"):
        motion.jacobian("Q")
    with pytest.raises(InvalidInput, match="no length to divide by"):
        motion.jacobian("P").scaled(0.0)
    with pytest.raises(InvalidInput, match="there is no driver 'x'"):
        motion.jacobian("P").times({"x": 1.0})
    assert motion.jacobian().rows == motion.jacobian("P").rows == ("P.x", "P.y")
    assert quantity(motion, "P.x").order == 0
