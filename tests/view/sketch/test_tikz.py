"""Pictures as TikZ: read by a strict parser and compared with the same pictures as SVG; texts of every kind."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.sketch.shapes import CircleShape, ShapeGroup, Text
from compoundkin.view.sketch.sketch_style import CLASSES, GROUPED, declarations, style_of
from compoundkin.view.sketch.svg import svg
from compoundkin.view.sketch.tikz import tex_text, tikz

NUMBER = r"-?\d+(?:\.\d+)?"
PLACE = rf"\(({NUMBER}),({NUMBER})\)"
OPTIONS = r"line width=[\d.]+bp", r"rotate=-?[\d.]+", "anchor=base (?:east|west)", "transparency group", ", "
STYLES = rf"\[(?:ck-[a-z]+(?:-[a-z]+)?\d?|{'|'.join(OPTIONS)})+\]"
ARC = rf" arc\[start angle=({NUMBER}), delta angle=({NUMBER}), radius=({NUMBER})\]"
WAY = rf"{PLACE}(?:{ARC}| circle\[radius={NUMBER}\]|(?:\s*--\s+{PLACE}|\s+{PLACE})*(?: -- cycle)?)"
COMMANDS = (
    rf"\\path{STYLES} {WAY};",
    rf"\\node{STYLES} at {PLACE} \{{.*\}};",
    rf"\\begin\{{scope\}}{STYLES}",
    r"\\end\{scope\}",
    r"% .*",
)


def body_of(text: str) -> str:
    """The commands of a picture, once all around them is as it should be."""
    head, _, rest = text.partition("]\n\\definecolor")
    assert head.count("{") == head.count("}")
    assert re.search(r"\\documentclass\[tikz\]\{standalone\}\n\\begin\{document\}\n\\begin\{tikzpicture\}\[\n", head)
    colours, body = re.fullmatch(
        r"((?:\{\w+\}\{HTML\}\{[0-9A-F]{6}\}\n(?:\\definecolor)?)+)\\useasboundingbox .*?;\n(.*)"
        r"\\end\{tikzpicture\}\n\\end\{document\}\n",
        rest,
        re.DOTALL,
    ).groups()  # type: ignore[union-attr]
    assert set(re.findall(r"=(ck[0-9a-f]{6})\b", head)) == set(re.findall(r"\{(ck\w+)\}", colours))
    assert set(re.findall(r"(ck-[\w-]+)/\.style", head)) >= set(re.findall(r"ck-[a-z-]+\d?", body))
    return body


def commands_of(body: str) -> list[str]:
    whole, found, at = re.compile("|".join(COMMANDS)), [], 0
    while at < len(body):
        match = whole.match(body, at)
        assert match, body[at : at + 200]
        found.append(match[0])
        at = match.end() + 1
    return found


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("six-bar", {"at": 0.6, "centres": True, "vectors": "velocity"}),
        ("jaw-crusher", {"paths": True, "ghosts": 2}),
        ("slider-crank-offset", {"dimensions": True}),
        ("planetary-train", {"kind": "groups"}),
    ],
)
def test_a_picture_as_tikz_has_the_lines_and_texts_of_its_svg(name: str, words: dict[str, object]) -> None:
    picture = ck.draw(load(name), **words)
    text = picture.content("tikz").decode()
    assert text == picture.content("tikz").decode()
    commands = commands_of(body_of(text))
    drawn = re.findall(r'<path[^>]* d="([^"]*)"|<circle[^>]* cx="(.*?)" cy="(.*?)"', picture.svg)
    paths = [one for one in commands if one.startswith("\\path")]
    assert len(paths) == len(drawn)
    for own, (way, x, y) in zip(paths, drawn, strict=True):
        asked = ends_of_svg(way) if way else [complex(float(x), float(y))]
        np.testing.assert_allclose(ends_of(own), [complex(p.real, picture.height - p.imag) for p in asked], atol=0.11)
    texts = re.findall(r'<text class="([^"]*)"', picture.svg)
    assert sum(one.startswith("\\node") for one in commands) == sum("ck-halo" not in style for style in texts)
    width, height = re.search(rf"rectangle {PLACE}", text).groups()  # type: ignore[union-attr]
    assert (float(width), float(height)) == pytest.approx((picture.width, picture.height), abs=0.06)


def ends_of(command: str) -> list[complex]:
    """The places of a command, of an arc both ends, which its angles tell."""
    places = [complex(float(x), float(y)) for x, y in re.findall(PLACE, command)]
    if arc := re.search(ARC, command):
        start, turn, radius = (float(part) for part in arc.groups())
        turned = np.exp(1j * np.deg2rad([start, start + turn])) * radius
        places.append(places[0] + turned[1] - turned[0])
    return places


def ends_of_svg(way: str) -> list[complex]:
    arcless = re.sub(r"A\S+ \S+ 0 0 [01] ", "L", way)
    return [complex(float(x), float(y)) for x, y in re.findall(rf"[ML]({NUMBER}) ({NUMBER})", arcless)]


def test_arcs_bulge_to_the_side_that_they_have_as_svg() -> None:
    """The middle of SVG's arc by its endpoints and sweep (W3C, SVG 1.1, F.6.5), that of TikZ's by its angles."""
    from compoundkin.view.sketch.shapes import ArcShape

    for sweep in (True, False):
        shape = ArcShape(10 + 10j, 30 + 18j, 14.0, sweep, "drive")
        chord, mid = shape.stop - shape.start, (shape.stop + shape.start) / 2
        # y downward: with sweep the arc is clockwise on paper, its middle to the left of its chord on paper
        off = np.sqrt(shape.radius**2 - abs(chord) ** 2 / 4)
        centre = mid + (1j if sweep else -1j) * chord / abs(chord) * off
        summit = centre + (mid - centre) / abs(mid - centre) * shape.radius
        start, turn, radius = (float(part) for part in re.search(ARC, tikz((shape,), 50, 50, 50, "A")).groups())  # type: ignore[union-attr]
        middle = complex(10, 40) - radius * np.exp(1j * np.deg2rad(start))
        found = middle + radius * np.exp(1j * np.deg2rad(start + turn / 2))
        assert found == pytest.approx(complex(summit.real, 50 - summit.imag), abs=0.01)


def test_a_picture_as_tikz_is_as_large_as_its_pdf() -> None:
    """Sizes in points: CairoSVG's page, and TikZ's bounding box by its units."""
    picture = ck.draw(load("crank-rocker"), size=400)
    page = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", picture.content("pdf")).groups()  # type: ignore[union-attr]
    unit = float(re.search(r"x=([\d.]+)bp", picture.content("tikz").decode())[1])  # type: ignore[index]
    assert [float(side) for side in page] == pytest.approx([picture.width * unit, picture.height * unit], rel=2e-3)


def test_every_class_of_the_style_sheet_says_how_it_is_filled() -> None:
    """SVG fills with black what says nothing, TikZ with nothing."""
    bare = {name for name in CLASSES if "fill" not in declarations(name)}
    bare |= {kind for kind in GROUPED if "fill" not in declarations(style_of(kind, 1))}
    assert bare == {"halo", "ring"}  # which go with others


def test_texts_are_escaped() -> None:
    assert tex_text(r"50 % of \a_1 {b}^2 #1 $x$ ~&") == (
        r"50 \% of \textbackslash{}a\_1 \{b\}\textasciicircum{}2 \#1 \$x\$ \textasciitilde{}\&"
    )
    assert tex_text("a--b,,c") == "a-{}-b,{},c"
    assert tex_text("F₃₄(B) 10⁻⁵") == r"F\ensuremath{_{34}}(B) 10\ensuremath{^{-5}}"
    assert tex_text("αω −1°") == r"\ensuremath{\alpha}\ensuremath{\omega} \ensuremath{-}1\ensuremath{^\circ}"
    assert tex_text("é 曲柄 a\nb\x00") == "é 曲柄 a b "


def test_names_cannot_end_the_line_that_they_are_in() -> None:
    title = "A\n\\input{x}"
    shapes = (ShapeGroup((Text(5 + 5j, "};\\end{document}", "letter"),), "ghost", title), CircleShape(0j, 2.0, "pin"))
    text = tikz(shapes, 50, 50, 50, title, "b\r\\bye")
    assert [one.split("[")[0][:9] for one in commands_of(body_of(text))] == [
        "% A \\inpu",
        "\\begin{sc",
        "\\node",
        "\\end{scop",
        "\\path",
    ]
    assert r"{\};\textbackslash{}end\{document\}};" in text
    assert not [line for line in text.splitlines() if line.startswith(("\\input", "\\bye"))]


def test_a_halo_and_its_text_are_one_node_all_drawn_in_order() -> None:
    text = tikz((Text(1j, "A", "halo letter"), Text(1j, "A", "letter"), CircleShape(0j, 1.0, "dot")), 9, 9, 9, "")
    (node,) = (line for line in text.splitlines() if line.startswith("\\node"))
    assert node == "\\node[ck-halo, ck-letter] at (0,8) {A};"


def test_the_same_style_sheet_counts_in_the_same_order() -> None:
    names = svg((CircleShape(0j, 1.0, "pin ink"),), 9, 9, 9, "").splitlines()
    at = [k for name in ("ink", "pin") for k, line in enumerate(names) if line.startswith(f".ck-{name}{{")]
    assert all(a < b for a, b in pairwise(at[:2]))
    assert "\\path[ck-ink, ck-pin]" in tikz((CircleShape(0j, 1.0, "pin ink"),), 9, 9, 9, "")


def test_the_page_on_latex_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "exchange" / "latex.md").read_text("utf-8")
    exec("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), {})
    assert (tmp_path / "toggle.tex").read_text("utf-8").startswith("% ")
