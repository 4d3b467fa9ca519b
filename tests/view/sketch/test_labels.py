"""Numbers, letters and dimensions: the right texts, off each other, each at its own link."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.sketch.kinematic_sketch import in_layers, moving_sketch
from compoundkin.view.sketch.labels import WIDE, Label, LabelCrowd, arranged_labels, text_half
from compoundkin.view.sketch.painter import Layer, Painter
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.shapes import CircleShape, Polyline, ShapeGroup, Text, leaves
from compoundkin.view.sketch.sketch_style import LETTER, SMALL
from tests.catalog import mechanism, motion
from tests.scaled import scaled

# A sheet of A4 has 180 mm between its margins; a point is 1/72 of an inch.
A4_POINTS = 180.0 / 25.4 * 72.0


def dense(line: tuple[complex, ...]) -> np.ndarray:
    """Points along a line, nearer to each other than a picture unit."""
    return np.concatenate([a + (b - a) * np.linspace(0.0, 1.0, int(abs(b - a)) + 2) for a, b in pairwise(line)])


@pytest.mark.parametrize("name", ["v8-engine", "roberts-cognates", "scissor-lift"])
def test_numbers_are_nearer_to_their_own_link_than_to_any_other(name: str) -> None:
    picture, scene = ck.draw(mechanism(name)), scene_of(mechanism(name), None, None, 0)
    points: dict[str, list[np.ndarray]] = {}
    for one in in_layers(Painter(scene, picture.window)):
        if one.link != "frame" and Layer.FRAME < one.layer < Layer.PIN and hasattr(one.shape, "points"):
            closed = () if isinstance(one.shape, Polyline) else one.shape.points[:1]
            points.setdefault(one.link, []).append(dense((*one.shape.points, *closed)))
            if closed:
                points[one.link].append(np.array([np.mean(one.shape.points)]))
    badges = [s for s in picture.shapes if isinstance(s, ShapeGroup) and isinstance(s.shapes[-1], Text)]
    assert len(badges) == len(scene.legend) - 1
    for badge in badges:
        at, own = badge.shapes[0].centre, badge.links[0]
        far = {link: min(np.abs(np.concatenate(lines) - at)) for link, lines in points.items()}
        if far[own] > 9.0:  # on its own link, or inside its plate, it is beside no other
            assert far[own] <= min(far.values()) + 1.0, (own, far[own])


@pytest.mark.parametrize("name", ["six-bar", "jansen-leg"])
def test_letters_avoid_bars_over_the_whole_motion(name: str) -> None:
    """Of all letters at all poses few are on a bar, and all are on the picture."""
    sketch = moving_sketch(motion(name))
    labels = [part for part in sketch.parts if part.is_label and part.letter]
    covered = []
    for k in range(0, sketch.scene.count, max(1, sketch.scene.count // 24)):
        shapes = [s for p, s in zip(sketch.parts, sketch.shapes(k)[len(sketch.still) :], strict=True) if not p.is_label]
        bars = [s for s in leaves(shapes) if isinstance(s, Polyline) and s.style.startswith("bar")]
        along = np.concatenate([dense(bar.points) for bar in bars])
        for part in labels:
            middle, half = sketch.places(part)[k] + part.shapes[0].at, text_half(part.letter, LETTER)
            gap = along - middle
            covered.append(np.any((np.abs(gap.real) < half.real) & (np.abs(gap.imag) < half.imag)))
            assert sketch.window.holds(middle - half)
            assert sketch.window.holds(middle + half)
    assert np.mean(covered) < 0.08


def test_all_configurations_stand_on_one_scale_by_their_names() -> None:
    six_bar, found = mechanism("six-bar"), ck.configurations(mechanism("six-bar"), {"crank": 0.6})
    picture = ck.draw(six_bar, at=0.6, kind="configurations")
    texts = [s.text for s in leaves(picture.shapes) if isinstance(s, Text)]
    assert [text for text in texts if "RRR" in text] == list(found.names)
    assert any(text.startswith("crank at 34.377") and "4 real of 4" in text for text in texts)
    # the bars of the driven link are of one length and direction in all panels: one scale, one pose
    bars = [s.points for s in leaves(picture.shapes) if isinstance(s, Polyline) and s.style == "bar0"]
    ways = np.array([b - a for a, b in bars])
    assert len(bars) == len(found)
    assert np.ptp(np.abs(ways)) < 1e-9
    assert np.angle(np.conjugate(ways[0])) == pytest.approx(0.6, abs=1e-9)
    # the pins are where the configurations have them: the distance of A and D in each panel
    scale = abs(ways[0]) / abs(six_bar.geometry.points["crank"]["D"] - six_bar.geometry.points["crank"]["E"])
    panels = [s for s in picture.shapes if isinstance(s, ShapeGroup)]
    for one, panel in zip(found, panels, strict=True):
        pins = [s.centre for s in leaves([panel]) if isinstance(s, CircleShape) and s.radius < 5.0]
        away = np.abs(np.subtract.outer(pins, pins))
        assert np.min(np.abs(away - abs(one.points["B"] - one.points["D"]) * scale)) < 1e-6


def test_all_circuits_are_named_with_their_branches() -> None:
    found = ck.circuits(mechanism("stephenson-iii"))
    picture = ck.draw(mechanism("stephenson-iii"), kind="circuits")
    texts = [s.text for s in leaves(picture.shapes) if isinstance(s, Text)]
    assert [t for t in texts if t.startswith("circuit ")] == [f"circuit {c.number}" for c in found.circuits]
    ghosts = [s for s in leaves_of_groups(picture.shapes) if s.style == "ghost"]
    assert len(ghosts) == len(found.branches) - len(found.circuits)


def test_many_configurations_stand_in_three_columns_as_tall_as_what_they_show() -> None:
    picture = ck.draw(mechanism("v8-engine"), kind="configurations")
    heads = [shape.at for shape in leaves(picture.shapes) if isinstance(shape, Text) and shape.style == "heading"]
    assert len(heads) == 40
    assert len({round(at.real) for at in heads}) == 3
    rows = sorted({round(at.imag) for at in heads})
    assert max(np.diff(rows)) < 300.0, "a panel was 374 tall in two columns"
    # badges of 18 links would hide what their colours tell
    assert not [shape for shape in leaves(picture.shapes) if isinstance(shape, Text) and shape.style == "number"]


def test_of_equal_dimensions_one_is_written() -> None:
    def written(name: str) -> list[str]:
        shapes = leaves(ck.draw(mechanism(name), dimensions=True).shapes)
        return [shape.text for shape in shapes if isinstance(shape, Text) and shape.style == "dimension-text"]

    assert sorted(written("v8-engine")) == ["2× 45°", "2× 90°", "4× 1.74 in", "8× 5.7 in"]
    rack = written("rack-and-pinion-steering")
    assert {"2× 0.12 m", "2× 0.281 m", "2× 0.35 m"} <= set(rack)
    # a crank-rocker is not crowded, and its stick's two points in line have one angle
    assert not any("×" in text for text in written("crank-rocker"))
    assert written("hydraulic-digger").count("147.8°") == 1


@pytest.mark.parametrize("kind", ["configurations", "circuits"])
def test_all_configurations_of_each_design_are_its_own(kind: str) -> None:
    """With outlines over designs too; a design that there is not is told."""

    def crank_rocker(length: object, width: object) -> ck.Mechanism:
        return ck.Mechanism(
            "Crank-rocker", ck.link("frame", A=(0, 0), D=(60, 0)), ck.link("crank", A=(0, 0), B=(length, 0)),
            ck.link("coupler", B=(0, 0), C=(55, 0)), ck.link("rocker", D=(0, 0), C=(45, 0)), ck.drive("crank"),
            ck.outline("crank", width),
        )  # fmt: skip

    both = crank_rocker(np.array([[25.0], [20.0]]), [[8], [12]])
    assert ck.draw(both, kind=kind, design=1).svg == ck.draw(crank_rocker(20.0, 12), kind=kind).svg
    assert ck.draw(ck.solve(both), kind=kind).svg == ck.draw(crank_rocker(25.0, 8), kind=kind).svg
    with pytest.raises(ck.errors.InvalidInput, match="there is no design 2"):
        ck.draw(both, kind=kind, design=2)


def leaves_of_groups(shapes: tuple[object, ...]) -> list[ShapeGroup]:
    """All groups, those inside others too."""
    groups = [s for s in shapes if isinstance(s, ShapeGroup)]
    return [*groups, *(inner for group in groups for inner in leaves_of_groups(group.shapes))]


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ({"kind": "configurations", "at": 3.0}, ck.errors.NotAssembled),
        ({"kind": "circuits", "at": {"nobody": 1.0}}, ck.errors.UnknownName),
        ({"kind": "circuits", "pose": 3}, ck.errors.InvalidInput),
        ({"kind": "graph", "dimensions": True}, ck.errors.InvalidInput),
    ],
)
def test_what_cannot_be_drawn_is_told(words: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        ck.draw(mechanism("triple-rocker"), **words)


@pytest.mark.parametrize("name", ["v8-engine", "jansen-leg", "roberts-cognates"])
def test_groups_are_legible_on_a_sheet_of_paper(name: str) -> None:
    picture = ck.draw(mechanism(name), kind="groups")
    assert SMALL * A4_POINTS / picture.width >= 7.0


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


CROWDED = ("six-bar", "3-rrr", "andrews-squeezer", "jansen-leg", "roberts-cognates", "watt-ii")


@pytest.mark.parametrize("name", [*CROWDED, "double-parallelogram-lift"])
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


def test_a_number_without_room_stands_aside_at_the_end_of_a_line() -> None:
    """The crusher's eccentric is shorter than its number, between a pivot, a pin and an arrow."""
    picture = ck.draw(mechanism("jaw-crusher-loaded"), dimensions=True)
    (number,) = (shape for shape in numbers(picture) if shape.text == "20 mm")
    half = text_half(number.text, SMALL)
    lines = [s.points for s in leaves(picture.shapes) if isinstance(s, Polyline) and s.style == "dimension"]
    leaders = [line for line in lines if len(line) == 2 and abs(line[1] - number.at) < half.real + 12.0]
    assert len(leaders) == 1
    bars = [dense(s.points) for s in leaves(picture.shapes) if isinstance(s, Polyline) and s.style.startswith("bar")]
    gap = np.concatenate(bars) - number.at
    assert not np.any((np.abs(gap.real) < half.real) & (np.abs(gap.imag) < half.imag))


