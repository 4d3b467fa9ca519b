"""Shapes as TikZ: a standalone LaTeX document with its picture and all its styles, to be edited by hand.

Texts are escaped for TeX; signs that it has no letter for are set as formulas.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from compoundkin.base.display import printable
from compoundkin.view.sketch.shapes import (
    ArcShape,
    Band,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Strokes,
    Text,
    coordinate_text,
)
from compoundkin.view.sketch.sketch_style import BASELINE, LOWERED_SIGNS, RAISED_SIGNS, declarations

# TeX's big points of a pixel: 72 and 96 to the inch.
OF_PIXEL = 0.75
# So many points of a line stand in a line of the file.
POINTS_IN_LINE = 8
ANCHORS = {"start": " west", "middle": "", "end": " east"}
HALO = "halo"
_SAME: Mapping[str, str] = {
    "stroke-linecap": "line cap",
    "stroke-linejoin": "line join",
    "fill-opacity": "fill opacity",
    "opacity": "opacity",
}


def tikz(shapes: Sequence[Shape], width: float, height: float, size: float, title: str, description: str = "") -> str:
    r"""Return a LaTeX document of a picture of `width` by `height` picture units. It is as large as its PDF.

    Its longer side has `size` pixels of 1/96 inch. All that the picture needs stands within it.

    >>> print(tikz((), 100, 50, 200, "Empty").splitlines()[5])
    \begin{tikzpicture}[
    """
    unit = OF_PIXEL * size / max(width, height)
    names = sorted({name for style in _styles(shapes) for name in style.split()})
    rules = {name: declarations(name) for name in names}
    colours = sorted({value for own in rules.values() for value in own.values() if value.startswith("#")})
    about = [tex_comment(text) for text in (title, description) if text]
    head = [
        *about,
        "% Of a document of yours: \\usepackage{tikz} and the tikzpicture alone. Numbers are picture units, y upward.",
        "\\RequirePackage{fix-cm}",
        "\\documentclass[tikz]{standalone}",
        "\\begin{document}",
        "\\begin{tikzpicture}[",
        f"  x={_length(unit)}, y={_length(unit)}, line width={_length(unit)}, inner sep=0pt,",
        *(f"  ck-{name}/.style={{{', '.join(_style(name, own, unit))}}}," for name, own in rules.items()),
        "]",
        *(f"\\definecolor{{{_colour(one)}}}{{HTML}}{{{one[1:].upper()}}}" for one in colours),
        f"\\useasboundingbox (0,0) rectangle ({coordinate_text(width)},{coordinate_text(height)});",
    ]
    return "\n".join([*head, *_commands(shapes, height, unit), "\\end{tikzpicture}", "\\end{document}", ""])


def _styles(shapes: Iterable[Shape]) -> Iterator[str]:
    for shape in shapes:
        yield shape.style
        if isinstance(shape, ShapeGroup):
            yield from _styles(shape.shapes)


def _colour(value: str) -> str:
    return f"ck{value[1:]}" if value.startswith("#") else value


def _length(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".") + "bp"


def _style(name: str, rules: Mapping[str, str], unit: float) -> Iterator[str]:
    return _behind(rules, unit) if name == HALO else _options(rules, unit)


def _options(rules: Mapping[str, str], unit: float) -> Iterator[str]:
    """Yield what a class of the style sheet looks like, in words of TikZ."""
    is_text = "font-size" in rules
    for key, value in rules.items():
        if key == "fill":
            yield f"{'text' if is_text else 'fill'}={_colour(value)}"
        elif key == "stroke":
            yield f"draw={_colour(value)}"
        elif key == "stroke-width":
            yield f"line width={_length(float(value) * unit)}"
        elif key == "stroke-dasharray":
            yield f"dash pattern={_dashes(value, unit)}"
        elif key == "font-size":
            size = float(value.removesuffix("px")) * unit
            yield f"font={_font(rules, size)}, anchor=base, yshift={_length(-BASELINE * size)}"
        elif key in _SAME:
            yield f"{_SAME[key]}={value}"


def _dashes(lengths: str, unit: float) -> str:
    parts = [_length(float(part) * unit) for part in lengths.split()]
    return " ".join(f"{'off' if k % 2 else 'on'} {part}" for k, part in enumerate(parts))


def _behind(rules: Mapping[str, str], unit: float) -> Iterator[str]:
    """Yield what a halo looks like: TeX's letters have no edge, so that it is a box behind them."""
    yield f"fill={_colour(rules['stroke'])}, inner sep={_length(float(rules['stroke-width']) * unit / 2.0)}"


def _font(rules: Mapping[str, str], size: float) -> str:
    slant = "\\itshape" if rules.get("font-style") == "italic" else ""
    weight = "\\bfseries" if rules.get("font-weight") == "bold" else ""
    return f"\\fontsize{{{_length(size)}}}{{{_length(1.2 * size)}}}{slant}{weight}\\selectfont"


def _commands(shapes: Sequence[Shape], height: float, unit: float) -> Iterator[str]:
    """Yield commands that draw shapes, one after another."""
    for before, shape in pairwise([None, *shapes]):
        if isinstance(shape, ShapeGroup):
            if shape.title:
                yield tex_comment(shape.title)
            if shape.style:
                yield f"\\begin{{scope}}[{_names(shape.style)}, transparency group]"
            yield from _commands(shape.shapes, height, unit)
            if shape.style:
                yield "\\end{scope}"
        elif isinstance(shape, Text):
            if not _is_of_halo(shape, before):
                yield _node(shape, height)
        elif shape is not None:
            band = f", line width={_length(shape.width * unit)}" if isinstance(shape, Band) else ""
            yield f"\\path[{_names(shape.style)}{band}] {_line_commands(shape, height)};"


def _names(style: str) -> str:
    # of two classes of one shape the later in the alphabet counts
    return ", ".join(f"ck-{name}" for name in sorted(style.split()))


def _is_of_halo(shape: Text, before: Shape | None) -> bool:
    """Whether the text before is the same with a halo, which is a node with both."""
    if not isinstance(before, Text) or HALO not in before.style.split():
        return False
    return (before.at, before.text) == (shape.at, shape.text)


def _node(shape: Text, height: float) -> str:
    turn = f"rotate={coordinate_text(-shape.angle)}, " if shape.angle else ""
    anchor = f", anchor=base{ANCHORS[shape.anchor]}" if shape.anchor != "middle" else ""
    return f"\\node[{turn}{_names(shape.style)}{anchor}] at {_place(shape.at, height)} {{{tex_text(shape.text)}}};"


def _place(point: complex, height: float) -> str:
    return f"({coordinate_text(point.real)},{coordinate_text(height - point.imag)})"


def _line(points: Sequence[complex], height: float) -> str:
    places = [_place(point, height) for point in points]
    rows = [places[k : k + POINTS_IN_LINE] for k in range(0, len(places), POINTS_IN_LINE)]
    return "\n  -- ".join(" -- ".join(row) for row in rows)


def _line_commands(shape: Polyline | Polygon | Band | Strokes | CircleShape | ArcShape, height: float) -> str:
    """The way of a shape's line."""
    if isinstance(shape, CircleShape):
        return f"{_place(shape.centre, height)} circle[radius={coordinate_text(shape.radius)}]"
    if isinstance(shape, ArcShape):
        return _arc(shape, height)
    if isinstance(shape, Strokes):
        return "\n  ".join(_line(line, height) for line in shape.lines)
    closed = isinstance(shape, Polygon) or (isinstance(shape, Band) and shape.closed)
    return _line(shape.points, height) + (" -- cycle" if closed else "")


def _arc(shape: ArcShape, height: float) -> str:
    """An arc of at most half a turn about its middle, y upward."""
    chord = (shape.stop - shape.start).conjugate()
    radius = max(shape.radius, abs(chord) / 2.0)
    off = (radius**2 - abs(chord) ** 2 / 4.0) ** 0.5
    way = -1.0 if shape.sweep else 1.0
    arm = -chord / 2.0 - 1j * way * off * (chord / abs(chord) if chord else 1.0)
    start = float(np.rad2deg(np.angle(arm)))
    turned = way * 2.0 * float(np.rad2deg(np.arcsin(min(1.0, abs(chord) / 2.0 / radius)))) if chord else 0.0
    options = f"start angle={start:.2f}, delta angle={turned:.2f}, radius={coordinate_text(radius)}"
    return f"{_place(shape.start, height)} arc[{options}]"


_COMMANDS: Mapping[str, str] = {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "`": r"\textasciigrave{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedblright{}",
    "'": r"\ensuremath{'}",
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
}
# From alpha on as Unicode lists them.
_GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu"),
    *("xi", "o", "pi", "rho", "varsigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
)
_CAPITALS = {"Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Φ": "Phi"}
_SIGNS = {
    **{chr(0x3B1 + k): name if name == "o" else f"\\{name}" for k, name in enumerate(_GREEK)},
    **{letter: f"\\{name}" for letter, name in (*_CAPITALS.items(), ("Ψ", "Psi"), ("Ω", "Omega"))},
    **{"−": "-", "·": r"\cdot", "×": r"\times", "±": r"\pm", "°": r"^\circ", "∞": r"\infty", "→": r"\to"},
    **{"≤": r"\le", "≥": r"\ge", "≈": r"\approx", "√": r"\surd", "′": "'", "″": "''", "µ": r"\mu", "∠": r"\angle"},
}
# Raised and lowered signs, several in a row as one formula.
_PLAIN = str.maketrans(RAISED_SIGNS + LOWERED_SIGNS, "0123456789-0123456789-")
_RUNS = re.compile(f"[{RAISED_SIGNS}]+|[{LOWERED_SIGNS}]+|.", re.DOTALL)
# Two of these would become one sign of another kind.
_DOUBLED = re.compile(r"([-,])(?=\1)")


def tex_text(text: str) -> str:
    r"""Return a text such that TeX sets it as it is written. Letters of other scripts stay: LuaLaTeX sets them.

    >>> print(tex_text("50 % of a_1 at ω₁₂, -0.5°"))
    50 \% of a\_1 at \ensuremath{\omega}\ensuremath{_{12}}, -0.5\ensuremath{^\circ}
    """
    shown = _DOUBLED.sub(r"\1\0", printable(text))
    return "".join(_set(run) for run in _RUNS.findall(shown)).replace("\0", "{}")


def tex_comment(text: str) -> str:
    r"""Return a text as one line of a comment.

    >>> tex_comment("one\ntwo")
    '% one two'
    """
    return "% " + printable(text)


def _set(run: str) -> str:
    if run[0] in RAISED_SIGNS + LOWERED_SIGNS:
        return f"\\ensuremath{{{'^' if run[0] in RAISED_SIGNS else '_'}{{{run.translate(_PLAIN)}}}}}"
    if run in _SIGNS:
        return f"\\ensuremath{{{_SIGNS[run]}}}"
    return _COMMANDS.get(run, run)
