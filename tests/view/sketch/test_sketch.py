"""Sketches: shapes where the solver puts points, the same source every time, labels that do not overlap."""

from __future__ import annotations

import warnings
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.files import load
from compoundkin.model.elements import Link
from compoundkin.view.notebook import MOST_LINKS
from compoundkin.view.sketch.kinematic_sketch import in_layers, window_on
from compoundkin.view.sketch.labels import ROOM, text_half
from compoundkin.view.sketch.painter import Laid, Layer, Painter
from compoundkin.view.sketch.picture import NARROW
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.shapes import ArcShape, CircleShape, Polygon, Polyline, ShapeGroup, Text, leaves
from compoundkin.view.sketch.sketch_style import BLOCK, LETTER, NUMBER, SMALL
from compoundkin.view.sketch.symbol_shapes import is_piston
from compoundkin.view.sketch.wheel_shapes import HALF, PART, disc_line, genevas, wheel_line
from tests import catalog

GOLDEN = Path(__file__).parent / "golden"
SIZES = {"letter": LETTER, "number": SMALL, "centre-name": SMALL, "code": SMALL}


@cache
def drawn(name: str) -> ck.results.Picture:
    return ck.draw(load(name))


def four_bar() -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1.5, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank"),
        unit="m",
    )


def of(picture: ck.results.Picture, style: str) -> list[object]:
    return [shape for shape in leaves(picture.shapes) if style in shape.style.split()]


def pairwise_around(shape: Polygon) -> list[tuple[complex, complex]]:
    return list(zip(shape.points, (*shape.points[1:], shape.points[0]), strict=True))


# --- what is drawn is where it is ------------------------------------------------------------------------


def test_pins_are_where_the_solver_puts_them() -> None:
    motion = ck.solve(four_bar(), {"crank": [0.3, 0.9, 1.7]})
    picture = ck.draw(motion, pose=1)
    assert picture.window is not None
    circles = [shape for shape in of(picture, "pin") if isinstance(shape, CircleShape) and shape.radius < 5]
    for letter in "ABCD":
        place = picture.window.at(complex(motion.points[letter].position[1]))
        assert min(abs(circle.centre - place) for circle in circles) < 1e-9
    assert len(circles) == 4


def test_the_crank_is_a_bar_at_its_angle_and_the_coupler_a_plate() -> None:
    picture = ck.draw(four_bar(), at=0.9)
    (crank,) = [shape for shape in of(picture, "bar0") if isinstance(shape, Polyline)]
    way = crank.points[1] - crank.points[0]
    # y points down on paper
    assert abs(np.angle(np.conjugate(way) / np.exp(0.9j))) % np.pi == pytest.approx(0.0, abs=1e-9)
    (coupler,) = [shape for shape in of(picture, "plate1") if isinstance(shape, Polygon)]
    sides = sorted(abs(a - b) / picture.window.scale for a, b in pairwise_around(coupler))
    assert sides == pytest.approx(sorted([3.0, abs(1.5 + 1j), abs(1.5 + 1j)]), rel=1e-9)


@pytest.mark.parametrize("mode", [-1, 1])
def test_a_value_between_poses_is_solved_for_in_the_same_mode(mode: int) -> None:
    picture = ck.draw(ck.solve(four_bar(), modes={"coupler": mode}), at=ck.deg(12.34))
    exact = ck.solve(four_bar(), {"crank": ck.deg(12.34)}, modes={"coupler": mode}).points["C"].position
    place = picture.window.at(complex(np.ravel(exact)[0]))
    assert min(abs(shape.centre - place) for shape in of(picture, "pin") if isinstance(shape, CircleShape)) < 1e-6


def test_the_driver_turns_as_its_speed_says() -> None:
    forward, backward = (of(ck.draw(ck.solve(four_bar(), speed=s), at=1.0), "drive") for s in (2.0, -2.0))
    assert [a.sweep for a in forward if isinstance(a, ArcShape)] == [False]
    assert [a.sweep for a in backward if isinstance(a, ArcShape)] == [True]