def test_plates_have_two_sides_and_an_angle() -> None:
    plate = mechanism("six-bar").geometry.points["plate"]
    d, a, c = (complex(plate[letter]) for letter in "DAC")
    texts = {shape.text for shape in numbers(ck.draw(mechanism("six-bar"), dimensions=True))}
    assert {f"{abs(a - d):.4g} mm", f"{abs(c - d):.4g} mm"} <= texts
    assert f"{abs(np.rad2deg(np.angle((c - d) / (a - d)))):.4g}°" in texts


class PlacedAgain(LabelCrowd):
    """Labels of which each is placed again in every round, and held against all others."""

    def is_new_for(self, k: int) -> bool:
        return True

    def _that_may_meet(self, moved: Sequence[np.ndarray]) -> list[np.ndarray]:
        return [np.delete(np.arange(len(moved)), k) for k in range(len(moved))]


@pytest.mark.parametrize("seed", range(4))
def test_labels_are_where_they_are_if_each_is_placed_again(seed: int) -> None:
    rng = np.random.default_rng(seed)

    def some(*shape: int) -> np.ndarray:
        return rng.uniform(-90.0, 90.0, shape) + 1j * rng.uniform(-90.0, 90.0, shape)

    labels = [
        Label(
            f"point {k}", complex(*rng.uniform(4.0, 14.0, 2)), tuple(some() + 30.0 * some(9) / 90.0), tuple(9 * [0.0])
        )
        for k in range(40)
    ]
    fixed = {label.key: rng.uniform(0.0, 20.0, 9) for label in labels}
    turn, shift = np.exp(1j * rng.uniform(-0.2, 0.2, (5, 40))), some(5, 40) / 9.0
    found = arranged_labels(labels, fixed, LabelCrowd(labels, turn, shift))
    assert found == arranged_labels(labels, fixed, PlacedAgain(labels, turn, shift))
    assert len({label.places.index(found[label.key]) for label in labels}) > 5
