"""Loops highlighted: closed polygons through the solved points, as many as Euler's formula asks for."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.structure import decompose, loop_count
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.shapes import CircleShape, Polyline, ShapeGroup, Text, leaves
from compoundkin.view.sketch.sketch_style import style_of
from compoundkin.view.sketch.structure_pictures import MOST, loop_polygon
from tests import catalog
from tests.support import examples

NAMES = ["six-bar", "stephenson-iii", "class-iii-six-bar", "jansen-leg", "planetary-train", "crank-shaper"]


def panels(picture: ck.results.Picture) -> list[ShapeGroup]:
    return [shape for shape in picture.shapes if isinstance(shape, ShapeGroup)]


def headings(picture: ck.results.Picture) -> list[str]:
    return [s.text for s in leaves(picture.shapes) if isinstance(s, Text) and s.style == "heading"]


@pytest.mark.parametrize("name", NAMES)
def test_there_is_a_panel_for_each_loop_that_eulers_formula_counts(name: str) -> None:
    structure = decompose(load(name))
    picture = ck.draw(structure, kind="loops")
    count = len(structure.pairs) - len(structure.mechanism.links) + 1
    assert headings(picture) == [f"loop {k}" for k in range(1, count + 1)]
    for panel, loop in zip(panels(picture), structure.loops, strict=True):
        assert panel.links == loop.links
        said = " ".join(s.text for s in leaves([panel]) if isinstance(s, Text) and s.style == "note")
        assert said == " - ".join(loop.links)


@pytest.mark.parametrize("name", NAMES)
def test_the_picture_is_well_formed_and_the_same_every_time(name: str) -> None:
    source = ck.draw(load(name), kind="loops").svg
    ET.fromstring(source)
    assert "nan" not in source
    assert ck.draw(load(name), kind="loops").svg == source


@settings(max_examples=examples(20), deadline=None)
@given(st.floats(0.0, 6.2))
def test_the_corners_are_the_solved_points_and_the_vectors_the_links(angle: float) -> None:
    """In order the points that neighbouring links share; each vector as long as its link, whose lengths are known."""
    motion = ck.solve(load("stephenson-iii"), ck.deg(100.0) + 0.1 * np.sin([angle]))
    scene = scene_of(motion, None, 0, 0)
    for loop in motion.structure.loops:
        corners = loop_polygon(scene, loop)
        assert [corner.letter for corner in corners] == [pair.letters[0] for pair in (loop.pairs[-1], *loop.pairs[:-1])]
        solved = [complex(np.ravel(motion.points[corner.letter].position)[0]) for corner in corners]
        np.testing.assert_allclose([corner.at for corner in corners], solved, atol=1e-9 * motion.size)
        points = motion.mechanism.geometry.points
        around = zip(loop.links, corners, [*corners[1:], corners[0]], strict=True)
        lengths = [abs(points[link][b.letter] - points[link][a.letter]) for link, a, b in around]
        drawn = np.abs(np.diff([corner.at for corner in (*corners, corners[0])]))
        np.testing.assert_allclose(drawn, lengths, rtol=1e-9)


def test_across_a_slide_a_vector_leads_along_its_guide() -> None:
    motion = ck.solve(load("slider-crank"), {"crank": [0.7]})
    (loop,) = motion.structure.loops
    corners = [corner.at for corner in loop_polygon(scene_of(motion, None, 0, 0), loop)]
    ways = np.diff([*corners, corners[0]])
    displacement = float(motion.pairs["stroke"].value[0])
    assert min(abs(abs(way) - abs(displacement)) for way in ways) < 1e-12
    assert abs(sum(ways)) < 1e-12


def test_the_arrows_run_around_in_the_colour_of_the_loop() -> None:
    """Each arrow begins where the one before it ends, but for the circles of the pins; and has its loop's colour."""
    picture = ck.draw(load("stephenson-iii"), kind="loops")
    for k, panel in enumerate(panels(picture), start=1):
        own = [s for s in panel.shapes if isinstance(s, Polyline) and s.style == style_of("bar", k)]
        pins = [s.centre for s in panel.shapes if isinstance(s, CircleShape)]
        assert len(own) == len(pins) == len(catalog.structure("stephenson-iii").loops[k - 1])
        for arrow, start, stop in zip(own, pins, [*pins[1:], pins[0]], strict=True):
            way = (stop - start) / abs(stop - start)
            assert np.angle((arrow.points[1] - arrow.points[0]) / way) == pytest.approx(0.0, abs=1e-9)
            assert abs(arrow.points[0] - start) < 6.0


def test_vectors_on_one_line_are_drawn_beside_it() -> None:
    """The loops of a planetary train lie on the line of the axes: there and back are two lines that do not touch."""
    for panel in panels(ck.draw(load("planetary-train"), kind="loops")):
        first, second = [s for s in panel.shapes if isinstance(s, Polyline) and s.style.startswith("bar")]
        e = (first.points[1] - first.points[0]) / abs(first.points[1] - first.points[0])
        assert abs((np.conjugate(e) * (second.points[0] - first.points[0])).imag) == pytest.approx(12.0)


def test_many_links_make_small_panels_and_not_more_of_them_than_anyone_reads() -> None:
    mechanism = ck.chains.random_mechanism(40, seed=3)
    picture = ck.draw(mechanism, kind="loops")
    count = loop_count(decompose(mechanism))
    assert len(panels(picture)) == min(count, MOST) > 15
    assert picture.width < 1100
    more = [s.text for s in leaves(picture.shapes) if isinstance(s, Text) and "more loops" in s.text]
    assert more == ([f"and {count - MOST} more loops"] if count > MOST else [])


def test_loops_of_what_cannot_be_drawn_are_shown_in_its_graph() -> None:
    links = ck.link("frame", A=0, D=4), ck.link("rod", A=0, B=1), ck.link("arm", B=0, C=3), ck.link("bar", C=0, D=3)
    loose = ck.Mechanism("Loose", *links)
    picture = ck.draw(loose, kind="loops")
    assert picture.description == "frame - rod - arm - bar"
    (panel,) = panels(picture)
    assert {s.title for s in panel.shapes if isinstance(s, ShapeGroup)} == {"frame", "rod", "arm", "bar"}
    assert len([s for s in panel.shapes if isinstance(s, Polyline) and s.style == "bar1"]) == 4


def test_an_open_chain_has_no_loops() -> None:
    crank = ck.Mechanism("Crank", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
    with pytest.raises(ck.errors.InvalidInput, match="no closed loop"):
        ck.draw(crank, kind="loops")


def test_the_command_writes_what_python_draws() -> None:
    result = CliRunner().invoke(cli, ["draw", "six-bar", "--structure", "loops"])
    assert result.exit_code == 0
    assert result.stdout == ck.draw(load("six-bar"), kind="loops").svg
