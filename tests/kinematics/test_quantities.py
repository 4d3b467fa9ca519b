"""Quantities by their names: values, units, parts of vectors, and what is told where there is none."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import derivative_order
from tests import catalog


@pytest.fixture(scope="module")
def six_bar() -> ck.results.Motion:
    return catalog.motion("six-bar")


@pytest.mark.parametrize(
    ("name", "unit", "expected"),
    [
        ("G", "mm", lambda m: m.points["G"].position),
        ("G.velocity", "mm/s", lambda m: m.points["G"].velocity),
        ("G.acceleration", "mm/s^2", lambda m: m.points["G"].acceleration),
        ("G.velocity.y", "mm/s", lambda m: np.asarray(m.points["G"].velocity).imag),
        ("G.velocity.length", "mm/s", lambda m: m.points["G"].speed),
        ("G.length", "mm", lambda m: np.abs(np.asarray(m.points["G"].position))),
        ("G.x", "mm", lambda m: m.points["G"].x),
        ("G.speed", "mm/s", lambda m: m.points["G"].speed),
        ("bar", "rad", lambda m: m.links["bar"].angle),
        ("bar.angular_velocity", "rad/s", lambda m: m.links["bar"].angular_velocity),
        ("bar.angular_acceleration", "rad/s^2", lambda m: m.links["bar"].angular_acceleration),
        ("slot", "mm", lambda m: m.pairs["slot"].value),
        ("slot.displacement", "mm", lambda m: m.pairs["slot"].value),
        ("slot.rate", "mm/s", lambda m: m.pairs["slot"].rate),
        ("E.angle", "rad", lambda m: m.pairs["E"].value),
        ("A.second", "rad/s^2", lambda m: m.pairs["A"].second),
        # the link comes first, and has no value: then the driver is meant
        ("crank.value", "rad", lambda m: m.drives["crank"].value),
        ("crank.speed", "rad/s", lambda m: m.drives["crank"].rate),
    ],
)
def test_a_quantity_is_that_of_the_motion(six_bar: ck.results.Motion, name: str, unit: str, expected: object) -> None:
    found = quantity(six_bar, name)
    np.testing.assert_array_equal(found.values, expected(six_bar))  # type: ignore[operator]
    assert found.unit == unit
    assert found.order == derivative_order(name)
    assert found.is_angle == (unit == "rad")
    assert found.is_vector == np.iscomplexobj(found.values)


def test_angles_are_shown_in_degrees_and_rates_are_not(six_bar: ck.results.Motion) -> None:
    shown = quantity(six_bar, "bar.angle").shown
    np.testing.assert_allclose(shown.values, np.rad2deg(six_bar.links["bar"].angle), rtol=1e-15)
    assert shown.unit == "deg"
    rate = quantity(six_bar, "bar.angular_velocity")
    assert rate.shown is rate


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("GG.velocity", "did you mean 'G'"),
        ("G.velocty", "did you mean 'G.velocity'"),
        ("bar.speeed", "known: angle, angular_velocity"),
        ("slot.angle", "did you mean 'bar.angle'"),
        ("A.displacement", "'A' has no 'displacement'"),
        ("", "known: "),
        (".x", "known: "),
        ("G.", "'G' has no ''"),
        ("bar.angle.length", "bar.angle is no vector; leave .length out"),
        ("GG.velocity.x", "did you mean 'G'"),
        ("G.velocity.z", "G.velocity has no 'z'; known: x, y, length"),
        ("bar.angle.z", "bar.angle is no vector; leave .z out"),
        ("G.velocty.z", "there is no point, link, pair or driver 'G.velocty'"),
    ],
)
def test_unknown_names_are_told_the_nearest(six_bar: ck.results.Motion, name: str, remedy: str) -> None:
    with pytest.raises(ck.errors.UnknownName, match=remedy):
        quantity(six_bar, name)


def test_beyond_the_order_solved_for_is_an_input_error(six_bar: ck.results.Motion) -> None:
    with pytest.raises(ck.errors.InvalidInput, match="order 2"):
        quantity(six_bar, "G.jerk")


def test_a_quantity_shows_itself_in_a_line(six_bar: ck.results.Motion) -> None:
    assert repr(quantity(six_bar, "G.velocity")) == "Quantity('G.velocity', v(G), 73 vectors in mm/s)"
    assert repr(quantity(six_bar, "bar").shown) == "Quantity('bar', θ(bar), 73 values in deg)"


def test_the_dimension_of_a_quantity_is_that_of_its_owner(six_bar: ck.results.Motion) -> None:
    found = {name: quantity(six_bar, name).dimension for name in ("G", "bar.angular_velocity", "slot.rate")}
    assert found == {"G": "length", "bar.angular_velocity": "angle", "slot.rate": "length"}
