"""DXF files: a pose on layers, the parts at true size, paths, profiles of cams."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.curves.samples import convex_hull
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.files.exchange.contract import Exported, Writable, flag, letters_of, positive
from compoundkin.files.exchange.dxf.dxf_pen import (
    RESERVED,
    CouplerPath,
    DxfPen,
    LegalNames,
    ProfileSpline,
    coupler_paths,
    drawn_letters,
    in_ascii,
    profile_spline,
    whole_motion,
)
from compoundkin.files.exchange.dxf.link_contours import LinkPart, link_parts
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.geometry import FRAME

# The number of each unit of length in $INSUNITS; the version whose files all programs read that know splines.
UNITS: Mapping[str, int] = MappingProxyType({"in": 1, "ft": 2, "mm": 4, "cm": 5, "m": 6, "um": 13, "dm": 14})


METRIC, ENGLISH, NO_UNIT = 1, 0, 0


VERSION = "R2000"


# Of parts the middle lines of slots and guides, which are not cut.
CENTRES = "CENTRES"


LINKS, JOINTS, GROUND, CRANKS, CURVES, NAMES = "LINKS", "JOINTS", "GROUND", "CRANKS", "CURVES", "NAMES"


# Each layer with its colour, by AutoCAD's index.
LAYERS: Mapping[str, int] = MappingProxyType(
    {LINKS: 5, JOINTS: 3, GROUND: 8, CRANKS: 1, CURVES: 6, NAMES: 7, CENTRES: 8}
)


POSE_LAYERS = tuple(name for name in LAYERS if name != CENTRES)


# How far curves may be off where it is not said, in parts of the mechanism's size.
CHORD = 1e-4


# No drawing is finer than this part of the mechanism's size.
FINEST = 1e-8


class DxfFormat(Writable):
    """Links as blocks at true size on layers; or the parts side by side."""

    name: ClassVar[str] = "dxf"
    program: ClassVar[str] = "CAD programs, laser cutters"
    title: ClassVar[str] = "DXF drawing"
    suffix: ClassVar[str] = ".dxf"
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "curves": "points whose paths are drawn, by commas; if left out those of outputs and of one link alone",
            "tolerance": "how far curves may be off, a length; 1/10000 of the mechanism's size if left out",
            "parts": "instead of a pose the parts side by side, as a laser cuts them: contours and holes alone",
        }
    )

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput where ezdxf is not installed or there is nothing to cut."""
        library = ezdxf(f".{self.name}")
        size = shown.mechanism.geometry.size
        tolerance = positive("tolerance", options.get("tolerance"), CHORD * size, FINEST * size)
        letters = _letters(shown, options.get("curves"))
        as_parts = flag("parts", options.get("parts"))
        motion = whole_motion(shown)
        parts = link_parts(shown, motion)
        splines = {id(curve): profile_spline(curve, tolerance) for part in parts for curve in part.profiles}
        paths = () if motion is None or as_parts else coupler_paths(motion, letters, tolerance)
        with fixed_dates(library):
            document = _document(library, shown, (NAMES, CENTRES) if as_parts else POSE_LAYERS)
            if as_parts:
                draw_parts(document, parts, splines, size)
            else:
                draw_pose(document, shown, parts, splines, size)
                draw_paths(document, paths)
            content = _content(document)
        errors = [*(path.error for path in paths), *(spline.error for spline in splines.values())]
        error = max(tolerance, *errors) if errors else None
        instead = "left out" if as_parts else "drawn as lines between their points"
        return Exported(content, self.name, tuple(_notes(shown, parts, error, instead)))


def _letters(shown: PosedMechanism, asked: Any) -> Sequence[str]:
    """The letters of paths; raises UnknownName."""
    if asked is None:
        return drawn_letters(shown)
    known = [letter for letter, links in shown.mechanism.carriers.items() if FRAME not in links]
    found = letters_of("curves", asked)
    for letter in found:
        if letter not in known:
            raise UnknownName(Problem("curves", f"no point {letter!r} moves", suggestion(letter, known)))
    return found


def _document(library: Any, shown: PosedMechanism, layers: Sequence[str]) -> Any:
    document = library.new(VERSION)
    unit = shown.mechanism.unit
    document.header["$INSUNITS"] = UNITS.get(unit, NO_UNIT)
    document.header["$MEASUREMENT"] = ENGLISH if unit in ("in", "ft") else METRIC
    for name in layers:
        document.layers.add(name, color=LAYERS[name])
    return document


