"""The visible parts of a mechanism at one pose: places of links and points, marks of its pairs, discs of its links."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number, entry, first_entry
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import fit
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outline_shapes import OutlineShape, outline_shapes
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.symbols import Mark, Outline, Pin, Sliding, Track, Wheel
from compoundkin.model.pairs.travel_limits import as_travel_limited, bounds_name
from compoundkin.structure import DrivenPair, Structure
from compoundkin.view.sketch.traced_numbers import as_place

# How large the drawn part of a picture is, in picture units: at least and at most its longer side. The middle of the
# links' lengths is drawn at least so long, if that is possible: many links make a large picture with fine lines.
LEAST, MOST = 480.0, 1200.0
BAR_LENGTH = 74.0
# Of so many bars or more the picture grows with their number.
FEW = 14
# Around it is room for letters, hatching and arrows.
MARGIN = 26.0
# A picture is at least so wide and so high, in picture units.
NARROWEST, LOWEST = 260.0, 130.0
# A line may be off by this much: no eye can tell.
DEVIATION = 0.12
# A path whose ends are nearer to each other than this part of its size is closed.
CLOSED = 1e-9
# A path of a long motion is drawn through so many of its places.
MOST_PLACES = 2001
# A path is drawn with so many points between two poses.
BETWEEN = 6


@dataclass(frozen=True)
class Window:
    """A part of the plane on a picture. `scale` picture units for a length unit, `corner` its upper left place."""

    scale: float
    corner: complex
    width: float
    height: float

    def at(self, place: Number) -> Number:
        """Return where a place is on the picture, y downward."""
        return ((place - self.corner) * self.scale).conjugate()

    def line(self, places: Number) -> tuple[complex, ...]:
        """Return a line through places as points of the picture. Those that it does not need are left out."""
        return simplified(np.atleast_1d(self.at(places)))

    def holds(self, point: complex, room: float = 0.0) -> bool:
        """Return whether a point is on the picture, and far from its edges. It must be so far from them."""
        return room <= point.real <= self.width - room and room <= point.imag <= self.height - room

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return float(np.hypot(self.width, self.height))


def box_around(points: Number, margin: float = MARGIN) -> tuple[complex, complex]:
    """Return the lower and the upper corner of a box around points with a margin."""
    known = np.asarray(points, dtype=complex)
    low, high = complex(known.real.min(), known.imag.min()), complex(known.real.max(), known.imag.max())
    return low - margin * (1 + 1j), high + margin * (1 + 1j)


def panel_around(points: Number, narrowest: float, margin: float = MARGIN) -> tuple[complex, float, float]:
    """Return the first corner, width and height of a panel around points, which are in its middle across."""
    low, high = box_around(points, margin)
    wide = max((high - low).real, narrowest)
    return low - (wide - (high - low).real) / 2.0, wide, (high - low).imag


def fitted_window(window: Window, points: Number, narrowest: float = NARROWEST) -> Window:
    """Return the window of the same scale that just holds some points. It has room for letters around them.

    It is no narrower than `narrowest`, its points in the middle.
    """
    low, high = box_around(points)
    extra = complex(max(0.0, narrowest - (high - low).real), max(0.0, LOWEST - (high - low).imag)) / 2.0
    low, high = low - extra, high + extra
    size = high - low
    return Window(
        window.scale, window.corner + low.conjugate() / window.scale, round(size.real, 1), round(size.imag, 1)
    )


def window_around(places: Iterable[Number], bars: Iterable[float]) -> Window:
    """Return the window on some places. It is finer where the lengths of links (`bars`) are many and short."""
    known = np.concatenate([np.ravel(p).astype(complex) for p in places] or [np.zeros(1, complex)])
    known = known[np.isfinite(known)]
    known = known if known.size else np.zeros(1, complex)
    low = complex(known.real.min(), known.imag.min())
    high = complex(known.real.max(), known.imag.max())
    wide, tall = high.real - low.real, high.imag - low.imag
    longer = max(wide, tall) or 1.0
    lengths = sorted(length for length in bars if length > 0)
    # the median; that of NumPy imports numpy.ma, which takes as long as all else here
    middle = lengths[(len(lengths) - 1) // 2 : len(lengths) // 2 + 1]
    usual = BAR_LENGTH * longer / (sum(middle) / len(middle)) if lengths else LEAST
    crowded = LEAST * np.sqrt(len(lengths) / FEW)
    scale = float(np.clip(max(usual, crowded), LEAST, MOST)) / longer
    return Window(scale, complex(low.real, high.imag), wide * scale, tall * scale)


def simplified(points: Number, deviation: float = DEVIATION) -> tuple[complex, ...]:
    """Return the points of a line that it needs to keep within a deviation. Source: Douglas and Peucker, 1973.

    >>> simplified(np.array([0, 1, 2, 2 + 1j]))
    (0j, (2+0j), (2+1j))
    """
    own, points = points, np.asarray(points, dtype=complex)
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    parts = [(0, len(points) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        inner = points[first + 1 : last] - points[first]
        chord = points[last] - points[first]
        length = abs(chord)
        off = np.abs((np.conjugate(chord) * inner).imag) / length if length > deviation else np.abs(inner)
        worst = int(np.argmax(off))
        if off[worst] > deviation:
            middle = first + 1 + worst
            keep[middle] = True
            parts += [(first, middle), (middle, last)]
    return tuple(as_place(p) for p in np.asarray(own)[keep])


def thinned(places: Number) -> Number:
    """Return some of many places, the first and the last among them.

    >>> len(thinned(np.zeros(100_001)))
    2001
    """
    chosen = np.linspace(0, len(places) - 1, min(len(places), MOST_PLACES)).round().astype(int)
    return places[chosen]


def smooth(places: Number) -> Number:
    """Return a smooth line through places, with points between them. Source: E. Catmull and R. Rom, 1974.

    >>> smooth(np.array([0, 1, 2, 3 + 0j])).real.round(3)[:4].tolist()
    [0.0, 0.167, 0.333, 0.5]
    """
    closed = abs(places[-1] - places[0]) <= CLOSED * np.max(np.abs(places - places[0]))
    before = places[-2] if closed else 2.0 * places[0] - places[1]
    after = places[1] if closed else 2.0 * places[-1] - places[-2]
    p = np.concatenate([[before], places, [after]])
    t = np.arange(BETWEEN)[:, None] / BETWEEN
    a, b, c, d = p[:-3], p[1:-2], p[2:-1], p[3:]
    slopes = (c - a) / 2.0, (d - b) / 2.0
    between = b + t * (slopes[0] + t * (3.0 * (c - b) - 2.0 * slopes[0] - slopes[1]))
    between = between + t**3 * (2.0 * (b - c) + slopes[0] + slopes[1])
    return np.append(between.T.ravel(), places[-1])


# Two poses are one if no link differs by more than this, in parts of the mechanism's size and in radians.
SAME_PLACE = 1e-6


@dataclass(frozen=True, eq=False)
class PairMark:
    """A mark of a pair, and the links that the pair joins."""

    pair: Pair
    mark: Mark
    members: tuple[str, ...]

    @property
    def link(self) -> str:
        """The link that carries the mark; of a slide that with the guide."""
        return self.members[0 if isinstance(self.mark, Sliding) else self.mark.member]


@dataclass(frozen=True, eq=False)
class Scene:
    """A mechanism at one pose of one design.

    `whole` holds the pose of each link along the motion, arrays (poses,) of the assembled ones; `here` at the pose
    shown, numbers with all their rates. `shown` is a motion with that pose, at the index `pose`; None for a mechanism
    that is shown as drawn.
    """

    structure: Structure
    whole: Mapping[str, Pose]
    here: Mapping[str, Pose]
    points: Mapping[str, Mapping[str, complex]]
    ends: Mapping[str, Ends]
    shown: Motion | None = None
    pose: tuple[int, int] = (0, 0)
    known: Number = None  # the indices of the assembled poses
    outlines: tuple[OutlineShape, ...] = ()

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.structure.mechanism

    def at(self, link: str, p: Number) -> complex:
        """Return where a point of a link is at the pose shown."""
        if type(p) is not complex:
            return as_place(self.here[link].place(p))
        # large mechanisms are painted group by group, and points asked for again and again
        found = self._found.get((link, p))
        if found is None:
            found = self._found[link, p] = as_place(self.here[link].place(p))
        return found

    @cached_property
    def _found(self) -> dict[tuple[str, complex], complex]:
        """Where points are that were asked for."""
        return {}

    def turned(self, link: str, along: Number) -> complex:
        """Return a direction on a link, in the world."""
        return as_place(self.here[link].u.c[0] * along)

    def places(self, letter: str) -> Number:
        """Return where a point is along the motion, (poses,)."""
        link = self.mechanism.carriers[letter][0]
        return np.atleast_1d(self.whole[link].place(self.points[link][letter]))

    def path(self, letter: str) -> list[Number]:
        """Return the path of a point along the motion. It is in pieces where poses between cannot be assembled."""
        places = self.places(letter)
        if self.known is None or len(places) != len(self.known):
            return [places]
        return np.split(places, np.flatnonzero(np.diff(self.known) > 1) + 1)

    @cached_property
    def letters(self) -> Mapping[str, complex]:
        """The places of all points at the pose shown, without points of the frame that no pair needs."""
        used = {letter for pair in self.structure.pairs for letter in pair.letters}
        found = {}
        for letter, links in self.mechanism.carriers.items():
            if links != (FRAME,) or letter in used:
                found[letter] = self.at(links[0], self.points[links[0]][letter])
        return found

    @cached_property
    def carried(self) -> Mapping[str, complex]:
        """The places of points that carry something.

        Without those of the frame alone, which tell where a guide is.
        """
        carriers = self.mechanism.carriers
        needed = {pair.letters[0] for pair in self.structure.pairs}
        return {k: place for k, place in self.letters.items() if k in needed or carriers[k] != (FRAME,)}

    @cached_property
    def pair_marks(self) -> tuple[PairMark, ...]:
        """The marks of all pairs."""
        return tuple(PairMark(pair, mark, pair.members) for pair in self.structure.pairs for mark in self._marks(pair))

    @cached_property
    def pins_at(self) -> Mapping[str, list[Pair]]:
        """The pairs that are drawn as pins, by their letters."""
        found: dict[str, list[Pair]] = {}
        for seen in self.pair_marks:
            if isinstance(seen.mark, Pin):
                found.setdefault(seen.pair.letters[0], []).append(seen.pair)
        return found

    @cached_property
    def other_marks(self) -> tuple[PairMark, ...]:
        """The marks of pairs that are no pins: in a large mechanism the fewest."""
        return tuple(seen for seen in self.pair_marks if not isinstance(seen.mark, Pin))

    def _marks(self, pair: Pair) -> tuple[Mark, ...]:
        ends, poses = self.ends[pair.name], tuple(self.whole[name] for name in pair.members)
        marks, ended = pair.glyph(ends, poses), as_travel_limited(pair)
        if ended is None:
            return marks
        known = self.ends.get(bounds_name(pair))
        bounds = ended.bounds(self.mechanism.geometry) if known is None else [side.point for side in known]
        return ended.with_ends(marks, (first_entry(bounds[0]), first_entry(bounds[1])), ends, poses)

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The numbers of the links. The frame is 1, the others follow as they are written."""
        return link_numbers(self.structure)

    @cached_property
    def legend(self) -> Mapping[str, int]:
        """The numbers of the visible links."""
        return {name: number for name, number in self.numbers.items() if name not in self.mechanism.auxiliary_links}

    @cached_property
    def groups(self) -> Mapping[str, int]:
        """Which group each link belongs to. It is 0 for the frame and driven links, then in solving order."""
        return link_groups(self.structure)

    @cached_property
    def driven(self) -> tuple[DrivenPair, ...]:
        """The driven pairs."""
        return tuple(self.structure.driven.values())

    def ghost(self, k: int) -> Scene:
        """Return the same scene at the k-th assembled pose of the motion."""
        poses = {name: Pose(pose.z, pose.u).trimmed(0).entry((k,)) for name, pose in self.whole.items()}
        return Scene(self.structure, self.whole, poses, self.points, self.ends, known=self.known)

    def compact(self, longest: float) -> Scene:
        """Return the scene with short guides, if one is used for longer.

        They are then as the pose shown uses them, not the whole motion.
        """
        spans = [seen.mark.high - seen.mark.low for seen in self.pair_marks if isinstance(seen.mark, Sliding)]
        return replace(self, whole=self.here) if max(spans, default=0.0) > longest else self

    @property
    def count(self) -> int:
        """The number of assembled poses of the motion."""
        return 1 if self.known is None else max(1, len(self.known))

    @property
    def closes(self) -> bool:
        """Whether every link is at the last assembled pose as at first."""
        size = self.mechanism.geometry.size
        ends = [(np.atleast_1d(pose.z.c[0]), np.atleast_1d(pose.u.c[0])) for pose in self.whole.values()]
        return all(abs(z[-1] - z[0]) <= SAME_PLACE * size and abs(u[-1] - u[0]) <= SAME_PLACE for z, u in ends)

    def rate(self, letter: str, k: int) -> complex:
        """Return the k-th derivative of where a point is, at the pose shown."""
        link = self.mechanism.carriers[letter][0]
        return complex(self.here[link].derivative(self.points[link][letter], k))

    def driver_value(self, name: str, k: int = 0) -> float:
        """Return a driver's value at the pose shown, or its speed (k = 1)."""
        if self.shown is None:
            return 1.0 if k else 0.0
        return float(_number(self.shown.inputs.drives[name][k], self.pose))


