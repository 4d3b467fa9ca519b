"""Marks of all kinds of pairs, structure pictures, saving, the command line, labels and windows."""

from __future__ import annotations

import builtins
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.cli import cli
from compoundkin.files import load, shipped_mechanisms
from compoundkin.model.pairs import KINDS, Pair
from compoundkin.model.pairs.symbols import Mark, Pin, Sliding, strap_line
from compoundkin.structure import decompose
from compoundkin.view.sketch.labels import label_around, placed
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.scene import Scene, simplified
from compoundkin.view.sketch.shapes import Band, CircleShape, Polygon, Polyline, ShapeGroup, Text, leaves
from compoundkin.view.sketch.sketch_style import COLOURS, FRAME, INK, PAPER
from compoundkin.view.sketch.svg import elements
from compoundkin.view.sketch.symbol_shapes import PAINTED
from tests import catalog
from tests.pictures import GALLERY
from tests.support import sample

SEEDS = st.integers(0, 2**32 - 1)
# What the picture of a pair needs besides names.
SIZED: dict[str, dict[str, Any]] = {"G": {"teeth": (20, 40)}, "B": {"radii": (0.1, 0.2)}, "K": {"radius": 2.0}}
every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=[kind.code for kind in KINDS.values()])


# --- glyphs ----------------------------------------------------------------------------------------------


@cache
def _scene(name: str) -> Scene:
    return scene_of(load(name), None, None, 0)


def test_every_mark_is_drawn() -> None:
    """Pins are drawn by their letters, all other marks by what `PAINTED` has for them."""
    assert {*PAINTED, Pin} == set(get_args(Mark))


@catalog.each(catalog.CHOSEN)
def test_a_guide_is_as_long_as_the_motion_uses_it(name: str) -> None:
    for seen in _scene(name).pair_marks:
        if isinstance(seen.mark, Sliding):
            values = catalog.motion(name).pairs[seen.pair.name].value
            assert (seen.mark.low, seen.mark.high) == pytest.approx((np.nanmin(values), np.nanmax(values)), rel=1e-9)


@every_kind
def test_every_kind_of_pair_has_marks(kind: type[Pair]) -> None:
    """Those of a pair that is closed in the world are finite, and belong to its members."""
    pair = replace(sample(kind), **SIZED.get(kind.code, {}))
    ends = pair.generic(np.random.default_rng(3))
    still = tuple(Pose.of(0j, 1 + 0j).counted(0.0) for _ in pair.members)
    marks = pair.glyph(ends, still)
    assert marks
    for mark in marks:
        assert isinstance(mark, Sliding) or mark.member in range(len(pair.members))
        for value in mark:
            assert np.all(np.isfinite(np.asarray(value, dtype=complex)))


@given(SEEDS, st.booleans())
def test_a_belt_touches_its_pulleys_and_cuts_neither(seed: int, crossed: bool) -> None:
    rng = np.random.default_rng(seed)
    radii = tuple(rng.uniform(0.2, 1.5, 2))
    centres = 0j, sum(radii) * rng.uniform(1.1, 4.0) * np.exp(1j * rng.uniform(0, 6.28))
    line = strap_line(centres, radii, crossed)
    fine = np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(line)])
    for centre, radius in zip(centres, radii, strict=True):
        assert np.abs(fine - centre).min() == pytest.approx(radius, rel=2e-3)
    # an open belt encloses both middles turning one way, a crossed one in opposite ways
    turns = [np.sum(np.angle((line[1:] - c) / (line[:-1] - c))) / (2 * np.pi) for c in centres]
    assert np.round(np.abs(turns)).tolist() == [1, 1]
    assert (np.sign(turns[0]) == np.sign(turns[1])) != crossed


# --- structure pictures ----------------------------------------------------------------------------------


@pytest.mark.parametrize("view", ["groups", "loops", "graph", "circle"])
@pytest.mark.parametrize("name", ["six-bar", "jansen-leg", "planetary-train", "excavator-arm", "scissor-lift"])
def test_structure_pictures_are_well_formed_and_the_same_every_time(name: str, view: str) -> None:
    mechanism = load(name)
    source = ck.draw(mechanism, kind=view).svg
    ET.fromstring(source)
    assert ck.draw(load(name), kind=view).svg == source


def test_the_parts_are_the_groups_in_solving_order() -> None:
    mechanism = load("jansen-leg")
    picture = ck.draw(mechanism, kind="groups")
    headings = [
        s.text for s in leaves(picture.shapes) if isinstance(s, Text) and s.style == "heading" and s.text != "+"
    ]
    assert headings == ["frame and driver", *(f"class II: {g.name}" for g in decompose(mechanism).groups)]
    outer = [s for s in leaves(picture.shapes) if s.style == "outer"]
    assert len(outer) == sum(len(group.outer) for group in decompose(mechanism).groups)


