"""Sizes and windows of sketches: blocks no larger than what carries them, points that only define a guide."""

from __future__ import annotations

import pytest

import compoundkin as ck
from compoundkin.view.sketch.shapes import Polygon, leaves
from compoundkin.view.sketch.sketch_style import BLOCK


def slider_crank(through: complex, crank: float = 0.2) -> ck.Mechanism:
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", A=(0, 0), G=through),
        ck.link("crank", A=(0, 0), B=(crank, 0)),
        ck.link("rod", B=(0, 0), C=(0.7, 0)),
        ck.link("ram", C=(0, 0)),
        ck.slide("ram", on="frame", at="C", through="G"),
        ck.drive("crank"),
    )


def test_a_point_that_only_defines_a_guide_does_not_enlarge_the_window() -> None:
    near, far = (ck.draw(slider_crank(complex(x, 0.1)), at=0.7) for x in (-0.9, 40.0))
    assert (near.width, near.height) == (far.width, far.height)
    assert near.window.scale == pytest.approx(far.window.scale, rel=1e-9)
    assert "G" not in {getattr(shape, "text", "") for shape in leaves(near.shapes)}
    # beside what is drawn of its guide it is shown
    beside = ck.draw(slider_crank(0.6 + 0.1j), at=0.7)
    assert "G" in {getattr(shape, "text", "") for shape in leaves(beside.shapes)}


@pytest.mark.parametrize("crank", [0.02, 0.1, 0.5])
def test_a_block_is_in_proportion_to_the_links_that_carry_it(crank: float) -> None:
    rod = ck.Mechanism(
        "Oscillating guide",
        ck.link("frame", A=(0, 0), D=(-1, 0)),
        ck.link("crank", A=(0, 0), B=(crank, 0)),
        ck.link("block", B=(0, 0)),
        ck.link("bar", D=(0, 0), E=(1.5, 0)),
        ck.slide("block", on="bar", at="B", through="D"),
        ck.drive("crank"),
    )
    picture = ck.draw(rod, at=0.7)
    (block,) = [s for s in leaves(picture.shapes) if isinstance(s, Polygon) and s.style.startswith("pin ")]
    length, width = sorted((abs(block.points[1] - block.points[0]), abs(block.points[2] - block.points[1])))[::-1]
    assert length / width == pytest.approx(BLOCK[0] / BLOCK[1])
    assert 0.7 * BLOCK[0] - 1e-9 <= length <= BLOCK[0] + 1e-9
    # not longer than the crank that carries it, where that leaves room for the pin in it
    assert length <= max(crank * picture.window.scale, 0.7 * BLOCK[0]) + 1e-9
