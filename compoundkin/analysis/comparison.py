"""`compare`: two mechanisms side by side: their structures, their dimensions, and how far apart they move.

From a pose that both have in common their drivers are moved by equal displacements. Drivers correspond where they
are of one kind and move the points alike; a sign of -1 says that the two count in opposite directions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from math import tau

import numpy as np

from compoundkin.analysis.common_pose import CommonPose, common_pose
from compoundkin.analysis.correspondence import (
    ComparedMechanism,
    compared_mechanism,
    link_partners,
    partners_by_place,
    tracers_by_name,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, first_entry, wrapped
from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose, roman

# Two mechanisms count as equal up to this distance, a part of their size: files of other programs have three decimals
# of numbers up to a hundred or so, and a mechanism magnifies their rounding somewhat.
TOLERANCE = 1e-4
# Distances below this part of the size are rounding.
ROUNDING = 1e-12
# A full turn is compared in steps of two degrees.
POSES = 181
# A range within this of a full turn is one.
_ROUNDING = 1e-6
# For links with more points the distances from the first two suffice.
_ALL_DISTANCES = 5


@checked
def compare(one: Mechanism, other: Mechanism) -> MechanismComparison:
    """Compare two mechanisms: structure, dimensions, and how far apart they come when moved alike.

    They move from a common pose by the same displacements of their drivers, over the common range. Points correspond
    that are in the same places there and move alike, else those of the same name; drivers correspond that move these
    points alike. Lengths of the second are converted by the units; without units, or where that fits nothing, they are
    taken as written, or times a power of ten. The frames have the same axes.

    Mechanisms that cannot be solved or have nothing in common raise nothing: `why` of the comparison has the reason.

    >>> from compoundkin.model.elements import drive, drawn, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> other = Mechanism("Other", link("frame", "O"), link("arm", "O", "Q"), drive("arm"), drawn(O=0, Q=2j))
    >>> found = compare(crank, other)
    >>> found.points, found.largest.distance < 1e-12
    ({'A': 'O', 'B': 'Q'}, True)
    """
    structures = decompose(one), decompose(other)
    facts = compared_facts(*structures)
    known = MechanismComparison(structures, 1.0, 0.0, "", {}, {}, facts)
    try:
        return _moved(known)
    except (InvalidInput, NotAssembled, NotDetermined) as error:
        return replace(known, why=error.problems[0].what if error.problems else str(error))


@dataclass(frozen=True)
class ComparedFact:
    """A fact about both mechanisms, in words."""

    what: str
    one: str
    other: str

    @property
    def differs(self) -> bool:
        """Whether the two differ."""
        return self.one != self.other


@dataclass(frozen=True)
class ComparedLength:
    """The distance of two points on a link of each mechanism, in the unit of the first."""

    link: str
    other_link: str
    points: tuple[str, str]
    other_points: tuple[str, str]
    one: float
    other: float

    @property
    def difference(self) -> float:
        """The second length minus the first."""
        return self.other - self.one


@dataclass(frozen=True)
class ComparedDriver:
    """A driver of each mechanism; `sign` is -1 where the two count in opposite directions.

    `start` are their values at the common pose, `other_start` in the second's own unit and sense, `reach` the range of
    displacements from there that both have: radians, or the first's unit of length. `speed` and `other_speed` are their
    speeds at the start, the second's in the first's unit and sense. Driven alike, both go at any speed.
    """

    name: str
    other: str
    is_angle: bool
    sign: int
    start: float
    other_start: float
    reach: tuple[float, float] = (0.0, 0.0)
    speed: float = 1.0
    other_speed: float = 1.0


@dataclass(frozen=True)
class PlaceDifference:
    """The greatest distance of corresponding points, at the driver values `drives` of the first."""

    point: str
    other: str
    distance: float
    drives: Mapping[str, float]


@dataclass(frozen=True)
class TurnDifference:
    """The greatest difference of the angles (radians from the first pose) of corresponding links."""

    link: str
    other: str
    angle: float
    drives: Mapping[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class MechanismComparison(DisplaysHtml):
    """Two mechanisms side by side, all lengths in the unit of the first, those of the second times `scale`.

    `points` and `links` map names of the first to those of the second. `places` are the points' greatest distances over
    `poses` poses, the greatest first, `turns` the differences of links whose angle no two points define; `only_one` and
    `only_other` are points without a counterpart. `apart` poses can be assembled in one of the two alone. Where the
    motions are not compared, `why` has the reason.
    """

    structures: tuple[Structure, Structure]
    scale: float
    size: float
    matched_by: str
    points: Mapping[str, str]
    links: Mapping[str, str]
    facts: tuple[ComparedFact, ...]
    lengths: tuple[ComparedLength, ...] = ()
    drivers: tuple[ComparedDriver, ...] = ()
    places: tuple[PlaceDifference, ...] = ()
    turns: tuple[TurnDifference, ...] = ()
    motions: tuple[Motion, Motion] | None = None
    poses: int = 0
    apart: int = 0
    why: str = ""

    @property
    def only_one(self) -> tuple[str, ...]:
        """The points of the first without a counterpart."""
        return tuple(k for k in self.structures[0].mechanism.carriers if k not in self.points)

    @property
    def only_other(self) -> tuple[str, ...]:
        """The points of the second without a counterpart."""
        known = set(self.points.values())
        return tuple(k for k in self.structures[1].mechanism.carriers if k not in known)

    @property
    def largest(self) -> PlaceDifference | None:
        """The greatest distance of all points, None where the motions are not compared."""
        return self.places[0] if self.places else None

    def within(self, tolerance: float = TOLERANCE) -> bool:
        """Return whether all points agree within this part of the size, and all links within as many radians.

        Points without a counterpart do not count.
        """
        if not self.places or self.apart:
            return False
        # NaN is no agreement
        near = all(one.distance <= tolerance * self.size for one in self.places)
        return near and all(one.angle <= tolerance for one in self.turns)

    @property
    def verdict(self) -> str:
        """The result in words."""
        largest = self.largest
        if largest is None:
            return f"the motions are not compared: {self.why}"
        unit = f" {self.structures[0].mechanism.unit}".rstrip()
        result = f"at most {largest.distance:.3g}{unit} apart, at {largest.point}"
        result = "they move alike to rounding" if largest.distance <= ROUNDING * self.size else result
        missing = f"; {count_phrase(self.apart, 'pose')} can be assembled in one of them alone" if self.apart else ""
        return f"{result}{missing}"

    def __repr__(self) -> str:
        one, other = (structure.mechanism.title for structure in self.structures)
        return f"MechanismComparison({one!r} with {other!r}: {self.verdict})"


def _moved(known: MechanismComparison) -> MechanismComparison:
    """Return a comparison with that of the motions. Raises as `solve`."""
    common = common_pose(*map(compared_mechanism, known.structures))
    if common is None:
        return replace(known, why="they have no pose in common, and few points of the same names")
    known = replace(known, scale=common.other.scale, size=common.one.size, matched_by=common.matched_by)
    known = _dimensioned(known, dict(common.points))
    course = SharedCourse(common, driver_partners(common))
    counts = len(common.one.motion.drives), len(common.other.motion.drives)
    if len(course.drivers) < max(counts):
        return replace(known, drivers=tuple(course.drivers), why="their drivers do not correspond")
    known = _dimensioned(known, course.points)
    if not course.both.size:
        return replace(known, drivers=tuple(course.drivers), why="no pose can be assembled in both")
    places = sorted(course.places(), key=lambda one: -one.distance)
    return replace(
        known,
        drivers=tuple(course.drivers),
        places=tuple(places),
        turns=tuple(course.turns(_links_without_two_points(known))),
        motions=course.motions,
        poses=int(course.both.size),
        apart=course.apart,
    )


def _dimensioned(known: MechanismComparison, points: dict[str, str]) -> MechanismComparison:
    """Return a comparison with corresponding points, the links that follow and their lengths."""
    mechanisms = known.structures[0].mechanism, known.structures[1].mechanism
    links = link_partners(*mechanisms, points)
    lengths = tuple(_compared_lengths(*mechanisms, links, points, known.scale))
    return replace(known, points=points, links=links, lengths=lengths)


def _links_without_two_points(known: MechanismComparison) -> dict[str, str]:
    """Return the moving links without two distinct points, whose angle places do not define."""
    defined = {length.link for length in known.lengths if min(length.one, length.other) > 0.0}
    return {name: partner for name, partner in known.links.items() if name not in defined and name != FRAME}


def _compared_lengths(
    one: Mechanism, other: Mechanism, links: Mapping[str, str], points: Mapping[str, str], scale: float
) -> Iterator[ComparedLength]:
    """Yield the distances of the common points of links, those of the second times `scale`."""
    for name, partner in links.items():
        mine, theirs = one.geometry.points.get(name, {}), other.geometry.points.get(partner, {})
        letters = [k for k in mine if points.get(k) in theirs]
        pairs = list(combinations(letters, 2))
        if len(letters) > _ALL_DISTANCES:
            pairs = [two for two in pairs if two[0] in letters[:2]]
        for a, b in pairs:
            like = points[a], points[b]
            lengths = abs(first_entry(mine[a] - mine[b])), scale * abs(first_entry(theirs[like[0]] - theirs[like[1]]))
            yield ComparedLength(name, partner, (a, b), like, float(lengths[0]), float(lengths[1]))


def compared_facts(one: Structure, other: Structure) -> tuple[ComparedFact, ...]:
    """Return the facts of both structures, in words.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> compared_facts(*[decompose(load(name)) for name in ("crank-rocker", "six-bar")])[1]
    ComparedFact(what='pairs', one='4 R', other='6 R + 1 P')
    """
    mine, theirs = _facts(one), _facts(other)
    return tuple(ComparedFact(what, mine[what], theirs[what]) for what in mine)


def _facts(structure: Structure) -> dict[str, str]:
    return {
        "links": str(len(structure.mechanism.links)),
        "pairs": " + ".join(f"{count.number} {count.code}" for count in structure.mobility.pairs),
        "mobility": str(structure.mobility.freedoms),
        "independent loops": str(len(structure.loops)),
        "drivers": ", ".join(structure.driven) or "none",
        "Assur groups": ", ".join(group.name for group in structure.groups) or "none",
        "class": roman(max((group.class_ for group in structure.groups), default=1)),
        "unit of length": structure.mechanism.unit or "none",
    }


@dataclass(frozen=True, eq=False)
class SharedCourse:
    """Both mechanisms at the same displacements of their drivers."""

    common: CommonPose
    drivers: Sequence[ComparedDriver]

    @cached_property
    def displacements(self) -> Mapping[str, Number]:
        """The displacements of the first's drivers from the common pose."""
        poses = POSES if any(low < high for low, high in (driver.reach for driver in self.drivers)) else 1
        return {driver.name: np.linspace(*driver.reach, poses) for driver in self.drivers}

    @cached_property
    def motions(self) -> tuple[Motion, Motion]:
        """The two motions. Raises NotAssembled where one has no pose at all."""
        mine, theirs = dict(self.common.values), dict[str, Number](self.common.other_values)
        for driver in self.drivers:
            moved = self.displacements[driver.name]
            scale = driver.sign / (1.0 if driver.is_angle else self.common.other.scale)
            mine[driver.name] = driver.start + moved
            theirs[driver.other] = driver.other_start + scale * moved
        return self.common.one.at(mine, 0), self.common.other.at(theirs, 0)

    @cached_property
    def assembled(self) -> tuple[Number, Number]:
        """Whether each is assembled, (poses,)."""
        one, other = (np.ravel(motion.assembled) for motion in self.motions)
        return one, other

    @property
    def apart(self) -> int:
        """The number of poses that can be assembled in one of the two alone."""
        return int(np.count_nonzero(self.assembled[0] != self.assembled[1]))

    @cached_property
    def both(self) -> Number:
        """The indices of the common poses."""
        return np.flatnonzero(self.assembled[0] & self.assembled[1])

    @cached_property
    def points(self) -> dict[str, str]:
        """The corresponding points: of several in one place those that move alike.

        The remaining tracers, elsewhere on their links, correspond by name.
        """
        one, other = self.common.one, self.common.other
        if self.common.matched_by != "place":
            return dict(self.common.points)
        there = one.places(one.at(self.common.values, 0)), other.places(other.at(self.common.other_values, 0))
        at_one, at_other = one.places(self.motions[0]), other.places(self.motions[1])
        mine, theirs = np.concatenate([there[0], at_one]), np.concatenate([there[1], at_other])
        points = partners_by_place(one, mine, other, theirs)
        return points | tracers_by_name(one, other, points)

    def places(self) -> Iterator[PlaceDifference]:
        """Yield the greatest distances of points."""
        one, other = self.common.one, self.common.other
        at_one, at_other = one.places(self.motions[0])[self.both], other.places(self.motions[1])[self.both]
        for letter, partner in self.points.items():
            off = np.abs(at_one[:, one.letters.index(letter)] - at_other[:, other.letters.index(partner)])
            if off.size:
                worst = int(off.argmax())
                yield PlaceDifference(letter, partner, float(off[worst]), self._drives(worst))

    def turns(self, links: Mapping[str, str]) -> Iterator[TurnDifference]:
        """Yield the greatest differences of the angles of `links`."""
        for name, partner in links.items():
            angles = [
                np.ravel(motion.links[link].angle)[self.both]
                for motion, link in zip(self.motions, (name, partner), strict=True)
            ]
            off = angles[0] - angles[1]
            if off.size:
                off = np.abs(wrapped(off - off[0]))
                worst = int(off.argmax())
                yield TurnDifference(name, partner, float(off[worst]), self._drives(worst))

    def _drives(self, pose: int) -> dict[str, float]:
        """Return the first's driver values at one of the common poses."""
        where = self.both[pose]
        return {name: float(np.ravel(drive.value)[where]) for name, drive in self.motions[0].drives.items()}


