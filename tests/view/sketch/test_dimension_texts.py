"""Dimensions of sketches: the right numbers at any scale, off each other."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.sketch.labels import WIDE
from compoundkin.view.sketch.shapes import Text, leaves
from compoundkin.view.sketch.sketch_style import SMALL
from tests.catalog import mechanism
from tests.scaled import scaled


def numbers(picture: ck.results.Picture) -> list[Text]:
    return [s for s in leaves(picture.shapes) if isinstance(s, Text) and s.style == "dimension-text"]


@pytest.mark.parametrize(
    ("name", "texts"),
    [
        ("four-bar-norton", {"40 mm", "120 mm", "80 mm", "100 mm"}),
        ("slider-crank-offset", {"40 mm", "120 mm", "20 mm"}),
        ("v-engine", {"2.125 in", "7.44 in", "67.5°"}),
        ("belt-coupled-cranks", {"0.12 m", "0.18 m", "0.2 m", "0.25 m", "20°", "r = 0.06 m", "r = 0.03 m"}),
    ],
)
def test_the_numbers_are_those_of_the_books(name: str, texts: set[str]) -> None:
    assert {shape.text for shape in numbers(ck.draw(mechanism(name), dimensions=True))} == texts


def test_nothing_but_the_numbers_changes_with_the_scale() -> None:
    first = ck.draw(mechanism("six-bar"), dimensions=True)
    large = ck.draw(scaled(mechanism("six-bar"), 1000.0), dimensions=True)
    assert [s.text for s in numbers(large)] == [s.text.replace(" mm", "000") for s in numbers(first)]
    assert large.width == pytest.approx(first.width, abs=60.0)


@pytest.mark.parametrize(("factor", "power"), [(1e-8, "⁻⁷"), (1e10, "¹¹")])
def test_numbers_far_from_one_have_powers_of_ten(factor: float, power: str) -> None:
    picture = ck.draw(scaled(mechanism("four-bar-norton"), factor), dimensions=True)
    assert {s.text for s in numbers(picture)} == {f"{d}·10{power}" for d in ("4", "8")} | {
        f"{d}·10{({'⁻⁷': '⁻⁶', '¹¹': '¹²'})[power]}" for d in ("1", "1.2")
    }


@pytest.mark.parametrize("name", ["six-bar", "3-rrr", "andrews-squeezer", "jansen-leg", "roberts-cognates", "watt-ii"])
def test_numbers_are_off_each_other_and_on_the_picture(name: str) -> None:
    picture = ck.draw(mechanism(name), dimensions=True)
    covers = []
    for shape in numbers(picture):
        half = len(shape.text) * WIDE * SMALL / 2.0
        along = np.exp(1j * np.deg2rad(shape.angle)) * np.linspace(-half + 4.0, half - 4.0, 9)
        covers.append(shape.at + along)
        assert picture.window.holds(shape.at, 4.0)
    for k, one in enumerate(covers):
        for other in covers[:k]:
            assert np.abs(np.subtract.outer(one, other)).min() > 7.0


def test_plates_have_two_sides_and_an_angle() -> None:
    plate = mechanism("six-bar").geometry.points["plate"]
    d, a, c = (complex(plate[letter]) for letter in "DAC")
    texts = {shape.text for shape in numbers(ck.draw(mechanism("six-bar"), dimensions=True))}
    assert {f"{abs(a - d):.4g} mm", f"{abs(c - d):.4g} mm"} <= texts
    assert f"{abs(np.rad2deg(np.angle((c - d) / (a - d)))):.4g}°" in texts
