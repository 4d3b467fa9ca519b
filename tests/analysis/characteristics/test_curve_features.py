"""Features of coupler curves, by published tables, closed forms, linear programming and the pole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

import compoundkin as ck
from compoundkin.analysis.characteristics.output_figures import Sampled, dwells
from compoundkin.analysis.characteristics.path_features import (
    fitted_circles,
    fitted_lines,
    monotonic_stretches,
    path_features,
    straightness,
)
from tests import catalog

CRANK = ck.deg(np.arange(0, 361, 5))
# R. L. Norton, Design of Machinery, link ratios for the smallest errors in straightness of Hoecken's linkage: the range
# of the crank around 180 degrees, frame and coupler by the crank, length and deviation (percent of it) in y.
# The table as remembered, not seen again; each row agrees with the linkage itself.
NORTON = [
    (120, 2.625, 3.438, 3.238, 0.010),
    (140, 2.500, 3.250, 3.623, 0.023),
    (160, 2.350, 3.025, 3.933, 0.047),
    (180, 2.200, 2.800, 4.181, 0.096),
]


def hoecken(frame: float, coupler: float) -> ck.Mechanism:
    """Hoecken's linkage: rocker and the arm to the tracing point are as long as the coupler."""
    links = ck.link("frame", A=0, D=frame), ck.link("crank", A=0, B=1), ck.link("rocker", D=0, C=coupler)
    return ck.Mechanism("Hoecken", *links, ck.link("coupler", B=0, C=coupler, P=2 * coupler), ck.drive("crank"))


@pytest.mark.parametrize(("span", "frame", "coupler", "length", "percent"), NORTON)
def test_hoeckens_line_is_as_straight_as_published(
    span: float, frame: float, coupler: float, length: float, percent: float
) -> None:
    motion = ck.solve(hoecken(frame, coupler), {"crank": CRANK})
    found = straightness(motion, "P", *ck.deg([180 - span / 2, 180 + span / 2]))
    assert found.length == pytest.approx(length, abs=6e-4)
    assert 100 * found.straightness == pytest.approx(percent, abs=6e-4)
    # the longest stretch as straight as that is at least as long
    longest = path_features(motion, "P", tolerance=found.deviation * 1.001).straight
    assert longest.length > 0.99 * found.length
    assert longest.deviation <= found.deviation * 1.001


@pytest.mark.parametrize("name", ["chebyshev-straight-line", "watt-straight-line", "roberts-straight-line"])
def test_lines_deviate_as_linear_programming_says(name: str) -> None:
    """The line of least greatest distance in y: over the whole range, from 3000 poses solved by themselves."""
    motion = catalog.motion(name)
    line = path_features(motion, "P").line
    values = motion.drives["arm-1"].value
    z = ck.solve(motion.mechanism, {"arm-1": np.linspace(values[0], values[-1], 3001)}, order=0).points["P"].position
    z = np.asarray(z) * np.conj(line.direction)
    one = np.ones(len(z))
    limits = np.r_[np.c_[z.real, one, -one], np.c_[-z.real, -one, -one]]
    best = linprog([0, 0, 1], A_ub=limits, b_ub=np.r_[z.imag, -z.imag], bounds=[(None, None)] * 3)
    assert best.x[0] == pytest.approx(0.0, abs=1e-5)
    assert line.deviation == pytest.approx(best.x[2], rel=1e-3)


def trochoid(arm: float) -> ck.results.Motion:
    """A point at 2 exp(it) + arm exp(-2it): two drivers carry it round."""
    links = ck.link("frame", A=0), ck.link("first", A=0, B=2), ck.link("second", B=0, P=arm)
    mechanism = ck.Mechanism("Trochoid", *links, ck.drive("first"), ck.drive("second", on="first"))
    t = ck.deg(np.arange(0, 361, 4))
    return ck.solve(mechanism, {"first": t, "second": -3 * t})


def test_double_points_of_a_hypotrochoid() -> None:
    """2 sin t = 1.5 sin 2t on the axis: cos t = 2/3, x = 7/6, and two more by turns of 120 degrees."""
    found = path_features(trochoid(1.5), "P")
    assert found.closed
    assert found.cusps == ()
    exact = 7 / 6 * np.exp(2j * np.pi * np.arange(3) / 3)
    points = np.array([place.point for place in found.double_points])
    assert len(points) == 3
    assert np.min(np.abs(points[:, None] - exact), axis=1) == pytest.approx(0.0, abs=1e-12)
    t = np.arccos(2 / 3)
    on_axis = next(place for place in found.double_points if abs(place.point.imag) < 1e-9)
    assert sorted(at["first"] for at in on_axis.at) == pytest.approx([t, 2 * np.pi - t], abs=1e-12)


def test_cusps_of_a_deltoid() -> None:
    """2 exp(it) + exp(-2it) stands still at its three cusps, at a distance of 3; its arc is 16 long."""
    found = path_features(trochoid(1.0), "P")
    cusps = np.array([place.point for place in found.cusps])
    assert len(cusps) == 3
    exact = 3 * np.exp(2j * np.pi * np.arange(3) / 3)
    assert np.min(np.abs(cusps[:, None] - exact), axis=1) == pytest.approx(0.0, abs=1e-10)
    assert found.double_points == ()
    assert found.length == pytest.approx(16.0, rel=1e-3)