def driver_partners(common: CommonPose) -> tuple[ComparedDriver, ...]:
    """Return the corresponding drivers.

    Drivers of one kind correspond that move the points alike at the common pose, else those of the same name or rank.
    """
    one, other = common.one, common.other
    likeness = _likeness(common)
    pairs = sorted(_candidates(common, likeness), key=lambda two: two[:3])
    found: dict[str, ComparedDriver] = {}
    taken: set[str] = set()
    for *_, sign, name, partner in pairs:
        if name not in found and partner not in taken:
            is_angle = one.structure.driven_angles[name]
            start, there = common.values[name], common.other_values[partner]
            matched = ComparedDriver(name, partner, is_angle, sign, start, there)
            scale = sign * (1.0 if is_angle else other.scale)
            speeds = one.speed(name), scale * other.speed(partner)
            reach = _reach(matched, one, other)
            found[name] = replace(matched, reach=reach, speed=speeds[0], other_speed=speeds[1])
            taken.add(partner)
    return tuple(found[name] for name in one.motion.drives if name in found)


def _candidates(common: CommonPose, likeness: Number) -> Iterator[tuple[float, bool, int, int, str, str]]:
    """Yield pairs of drivers of one kind with their unlikeness, and the sign of one in the other's sense."""
    one, other = common.one.structure.driven_angles, common.other.structure.driven_angles
    for i, name in enumerate(common.one.motion.drives):
        for j, partner in enumerate(common.other.motion.drives):
            if one[name] == other[partner]:
                like = float(likeness[i, j])
                yield -round(abs(like), 3), name != partner, abs(i - j), -1 if like < 0.0 else 1, name, partner