def _content(document: Any) -> bytes:
    text = io.StringIO()
    document.write(text)
    return in_ascii(text.getvalue())


def _notes(shown: PosedMechanism, parts: Sequence[LinkPart], error: float | None, instead: str) -> Iterator[str]:
    unit = shown.mechanism.unit
    if not unit:
        yield "the lengths have no unit"
    elif unit not in UNITS:
        yield f"DXF has no number for the unit {unit!r}; lengths are written as they are"
    if error is not None:
        yield f"curves are within {error:.3g}{f' {unit}' if unit else ''} of the exact ones"
    if bare := [part.link for part in parts if not part.is_cut and part.link != FRAME]:
        yield f"links without an outline, {instead}: {', '.join(bare)}"


FORMAT = DxfFormat()


def ezdxf(where: str = "") -> Any:
    """Return `ezdxf`. Raises InvalidInput, which names a place, where it is not installed."""
    try:
        return import_module("ezdxf")
    except ImportError:
        raise InvalidInput(Problem(where, "DXF files need ezdxf", "pip install 'compoundkin[dxf]'")) from None


@contextmanager
def fixed_dates(library: Any) -> Iterator[None]:
    """Let it write fixed dates, so that the same drawing is the same bytes."""
    before = library.options.write_fixed_meta_data_for_testing
    library.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        library.options.write_fixed_meta_data_for_testing = before


# Room between parts, and how wide a row of them is, in parts of the mechanism's size.
ROOM, ROW = 0.05, 2.0


def draw_parts(document: Any, parts: Sequence[LinkPart], splines: Mapping[int, ProfileSpline], size: float) -> None:
    """Draw all parts that have a contour, in rows. Raises InvalidInput where none has."""
    cut = [part for part in parts if part.is_cut]
    if not cut:
        what = "no link has an outline, and there is no cam to cut"
        raise InvalidInput(Problem("parts", what, 'write outlines: outline("crank", 8, pin=5)'))
    model, names = document.modelspace(), LegalNames(NAMES, CENTRES, *RESERVED)
    corner, tallest = 0j, 0.0
    for part in cut:
        layers: list[int | None] = [sheet.layer for sheet in part.sheets]
        for layer in layers or [None]:
            low, high = _box(part, splines, layer)
            if corner.real > 0 and corner.real + (high - low).real > ROW * size:
                corner, tallest = complex(0.0, corner.imag - tallest - (2 * ROOM + LETTER) * size), 0.0
            by = corner - complex(low.real, high.imag)
            several = len(part.sheets) > 1
            name = names.of(f"{part.link} layer {layer}" if several else part.link)
            document.layers.add(name, color=7)
            draw_part(DxfPen(model, name, by), part, splines, layer)
            draw_centre_lines(DxfPen(model, CENTRES, by), part, splines)
            under = by + complex(low.real, low.imag - 1.4 * LETTER * size)
            DxfPen(model, NAMES).text(name, under, LETTER * size)
            corner += (high - low).real + ROOM * size
            tallest = max(tallest, (high - low).imag)


def _box(part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None) -> tuple[complex, complex]:
    """The corners of the box around a part's sheet."""
    places = list(_extremes(part, splines, layer))
    xs, ys = [p.real for p in places], [p.imag for p in places]
    return complex(min(xs), min(ys)), complex(max(xs), max(ys))


def _extremes(part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None) -> Iterator[complex]:
    for sheet in part.sheets:
        for contour in sheet.contours if layer in (None, sheet.layer) else ():
            for edge in contour:
                yield from (edge.start, edge.stop)
                if edge.centre is not None and edge.turn > 0:
                    ways = [edge.centre + edge.radius * way for way in (1, 1j, -1, -1j)]
                    yield from (place for place in ways if 0.0 <= edge.share_of(place) <= 1.0)
    for curve in part.profiles:
        yield from splines[id(curve)].control_points.tolist()


# Sizes of what has none of its own, in parts of the mechanism's: circles of joints, supports, letters.
JOINT, SUPPORT, LETTER = 0.01, 0.03, 0.025


