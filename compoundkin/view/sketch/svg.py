"""Shapes as SVG; SVG as PNG, PDF and arrays of pixels, by CairoSVG where it is installed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from html import escape, unescape
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import missing_extra
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
from compoundkin.view.sketch.sketch_style import BASELINE, LOWERED_SIGNS, PAPER, RAISED_SIGNS, sheets_of_papers

FONT = "font-family:Helvetica,Arial,sans-serif"
# Pixels for a picture unit where texts are as large as those of a page.
NATURAL = 1.1
# A PNG has so many pixels for each of the picture's: sharp on fine screens and in print.
FINE = 2.0
# Where colours are in the four bytes of a pixel of Cairo's on machines of our days: blue, green, red.
RED_GREEN_BLUE = [2, 1, 0]
DOTS_PER_INCH = 96
# Raised signs that every font has.
COMMON_SIGNS = "¹²³"
PLAIN_SIGNS = str.maketrans(LOWERED_SIGNS + RAISED_SIGNS, "0123456789−0123456789−")
SHIFTED_RUNS = re.compile(f"[{LOWERED_SIGNS}]+|[{RAISED_SIGNS}]+|[^{LOWERED_SIGNS}{RAISED_SIGNS}]+")
# How small they are set, and how far off the line, in ems.
SMALL, LOWER, HIGHER = 0.7, 0.196, 0.35
# An element with such signs that is not set from its start.
ANCHORED = re.compile(r'(<text[^>]*?) text-anchor="(middle|end)"([^>]*)>([^<]*<tspan.*?)</text>')
PIECES = re.compile(r"(?:<tspan([^>]*)>)?([^<]+)(?:</tspan>)?")


def svg(shapes: Sequence[Shape], width: float, height: float, size: float, title: str, description: str = "") -> str:
    """Return the source of a picture of `width` by `height` picture units. Its longer side is shown `size` pixels long.

    >>> print(svg((), 100, 50, 200, "Empty").splitlines()[1])
    <title>Empty</title>
    """
    return svg_document(elements(shapes), shapes, width, height, size, title, description)


def svg_document(
    lines: Iterable[str],
    styled: Sequence[Shape],
    width: float,
    height: float,
    size: float,
    title: str,
    description: str = "",
) -> str:
    """Return the source of a picture whose elements are there already. It has the style sheet of some shapes."""
    shown = size / max(width, height)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {coordinate_text(width)} {coordinate_text(height)}" '
        f'width="{coordinate_text(width * shown)}" height="{coordinate_text(height * shown)}" '
        f'role="img" style="{FONT}">'
    )
    about = [f"<title>{escape(title)}</title>", *([f"<desc>{escape(description)}</desc>"] if description else [])]
    sheet = f"<style>\n{css(styled)}\n</style>"
    return "\n".join([head, *about, sheet, *lines, "</svg>", ""])


def css(shapes: Iterable[Shape]) -> str:
    """Return the style sheet of some shapes on light or dark paper. A reader may prefer dark.

    Of two classes of one shape the later in the alphabet counts: "pin" fills what "ink" or "frame" strokes.
    """
    used = sorted({name for style in _styles(shapes) for name in style.split()})
    light, dark = sheets_of_papers(used)
    return f"{light}\n@media (prefers-color-scheme: dark) {{\n{dark}\n}}"


def _styles(shapes: Iterable[Shape]) -> Iterable[str]:
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield shape.style
            yield from _styles(shape.shapes)
        elif isinstance(shape, Polyline | Polygon | Band | Strokes | CircleShape | ArcShape | Text):
            yield shape.style


def inline(shapes: Sequence[Shape], width: float, height: float, title: str, description: str = "") -> str:
    """Return a picture as part of a page. As wide as there is room, its style that of the page, its links named.

    >>> inline((ShapeGroup((), links=("bar", "block")),), 100, 50, "A").splitlines()[2]
    '<g data-links="bar,block">'
    """
    name = escape(f"{title}. {description}" if description else title)
    head = (
        f'<svg viewBox="0 0 {coordinate_text(width)} {coordinate_text(height)}" '
        f'style="max-width:{coordinate_text(width * NATURAL)}px;{FONT}" '
        f'role="img" aria-label="{name}">'
    )
    return "\n".join([head, f"<title>{escape(title)}</title>", *elements(shapes, tagged=True), "</svg>"])


def link_names(names: Iterable[str]) -> str:
    """Return the names of links as one attribute of an element of a page. No name has a comma in it.

    >>> link_names(["bar", "block"])
    'bar,block'
    """
    return escape(",".join(names))


def elements(shapes: Iterable[Shape], *, tagged: bool = False) -> Iterator[str]:
    """Return the elements of shapes, line by line. `tagged` tells the links that groups of them show."""
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            tag = f' data-links="{link_names(shape.links)}"' if tagged and shape.links else ""
            if shape.style or shape.title or tag:
                yield f"<g{_class(shape.style)}{tag}>"
            if shape.title:
                yield f"<title>{escape(shape.title)}</title>"
            yield from elements(shape.shapes, tagged=tagged)
            if shape.style or shape.title or tag:
                yield "</g>"
        else:
            yield _element(shape)


def _element(shape: Polyline | Polygon | Band | Strokes | CircleShape | ArcShape | Text) -> str:
    style = _class(shape.style)
    if isinstance(shape, Text):
        x, y = coordinate_text(shape.at.real), coordinate_text(shape.at.imag)
        anchor = f' text-anchor="{shape.anchor}"' if shape.anchor != "start" else ""
        turn = f' transform="rotate({coordinate_text(shape.angle)} {x} {y})"' if shape.angle else ""
        return f'<text{style} x="{x}" y="{y}" dy="{BASELINE:g}em"{anchor}{turn}>{markup(shape.text)}</text>'
    if isinstance(shape, CircleShape):
        x, y = coordinate_text(shape.centre.real), coordinate_text(shape.centre.imag)
        return f'<circle{style} cx="{x}" cy="{y}" r="{coordinate_text(shape.radius)}"/>'
    if isinstance(shape, ArcShape):
        radius = coordinate_text(shape.radius)
        way = f"M{_pair(shape.start)}A{radius} {radius} 0 0 {int(shape.sweep)} {_pair(shape.stop)}"
        return f'<path{style} d="{way}"/>'
    if isinstance(shape, Strokes):
        return f'<path{style} d="{"".join(_path_data(line) for line in shape.lines)}"/>'
    if isinstance(shape, Band):
        way = f'd="{_path_data(shape.points)}{"Z" if shape.closed else ""}"'
        return f'<path{style} stroke-width="{coordinate_text(shape.width)}" {way}/>'
    return f'<path{style} d="{_path_data(shape.points)}{"Z" if isinstance(shape, Polygon) else ""}"/>'


def markup(text: str) -> str:
    """Return a text as it stands in an element, its lowered and raised signs as small ones of the same font.

    Few fonts have lowered signs of their own, and Cairo looks for them in no other.

    >>> markup("F₁₂")
    'F<tspan font-size="0.7em" dy="0.28em">12</tspan>'
    >>> markup("m₂g")
    'm<tspan font-size="0.7em" dy="0.28em">2</tspan><tspan dy="-0.196em">g</tspan>'
    """
    parts, shift = [], 0.0
    for run in SHIFTED_RUNS.findall(text):
        lowered = run[0] in LOWERED_SIGNS
        raised = run[0] in RAISED_SIGNS and not set(run) <= set(COMMON_SIGNS)
        target = LOWER if lowered else -HIGHER if raised else 0.0
        size, plain = (SMALL, run.translate(PLAIN_SIGNS)) if target else (1.0, run)
        small = f' font-size="{SMALL:g}em"' if target else ""
        moved = f' dy="{(target - shift) / size:.3g}em"'
        parts.append(escape(plain) if target == shift else f"<tspan{small}{moved}>{escape(plain)}</tspan>")
        shift = target
    return "".join(parts)


def _path_data(points: Sequence[complex]) -> str:
    return "M" + "L".join(_pair(point) for point in points)


def _pair(point: complex) -> str:
    return f"{coordinate_text(point.real)} {coordinate_text(point.imag)}"


def _class(style: str) -> str:
    return f' class="{" ".join(f"ck-{name}" for name in style.split())}"' if style else ""


def converted(source: str, form: str) -> bytes:
    """Return an SVG source as "png" or "pdf". Raises InvalidInput where CairoSVG is not installed."""
    try:
        import cairosvg
    except (ImportError, OSError) as error:
        what = f"{form.upper()} needs CairoSVG and the library Cairo: {error}"
        raise missing_extra(f".{form}", what, "pictures", "save an .svg") from None
    convert: Any = cairosvg.svg2png if form == "png" else cairosvg.svg2pdf
    extra = {"scale": FINE} if form == "png" else {}
    made: bytes = convert(bytestring=for_cairo(source).encode("utf-8"), **extra)
    return made


def on_light_paper(source: str) -> str:
    """Return the source without its rules for dark paper. CairoSVG would apply them to any."""
    start, end = source.find("@media"), source.find("</style>")
    return source[:start] + source[end:] if 0 <= start < end else source


def for_cairo(source: str) -> str:
    """Return the source as CairoSVG draws it right: on light paper, texts of several pieces set from their start.

    It would set each piece about the anchor of the text.
    """

    def from_start(found: re.Match[str]) -> str:
        head, anchor, rest, inside = found.groups()
        pieces = PIECES.findall(inside)
        width = sum(_ems(unescape(text)) * (SMALL if "font-size" in how else 1.0) for how, text in pieces)
        return f'{head} dx="{-width / (2.0 if anchor == "middle" else 1.0):.4g}em"{rest}>{inside}</text>'

    return ANCHORED.sub(from_start, on_light_paper(source))


@lru_cache(maxsize=1024)
def _ems(text: str) -> float:
    """Return the width of a text in Cairo's own font of the pictures, in ems."""
    from cairosvg.surface import cairo

    context: Any = cairo.Context(cairo.RecordingSurface(cairo.CONTENT_ALPHA, None))
    context.select_font_face("Helvetica")
    context.set_font_size(100.0)
    return float(context.text_extents(text)[4]) / 100.0