def _likeness(common: CommonPose) -> Number:
    """Return how alike drivers move the points: 1 alike, -1 in opposite directions, 0 unknown."""
    one = _rates(common.one, common.values, list(common.points))
    other = _rates(common.other, common.other_values, list(common.points.values()))
    product = (one.conj().T @ other).real
    size = np.linalg.norm(one, axis=0)[:, None] * np.linalg.norm(other, axis=0)
    known = np.isfinite(size) & np.isfinite(product) & (size > 0.0)
    return np.where(known, product / np.where(known, size, 1.0), 0.0)


def _rates(side: ComparedMechanism, values: Mapping[str, float], letters: list[str]) -> Number:
    """Return the points' rates by each driver, (points, drivers)."""
    found = side.rates(values)[1]
    return found[[side.letters.index(letter) for letter in letters]]


def _reach(driver: ComparedDriver, one: ComparedMechanism, other: ComparedMechanism) -> tuple[float, float]:
    """Return the displacements from the common pose within the ranges of both."""
    mine = _range(one, driver.name, driver.start, 1.0)
    theirs = _range(other, driver.other, driver.other_start, driver.sign * (1.0 if driver.is_angle else other.scale))
    whole = [driver.is_angle and high - low >= tau - _ROUNDING for low, high in (mine, theirs)]
    if all(whole):
        return 0.0, tau
    if any(whole):
        return theirs if whole[0] else mine
    turns = (-tau, 0.0, tau) if driver.is_angle else (0.0,)
    common = [(max(mine[0], theirs[0] + turn), min(mine[1], theirs[1] + turn)) for turn in turns]
    low, high = max(common, key=lambda part: part[1] - part[0])
    return (low, high) if low <= high else (0.0, 0.0)


def _range(side: ComparedMechanism, name: str, start: float, scale: float) -> tuple[float, float]:
    """Return the least and the greatest displacement of a driver in its own range."""
    values = (np.ravel(side.motion.drives[name].value) - start) * scale
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