def test_a_path_is_that_of_the_point_and_ghosts_are_other_poses() -> None:
    motion = ck.solve(four_bar())
    picture = ck.draw(motion, paths="P", ghosts=4)
    (path,) = of(picture, "path")
    places = picture.window.at(np.asarray(motion.points["P"].position))
    corners = np.array(path.points)
    assert max(min(abs(corners - place)) for place in places) < 15
    assert abs(corners.real.max() - places.real.max()) < 0.5
    ghosts = [shape for shape in picture.shapes if isinstance(shape, ShapeGroup) and shape.style == "ghost"]
    assert len(ghosts) == 4


def test_a_path_is_broken_where_poses_cannot_be_assembled() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(load("triple-rocker"), ck.deg(np.arange(0, 361, 2.0)))
    runs = np.count_nonzero(np.diff(np.concatenate([[0], motion.assembled.astype(int), [0]])) == 1)
    assert runs > 1
    assert len(of(ck.draw(motion, paths="C"), "path")) == runs


def test_vectors_have_one_scale_and_the_directions_of_the_solver() -> None:
    motion = ck.solve(four_bar(), {"crank": [1.0]}, speed=2.0)
    picture = ck.draw(motion, vectors="velocity")
    heads = [shape.points[0] for shape in of(picture, "velocity-head")]
    ratios = []
    for letter in "BCP":
        start = picture.window.at(complex(motion.points[letter].position[0]))
        wanted = np.conjugate(complex(motion.points[letter].velocity[0]))
        tip = min(heads, key=lambda head, start=start, wanted=wanted: abs(np.angle((head - start) / wanted)))
        assert np.angle((tip - start) / wanted) == pytest.approx(0.0, abs=1e-9)
        ratios.append(abs(tip - start) / abs(wanted))
    assert ratios == pytest.approx([ratios[0]] * 3, rel=1e-9)
    (note,) = [shape for shape in of(picture, "note") if "velocity" in shape.text]
    amount = float(note.text.split()[1])
    shown = [s for s in of(picture, "velocity-head") if abs(s.points[0].imag - note.at.imag) < 1]
    assert abs(shown[0].points[0].real - 16.0) == pytest.approx(amount * ratios[0], rel=1e-6)
    assert note.text.endswith("m/s")


def test_the_velocity_polygon_has_images_similar_to_the_links() -> None:
    motion = ck.solve(four_bar(), {"crank": [1.0]}, speed=2.0)
    picture = ck.draw(motion, kind="polygon")
    (image,) = [shape for shape in of(picture, "plate1") if isinstance(shape, Polygon)]
    sides = np.sort([abs(a - b) for a, b in pairwise_around(image)])
    assert sides / sides[-1] == pytest.approx(np.array([abs(1.5 + 1j), abs(1.5 + 1j), 3.0]) / 3.0, rel=1e-9)


@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
@pytest.mark.parametrize("name", ["crank-rocker", "disc-cam-offset-roller", "six-bar", "planetary-train"])
def test_the_legend_of_a_polygon_is_on_its_picture(name: str, kind: str) -> None:
    picture = ck.draw(load(name), kind="polygon", vectors=kind)
    notes = of(picture, "note")
    assert len(notes) == 2
    for note in notes:
        assert 0 < note.at.real < picture.width
        assert note.at.real + len(note.text) * SMALL * NARROW <= picture.width
    assert picture.window.width == picture.width
    assert picture.window.holds(complex(picture.window.at(0j)), room=10.0)


def test_instant_centres_of_a_four_bar_lie_on_their_lines() -> None:
    motion = ck.solve(four_bar(), {"crank": [0.8]})
    picture = ck.draw(motion, centres=True)
    centre = ck.instant_centres(motion)["frame", "coupler"].point[0]
    place = picture.window.at(complex(centre))
    dots = [shape.centre for shape in of(picture, "centre")]
    named = {shape.text for shape in of(picture, "centre-name")}
    on_paper = picture.window.holds(complex(place))
    assert on_paper == any(abs(dot - place) < 0.5 for dot in dots)
    assert {"12", "23", "34", "14"} <= {name for text in named for name in text.split()}


