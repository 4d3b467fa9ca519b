"""Things drawn as what they are, in proportion: blocks, racks, Geneva wheels, pistons, followers, guide points."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.sketch.kinematic_sketch import in_layers, window_on
from compoundkin.view.sketch.painter import Laid, Layer, Painter
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, leaves
from compoundkin.view.sketch.sketch_style import BLOCK
from compoundkin.view.sketch.symbol_shapes import is_piston
from compoundkin.view.sketch.wheel_shapes import HALF, PART, disc_line, genevas, wheel_line


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
