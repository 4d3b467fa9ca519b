"""Drawn curves from files: a table of points, a path of an SVG, a polyline or spline of a DXF drawing."""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Container, Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, suffix_of
from compoundkin.files.parsed_document import unreadable

# Straight pieces of a curved one, and the part of its extent by which a DXF curve may be missed by them.
PIECES, MISSED = 24, 1e-3
_SEPARATORS = (";", "\t", ",", None)
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# Elements of an SVG that are curves, and those that are where there are no others.
_PATHS, _SHAPES = ("path", "polyline", "polygon"), ("rect", "circle", "ellipse")
# How many numbers each letter of an SVG path takes.
_COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_FLAGS = (3, 4)
# After which letters a smooth curve mirrors their last control point; after others it begins straight.
_MIRRORED = {"S": "CS", "T": "QT"}


def read_curve(path: str | os.PathLike[str], fewest: int = 0) -> Number:
    """Return the places along the curve of a file, complex (n,), y upward.

    A table has a point a line, in columns x and y (others, as of the time, need a heading that names them). Of an
    SVG the longest path, polyline or polygon is taken, else the longest rectangle, circle or ellipse, in its own
    units, with its transforms; of a DXF the longest polyline, spline, arc, circle or ellipse. Lines of a drawing with
    at most so many corners as `fewest` are given in pieces. Raises InvalidInput for a file that cannot be read or has
    no curve.
    """
    form = SUFFIXES["curve"].get(suffix_of(path))
    if form is None:
        raise unreadable(path, "curves are not read from such files", f"give one of {', '.join(SUFFIXES['curve'])}")
    curves = {"csv": _of_table, "svg": _of_svg, "dxf": _of_dxf}[form](_content(path), str(path))
    found = max(curves, key=lambda curve: float(np.abs(np.diff(curve)).sum()), default=np.zeros(0, complex))
    _check(path, found)
    if form != "csv" and len(found) <= fewest:  # lines of a drawing are as much of it as its corners
        many = -(-PIECES // (len(found) - 1)) * (len(found) - 1)
        steps = np.linspace(0.0, len(found) - 1.0, many + 1)
        found = np.interp(steps, np.arange(len(found)), found)
    return found


def read_timed_curve(path: str | os.PathLike[str], column: str) -> tuple[Number, Number]:
    """Return the places along the curve of a table, complex (n,), and another of its columns by its heading (n,).

    Raises InvalidInput for other files than tables, columns that are not there, and cells that are no numbers.
    """
    if SUFFIXES["curve"].get(suffix_of(path)) != "csv":
        raise unreadable(path, "only a table has columns", "give a .csv with a heading, such as t,x,y")
    table = _table(_content(path), str(path))
    _check(path, table.places)
    if not table.headings:
        raise InvalidInput(Problem(str(path), "no heading names its columns", f"put a first line: {column},x,y"))
    names = zip((cell.lower() for cell in table.headings), _words(table.headings), strict=True)
    at = next((k for k, both in enumerate(names) if column.lower() in both), None)
    if at is None:
        known = ", ".join(table.headings)
        raise InvalidInput(Problem(str(path), f"it has no column {column}", f"its columns are {known}"))
    values = [_real(row[at]) if at < len(row) else None for row in table.rows]
    if None in values:
        where = f"{path}: {', '.join(table.rows[values.index(None)])}"
        raise InvalidInput(Problem(where, f"there is no number in column {column}", "each point needs one"))
    return table.places, np.array(values)


def _content(path: str | os.PathLike[str]) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise unreadable(path, f"it cannot be read: {error.strerror or error}") from None


def _check(path: str | os.PathLike[str], curve: Number) -> None:
    """Raise InvalidInput for what is no curve."""
    if len(curve) < 2:
        raise unreadable(path, "there is no curve in it", "a curve is a path, a polyline, or two columns x and y")
    if not np.isfinite(curve).all():
        raise unreadable(path, "a number of the curve is not finite")


def _text(content: bytes, where: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise unreadable(where, f"it is not UTF-8 text (byte {error.start})", "save it as UTF-8") from None


class _PointTable(NamedTuple):
    """The headings of a table, none where there are no words; its rows that have a place, and these places (n,)."""

    headings: list[str]
    rows: list[list[str]]
    places: Number


def _of_table(content: bytes, where: str) -> list[Number]:
    return [_table(content, where).places]


def _table(content: bytes, where: str) -> _PointTable:
    rows = _rows(_lines(content, where))
    columns, first = _columns(rows, where)
    known, places = list[list[str]](), list[complex]()
    for k, row in enumerate(rows[first:], start=first + 1):
        cells = [row[c] if c < len(row) else "" for c in columns]
        x, y = map(_real, cells)
        if x is None or y is None:
            if not any(cells):  # an empty line of a table: where a tracker lost the point
                continue
            raise InvalidInput(Problem(f"{where}: line {k}", f"{', '.join(cells)} are no two numbers", "write x, y"))
        known.append(row)
        places.append(complex(x, y))
    has_headings = 0 < first <= len(rows) and {"x", "y"} <= set(_words(rows[first - 1]))
    return _PointTable(rows[first - 1] if has_headings else [], known, np.array(places, complex))


def _lines(content: bytes, where: str) -> list[str]:
    """Return the lines of a table but for empty ones and remarks."""
    return [line for line in _text(content, where).splitlines() if line.strip() and not line.lstrip().startswith("#")]


def _rows(lines: list[str]) -> list[list[str]]:
    separator = _separator(lines)
    return [[cell.strip(' "') for cell in line.split(separator)] for line in lines]


def _words(row: list[str]) -> list[str]:
    """Return the first words of cells, without units."""
    return [re.split(r"[\s(\[_]", cell.strip().lower())[0] for cell in row]


def _separator(lines: list[str]) -> str | None:
    """Return what parts the cells of the last line, None for blanks."""
    return next((one for one in _SEPARATORS if one is None or (lines and one in lines[-1])), None)


def _columns(rows: list[list[str]], where: str) -> tuple[tuple[int, int], int]:
    """Return the columns of x and y, and the index of the first row of numbers."""
    for k, row in enumerate(rows):
        words = _words(row)
        if "x" in words and "y" in words:
            return (words.index("x"), words.index("y")), k + 1
        if row and all(_real(cell) is not None for cell in row):
            if len(row) == 2:
                return (0, 1), k
            what = f"line {k + 1} has {len(row)} numbers, and no heading says which are x and y"
            raise InvalidInput(Problem(where, what, "put a first line with the names of the columns: t,x,y"))
    return (0, 1), len(rows)


def _real(cell: str) -> float | None:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return None


def _of_svg(content: bytes, where: str) -> list[Number]:
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise unreadable(where, f"it is no SVG: {error}") from None
    # a rectangle beside paths is the paper, commonly
    for kinds in (_PATHS, _SHAPES):
        if drawn := [np.conj(curve) for curve in _below(root, np.eye(3), where, kinds) if len(curve) > 1]:
            return drawn
    return []


def _below(element: ElementTree.Element, outer: Number, where: str, kinds: Container[str]) -> Iterator[Number]:
    """Yield the curves of an element and those in it, y downward as they are there."""
    matrix = outer @ _transform(element.get("transform", ""), where)
    kind = element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""
    curves: list[Number] = []
    if kind not in kinds:
        pass
    elif kind == "path":
        curves = _of_path(element.get("d", ""), where)
    elif kind in _SHAPES:
        curves = _of_path(_path_of(kind, element, where), where)
    elif kind in ("polyline", "polygon"):
        numbers = [float(one) for one in re.findall(_NUMBER, element.get("points", ""))]
        places = np.array(numbers[: len(numbers) // 2 * 2]).reshape(-1, 2) @ [1.0, 1.0j]
        curves = [np.append(places, places[:1]) if kind == "polygon" else places]
    for curve in curves:
        x, y, _ = matrix @ [curve.real, curve.imag, np.ones(len(curve))]
        yield x + 1j * y
    for child in element:
        yield from _below(child, matrix, where, kinds)


def _path_of(kind: str, element: ElementTree.Element, where: str) -> str:
    """Return the path of a rectangle, circle or ellipse. Source: SVG 2, W3C 2018, chapter 10."""
    names = {"rect": ("x", "y", "width", "height"), "circle": ("cx", "cy", "r", "r")}
    numbers = []
    for name in names.get(kind, ("cx", "cy", "rx", "ry")):
        match = re.fullmatch(rf"({_NUMBER})(px)?", element.get(name, "0").strip())
        if match is None:
            what = f"{name} of a {kind} is {element.get(name)}"
            raise InvalidInput(Problem(where, what, "write it as a number, or the shape as a path"))
        numbers.append(float(match[1]))
    x, y, wide, high = numbers
    if not (wide > 0.0 and high > 0.0):
        return ""
    if kind == "rect":
        return f"M{x},{y} h{wide} v{high} h{-wide} z"
    arc = f"a{wide},{high} 0 0 1"
    return f"M{x - wide},{y} {arc} {2.0 * wide},0 {arc} {-2.0 * wide},0"


def _transform(text: str, where: str) -> Number:
    """Return the matrix of a transform. Source: CSS Transforms 1, W3C 2019, chapter 8."""
    matrix = np.eye(3)
    for word, rest in re.findall(r"(\w+)\s*\(([^)]*)\)", text):
        numbers = [float(one) for one in re.findall(_NUMBER, rest)]
        own = np.eye(3)
        if word == "translate" and numbers:
            own[:2, 2] = [*numbers, 0.0][:2]
        elif word == "scale" and numbers:
            own[[0, 1], [0, 1]] = (numbers * 2)[:2]
        elif word == "rotate" and len(numbers) in (1, 3):
            c, s = np.cos(np.deg2rad(numbers[0])), np.sin(np.deg2rad(numbers[0]))
            own[:2, :2] = [[c, -s], [s, c]]
            about = np.array(numbers[1:] or [0.0, 0.0])
            own[:2, 2] = about - own[:2, :2] @ about
        elif word == "matrix" and len(numbers) == 6:
            own[:2] = np.reshape(numbers, (3, 2)).T
        else:
            raise InvalidInput(Problem(where, f"the transform {word}({rest}) is not read", "apply it in the drawing"))
        matrix = matrix @ own
    return matrix


def _of_path(text: str, where: str) -> list[Number]:
    """Return the pieces of an SVG path. Source: SVG 2, W3C 2018, chapter 9."""
    parts: list[list[complex]] = []
    handle, before = 0j, ""  # the last control point, which a smooth curve of its kind mirrors
    for letter, numbers in _commands(text, where):
        at = parts[-1][-1] if parts else 0j
        if letter in "Mm":
            parts.append([(at if letter == "m" else 0j) + complex(*numbers)])
        else:
            is_smooth = before in _MIRRORED.get(letter.upper(), "")
            new, handle = _next_places(letter, numbers, (parts[-1][0], at, handle if is_smooth else at))
            parts[-1] += new
            if letter in "Zz":
                parts.append(new)
        before = letter.upper()
    return [np.array(part) for part in parts if len(part) > 1]


def _next_places(
    letter: str, numbers: list[float], places: tuple[complex, complex, complex]
) -> tuple[list[complex], complex]:
    """Return the places along a command of a path, and its last control point.

    `places` are where the piece began, where the path is, and the control point that a smooth curve mirrors.
    """
    start, at, handle = places
    kind, origin = letter.upper(), at if letter.islower() else 0j
    if kind == "Z":
        return [start], start
    if kind == "H":
        return [complex(origin.real + numbers[0], at.imag)], at
    if kind == "V":
        return [complex(at.real, origin.imag + numbers[0])], at
    if kind == "A":
        return _arc(at, origin + complex(*numbers[5:]), numbers), at
    controls = [origin + complex(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
    if kind == "L":
        return controls, at
    if kind in _MIRRORED:
        controls.insert(0, 2 * at - handle)
    return _bezier([at, *controls]), controls[-2]


def _commands(text: str, where: str) -> Iterator[tuple[str, list[float]]]:
    """Yield the letters of a path with their numbers, repeated ones one by one."""
    found = re.findall(r"([MLHVCSQTAZmlhvcsqtaz])([^MLHVCSQTAZmlhvcsqtaz]*)", text)
    if found and found[0][0] not in "Mm":
        raise InvalidInput(Problem(where, f"a path begins with {found[0][0]}, not with M", "write the path anew"))
    for letter, rest in found:
        count = _COUNTS[letter.upper()]
        if not count:
            yield letter, []
            continue
        numbers = _arc_numbers(rest) if letter in "Aa" else [float(one) for one in re.findall(_NUMBER, rest)]
        if not numbers or len(numbers) % count:
            what = f"{letter} of a path has {len(numbers)} numbers, not a multiple of {count}"
            raise InvalidInput(Problem(where, what, "write the path anew"))
        for k in range(0, len(numbers), count):
            # further pairs after a move are lines
            after_move = {"M": "L", "m": "l"}.get(letter, letter) if k else letter
            yield after_move, numbers[k : k + count]


def _arc_numbers(text: str) -> list[float]:
    """Return the numbers of arcs, whose flags may stand without blanks."""
    found: list[float] = []
    place = 0
    while match := re.compile(r"[\s,]*(" + (r"[01]" if len(found) % 7 in _FLAGS else _NUMBER) + ")").match(text, place):
        found.append(float(match[1]))
        place = match.end()
    return found


def _bezier(controls: list[complex]) -> list[complex]:
    """Return places along a Bézier curve after its first, by de Casteljau's construction."""
    t = np.arange(1, PIECES + 1) / PIECES
    rows = [np.full(PIECES, one) for one in controls]
    while len(rows) > 1:
        rows = [(1 - t) * a + t * b for a, b in pairwise(rows)]
    return list(map(complex, rows[0]))


def _arc(start: complex, end: complex, numbers: list[float]) -> list[complex]:
    """Return places along an elliptic arc after its start. Source: SVG 2, appendix B.2.4."""
    rx, ry, tilt, large, sweep = (*map(abs, numbers[:2]), *numbers[2:5])
    if start == end or not rx or not ry:
        return [end]
    turn = np.exp(1j * np.deg2rad(tilt))
    # on the ellipse's axes, in its radii, it is a circle of radius one
    a, b = (complex((p / turn).real / rx, (p / turn).imag / ry) for p in (start, end))
    half = abs(b - a) / 2
    size = max(half, 1.0)  # radii that are too small grow
    off = np.sqrt(max(size**2 - half**2, 0.0)) * (1 if bool(large) != bool(sweep) else -1)
    centre = (a + b) / 2 + 1j * (b - a) / abs(b - a) * off
    angle = float(np.angle((b - centre) / (a - centre)))
    angle += 2 * np.pi * ((sweep and angle < 0) - (not sweep and angle > 0))
    around = centre + (a - centre) * np.exp(1j * angle * np.arange(1, PIECES + 1) / PIECES)
    places = turn * (around.real * rx + 1j * around.imag * ry)
    return [*map(complex, places[:-1]), end]


def _of_dxf(content: bytes, where: str) -> list[Number]:
    import io

    from compoundkin.files.exchange.dxf.dxf_format import ezdxf

    library = ezdxf(where)
    try:
        document = library.read(io.StringIO(content.decode("utf-8", errors="surrogateescape")))
    except (OSError, ValueError, library.DXFError) as error:
        raise unreadable(where, f"it is no DXF drawing: {' '.join(str(error).split())}") from None
    from ezdxf.path import make_path

    found = []
    for entity in document.modelspace().query("LWPOLYLINE POLYLINE SPLINE ARC CIRCLE ELLIPSE"):
        path = make_path(entity)
        corners = np.array([complex(p.x, p.y) for p in path.control_vertices()])
        size = float(np.abs(corners - corners[:1]).max(initial=0.0))
        if size:
            found.append(np.array([complex(p.x, p.y) for p in path.flattening(size * MISSED)]))
    return found