def test_one_design_of_several_is_shown() -> None:
    lengths = np.array([[3.0], [3.4]])
    words = [ck.link("coupler", B=0, C=lengths), ck.link("rocker", D=0, C=3), ck.drive("crank")]
    both = ck.Mechanism("Two", ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), *words)
    motion = ck.solve(both, {"crank": ck.deg([20, 40, 60])})
    for design in range(2):
        picture = ck.draw(motion, at=ck.deg(40), design=design, paths="C", ghosts=2, vectors="velocity", centres=True)
        bars = [abs(s.points[1] - s.points[0]) / picture.window.scale for s in of(picture, "bar1")]
        assert any(abs(bar - lengths[design, 0]) < 1e-9 for bar in bars)
        place = picture.window.at(complex(motion.points["C"].position[design, 1]))
        assert min(abs(s.centre - place) for s in of(picture, "pin") if isinstance(s, CircleShape)) < 1e-9


# --- the source ------------------------------------------------------------------------------------------


@catalog.each(catalog.THIRD)
def test_the_sketch_is_small_well_formed_on_its_paper_and_the_same_every_time(name: str) -> None:
    picture = drawn(name)
    source = picture.svg
    root = ET.fromstring(source)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert root.find("{http://www.w3.org/2000/svg}title") is not None
    assert "nan" not in source.lower()
    assert "inf" not in source.replace("at infinity", "").lower()
    assert len(source) < 20_000
    assert ck.draw(load(name)).svg == source
    points = np.array([point for shape in picture.shapes for point in _points(shape)])
    assert points.real.min() >= -1e-6
    assert points.real.max() <= picture.width + 1e-6
    assert points.imag.min() >= -1e-6
    assert points.imag.max() <= picture.height + 1e-6
    assert not overlaps(picture)


def _points(shape: object) -> list[complex]:
    if isinstance(shape, ShapeGroup):
        return [point for inner in shape.shapes for point in _points(inner)]
    if isinstance(shape, CircleShape):
        return [shape.centre]
    if isinstance(shape, Text):
        return [shape.at]
    return list(getattr(shape, "points", ()))


@given(st.floats(0.0, 6.28))
def test_labels_do_not_overlap_at_any_pose(angle: float) -> None:
    assert not overlaps(ck.draw(load("jansen-leg"), at=angle, centres=False))


def overlaps(picture: ck.results.Picture) -> list[tuple[str, str]]:
    boxes = []
    for shape in leaves(picture.shapes):
        if isinstance(shape, Text) and shape.style in ("letter", "number"):
            half = complex(NUMBER, NUMBER) if shape.style == "number" else text_half(shape.text, SIZES[shape.style])
            boxes.append((shape.text, shape.at, half))
    found = []
    for k, (one, a, p) in enumerate(boxes):
        for two, b, q in boxes[:k]:
            gap = a - b
            if abs(gap.real) < p.real + q.real - ROOM and abs(gap.imag) < p.imag + q.imag - ROOM:
                found.append((one, two))
    return found


@pytest.mark.parametrize("name", sorted(path.stem for path in GOLDEN.glob("*.svg")))
def test_pictures_that_were_looked_at_stay_as_they_are(name: str) -> None:
    """After a change that is meant, look at the new ones and write them: python -m tests.view.sketch.goldens."""
    assert drawn(name).svg == (GOLDEN / f"{name}.svg").read_text(encoding="utf-8")


# --- bad input -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "where"),
    [
        ({"at": 1.0, "pose": 0}, "pose"),
        ({"pose": 999}, "pose"),
        ({"pose": True}, "pose"),
        ({"design": 3}, "design"),
        ({"ghosts": -1}, "ghosts"),
        ({"ghosts": 2.5}, "ghosts"),
        ({"vectors": "speed"}, "vectors"),
        ({"labels": "pins"}, "labels"),
        ({"size": 0}, "size"),
        ({"size": "big"}, "size"),
        ({"at": [1.0, 2.0]}, "at.crank"),
        ({"at": float("nan")}, "at.crank"),
    ],
)
def test_wrong_input_is_told(words: dict[str, object], where: str) -> None:
    with pytest.raises(ck.errors.InvalidInput) as caught:
        ck.draw(four_bar(), **words)
    assert caught.value.problems[0].where == where


def test_unknown_names_are_told() -> None:
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'crank'"):
        ck.draw(four_bar(), at={"crnk": 1.0})
    with pytest.raises(ck.errors.UnknownName, match="there is no such point"):
        ck.draw(four_bar(), paths="Q")
    with pytest.raises(ck.errors.InvalidInput, match="no motion or mechanism"):
        ck.draw("six-bar")