def test_a_point_at_the_pole_has_a_cusp_there() -> None:
    """The point of the coupler at the instant centre of one pose, between two poses that are solved."""
    mechanism = catalog.mechanism("crank-rocker")
    at = ck.deg(62.3)
    pose = ck.solve(mechanism, {"crank": [at]}, speed=1)
    local = ck.figures.pole(pose, "coupler").moving
    own = {"B": 0, "C": mechanism.geometry.points["coupler"]["C"], "Q": complex(local[0])}
    links = [ck.link("coupler", **own) if link.name == "coupler" else link for link in mechanism.links.values()]
    motion = ck.solve(ck.Mechanism("Cusp", *links, ck.drive("crank")), {"crank": CRANK})
    (cusp,) = path_features(motion, "Q").cusps
    assert cusp.at[0]["crank"] == pytest.approx(at, abs=1e-9)


def test_points_on_lines_and_circles_are_told_as_such() -> None:
    found = path_features(catalog.motion("crank-rocker"), "C")
    assert found.is_circular
    assert not found.is_straight
    assert found.retraced
    assert found.circle.radius == pytest.approx(4.0)
    # the stroke of the rocker by the triangles at the dead points: B, C in line with the crank
    angles = [np.arccos((5.5**2 + 4**2 - d**2) / (2 * 5.5 * 4)) for d in (5 + 2, 5 - 2)]
    assert found.circle.length == pytest.approx(4 * (angles[0] - angles[1]), rel=1e-9)
    piston = path_features(catalog.motion("slider-crank"), "B")
    assert piston.is_straight
    assert piston.line.length == pytest.approx(0.24)


def test_fits_of_many_stretches_are_those_of_each() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(5, 40)) + 0.05j * rng.normal(size=(5, 40))
    turned = points * np.exp(1j * np.array([0, 1, 2, 3, 4.0]))[:, None]
    lines = fitted_lines(turned)
    # the least width over all directions, each side of the hull being one: tried finely
    fine = np.exp(-1j * np.linspace(-0.2, 0.2, 40001))
    for k in range(5):
        widths = np.ptp((points[k][:, None] * fine).imag, axis=0)
        assert 2 * lines.deviation[k] == pytest.approx(widths.min(), rel=1e-4)
    arc = 2j + 7 * np.exp(1j * np.linspace(0.2, 0.9, 50))
    assert fitted_circles(arc).radius == pytest.approx(7.0)
    assert abs(fitted_circles(arc).place - 2j) < 1e-9


def test_dwells_of_a_cosine_of_two_periods() -> None:
    """cos 2t lies within 1 - cos 0.8 of its extremes for 0.8 about each, at the end of the cycle too."""
    s = np.linspace(0, 2 * np.pi, 73)
    found = dwells(Sampled(s, np.cos(2 * s), lambda x: np.cos(2 * x), 2 * np.pi), 1 - np.cos(0.8), 0.5)
    assert [(one.first + one.last) / 2 for one in found] == pytest.approx(np.pi / 2 * np.array([1, 2, 3, 4]), abs=1e-9)
    assert [one.last - one.first for one in found] == pytest.approx([0.8] * 4, abs=1e-9)


def test_wrong_places_points_and_tolerances_are_refused() -> None:
    motion = catalog.motion("crank-rocker")
    with pytest.raises(ck.errors.UnknownName, match="no such point"):
        path_features(motion, "Z")
    with pytest.raises(ck.errors.InvalidInput, match="does not move"):
        path_features(motion, "A")
    with pytest.raises(ck.errors.InvalidInput, match="no length"):
        path_features(motion, "C", tolerance=-1.0)
    with pytest.raises(ck.errors.InvalidInput, match="outside: crank goes from 0"):
        straightness(motion, "C", 0.0, 9.0)
    with pytest.raises(ck.errors.InvalidInput, match="no driver moves"):
        path_features(ck.solve(motion.mechanism, {"crank": [1.0]}), "C")


def test_what_is_straight_has_no_arc_but_itself() -> None:
    """Both tracers of the pantograph are led along lines: no circle goes through their places."""
    features = ck.figures.path_features(catalog.motion("pantograph"), "C")
    assert features.arc.is_straight
    assert np.isfinite(features.arc.length)
    assert features.arc.deviation == pytest.approx(0.0, abs=1e-12)


def test_a_path_of_a_single_pose_has_no_stretch() -> None:
    """The first pose is assembled, and those after it are beyond the limit."""
    links = (
        ck.link("frame", A=0, D=5),
        ck.link("crank", A=0, B=3),
        ck.link("coupler", B=0, C=1),
        ck.link("rocker", D=0, C=2),
    )
    drawn = ck.drawn(B=3.0, C=3.25 + 0.25j * np.sqrt(15.0))
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(ck.Mechanism("rockers", *links, ck.drive("crank"), drawn), {"crank": [0.0, 1.5, 1.6, 1.7]})
    assert motion.assembled.tolist() == [True, False, False, False]
    assert list(monotonic_stretches(motion, 0)) == []
