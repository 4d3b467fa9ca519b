"""DXF files: a pose on layers, the parts at true size, paths, profiles of cams.

The pen writes entities with legal names, profiles as splines, coupler paths as polylines.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from math import inf
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import convex_hull
from compoundkin.base.errors import (
    InvalidInput,
    NotAssembled,
    NotDetermined,
    Problem,
    UnknownName,
    missing_extra,
    suggestion,
)
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.cam_profile import short_chords
from compoundkin.files.exchange.contract import Exported, Writable, flag, letters_of, positive
from compoundkin.files.exchange.dxf.link_contours import Contour, LinkPart, link_parts
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.geometry import FRAME

# Entities on this layer of a block take that of the block.
OF_BLOCK = "0"


@dataclass(frozen=True)
class DxfPen:
    """What draws on one layer of a layout, a block or the model.

    All is moved `by` a distance.
    """

    layout: Any
    layer: str = OF_BLOCK
    by: complex = 0j

    def contour(self, edges: Contour) -> None:
        """Draw a closed contour, with arcs as bulges; a whole circle as one."""
        centre = edges[0].centre
        if centre is not None and all(edge.centre == centre for edge in edges):
            self.circle(centre, edges[0].radius)
            return
        corners = [(*self._pair(edge.start), edge.bulge) for edge in edges]
        self.layout.add_lwpolyline(corners, format="xyb", close=True, dxfattribs=self._own)

    def line(self, places: Sequence[complex] | Number, closed: bool = False) -> None:
        """Draw a line through places; a straight one as such."""
        ends = [self._pair(place) for place in places]
        if len(ends) == 2:
            self.layout.add_line(*ends, dxfattribs=self._own)
        else:
            self.layout.add_lwpolyline(ends, close=closed, dxfattribs=self._own)

    def circle(self, centre: complex, radius: float) -> None:
        """Draw a circle."""
        self.layout.add_circle(self._pair(centre), radius, dxfattribs=self._own)

    def arc(self, centre: complex, radius: float, start: float, stop: float) -> None:
        """Draw an arc counterclockwise between angles in radians."""
        angles = [float(np.rad2deg(angle)) for angle in (start, stop)]
        self.layout.add_arc(self._pair(centre), radius, *angles, dxfattribs=self._own)

    def spline(self, spline: ProfileSpline) -> None:
        """Draw a cubic spline."""
        own = self.layout.add_spline(degree=3, dxfattribs=self._own)
        own.control_points = [(*self._pair(place), 0.0) for place in spline.control_points]
        own.knots = spline.knots.tolist()

    def point(self, place: complex) -> None:
        """Mark a place."""
        self.layout.add_point(self._pair(place), dxfattribs=self._own)

    def text(self, text: str, place: complex, height: float) -> None:
        """Write a text that begins at a place."""
        self.layout.add_text(literal(text), height=height, dxfattribs={**self._own, "insert": self._pair(place)})

    @property
    def _own(self) -> dict[str, str]:
        return {"layer": self.layer}

    def _pair(self, place: complex) -> tuple[float, float]:
        moved = complex(place) + self.by
        return moved.real, moved.imag


# What AutoCAD refuses in names of layers and blocks.
_REFUSED = re.compile(r"[<>/\\\":;?*|=`,]")


LONGEST = 200


# Layers that every file has, or that are not plotted.
RESERVED = ("0", "Defpoints")


# The last letter that DXF can write out.
LAST = 0xFFFF


def in_ascii(text: str) -> bytes:
    r"""Return a text with other letters written out as DXF has it.

    No code page matters then.

    >>> in_ascii("bär")
    b'b\\U+00E4r'
    """
    return "".join(c if c.isascii() else f"\\U+{ord(c):04X}" for c in text).encode("ascii")


def sayable(text: str) -> str:
    """Return a text with `_` for what DXF cannot say.

    That is what does not print, and letters beyond four digits.
    """
    return "".join(c if c.isprintable() and ord(c) <= LAST else "_" for c in text)


def literal(text: str) -> str:
    r"""Return a text in which signs that would command something stand for themselves.

    >>> print(literal("50%%c x^2"))
    50%%%%%%c x^ 2
    """
    return sayable(text).replace("%%", "%%%%%%").replace("^", "^ ").replace("\\U+", "\\U+005CU+")


class LegalNames:
    """Names given so far, each once.

    >>> names = LegalNames()
    >>> names.of("bar"), names.of("Bar"), names.of("a/b")
    ('bar', 'Bar-2', 'a_b')
    """

    def __init__(self, *taken: str) -> None:
        self._used = {name.casefold() for name in taken}

    def of(self, wanted: str) -> str:
        """Return a name like the one wanted, that nothing has yet."""
        name = own = _REFUSED.sub("_", sayable(wanted)).strip()[:LONGEST] or "_"
        k = 1
        while own.casefold() in self._used:
            k += 1
            own = f"{name}-{k}"
        self._used.add(own.casefold())
        return own


# The curve is first cut into so many pieces, besides at its own breaks; each is halved so often at most.
FIRST, HALVINGS = 16, 14


# Shares of a piece at which the error is looked for.
LOOKED_AT = np.linspace(0.0, 1.0, 10)[1:-1]


@dataclass(frozen=True, eq=False)
class ProfileSpline:
    """Cubic pieces with the curve's own places and tangents at the ends. `error` bounds how far it is off between."""

    parameters: Number
    places: Number
    slopes: Number
    error: float

    @property
    def control_points(self) -> Number:
        """The control points of it as a B-spline.

        They are a tangent both ways of each place, and both ends.
        """
        third = np.diff(self.parameters) / 3.0
        inner = np.stack((self.places[:-1] + self.slopes[:-1] * third, self.places[1:] - self.slopes[1:] * third), -1)
        return np.concatenate((self.places[:1], inner.ravel(), self.places[-1:]))

    @property
    def knots(self) -> Number:
        """The knots that belong to them."""
        s = self.parameters
        return np.concatenate((np.repeat(s[0], 4), np.repeat(s[1:-1], 2), np.repeat(s[-1], 4)))