def test_a_pose_that_does_not_close_is_told() -> None:
    with pytest.raises(ck.errors.NotAssembled):
        ck.draw(load("triple-rocker"), at=ck.deg(170))


def test_a_mechanism_that_cannot_be_solved_is_shown_as_drawn() -> None:
    words = [
        ck.link("frame", "A", "D"),
        ck.link("rod", "A", "B"),
        ck.link("arm", "B", "C"),
        ck.drawn(A=0, D=4, B=1j, C=2),
    ]
    picture = ck.draw(ck.Mechanism("Open", *words))
    assert len([s for s in of(picture, "ink") if isinstance(s, CircleShape)]) == 2
    loose = ck.Mechanism("Loose", ck.link("frame", A=0), ck.link("rod", A=0, B=1), ck.link("arm", B=0, C=1))
    with pytest.raises(ck.errors.InvalidInput, match="cannot be solved"):
        ck.draw(loose)


def test_motions_and_mechanisms_show_themselves() -> None:
    mechanism = four_bar()
    assert mechanism._repr_svg_().startswith("<svg")
    assert ck.solve(mechanism)._repr_svg_().startswith("<svg")


def test_what_has_no_picture_shows_its_text_in_notebooks() -> None:
    loose = ck.Mechanism("Loose", ck.link("frame", A=0), ck.link("rod", A=0, B=1), ck.link("arm", B=0, C=1))
    assert loose._repr_svg_() is None
    many = [ck.link(f"bar {k}", **{f"P{k}": 0, f"P{k + 1}": 1}) for k in range(MOST_LINKS)]
    assert ck.Mechanism("Long chain", ck.link("frame", P0=0), *many)._repr_svg_() is None


def test_what_is_shown_as_drawn_has_no_rates_and_no_centres() -> None:
    links = ck.link("frame", "A", "D"), ck.link("rod", "A", "B"), ck.link("arm", "B", "C")
    still = ck.Mechanism("Open", *links, ck.drawn(A=0, D=4, B=1j, C=2))
    for words in ({"vectors": "velocity"}, {"centres": True}):
        with pytest.raises(ck.errors.InvalidInput, match="has no motion"):
            ck.draw(still, **words)
    with pytest.raises(ck.errors.InvalidInput, match="there is only 0"):
        ck.draw(ck.solve(four_bar()), design=1)
    with pytest.raises(ck.errors.InvalidInput, match="nothing moves"):
        ck.draw(ck.solve(four_bar(), speed=0.0), kind="polygon")
    assert ck.draw(ck.solve(four_bar(), speed=0.0), vectors="velocity").svg.count("velocity") == 0


def test_a_slide_without_values_is_drawn_where_it_is_asked_for() -> None:
    frame, block = ck.link("frame", O=(0, 0)), ck.link("block", P=(0, 0))
    slide = ck.slide("block", on="frame", through="O", turn=0.0)
    press = ck.Mechanism("Press", frame, block, slide, ck.drive("block"))
    assert "block at 3" in ck.draw(press, at=3.0).description
    with pytest.raises(ck.errors.InvalidInput):
        ck.draw(press)


def test_grooves_are_as_long_as_the_way_of_their_pins() -> None:
    links = ck.link("frame", A=(0, 0), C=(60, 10)), ck.link("crank", A=(0, 0), B=(15, 0)), ck.link("rod", B=0, P=50)
    arc = ck.arc("rod", on="frame", at="P", centre_at="C", radius=30)
    motion = ck.solve(ck.Mechanism("ArcShape", *links, arc, ck.drive("crank"), ck.drawn(P=(60, 40), B=(15, 0))))
    picture = ck.draw(motion)
    (groove,) = of(picture, "frame-track")
    middle = picture.window.at(60 + 10j)
    way = np.angle(np.asarray(motion.points["P"].position) - (60 + 10j))
    ends = np.angle(np.conjugate(np.array(groove.points)[[0, -1]] - middle))
    assert sorted(ends) == pytest.approx([way.min(), way.max()], abs=1e-9)
    assert np.abs(np.array(groove.points) - middle) == pytest.approx(30 * picture.window.scale, rel=1e-9)