def draw_pose(
    document: Any, shown: PosedMechanism, parts: Sequence[LinkPart], splines: Mapping[int, ProfileSpline], size: float
) -> None:
    """Draw a mechanism of a size at its pose."""
    model, names = document.modelspace(), LegalNames()
    for part in parts:
        block = document.blocks.new(names.of(f"LINK-{part.link}"))
        draw_part(DxfPen(block), part, splines)
        draw_centre_lines(DxfPen(block), part, splines)
        _draw_bars(DxfPen(block), part)
        pose = shown.poses[part.link]
        place, turn = complex(pose.z.c[0]), float(np.rad2deg(np.angle(complex(pose.u.c[0]))))
        on = GROUND if part.link == FRAME else CRANKS if part.link in shown.structure.driven else LINKS
        model.add_blockref(block.name, (place.real, place.imag), dxfattribs={"layer": on, "rotation": turn})
    _draw_joints(model, shown, parts, size)
    _draw_names(model, shown, parts, size)


def draw_part(pen: DxfPen, part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None = None) -> None:
    """Draw a link at true size: all its sheets, or that on one layer."""
    holes = DxfPen(pen.layout, JOINTS if layer is None else pen.layer, pen.by)
    drawn: set[object] = set()
    for sheet in part.sheets:
        for shape in (*sheet.contours, *sheet.holes):
            if layer in (None, sheet.layer) and shape not in drawn:
                (holes.circle if shape in sheet.holes else pen.contour)(*(shape if shape in sheet.holes else (shape,)))
                drawn.add(shape)
    for curve in part.profiles:
        if curve.closed:
            pen.spline(splines[id(curve)])


def draw_centre_lines(pen: DxfPen, part: LinkPart, splines: Mapping[int, ProfileSpline]) -> None:
    """Draw what has no width: guides, the middle lines of slots."""
    for guide in dict.fromkeys(part.guides):
        if guide[0] != guide[-1]:
            pen.line(guide)
    for groove in part.grooves:
        pen.arc(*groove)
    for curve in part.profiles:
        if not curve.closed:
            pen.spline(splines[id(curve)])


def _draw_bars(pen: DxfPen, part: LinkPart) -> None:
    """Draw wheels and belts; of a link without an outline lines between its points too."""
    for wheel in dict.fromkeys(part.wheels):
        pen.circle(*wheel)
    for belt in part.belts:
        pen.line(belt[:-1], closed=True)
    joints = DxfPen(pen.layout, JOINTS, pen.by)
    for place in dict.fromkeys(part.points.values()):
        joints.point(place)
    corners = convex_hull(part.points.values())
    if part.link != FRAME and not part.is_cut and len(corners) > 1:
        pen.line(corners, closed=True)


def draw_paths(document: Any, paths: Sequence[CouplerPath]) -> None:
    """Draw paths of points."""
    pen = DxfPen(document.modelspace(), CURVES)
    for path in paths:
        pen.line(path.places, path.closed)


def _draw_joints(model: Any, shown: PosedMechanism, parts: Sequence[LinkPart], size: float) -> None:
    """Draw a circle for each pin that has no hole of its own size, and a triangle under those of the frame."""
    with_holes = {(part.link, p) for part in parts for sheet in part.sheets for p, _ in sheet.holes}
    for letter, links in shown.mechanism.carriers.items():
        real = [link for link in links if link not in shown.mechanism.auxiliary_links]
        if len(real) < 2:
            continue
        at = shown.place(real[0], letter)
        if not any((link, shown.points[link][letter]) in with_holes for link in real):
            DxfPen(model, JOINTS).circle(at, JOINT * size)
        if FRAME in real:
            foot = SUPPORT * size
            DxfPen(model, GROUND).line((at, at - foot * (0.6 + 1j), at + foot * (0.6 - 1j)), closed=True)


def _draw_names(model: Any, shown: PosedMechanism, parts: Sequence[LinkPart], size: float) -> None:
    """Write the letters of points beside them, the names of links into their middle."""
    pen, height = DxfPen(model, NAMES), LETTER * size
    named = {letter: part.link for part in parts for letter in part.points}
    for letter, link in named.items():
        pen.text(letter, shown.place(link, letter) + JOINT * size * (1.5 + 1.5j), height)
    for part in parts:
        if part.link != FRAME and part.points:
            middle = sum(part.points.values()) / len(part.points)
            beside = 0j if len(part.points) > 1 else size * (1.5 - 4j) * JOINT
            pen.text(part.link, shown.place(part.link, middle) + beside, 0.8 * height)