def profile_spline(curve: Curve, tolerance: float) -> ProfileSpline:
    """Return a cubic spline that is nowhere farther from a curve than a tolerance.

    It is compared at eight places of each piece, by parameter, which is no less than the distance. Source: C. de Boor,
    A Practical Guide to Splines, revised ed., chapter IV: the error falls with the fourth power of the length.

    >>> from compoundkin.base.curves.curve import Analytic
    >>> circle = Analytic(lambda s: s.turn() * 2.0, 0.0, 2 * np.pi, closed=True)
    >>> found = profile_spline(circle, 2e-4)
    >>> found.error <= 2e-4, len(found.parameters)
    (True, 17)
    """
    within = [s for s in curve.breaks if curve.low < s < curve.high]
    s = np.unique([*np.linspace(curve.low, curve.high, FIRST + 1), *within])
    error = inf
    for _ in range(HALVINGS):
        places, slopes = curve.expansion(s, 1)
        off = np.abs(_cubic(s, places, slopes) - _own(curve, s)).max(axis=-1)
        error = float(off.max())
        if error <= tolerance:
            break
        s = np.sort(np.append(s, 0.5 * (s[:-1] + s[1:])[off > tolerance]))
    return ProfileSpline(s, places, slopes, error)


def _own(curve: Curve, s: Number) -> Number:
    """The places of the curve within the pieces, (pieces, places)."""
    return curve.expansion(s[:-1, None] + np.diff(s)[:, None] * LOOKED_AT, 0)[0]


def _cubic(s: Number, places: Number, slopes: Number) -> Number:
    """Those of the cubic pieces with the same ends and slopes."""
    h, t = np.diff(s)[:, None], LOOKED_AT
    a, b, v, w = places[:-1, None], places[1:, None], slopes[:-1, None] * h, slopes[1:, None] * h
    return a + t * v + t**2 * (3.0 * (b - a) - 2.0 * v - w) + t**3 * (2.0 * (a - b) + v + w)


# A path whose ends are nearer to each other than this part of the size is closed, one that is shorter is none.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class CouplerPath:
    """The path of a point, or a piece of it between gaps.

    `places` are complex; that of a closed one does not have its first place again. Chords are
    off by the `error` at most.
    """

    letter: str
    places: Number
    closed: bool
    error: float


def whole_motion(shown: PosedMechanism) -> Motion | None:
    """Return the motion over the drivers' own ranges; None where there is none."""
    if shown.motion is not None and shown.motion.inputs.poses > 1:
        return shown.motion
    try:
        motion = quietly_solved(shown.structure)
    except (InvalidInput, NotAssembled, NotDetermined):
        return None
    return motion if motion.inputs.poses > 1 else None


def drawn_letters(shown: PosedMechanism) -> tuple[str, ...]:
    """Return the points whose paths people expect.

    They are those among the outputs, and those of one moving link alone.
    """
    mechanism = shown.mechanism
    asked = {name.partition(".")[0] for name in mechanism.outputs}
    return tuple(
        letter
        for letter, links in mechanism.carriers.items()
        if FRAME not in links and (letter in asked or len(links) == 1) and links[0] not in mechanism.auxiliary_links
    )


def coupler_paths(motion: Motion, letters: Sequence[str], tolerance: float) -> tuple[CouplerPath, ...]:
    """Return the paths of points by chords within a tolerance.

    The motion is solved again between its poses until the middle of no step is.
    """
    if not letters:
        return ()
    s = np.arange(motion.inputs.poses, dtype=float)
    _, rows, error = short_chords(s, lambda s: _places(motion, letters, s), tolerance)
    size = motion.size
    return tuple(path for letter, row in zip(letters, rows, strict=True) for path in _pieces(letter, row, size, error))


def _places(motion: Motion, letters: Sequence[str], s: Number) -> Number:
    """Where points are at places along the motion, (letters, places); not a number where it is not assembled."""
    found = between(motion, 0, s, order=0)
    return np.array([np.broadcast_to(found.points[letter].position, s.shape) for letter in letters])


def _pieces(letter: str, row: Number, size: float, error: float) -> Iterator[CouplerPath]:
    """Yield the known pieces of a path."""
    known = np.isfinite(row)
    for part in np.split(np.arange(len(row)), np.flatnonzero(np.diff(known.astype(int))) + 1):
        places = row[part]
        if known[part[0]] and np.abs(places - places[0]).max() > SAME * size:
            closed = len(part) == len(row) and abs(places[-1] - places[0]) <= SAME * size
            yield CouplerPath(letter, places[:-1] if closed else places, closed, error)


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
    suffix: ClassVar[str] = suffix_for("curve", "dxf")
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
        raise missing_extra(where, "DXF files need ezdxf", "dxf") from None


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