def test_a_cam_that_is_touched_from_inside_is_a_ring() -> None:
    links = ck.link("frame", A=(0, 0), G=(10, 0)), ck.link("ring", A=(0, 0)), ck.link("follower", P=(0, 0))
    guide = ck.slide("follower", on="frame", through="G", angle=np.pi / 2, turn=0.0)
    cam = ck.cam("follower", on="ring", at="P", profile=ck.profiles.disc(50, (8, 0)), radius=6, inside=True)
    mechanism = ck.Mechanism("Ring", *links, guide, cam, ck.drive("ring"), ck.drawn(P=(10, 40)))
    rims = [s for s in of(ck.draw(mechanism), "line0") if isinstance(s, Polygon)]
    assert len(rims) == 2
    assert not [s for s in of(ck.draw(mechanism), "plate0") if isinstance(s, Polygon)]


@pytest.mark.parametrize("frame", [ck.link("frame", A=0), ck.link("frame", A=0, B=1), ck.link("frame", "A")])
def test_a_frame_alone_is_shown(frame: Link) -> None:
    """There is nothing to be drawn of it, and no centre, which is no reason to end with a traceback."""
    alone = ck.Mechanism("Frame", frame)
    assert "Frame" in alone._repr_html_()
    for kind in ("groups", "graph"):
        assert ck.draw(alone, kind=kind).svg.startswith("<svg")
    with pytest.raises(ck.errors.NotDetermined):
        ck.draw(alone, kind="circle")
    if frame.points["A"] is not None:
        assert ck.draw(alone).svg.startswith("<svg")
        assert ck.animate(alone).svg.startswith("<svg")
        with pytest.raises(ck.errors.NotDetermined):
            ck.instant_centres(ck.solve(alone))
        assert "Frame" in ck.report(alone).html()


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
    assert near.window is not None
    assert far.window is not None
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
    assert picture.window is not None
    # not longer than the crank that carries it, where that leaves room for the pin in it
    assert length <= max(crank * picture.window.scale, 0.7 * BLOCK[0]) + 1e-9


# --- things drawn as what they are -----------------------------------------------------------------------


def laid_of(name: str) -> list[Laid]:
    scene = scene_of(load(name), None, None, 0)
    return in_layers(Painter(scene, window_on(scene)))


def test_a_rack_is_behind_its_pinion_and_slides_without_a_block() -> None:
    laid = laid_of("rack-and-pinion-steering")
    last_of_rack = max(k for k, one in enumerate(laid) if one.link == "bar" and one.layer < Layer.PIN)
    wheel = next(k for k, one in enumerate(laid) if one.link == "pinion" and isinstance(one.shape, CircleShape))
    assert last_of_rack < wheel
    assert not [one for one in laid if one.layer == Layer.BLOCK]


@pytest.mark.parametrize("slots", [3, 4, 6, 8, 60])
def test_a_geneva_wheel_has_the_slots_and_arcs_that_its_dimensions_tell(slots: int) -> None:
    crank, wheel = np.sin(np.pi / slots), np.cos(np.pi / slots)
    mechanism = ck.Mechanism(
        "Geneva",
        ck.link("frame", O=(0, 0), C=(1, 0)),
        ck.link("crank", O=(0, 0), A=(crank, 0)),
        ck.link("wheel", C=(0, 0), E=(-wheel, 0)),
        ck.slot("crank", on="wheel", at="A", through="C", angle=np.pi, reach=(0.9 * (1 - crank), "E")),
        ck.drive("crank", values=np.linspace(-0.9, 0.9, 5) * (np.pi / 2 - np.pi / slots)),
        ck.drawn(A=(crank, 0), E=(1 - wheel, 0)),
    )
    scene = scene_of(mechanism, None, 2, 0)
    (found,) = genevas(scene)
    assert found.slots == slots
    scale = 300.0
    line, around = wheel_line(found, scale), 2 * np.pi / slots
    # the same after the turn of one slot, and round about as wide as its mouths say
    turned = line * np.exp(1j * around)
    assert max(min(abs(turned - p)) for p in line) < 1e-9
    assert abs(line).max() == pytest.approx(wheel, rel=1e-9)
    # where the crank locks it, its disc lies in an arc of the wheel and does not cut it
    centres = np.exp(1j * (np.pi + around * (np.arange(slots) + 0.5)))
    radius = abs(disc_line(found, scale)).max()
    assert abs(line[None] - centres[:, None]).min(axis=1) == pytest.approx(np.full(slots, radius), rel=1e-9)
    # the pin is in a slot at every pose: no edge of the wheel is nearer to it than half a slot's width
    motion = ck.solve(mechanism)
    pin = motion.points["A"].position - 1.0
    own = pin * np.exp(-1j * motion.links["wheel"].angle)
    assert min(abs(line - p).min() for p in own) * scale > 0.9 * min(HALF, PART * crank * scale)


