"""Tasks of dimensional synthesis as data: poses, points, both, functions, swings, strokes; and conditions on answers.

A task has so many precision positions, which answers meet exactly, or within its `tolerance`. Angles are radians.
The functions of `task_words` make tasks of what users write.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Self

import numpy as np

from compoundkin.base.arguments import planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, count_phrase
from compoundkin.base.errors import InvalidInput, Problem

# Precision positions nearer to each other than this part of their extent are one.
SAME = 1e-9
# Of more places than so many the extent is that of the farthest in as many directions.
MANY = 256
# Preferences among answers, by what they are ranked.
PREFERENCES = TRANSMISSION, COMPACTNESS, ACCURACY = "transmission", "compactness", "accuracy"
# Links on the frame, beside the body of a task.
INPUT, OUTPUT = "input", "output"


@dataclass(frozen=True, eq=False, repr=False)
class Conditions(ShortRepr):
    """What answers must fulfil beside the task.

    `region` is a polygon (corners, complex) that holds all fixed pivots, `lengths` the least and greatest length
    between two joints, `ground` are places at which the fixed pivots must be. `transmission` is the least transmission
    angle (radians), `turning` whether the driver must turn fully. `prefer` ranks the answers. `obstacles` are polygons
    that pins, and the lines between points of a moving link, keep clear of.
    """

    region: Number = None
    lengths: tuple[float, float] | None = None
    ground: tuple[complex, ...] = ()
    transmission: float = 0.0
    turning: bool = False
    prefer: str = TRANSMISSION
    obstacles: tuple[Number, ...] = ()

    @classmethod
    def of(
        cls, region: Any, lengths: Any, ground: Any, transmission: float, turning: bool, prefer: str,
        obstacles: Any = None,
    ) -> Conditions:  # fmt: skip
        """Return conditions as users give them. Raises InvalidInput for what is none."""
        if prefer not in PREFERENCES:
            raise InvalidInput(Problem("prefer", f"{prefer!r} is no preference", f"one of {', '.join(PREFERENCES)}"))
        if not 0.0 <= transmission < np.pi / 2:
            raise InvalidInput(Problem("transmission", f"{transmission:g} is no transmission angle", "0 to pi / 2"))
        known = () if ground is None else tuple(places("ground", ground).tolist())
        if len(set(known)) < len(known):
            raise InvalidInput(Problem("ground", "a place is given twice", "no two fixed pivots are at one place"))
        return cls(
            _polygon("region", region), _bounds(lengths), known, transmission, turning, prefer, _obstacles(obstacles)
        )

    def seen_from(self, size: complex, middle: complex) -> Conditions:
        """Return the conditions on what is seen at p where it is at ``size * p + middle``."""
        region = None if self.region is None else (self.region - middle) / size
        lengths = None if self.lengths is None else (self.lengths[0] / abs(size), self.lengths[1] / abs(size))
        ground = tuple((place - middle) / size for place in self.ground)
        obstacles = tuple((obstacle - middle) / size for obstacle in self.obstacles)
        return replace(self, region=region, lengths=lengths, ground=ground, obstacles=obstacles)

    def holds(self, place: complex) -> bool:
        """Return whether the region holds a place."""
        return self.region is None or bool(inside(np.array([place]), self.region)[0])


def _polygon(where: str, region: Any) -> Number:
    """Return the corners of a region, given as two opposite corners or as a polygon."""
    if region is None:
        return None
    corners = places(where, region)
    if len(corners) == 2:
        low, high = corners
        corners = np.array([low, complex(high.real, low.imag), high, complex(low.real, high.imag)])
    if len(corners) < 2:
        raise InvalidInput(Problem(where, "one corner is no region", "give two opposite corners, or a polygon"))
    area = np.sum(np.conj(corners) * np.roll(corners, -1)).imag / 2.0
    if abs(area) <= SAME * np.ptp(np.abs(corners - corners[0])) ** 2:
        raise InvalidInput(Problem(where, "it has no area", "give two opposite corners, or a polygon"))
    return corners


def _obstacles(given: Any) -> tuple[Number, ...]:
    if given is None:
        return ()
    if not isinstance(given, Iterable) or isinstance(given, str | bytes | Mapping):
        raise InvalidInput(
            Problem("obstacles", "they are no polygons", "give a list of polygons, each a list of corners")
        )
    return tuple(_polygon(f"obstacles[{k}]", one) for k, one in enumerate(given))


def _bounds(lengths: Any) -> tuple[float, float] | None:
    if lengths is None:
        return None
    found = real_numbers("lengths", lengths)
    if found.shape != (2,) or not 0.0 <= found[0] < found[1]:
        raise InvalidInput(Problem("lengths", "they are no bounds", "give the least and the greatest length"))
    return float(found[0]), float(found[1])


def inside(place: Number, polygon: Number) -> Number:
    """Return whether places lie in a polygon, by how often a ray crosses its sides.

    >>> inside(np.array([0.5 + 0.5j, 2 + 0j]), np.array([0, 1, 1 + 1j, 1j])).tolist()
    [True, False]
    """
    a, b = polygon, np.roll(polygon, -1)
    p = np.asarray(place)[..., None]
    rising = (a.imag > p.imag) != (b.imag > p.imag)
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = a.real + (p.imag - a.imag) * (b - a).real / (b - a).imag
    return np.sum(rising & (p.real < cut), axis=-1) % 2 == 1


def meets(a: Number, b: Number, polygon: Number) -> Number:
    """Return whether straight lines from places to others meet a polygon: cross one of its sides, or lie in it.

    >>> meets(np.array([-1j, 0.5 - 1j]), np.array([1j, 0.5 + 1j]), np.array([0.1, 1, 1 + 0.5j])).tolist()
    [False, True]
    """
    p, q = polygon, np.roll(polygon, -1)
    a, b = np.asarray(a)[..., None], np.asarray(b)[..., None]

    def side(of: Number, to: Number, place: Number) -> Number:
        return (np.conj(to - of) * (place - of)).imag > 0.0

    crossed = (side(a, b, p) != side(a, b, q)) & (side(p, q, a) != side(p, q, b))
    return crossed.any(axis=-1) | inside(a[..., 0], polygon)


@dataclass(frozen=True, eq=False, repr=False)
class Task(ShortRepr):
    """What a mechanism is to do.

    `tolerance` is by how much answers may miss it (lengths, radians); zero asks for exact ones. `conditions` are set by
    `synthesise`.
    """

    tolerance: float = field(default=0.0, kw_only=True)
    conditions: Conditions = field(default_factory=Conditions, kw_only=True)

    def under(self, conditions: Conditions) -> Self:
        """Return the task under conditions."""
        return replace(self, conditions=conditions)

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return "a task"


@dataclass(frozen=True, eq=False, repr=False)
class PoseTask(Task):
    """Motion generation: a body `link` takes poses `z` (places of its origin) and `u` (unit vectors), arrays (n,).

    `velocities` are twists (velocity, angular velocity) at some of the poses, by their index: only their ratio counts,
    the pose and one infinitely near are met. `accelerations` are those with the twist of the same pose: three poses
    infinitely near. With `links` it goes along a course, `closed` or not, led by a linkage of at most so many links.
    """

    link: str
    z: Number
    u: Number
    velocities: Mapping[int, tuple[complex, float]] = field(default_factory=dict)
    accelerations: Mapping[int, tuple[complex, float]] = field(default_factory=dict)
    links: int = 0
    closed: bool = False

    @property
    def count(self) -> int:
        """How many poses there are, those infinitely near too."""
        return len(self.z) + len(self.velocities) + len(self.accelerations)

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        if self.links:
            return f"{self.link} along {'a closed' if self.closed else 'an open'} course of {self.count} poses"
        near = self.count - len(self.z)
        text = f"{self.link} through {count_phrase(len(self.z), 'pose')}"
        return f"{text}, {near} more infinitely near" if near else text


@dataclass(frozen=True, eq=False, repr=False)
class PointTask(Task):
    """Path generation: a coupler point goes through `points`, complex (n,), in this order."""

    points: Number

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"a point through {count_phrase(len(self.points), 'point')}"


@dataclass(frozen=True, eq=False, repr=False)
class TimedPointTask(Task):
    """Path generation with timing: a coupler point is at `points` when the crank has turned by `angles` (radians)."""

    points: Number
    angles: Number

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"a point through {count_phrase(len(self.points), 'point')} at given crank angles"


class CurveTiming(NamedTuple):
    """When a point is where on a curve: `parts` of the driver's turn from its begin, (n,), from 0 to 1 at its end.

    A closed curve ends a whole turn later. `turn` is the angle by which the driver turns meanwhile (radians), zero
    where any will do; in `either` sense, or in that of its sign.
    """

    parts: Number
    turn: float
    either: bool


@dataclass(frozen=True, eq=False, repr=False)
class CurveTask(Task):
    """A point traces a curve through `points`, complex (n,), of a linkage of at most so many `links`.

    A curve that is not `closed` is traced by a part of the driver's turn; the rest of it is free. Without a `timing`
    any will do.
    """

    points: Number
    closed: bool
    links: int
    timing: CurveTiming | None = None

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        how = "a closed curve" if self.closed else "an open curve"
        when = "" if self.timing is None else " with timing"
        return f"a point along {how} of {count_phrase(len(self.points), 'point')}{when}"


@dataclass(frozen=True, eq=False, repr=False)
class MixedTask(Task):
    """Poses of a body first, then points that its origin goes through with any orientation (Alt-Burmester)."""

    link: str
    z: Number
    u: Number
    points: Number

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"{self.link} through {count_phrase(len(self.z), 'pose')} and {count_phrase(len(self.points), 'point')}"


@dataclass(frozen=True, eq=False, repr=False)
class FunctionTask(Task):
    """Function generation: the output is at `outputs` where the input has turned by `inputs`, arrays (n,).

    `linkage` is "four-bar" (outputs are angles), "slider-crank" (displacements) or "inverted" (angles of a swinging
    block). Angles and displacements count from where the input is zero, at unknown places, unless they are
    `absolute`. `whole` is the function over its range, pairs (m, 2), over which the error of answers counts. With
    `links` it is followed by linkages of at most so many links, of an atlas.
    """

    inputs: Number
    outputs: Number
    linkage: str = "four-bar"
    absolute: bool = False
    whole: Number = None
    links: int = 0

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        if self.links:
            kind = "a displacement" if self.linkage == "slider-crank" else "an angle"
            return f"{kind} that follows {count_phrase(len(self.inputs), 'pair')}"
        return f"a {self.linkage} function of {count_phrase(len(self.inputs), 'pair')}"


@dataclass(frozen=True, eq=False, repr=False)
class SwingTask(Task):
    """A crank-rocker whose rocker swings by `angle`, forth and back in the ratio of times `time_ratio`."""

    angle: float
    time_ratio: float = 1.0

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"a swing of {np.rad2deg(self.angle):.6g} degrees in the time ratio {self.time_ratio:.6g}"


@dataclass(frozen=True, eq=False, repr=False)
class StrokeTask(Task):
    """A slide of stroke `length`, forth and back in the ratio of times `time_ratio`.

    `linkage` is "slider-crank", with an `offset` of the guide if given, or "crank-shaper".
    """

    length: float
    time_ratio: float = 1.0
    linkage: str = "slider-crank"
    offset: float | None = None

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"a {self.linkage} of stroke {self.length:.6g} in the time ratio {self.time_ratio:.6g}"


@dataclass(frozen=True, eq=False, repr=False)
class OutputTask(Task):
    """A second output about `pivot` takes `angles`, an array (n,), at the positions of a solved linkage, `base`."""

    base: Any
    angles: Number
    pivot: complex

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        return f"a second output at {count_phrase(len(self.angles), 'angle')} of {self.base.candidate.title}"


@dataclass(frozen=True, eq=False, repr=False)
class DwellTask(Task):
    """A six-bar whose output swings by `swing`, and rests at both ends while the crank turns by two `dwells`."""

    swing: float
    dwells: tuple[float, float]

    @property
    def in_words(self) -> str:
        """The task as a phrase."""
        first, second = (f"{np.rad2deg(one):.6g}" for one in self.dwells)
        return f"a swing of {np.rad2deg(self.swing):.6g} degrees with dwells of {first} and {second}"


def places(where: str, given: Any) -> Number:
    """Return places of the plane as complex numbers (n,), given so or as (n, 2). Raises InvalidInput."""
    found = planar_numbers(where, given)
    if found.ndim == 2 and found.shape[1] == 2 and not np.any(found.imag):
        found = found[:, 0].real + 1j * found[:, 1].real
    if found.ndim != 1:
        raise InvalidInput(Problem(where, "these are no places", "give (x, y) for each, or complex numbers"))
    check_finite(where, found)
    return found.astype(complex)


def extent(place: Number) -> float:
    """Return the size of a set of places, 1 for a single one.

    >>> extent(np.array([0, 3, 4j]))
    5.0
    """
    if len(place) > MANY:  # the farthest of so many directions: between any two the extent is less by 2e-5 at most
        ahead = np.exp(1j * np.pi * np.arange(MANY) / MANY)
        farthest = [each((place * np.conj(one)).real) for one in ahead for each in (np.argmin, np.argmax)]
        place = place[np.unique(farthest)]
    return float(np.max(np.abs(np.subtract.outer(place, place)), initial=0.0)) or 1.0


def check_finite(where: str, numbers: Number) -> None:
    """Raise InvalidInput for numbers that are not finite."""
    if not np.isfinite(numbers).all():
        raise InvalidInput(Problem(where, "some are not finite"))
