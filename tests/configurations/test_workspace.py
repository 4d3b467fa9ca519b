"""Workspaces: closed forms of serial and parallel robots, symmetry, and places that the drivers reach."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, NotAssembled, UnknownName
from compoundkin.configurations.region_boundary import signed_area
from tests.catalog import mechanism as loaded

UPPER, FORE, HAND = 1.0, 0.7, 0.2


def arm(*more: float) -> ck.Mechanism:
    lengths = (UPPER, FORE, *more)
    letters = "ABCP"[: len(lengths)] + "P"
    names = [f"link-{k}" for k in range(len(lengths))]
    links = [ck.link(name, **{letters[k]: 0, letters[k + 1]: lengths[k]}) for k, name in enumerate(names)]
    drives = [ck.drive(name, on=names[k - 1] if k else "frame") for k, name in enumerate(names)]
    return ck.Mechanism("Arm", ck.link("frame", A=0), *links, *drives, unit="m")


@pytest.mark.parametrize(("robot", "radii"), [
    (arm(), (UPPER + FORE, UPPER - FORE)), (arm(HAND), (UPPER + FORE + HAND, UPPER - FORE - HAND)),
])  # fmt: skip
def test_serial_arms_reach_an_annulus(robot: ck.Mechanism, radii: tuple[float, float]) -> None:
    """Its radii are the sum of the links and the longest less the others: J. J. Craig, Robotics, section 4.2."""
    found = ck.figures.workspace(robot, "P")
    (outer,), (inner,) = found.outer, found.inner
    np.testing.assert_allclose(np.abs(outer), radii[0], rtol=1e-9)
    np.testing.assert_allclose(np.abs(inner), radii[1], rtol=1e-9)
    assert signed_area(outer) > 0.0 > signed_area(inner)
    np.testing.assert_allclose(found.area, np.pi * (radii[0] ** 2 - radii[1] ** 2), rtol=1e-4)
    z = np.exp(1j * np.arange(9)) * np.linspace(0.05, 2.0, 9)
    assert found.contains(z).tolist() == ((np.abs(z) <= radii[0]) & (np.abs(z) >= radii[1])).tolist()


def test_ranges_cut_a_sector_out_of_the_annulus() -> None:
    """r^2 = l1^2 + l2^2 + 2 l1 l2 cos q2, and the upper arm only turns that."""
    found = ck.figures.workspace(arm(), "P", {"link-0": (0.0, 1.5), "link-1": (0.2, 2.5)})
    np.testing.assert_allclose(found.area, 1.5 * UPPER * FORE * (np.cos(0.2) - np.cos(2.5)), rtol=5e-4)
    assert (len(found.outer), len(found.inner)) == (1, 0)
    radius = np.sqrt(UPPER**2 + FORE**2 + 2.0 * UPPER * FORE * np.cos([0.2, 2.5]))
    size = np.abs(found.outer[0])
    np.testing.assert_allclose([size.max(), size.min()], radius, rtol=1e-6)


def test_the_condition_of_an_arm_is_that_of_its_jacobian() -> None:
    found = ck.figures.workspace(arm(), "P", cells=24)
    at = found.inside
    q2 = np.arccos((np.abs(found.places[at]) ** 2 - UPPER**2 - FORE**2) / (2.0 * UPPER * FORE))
    matrix = ck.solve(arm(), {"link-0": 0.3, "link-1": q2}).jacobian("P").matrix
    np.testing.assert_allclose(found.condition[at], np.linalg.cond(matrix), rtol=1e-8)
    assert np.isnan(found.condition[~at]).all()


def test_a_five_bar_of_equal_links_reaches_where_two_discs_meet() -> None:
    """In all modes; X.-J. Liu, J. Wang and G. Pritschow, Kinematics ... of planar 5R mechanisms (2006), section 3."""
    found = ck.figures.workspace(loaded("five-bar"), "P", modes="all")
    reach, base = 180.0, 118.0
    lens = 2.0 * reach**2 * np.arccos(base / 2.0 / reach) - base / 2.0 * np.sqrt(4.0 * reach**2 - base**2)
    np.testing.assert_allclose(found.area, lens, rtol=1e-4)
    (outline,) = found.outer
    np.testing.assert_allclose(np.maximum(np.abs(outline), np.abs(outline - base)), reach, rtol=1e-9)
    # singular of the second kind: the outer links in line, P between B and D
    tip = 59.0 + 158.0j
    assert np.all(found.contains([tip, np.conj(tip)]))


def test_the_drawn_mode_reaches_less_and_all_that_its_drivers_lead_to() -> None:
    robot = loaded("five-bar")
    found = ck.figures.workspace(robot, "P")
    turns = [angle.ravel() for angle in np.meshgrid(*[np.linspace(0.1, 6.2, 61)] * 2)]
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(robot, {"left": turns[0], "right": turns[1]}, order=0)
    assert found.contains(np.asarray(motion.points["P"].position)[motion.assembled]).all()
    assert 0.98 < found.area / 60081.02 < 1.0
    # below it ends where the outer links lie over each other, B on D: a circle about where the cranks meet
    low = found.outer[0][found.outer[0].imag < -150.0]
    assert len(low) > 20
    np.testing.assert_allclose(np.abs(low - (59.0 - 1j * np.sqrt(90.0**2 - 59.0**2))), 90.0, rtol=1e-9)
    assert found.determinants.shape[0] == 4


def test_the_digger_reaches_what_its_strokes_lead_to() -> None:
    """The largest radius about the boom's pin by the law of cosines, the cylinders at their ends or between."""
    digger = loaded("hydraulic-digger")
    found = ck.figures.workspace(digger, "L")
    a, b, c = 2.05, 1.05, np.abs
    e, f = 2.05 - (0.977 + 0.737j), c(-0.251 + 0.158j)
    # the angle at A between the boom's cylinder pin E and the stick's pin F, by the stroke; the stick turns with it
    strokes = np.array([1.046, 1.556])
    corner = np.arccos((c(e) ** 2 + f**2 - strokes**2) / (2.0 * c(e) * f))
    direction = np.angle(-e) - corner
    turned = direction - np.angle(-0.251 + 0.158j)
    radii = c(a + b * np.exp(1j * turned))
    sizes = c(found.outer[0])
    np.testing.assert_allclose([sizes.max(), sizes.min()], [radii.max(), radii.min()], rtol=1e-5)
    grid = [
        one.ravel() for one in np.meshgrid(np.linspace(0.905, 1.305, 9), np.linspace(1.046, 1.556, 9), [0.84, 1.26])
    ]
    names = ("boom-cylinder", "stick-cylinder", "bucket-cylinder")
    motion = ck.solve(digger, dict(zip(names, grid, strict=True)), order=0)
    assert found.contains(np.asarray(motion.points["L"].position)).all()
    tips = ck.figures.workspace(digger, "M", cells=32)
    assert tips.contains(np.asarray(motion.points["M"].position)).all()
    (outline,) = tips.outer
    # no place of the boundary is inside: a step outward from it leaves the region
    normal = -1j * (outline[2:] - outline[:-2]) / c(outline[2:] - outline[:-2])
    assert tips.contains(outline[1:-1] - 1e-4 * normal).mean() > 0.9
    assert not tips.contains(outline[1:-1] + 1e-4 * normal)[5:-5].all()