def test_the_graph_has_a_node_for_each_link_and_a_line_for_each_pair() -> None:
    structure = decompose(load("six-bar"))
    picture = ck.draw(structure, kind="graph")
    titles = [shape.title for shape in picture.shapes if isinstance(shape, ShapeGroup)]
    assert set(structure.mechanism.links) <= set(titles)
    assert sum(title.endswith("pair") for title in titles) == len(structure.pairs)
    nodes = [
        s.shapes[0].centre for s in picture.shapes if isinstance(s, ShapeGroup) and isinstance(s.shapes[0], CircleShape)
    ]
    assert min(abs(a - b) for k, a in enumerate(nodes) for b in nodes[:k]) > 40


def test_the_circle_diagram_has_a_chord_for_each_centre() -> None:
    mechanism = load("six-bar")
    picture = ck.draw(mechanism, kind="circle")
    lines = [shape for shape in leaves(picture.shapes) if isinstance(shape, Polyline)]
    assert len(lines) == 15
    assert sum(line.style == "ink" for line in lines) == 7
    assert "13 = 12 23 × 14 34" in [s.text for s in leaves(picture.shapes) if isinstance(s, Text)]


def test_overconstrained_mechanisms_that_move_are_drawn_as_they_are_written() -> None:
    mechanism = load("wedge-press")
    picture = ck.draw(mechanism, at=20.0)
    blocks = [s for s in leaves(picture.shapes) if isinstance(s, Polygon) and s.style.startswith("pin ")]
    assert len(blocks) == 3
    ET.fromstring(ck.draw(mechanism, kind="groups").svg)


def test_structure_pictures_tell_what_they_cannot_show() -> None:
    loose = ck.Mechanism("Loose", ck.link("frame", A=0), ck.link("rod", A=0, B=1), ck.link("arm", B=0, C=1))
    assert "3 links" in ck.draw(loose, kind="graph").description
    with pytest.raises(ck.errors.NotDetermined):
        ck.draw(loose, kind="groups")
    with pytest.raises(ck.errors.InvalidInput, match="there is no picture"):
        ck.draw(loose, kind="net")
    with pytest.raises(ck.errors.InvalidInput, match="is no motion or mechanism or structure"):
        ck.draw("six-bar", kind="groups")
    motion = ck.solve(load("crank-rocker"))
    assert ck.draw(motion, kind="groups").svg == ck.draw(motion.mechanism, kind="groups").svg


def test_a_picture_is_asked_only_what_belongs_to_its_kind() -> None:
    motion = ck.solve(load("crank-rocker"))
    for kind, words in (
        ("graph", {"at": 0.5}),
        ("graph", {"at": np.array([0.5])}),
        ("circle", {"pose": 3}),
        ("groups", {"ghosts": 2}),
        ("loops", {"labels": False}),
        ("polygon", {"centres": True}),
    ):
        with pytest.raises(ck.errors.InvalidInput, match=f"does not go with the kind '{kind}'"):
            ck.draw(motion, kind=kind, **words)
    with pytest.raises(ck.errors.InvalidInput, match="a polygon is one of them"):
        ck.draw(motion, kind="polygon", vectors=("velocity", "acceleration"))


@pytest.mark.parametrize("kind", ["groups", "loops"])
def test_groups_and_loops_are_drawn_at_a_pose_that_is_asked_for(kind: str) -> None:
    motion = ck.solve(load("crank-rocker"))
    there = ck.draw(motion, kind=kind, pose=20).svg
    assert there != ck.draw(motion, kind=kind).svg
    assert there == ck.draw(motion, at=float(motion.drives["crank"].value[20]), kind=kind).svg
    with pytest.raises(ck.errors.InvalidInput, match="there is no pose"):
        ck.draw(motion, kind=kind, pose=10_000)


# --- saving ----------------------------------------------------------------------------------------------


def test_pictures_are_saved_in_three_forms(tmp_path: Path) -> None:
    picture = ck.draw(load("crank-rocker"))
    for suffix, start in ((".svg", b"<svg"), (".png", b"\x89PNG"), (".pdf", b"%PDF")):
        picture.save(tmp_path / f"a{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes().startswith(start)


def test_a_picture_that_cannot_be_made_leaves_the_file_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.png"
    target.write_bytes(b"before")
    real = builtins.__import__

    def missing(name: str, *args: Any, **words: Any) -> Any:
        if name == "cairosvg":
            raise ImportError("no cairosvg here")
        return real(name, *args, **words)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ck.errors.InvalidInput, match=r"compoundkin\[pictures\]"):
        ck.draw(load("crank-rocker")).save(target)
    assert target.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("name", ["a.gif", "a", "missing/a.svg"])
def test_files_that_cannot_be_written_are_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(ck.errors.InvalidInput):
        ck.draw(load("crank-rocker")).save(tmp_path / name)


