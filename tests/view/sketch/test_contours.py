"""Outlines in sketches: as wide as they are, behind all else, one edge around all of a link."""

from __future__ import annotations

import compoundkin as ck
from compoundkin.view.sketch.shapes import Band, CircleShape, leaves
from compoundkin.view.sketch.svg import elements

BARE = ck.Mechanism(
    "Crank", ck.link("frame", A=(0, 0)), ck.link("crank", A=(0, 0), B=(3, 4)), ck.drive("crank", values=0.0)
)
CRANK = BARE.replace(ck.outline("crank", 2), ck.outline("frame", polygon=[(-2, -2), (2, -2), (0, -4)], layer=1))


def test_outlines_are_drawn_in_true_size() -> None:
    picture = ck.draw(CRANK)
    scale = picture.window.scale
    bands = [shape for shape in leaves(picture.shapes) if isinstance(shape, Band)]
    bar = next(band for band in bands if band.style == "area-bar0")
    assert abs(bar.width - 2.0 * scale) < 1e-9
    assert abs(abs(bar.points[1] - bar.points[0]) - 5.0 * scale) < 1e-9
    assert [band.style for band in bands] == ["contour-bar0", "area-bar0", "contour0", "area0"]
    low, high = bar.points[0] - bar.width / 2.0 * (1 + 1j), bar.points[1] + bar.width / 2.0 * (1 + 1j)
    assert 0.0 < low.real < picture.width
    assert 0.0 < high.imag < picture.height


def test_outlines_are_behind_all_else_and_only_where_they_are_written() -> None:
    lines = [*elements(ck.draw(CRANK).shapes)]
    kinds = [next((kind for kind in ("ck-area", "ck-bar", "ck-pin") if kind in line), "") for line in lines]
    assert kinds.index("ck-bar") > len(kinds) - 1 - kinds[::-1].index("ck-area")
    assert "ck-area" not in ck.draw(BARE).svg
    assert not [shape for shape in leaves(ck.draw(BARE).shapes) if isinstance(shape, Band)]
    disc = ck.draw(BARE.replace(ck.outline("crank", at="B", radius=1)))
    assert any(isinstance(one, CircleShape) and one.style == "area0" for one in leaves(disc.shapes))


def test_animations_move_them_with_their_links() -> None:
    turning = CRANK.replace(ck.drive("crank", values=ck.deg(range(0, 361, 30))))
    svg = ck.animate(turning).svg
    assert svg.count("ck-area-bar0") >= 1
