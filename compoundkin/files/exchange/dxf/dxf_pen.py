"""The pen of DXF: entities with legal names, profiles as splines, coupler paths as polylines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.curves import Curve
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined
from compoundkin.files.exchange.chords import short_chords
from compoundkin.files.exchange.dxf.link_contours import Contour
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