def link_numbers(structure: Structure) -> dict[str, int]:
    """Return the numbers of the links. The frame is 1, the others follow as written, what leads points last."""
    auxiliary = structure.mechanism.auxiliary_links
    others = sorted((name for name in structure.mechanism.links if name != FRAME), key=lambda name: name in auxiliary)
    return {name: k for k, name in enumerate([FRAME, *others], start=1)}


def link_groups(structure: Structure) -> dict[str, int]:
    """Return which group each link belongs to. It is 0 for the frame and driven links, then in solving order."""
    found = dict.fromkeys(structure.mechanism.links, 0)
    for k, group in enumerate(structure.groups, start=1):
        found.update(dict.fromkeys(group.links, k))
    return found


def scene_of_motion(motion: Motion, shown: Motion, design: int, pose: int) -> Scene:
    """Return the scene of a pose of `shown`. Its guides are used as in the whole `motion`."""
    known = np.flatnonzero(motion.failed[min(design, len(motion.failed) - 1)] == 0)
    at = min(design, shown.inputs.designs - 1), pose
    placed = motion.mechanism.geometry.points.items()
    points = {link: {k: complex(_number(p, at, shown)) for k, p in own.items()} for link, own in placed}
    ends = {
        name: tuple(End(*(_side(v, at) for v in end)) for end in sides) for name, sides in shown.inputs.ends.items()
    }
    whole = {name: _along(pose, design, known) for name, pose in motion.poses.items()}
    here = {name: pose.entry(at) for name, pose in shown.poses.items()}
    own = outline_shapes(motion.mechanism, points, motion.shape, design)
    return Scene(motion.structure, whole, here, points, ends, shown, at, known, own)


