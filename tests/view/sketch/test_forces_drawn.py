"""Forces on pictures: arrows to one scale, closed polygons, free bodies, names, and what it says of wrong wishes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, UnknownName
from compoundkin.view.sketch.force_arrows import acting_forces, force_arrow, force_scale, moment_arc
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.shapes import ArcShape, Polygon, Polyline, Shape, ShapeGroup, Text, leaves
from compoundkin.view.sketch.svg import markup, pixels, svg
from tests.view.loaded import MASS, REACH, SPEED, UNITS, crank_forces, six_bar_forces


def _texts(shapes: tuple[Shape, ...]) -> list[str]:
    return [shape.text for shape in leaves(shapes) if isinstance(shape, Text)]


def test_what_acts_on_each_link_is_in_equilibrium_and_as_in_the_closed_form() -> None:
    forces = six_bar_forces()
    scene = scene_of(forces.motion, np.deg2rad(37.5), None, 0)  # between two poses: found anew there
    for link, own in acting_forces(forces, scene).items():
        if link != "frame":
            assert abs(sum(one.force for one in own)) < 1e-9
            assert abs(sum(one.moment + (np.conjugate(one.at) * one.force).imag for one in own)) < 1e-7
    one = crank_forces()
    own = {one.name: one for one in acting_forces(one, scene_of(one.motion, 0.0, None, 0))["crank"]}
    assert own["m₂g"].force == pytest.approx(-9.81j * MASS)
    assert own["m₂g"].at == pytest.approx(REACH)
    assert own["−m₂a₂"].force == pytest.approx(MASS * SPEED**2 * REACH / 1000.0)
    assert own["F₁₂"].force == pytest.approx(9.81j * MASS - MASS * SPEED**2 * REACH / 1000.0)
    assert own["P₂"].moment == pytest.approx(9.81 * MASS * REACH)


def test_arrows_are_to_scale_and_press_from_outside() -> None:
    forces = six_bar_forces()
    scene = scene_of(forces.motion, np.deg2rad(35), None, 0)
    pushed = next(one for one in acting_forces(forces, scene)["bar"] if one.name == "force")
    scale = force_scale([pushed], 100.0, "N")
    assert scale is not None
    assert (scale.amount, scale.text) == (5.0, "5 N")
    away, into = force_arrow(pushed, 0j, scale), force_arrow(pushed, 0j, scale, complex(np.conjugate(pushed.force)) * 9)
    for arrow in (away, into):
        assert abs(arrow.stop - arrow.start) == pytest.approx(100.0)
        assert np.angle(np.conjugate(arrow.stop - arrow.start)) == pytest.approx(np.angle(-3 - 5j))
    assert abs(away.start) < abs(away.stop)
    assert abs(into.stop) < abs(into.start)


@pytest.mark.parametrize("sign", [1, -1])
def test_arcs_turn_as_the_moments_do(sign: int) -> None:
    found = next(iter(acting_forces(crank_forces(), scene_of(crank_forces().motion, 0.0, None, 0))["crank"]))
    turned = moment_arc(type(found)(**{**vars(found), "moment": sign * 2.0}), 0j, 20.0, 1 + 0j)
    arc, head = (next(s for s in leaves(turned) if isinstance(s, kind)) for kind in (ArcShape, Polygon))
    # y points downward: counterclockwise goes against the sweep of SVG
    assert arc.sweep is (sign < 0)
    way = (np.conjugate(arc.start) * (arc.stop - arc.start)).imag
    assert np.sign(way) == -sign
    assert abs(abs(head.points[0]) - 20.0) < 1e-9


def test_polygons_close() -> None:
    picture = ck.draw(six_bar_forces(), at=ck.deg(35), kind="force-polygon", link="plate")
    groups = [s for s in picture.shapes if isinstance(s, ShapeGroup)]
    arrows = [s for g in groups for s in g.shapes if isinstance(s, ShapeGroup) and s.title]
    lines = [shape for one in arrows for shape in one.shapes if isinstance(shape, Polyline | Polygon)]
    starts = [shape.points[0] for shape in lines if isinstance(shape, Polyline)]
    tips = [shape.points[0] for shape in lines if isinstance(shape, Polygon)]
    assert len(starts) == len(tips) == 5
    assert np.allclose(starts, [tips[-1], *tips[:-1]])


def test_free_bodies_name_everything() -> None:
    forces = six_bar_forces()
    texts = _texts(ck.draw(forces, at=ck.deg(35), kind="free-bodies").shapes)
    assert {"2 crank", "3 plate", "4 rocker", "5 bar", "6 block"} <= set(texts)
    assert any(text.startswith("F₅₆") for text in texts)
    assert any(text.startswith("T₂") for text in texts)
    assert any("arcs not to scale" in text for text in texts)
    assert ck.draw(forces.motion, at=ck.deg(35), kind="free-bodies", link="bar").title.endswith("free body")
    assert ck.draw(forces, at=ck.deg(35)).title.endswith("forces")
    assert ck.draw(forces, kind="graph").title == ck.draw(forces.motion, kind="graph").title


def test_small_links_are_enlarged_and_small_forces_have_their_own_scale() -> None:
    """A jaw crusher at rest of its jaw: an eccentric of 20 mm beside a jaw of 1.2 m, toggles of 600 N beside 9 kN."""
    forces = ck.force_analysis(ck.solve(ck.load("jaw-crusher-loaded")))
    picture = ck.draw(forces, kind="free-bodies")
    texts = _texts(picture.shapes)
    assert texts.count("10 times as large") == 1
    assert {"500 N", "1000 N", "5000 N"} <= set(texts)
    wheel = _texts(ck.draw(ck.load("geared-press"), kind="free-bodies").shapes)
    assert not [text for text in wheel if "times as large" in text], "a large wheel about near points"
    arrows = {one.title: one for one in leaves_of_groups(picture.shapes) if "weight" in one.title}
    toggle, jaw = (next(a for t, a in arrows.items() if name in t) for name in ("rear-toggle", "jaw"))
    lengths = [abs(one.shapes[0].points[0] - one.shapes[0].points[-1]) for one in (toggle, jaw)]
    assert lengths[0] > 0.4 * lengths[1], "588.6 N and 8829 N"


def test_every_force_has_an_arrow_or_a_note() -> None:
    forces = ck.force_analysis(ck.solve(ck.load("jaw-crusher-loaded")))
    texts = _texts(ck.draw(forces, pose=32).shapes)
    notes = " ".join(text for text in texts if "not drawn" in text or " · " in text)
    for name, value in (("m₂g", "1766"), ("m₃g", "4120"), ("m₄g", "588.6")):
        assert name in texts or f"{name} {value}" in notes, name


def leaves_of_groups(shapes: Sequence[Shape]) -> Iterator[ShapeGroup]:
    """The groups, each after the one that it is in."""
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield shape
            yield from leaves_of_groups(shape.shapes)


def test_a_pin_of_three_links_acts_on_each() -> None:
    bare = ck.load("toggle-press")
    press = ck.Mechanism("Press", *bare.items, ck.force("slider", (-10000, 0), at="D"), units=UNITS)
    forces = ck.force_analysis(ck.solve(press))
    bare = ck.load("planetary-train")
    train = ck.Mechanism("Train", *bare.items, ck.torque("sun", 2000.0), units=UNITS)
    for one in (forces, ck.force_analysis(ck.solve(train))):
        scene = scene_of(one.motion, None, 3, 0)
        for link, own in acting_forces(one, scene).items():
            if link != "frame":
                assert abs(sum(f.moment + (np.conjugate(f.at) * f.force).imag for f in own)) < 1e-6
    texts = _texts(ck.draw(forces, at=ck.deg(45)).shapes)
    assert {"F₃(B)", "F₄(B)", "F₅(B)"} <= set(texts)


def test_wrong_wishes() -> None:
    with pytest.raises(UnknownName, match="plate"):
        ck.draw(six_bar_forces(), kind="free-bodies", link="plat")
    with pytest.raises(InvalidInput, match="units"):
        ck.draw(ck.load("six-bar"), kind="free-bodies")
    with pytest.raises(InvalidInput, match="ghosts"):
        ck.draw(six_bar_forces(), ghosts=3)


@pytest.mark.parametrize("angle", [0.0, 1.0, 4.0])
def test_ordinates_on_a_bar_are_to_scale_and_on_their_side(angle: float) -> None:
    """A cantilever turned by any angle under a force across it: M = -F l at its root, to the right of its axis."""
    across = -50j * np.exp(1j * angle)
    mechanism = ck.Mechanism(
        "Arm",
        ck.link("frame", A=0),
        ck.link("arm", A=0, B=2),
        ck.drive("arm"),
        ck.force("arm", (across.real, across.imag), at="B"),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    forces = ck.force_analysis(ck.solve(mechanism, {"arm": [angle]}), inertia=False)
    picture = ck.draw(forces, kind="bending-moment")
    (line,) = (one for one in picture.shapes if isinstance(one, Polyline) and len(one.points) > 100)
    foot, tip, end = line.points[0], line.points[1], line.points[-1]
    (text,) = (one for one in picture.shapes if isinstance(one, Text) and one.text == "100 N m")
    start, head = (
        next(one.points[0] for one in picture.shapes if isinstance(one, kind) and one.points[0].imag == text.at.imag)
        for kind in (Polyline, Polygon)
    )
    assert abs(tip - foot) == pytest.approx(abs(head - start))
    aside = (tip - foot) / (end - foot)
    assert abs(aside.real) < 1e-6
    assert aside.imag > 0.0  # on paper y points down: to the right of the axis


@pytest.mark.parametrize(
    ("anchor", "low", "high"), [("start", 100.0, 200.0), ("end", 0.0, 100.0), ("middle", 60.0, 140.0)]
)
def test_lowered_signs_are_small_digits_of_the_font_where_their_text_is(anchor: str, low: float, high: float) -> None:
    """Cairo looks for a sign in one font alone, and would set each piece of a text about its anchor."""
    source = svg([Text(100 + 50j, "−m₁₂a₃ 4.5", "code", anchor)], 200.0, 100.0, 400.0, "A")
    assert not set("₁₂₃") & set(source)
    ink = np.flatnonzero((pixels(source, 400, 200) < 128).any(axis=(0, 2))) / 2.0
    assert low - 2.0 < ink.min()
    assert ink.max() < high + 2.0
    assert ink.max() - ink.min() > 40.0
    if anchor == "middle":
        assert (ink.max() + ink.min()) / 2.0 == pytest.approx(100.0, abs=2.0)


def test_raised_signs_that_every_font_has_stay() -> None:
    assert markup("mm/s², 2.5·10⁻⁵ m") == (
        'mm/s², 2.5·10<tspan font-size="0.7em" dy="-0.5em">−5</tspan><tspan dy="0.35em"> m</tspan>'
    )