def test_pistons_are_what_is_called_so_and_never_leave_their_bores_on_the_side_of_the_head() -> None:
    for name, count in (
        ("v8-engine", 8),
        ("slider-crank", 1),
        ("atkinson-engine", 1),
        ("hand-pump", 1),
        ("toggle-press", 0),
    ):
        motion = ck.solve(load(name))
        assert sum(map(is_piston, scene_of(motion, None, None, 0).pair_marks)) == count
    for sense, mechanism in ((1, "slider-crank"), (-1, "slider-crank-crossed")):
        motion = ck.solve(load(mechanism))
        for pose in (0, 17, 36):
            picture = ck.draw(motion, pose=pose)
            (body,) = [s for s in leaves(picture.shapes) if isinstance(s, Polygon) and s.style.startswith("pin ")]
            bore = next(s for s in leaves(picture.shapes) if isinstance(s, Polyline) and len(s.points) == 4)
            crown, head = (max(sense * p.real for p in s.points) for s in (body, bore))
            assert head > crown + 5
            assert max(p.imag for p in bore.points) > max(p.imag for p in body.points)


def test_a_sliding_follower_has_a_stem_that_stays_in_its_bush() -> None:
    motion = ck.solve(load("disc-cam-roller-program"))
    for pose in (0, 20, 45):
        picture = ck.draw(motion, pose=pose)
        (rod,) = [s for s in leaves(picture.shapes) if isinstance(s, Polyline) and s.style == "bar1"]
        bush = [
            s for s in leaves(picture.shapes) if isinstance(s, Polyline) and s.style == "frame" and len(s.points) == 2
        ]
        walls = [p for s in bush for p in s.points if abs(p.real - rod.points[0].real) < 10]
        assert len(walls) == 4
        # y points down on paper
        low, high = (pick(p.imag for p in rod.points) for pick in (max, min))
        assert high < min(p.imag for p in walls) < max(p.imag for p in walls) < low
    assert not [s for s in leaves(picture.shapes) if isinstance(s, Polygon) and s.style.startswith("pin ")]


def test_a_knife_edge_points_at_its_profile() -> None:
    disc = ck.profiles.disc(30.0, 12 + 0j)
    picture = ck.draw(
        ck.Mechanism(
            "Knife edge",
            ck.link("frame", A=(0, 0)),
            ck.link("cam", A=(0, 0), M=(12, 0)),
            ck.link("follower", P=(0, 0)),
            ck.slide("follower", on="frame", at="P", through="A", angle=np.pi / 2, offset=-5.0),
            ck.cam("follower", on="cam", at="P", profile=disc),
            ck.drive("cam", values=ck.deg(np.arange(0, 360, 20))),
            ck.drawn(P=(5, 30)),
        )
    )
    edges = [s for s in leaves(picture.shapes) if isinstance(s, Polygon) and len(s.points) == 3]
    (edge,) = [s for s in edges if s.style.startswith("pin ")]
    profile = next(s for s in leaves(picture.shapes) if isinstance(s, Polygon) and s.style == "plate0")
    away = [min(abs(p - q) for q in profile.points) for p in edge.points]
    assert away[0] == min(away)
    assert edge.points[0].imag > max(p.imag for p in edge.points[1:])


def test_an_angle_that_is_zero_but_for_rounding_is_zero_below_a_sketch() -> None:
    picture = ck.draw(ck.solve(slider_crank(0.6 + 0.1j), {"crank": [-7e-15]}))
    assert any(getattr(s, "text", "").startswith("crank at 0°") for s in leaves(picture.shapes))