# --- the command line ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options",
    [
        ["--at", "35", "--vectors", "velocity", "--centres"],
        ["--ghosts", "4", "--path", "G", "--no-labels"],
        ["--polygon", "acceleration", "--at", "35"],
        ["--structure", "graph"],
        ["--at", "20", "--speed", "300rpm", "--vectors", "acceleration", "--size", "300"],
    ],
)
def test_draw_writes_svg(tmp_path: Path, options: list[str]) -> None:
    result = CliRunner().invoke(cli, ["draw", "six-bar", *options])
    assert result.exit_code == 0
    ET.fromstring(result.stdout)
    target = tmp_path / "a.svg"
    written = CliRunner().invoke(cli, ["draw", "six-bar", *options, "-o", str(target)])
    assert written.exit_code == 0
    assert target.read_text(encoding="utf-8") == result.stdout


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--at", "abc"], "not one number"),
        (["--path", "Q"], "no such point"),
        (["--structure", "graph", "--at", "35"], "does not go with --structure"),
        (["--polygon", "velocity", "--ghosts", "3"], "does not go with --polygon"),
        (["--structure", "graph", "--path", "G"], "--path"),
        (["-o", "a.gif"], "not saved as"),
        (["--size", "3"], "not a number of pixels"),
        (["--design", "4"], "no design 4"),
    ],
)
def test_wrong_options_are_told(options: list[str], said: str) -> None:
    result = CliRunner().invoke(cli, ["draw", "six-bar", *options])
    assert result.exit_code == 2
    assert said in result.stderr
    assert "Traceback" not in result.stderr


def test_a_pose_that_does_not_close_has_its_exit_code() -> None:
    assert CliRunner().invoke(cli, ["draw", "triple-rocker", "--at", "170"]).exit_code == 3


# --- parts -----------------------------------------------------------------------------------------------


@given(SEEDS)
def test_labels_of_crowded_points_do_not_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = [complex(*rng.uniform(150, 350, 2)) for _ in range(20)]
    labels = [label_around(str(k), p, 6 + 6j, 8.0) for k, p in enumerate(points)]
    found = list(placed(labels, [CircleShape(p, 4.0, "pin") for p in points], 500, 500).values())
    for k, a in enumerate(found):
        assert all(abs((a - b).real) >= 12 or abs((a - b).imag) >= 12 for b in found[:k])


@given(SEEDS)
def test_a_simplified_line_is_near_the_line(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 6.28, 200)
    line = 100 * np.exp(1j * t) + 20 * rng.uniform() * np.exp(3j * t)
    short = np.array(simplified(line, 0.5))
    assert len(short) < 100
    a, b = short[:-1, None], short[1:, None]
    share = np.clip(((np.conjugate(b - a) * (line - a)).real / np.abs(b - a) ** 2), 0, 1)
    assert np.abs(line - a - share * (b - a)).min(axis=0).max() < 0.5 + 1e-9


@pytest.mark.parametrize("paper", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("colour", [*COLOURS, INK, FRAME])
def test_colours_have_contrast(colour: tuple[str, str], paper: int) -> None:
    """At least 3 : 1, as WCAG 2.1 asks of graphics (success criterion 1.4.11)."""
    light, dark = sorted((_luminance(colour[paper]), _luminance(PAPER[paper])), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 3.0


def _luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return float(np.dot(linear, [0.2126, 0.7152, 0.0722]))


def test_the_gallery_shows_the_whole_catalog() -> None:
    root = ET.fromstring(GALLERY.read_text(encoding="utf-8"))
    inner = [element.get("id") for element in root.iter("{http://www.w3.org/2000/svg}svg")][1:]
    assert inner == list(shipped_mechanisms.shipped()), "write it again: python -m tests.pictures"


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


@pytest.mark.parametrize("name", ["v8-engine", "roberts-cognates", "jansen-leg", "sun-and-planet"])
def test_no_line_of_a_graph_goes_through_a_link_that_it_does_not_join(name: str) -> None:
    picture = ck.draw(ck.load(name), kind="graph")
    groups = [shape for shape in picture.shapes if isinstance(shape, ShapeGroup)]
    centres = {
        one.links[0]: one.shapes[0].centre if isinstance(one.shapes[0], CircleShape) else np.mean(one.shapes[0].points)
        for one in groups if one.links
    }  # fmt: skip
    lines = [shape.points for one in groups if not one.links for shape in one.shapes if isinstance(shape, Polyline)]
    assert len(lines) == len(ck.decompose(ck.load(name)).pairs)
    for points in lines:
        along = np.concatenate([np.linspace(a, b, 200) for a, b in pairwise(points)])
        near = {link for link, at in centres.items() if np.abs(along - at).min() < 14.0}
        assert len(near) == 2, near