def _along(pose: Pose, design: int, known: Number) -> Pose:
    """A pose along the motion of one design, those places of it that are known."""
    parts = [None if v is None else np.atleast_2d(v.c[0]) for v in (pose.z, pose.u, pose.theta)]
    cut = [None if v is None else v[min(design, len(v) - 1)] for v in parts]
    z, u, theta = (None if v is None else constant(v[known] if len(v) > 1 else v) for v in cut)
    return Pose(z or constant(0j), u or constant(1 + 0j), theta)


def _number(value: Number, at: tuple[int, int], motion: Motion | None = None) -> Number:
    """A number of an array (1 or designs, 1 or poses), or of one that broadcasts with a motion's shape."""
    if np.ndim(value) == 0:
        return value
    return entry(value if motion is None else fit(motion.shape)(value), at)


def _side(value: Number, at: tuple[int, int]) -> Number:
    return None if value is None else _number(value.c[0] if isinstance(value, Series) else value, at)


# A point is on a wheel if it is not farther outside than this part of its radius.
ON_RIM = 0.02


def is_inside(scene: Scene, link: str) -> bool:
    """Return whether all points of a link are within a disc of its own."""
    own = np.array([complex(p) for p in scene.points[link].values()])
    return any(bool(np.all(inside)) for inside in _inside(scene, link, own))