def test_the_reach_of_a_3_rrr_is_as_symmetric_as_it_is() -> None:
    """With a fixed platform each leg reaches an annulus: C. Gosselin and J. Angeles (1988). Here three discs meet."""
    robot = loaded("3-rrr")
    fixed = ck.figures.workspace(robot, "P", orientation=0.0, cells=96)
    bases = np.array([0.0, 10.0, 5.0 + 8.660254037844386j])
    corners = np.array([0.0, 3.0, 1.5 + 2.598076211353316j]) - (1.5 + 0.8660254037844386j)
    (outline,) = fixed.outer
    far = np.abs(outline + corners[:, None] - bases[:, None]).max(axis=0)
    np.testing.assert_allclose(far, 8.0, rtol=1e-9)
    free = ck.figures.workspace(robot, "P", cells=24)
    middle, third = np.mean(bases), np.exp(2j * np.pi / 3.0)
    z = middle + np.linspace(0.2, 6.0, 12) * np.exp(1j * np.arange(12))
    assert free.contains(z).tolist() == free.contains(middle + third * (z - middle)).tolist()
    assert free.area > fixed.area
    assert free.contains(outline[::20]).all()


def test_pictures_show_region_boundary_and_mechanism() -> None:
    found = ck.figures.workspace(loaded("five-bar"), "P", cells=32)
    figure = found.plot(colour="condition").figure
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels == ["drivers lose their hold", "outer boundary"]
    assert figure.axes[1].get_ylabel() == "condition number"
    with pytest.raises(InvalidInput, match="cannot be coloured by 'red'"):
        found.plot(colour="red")
    assert repr(found).startswith("Workspace(P by left, right: 594")


@pytest.mark.parametrize(("name", "point", "given", "told"), [
    ("five-bar", "B", {}, "one driver (left) moves B, on a curve"),
    ("five-bar", "A", {}, "no driver moves A"),
    ("excavator-arm", "W", {}, "a slide has no end of its own; say from where to where: ranges={'boom-cylinder'"),
    ("five-bar", "P", {"ranges": {"left": (2, 1)}}, "2 to 1 is not a range"),
    ("five-bar", "P", {"ranges": {"x": (0, 1)}}, "there is no driver 'x'"),
    ("five-bar", "P", {"orientation": 0.1}, "two drivers leave outer-left no choice of its angle"),
    ("five-bar", "P", {"cells": 2}, "2 cells are no lattice"),
    ("double-parallelogram-lift", "T", {}, "redundant"),
])  # fmt: skip
def test_what_has_no_region_is_refused(name: str, point: str, given: dict[str, object], told: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        ck.figures.workspace(loaded(name), point, **given)  # type: ignore[arg-type]
    assert told in str(caught.value)


def test_more_that_is_refused() -> None:
    with pytest.raises(UnknownName, match="there is no such point"):
        ck.figures.workspace(loaded("five-bar"), "Q")
    with pytest.raises(NotAssembled, match="reaches no region"):
        ck.figures.workspace(loaded("pantograph"), "P", {"x": (300, 301), "y": (0, 1)})
    four = arm(HAND)
    more = ck.link("tip", P=0, T=0.1), ck.drive("tip", on="link-2")
    with pytest.raises(InvalidInput, match=r"4 drivers .* move T"):
        ck.figures.workspace(four.replace(*more), "T")
    with pytest.raises(InvalidInput, match="are no places"):
        ck.figures.workspace(arm(), "P", cells=16).contains("x")