def require_cairo(form: str) -> None:
    """Raise InvalidInput where CairoSVG is not installed."""
    try:
        import cairosvg  # noqa: F401
    except (ImportError, OSError) as error:
        what = f"{form.upper()} needs CairoSVG and the library Cairo: {error}"
        raise missing_extra(f".{form}", what, "animation", "save an .svg") from None


def pixel_size(width: float, height: float, size: float) -> tuple[int, int]:
    """Return width and height in pixels, even numbers as films need them.

    The longer one is that of `size` or next to it.

    >>> pixel_size(300.0, 199.0, 640.0)
    (640, 424)
    """
    scale = size / max(width, height)
    return max(2, 2 * round(width * scale / 2.0)), max(2, 2 * round(height * scale / 2.0))


def pixels(source: str, width: int, height: int) -> Number:
    """Draw an SVG source on light paper, as bytes (height, width, 3). They are red, green, blue."""
    from cairosvg.parser import Tree
    from cairosvg.surface import PNGSurface

    tree = Tree(bytestring=for_cairo(source).encode("utf-8"))
    # drawn, but not packed as PNG and unpacked again, which takes longer than drawing
    surface: Any = PNGSurface(
        tree, None, DOTS_PER_INCH, output_width=width, output_height=height, background_color=PAPER[0]
    ).cairo
    surface.flush()
    rows = np.frombuffer(surface.get_data(), dtype=np.uint8).reshape(height, surface.get_stride())
    return np.ascontiguousarray(rows[:, : 4 * width].reshape(height, width, 4)[:, :, RED_GREEN_BLUE])