def _inside(scene: Scene, link: str, own: Number) -> Iterator[Number]:
    """For each disc of a link, which of its points are within it."""
    for seen in scene.other_marks:
        mark = seen.mark
        if isinstance(mark, Wheel) and seen.link == link and not mark.is_ring:
            yield np.abs(own - complex(mark.at)) <= float(mark.radius) * (1.0 + ON_RIM)
        elif isinstance(mark, Outline) and seen.link == link and mark.closed and not mark.is_hollow:
            # a closed line goes once around a point within it
            line = np.append(mark.line, mark.line[:1])[:, None] - own
            with np.errstate(divide="ignore", invalid="ignore"):
                turned = np.angle(line[1:] / line[:-1]).sum(axis=0)
            yield np.abs(turned) > np.pi


def racks(scene: Scene) -> frozenset[str]:
    """Return the names of the links that carry a rack."""
    tracks = ((seen.members, seen.mark) for seen in scene.other_marks if isinstance(seen.mark, Track))
    return frozenset(members[mark.member] for members, mark in tracks if mark.pitch)


def smallest_wheel(scene: Scene, letter: str) -> float:
    """Return the least radius of the wheels about a point. It is infinite without wheels."""
    links = scene.mechanism.carriers[letter]
    return min(
        (
            float(seen.mark.radius)
            for seen in scene.other_marks
            if isinstance(seen.mark, Wheel)
            and (link := seen.link) in links
            and abs(complex(seen.mark.at) - complex(scene.points[link][letter])) <= ON_RIM * float(seen.mark.radius)
        ),
        default=np.inf,
    )
