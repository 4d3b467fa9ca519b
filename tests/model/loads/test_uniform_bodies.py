"""Uniform bars and plates against closed forms, and against the same body cut into triangles."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.model.loads.mass import uniform_body

SI = {"length": "m", "mass": "kg", "force": "N"}


def test_a_rectangle_and_a_triangle() -> None:
    """a^2 + b^2 over 12; the sum of the sides' squares over 36 (textbooks, for a unit of mass)."""
    rectangle = uniform_body([1 + 1j, 4 + 3j, 4 + 1j, 1 + 3j, 2 + 2j])
    assert rectangle == ("uniform plate", pytest.approx(6.0), pytest.approx(2.5 + 2j), pytest.approx(13.0 / 12.0))
    a, b, c = 0j, 5 + 1j, 2 + 4j
    triangle = uniform_body([a, b, c])
    sides = abs(b - a) ** 2 + abs(c - b) ** 2 + abs(a - c) ** 2
    assert triangle.extent == pytest.approx(9.0)
    assert triangle.centre == pytest.approx((a + b + c) / 3.0)
    assert triangle.inertia == pytest.approx(sides / 36.0)


def test_points_in_line_are_a_bar() -> None:
    along = np.exp(0.7j)
    bar = uniform_body([along, 0j, 4 * along, 3 * along])
    assert bar == ("uniform bar", pytest.approx(4.0), pytest.approx(2 * along), pytest.approx(16.0 / 12.0))


coordinates = st.integers(-20, 20)


@settings(max_examples=60)
@given(st.lists(st.builds(complex, coordinates, coordinates), min_size=3, max_size=7), st.randoms())
def test_the_plate_is_that_of_its_hull(points: list[complex], order: object) -> None:
    """Against scipy's hull cut into triangles from its first point; in any order; over designs at once."""
    from scipy.spatial import ConvexHull, QhullError

    body = uniform_body(points)
    order.shuffle(points)  # type: ignore[attr-defined]
    np.testing.assert_allclose(uniform_body(points)[1:], body[1:], rtol=1e-9, atol=1e-9)
    designs = uniform_body([np.array([[p], [2 * p], [1j * p]]) for p in points])
    factors = np.array([1.0, 4.0, 1.0])[:, None]
    if body.kind == "uniform plate":
        np.testing.assert_allclose(designs.extent, body.extent * factors, rtol=1e-9)
    if body.extent:
        np.testing.assert_allclose(designs.inertia, body.inertia * factors, rtol=1e-9)
    try:
        hull = np.array(points)[ConvexHull(np.array([[p.real, p.imag] for p in points])).vertices]
    except QhullError:
        assert body.kind == "uniform bar"
        return
    corners = [(hull[0], b, c) for b, c in pairwise(hull[1:])]
    areas = np.array([abs(((b - a).conjugate() * (c - a)).imag) / 2.0 for a, b, c in corners])
    centres = np.array([(a + b + c) / 3.0 for a, b, c in corners])
    own = np.array([(abs(b - a) ** 2 + abs(c - b) ** 2 + abs(a - c) ** 2) / 36.0 for a, b, c in corners])
    centre = np.sum(areas * centres) / np.sum(areas)
    inertia = np.sum(areas * (own + abs(centres - centre) ** 2)) / np.sum(areas)
    np.testing.assert_allclose(body[1:], (np.sum(areas), centre, inertia), rtol=1e-9)


def test_what_is_assumed_is_said() -> None:
    linkage = ck.Mechanism(
        "m", ck.link("frame", A=0), ck.link("bar", A=0, B=6), ck.link("plate", B=0, C=6, D=3j), ck.link("dot", C=0),
        ck.mass("bar", density=0.5), ck.mass("plate", 2.0, at="C"), ck.mass("dot", 1.0), units=SI,
    )  # fmt: skip
    masses = linkage.masses
    assert (masses["bar"].mass, masses["bar"].at, masses["bar"].inertia) == (3.0, 3.0, 9.0)
    assert masses["bar"].assumed == "mass and mass centre and inertia of a uniform bar A-B"
    assert (masses["plate"].at, masses["plate"].inertia) == ("C", pytest.approx(5.0))
    assert masses["plate"].assumed == "inertia of a uniform plate B-C-D"
    assert (masses["dot"].at, masses["dot"].inertia) == (0.0, 0.0)
    assert linkage.replace(ck.mass("bar", 1, at=(0, 0), inertia=0)).masses["bar"].assumed == ""
