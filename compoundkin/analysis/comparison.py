"""`compare`: two mechanisms side by side: their structures, their dimensions, and how far apart they move.

From a pose that both have in common their drivers are moved by equal displacements. Drivers correspond where they
are of one kind and move the points alike; a sign of -1 says that the two count in opposite directions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import tau

import numpy as np

from compoundkin.analysis.common_pose import CommonPose, common_pose
from compoundkin.analysis.comparison_result import (
    ComparedDriver,
    ComparedFact,
    MechanismComparison,
    PlaceDifference,
    TurnDifference,
)
from compoundkin.analysis.correspondence import (
    ComparedMechanism,
    compared_lengths,
    compared_mechanism,
    link_partners,
    partners_by_place,
    tracers_by_name,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose, roman


@checked
def compare(one: Mechanism, other: Mechanism) -> MechanismComparison:
    """Compare two mechanisms: structure, dimensions, and how far apart they come when moved alike.

    They are moved from a pose that both have, by the same displacements of their drivers, over the range that both
    have. Points stand for each other that are in the same places there and go on together, else those of the same name;
    drivers do that move these points alike. Lengths of the second are converted by the units. Where one has none, or
    nothing fits so, they are taken as written, or times a power of ten. The frames' axes are the same.

    Nothing is raised for mechanisms that cannot be solved or have nothing in common: the comparison then says why.

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


def _moved(known: MechanismComparison) -> MechanismComparison:
    """Return a comparison with what the motions tell. Raises what keeps them from being solved."""
    common = common_pose(*map(compared_mechanism, known.structures))
    if common is None:
        return replace(known, why="they have no pose in common, and few points of the same names")
    known = replace(known, scale=common.other.scale, size=common.one.size, matched_by=common.matched_by)
    known = _dimensioned(known, dict(common.points))
    course = SharedCourse(common, driver_partners(common))
    counts = len(common.one.motion.drives), len(common.other.motion.drives)
    if len(course.drivers) < max(counts):
        return replace(known, drivers=tuple(course.drivers), why="their drivers do not stand for each other")
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
    """Return a comparison with the points that stand for each other, the links that follow and their lengths."""
    mechanisms = known.structures[0].mechanism, known.structures[1].mechanism
    links = link_partners(*mechanisms, points)
    lengths = tuple(compared_lengths(*mechanisms, links, points, known.scale))
    return replace(known, points=points, links=links, lengths=lengths)


def _links_without_two_points(known: MechanismComparison) -> dict[str, str]:
    """Return the moving links that have no two points, so that places do not tell how they turn."""
    told = {length.link for length in known.lengths if min(length.one, length.other) > 0.0}
    return {name: partner for name, partner in known.links.items() if name not in told and name != FRAME}


def compared_facts(one: Structure, other: Structure) -> tuple[ComparedFact, ...]:
    """Return what there is to say of both structures, in words.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> compared_facts(*[decompose(load(name)) for name in ("crank-rocker", "six-bar")])[1]
    ComparedFact(what='pairs', one='4 R', other='6 R + 1 P')
    """
    return tuple(ComparedFact(what, tell(one), tell(other)) for what, tell in _FACTS.items())


def _pairs(structure: Structure) -> str:
    return " + ".join(f"{count.number} {count.code}" for count in structure.mobility.pairs)


def _groups(structure: Structure) -> str:
    return ", ".join(group.name for group in structure.groups) or "none"


def _class(structure: Structure) -> str:
    return roman(max((group.class_ for group in structure.groups), default=1))


def _drivers(structure: Structure) -> str:
    return ", ".join(structure.driven) or "none"


_FACTS: Mapping[str, Callable[[Structure], str]] = {
    "links": lambda structure: str(len(structure.mechanism.links)),
    "pairs": _pairs,
    "mobility": lambda structure: str(structure.mobility.freedoms),
    "independent loops": lambda structure: str(len(structure.loops)),
    "drivers": _drivers,
    "Assur groups": _groups,
    "class": _class,
    "unit of length": lambda structure: structure.mechanism.unit or "none",
}
# A full turn is compared in steps of two degrees.
POSES = 181


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
        """At which poses each is assembled."""
        one, other = (np.ravel(motion.assembled) for motion in self.motions)
        return one, other

    @property
    def apart(self) -> int:
        """How many poses can be assembled in one of the two alone."""
        return int(np.count_nonzero(self.assembled[0] != self.assembled[1]))

    @cached_property
    def both(self) -> Number:
        """The indices of the poses that both have."""
        return np.flatnonzero(self.assembled[0] & self.assembled[1])

    @cached_property
    def points(self) -> dict[str, str]:
        """The points that stand for each other. Of several in one place it is those that go on together.

        Tracers that are left, elsewhere on their links, go by their names.
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
        """Yield how far apart points come."""
        one, other = self.common.one, self.common.other
        at_one, at_other = one.places(self.motions[0])[self.both], other.places(self.motions[1])[self.both]
        for letter, partner in self.points.items():
            off = np.abs(at_one[:, one.letters.index(letter)] - at_other[:, other.letters.index(partner)])
            if off.size:
                worst = int(off.argmax())
                yield PlaceDifference(letter, partner, float(off[worst]), self._drives(worst))

    def turns(self, links: Mapping[str, str]) -> Iterator[TurnDifference]:
        """Yield how differently links turn. `links` have no two points that tell it."""
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
        """Return the first's driver values at one of the poses that both have."""
        where = self.both[pose]
        return {name: float(np.ravel(drive.value)[where]) for name, drive in self.motions[0].drives.items()}


# A range that lacks no more than this of a full turn is one.
_ROUNDING = 1e-6


def driver_partners(common: CommonPose) -> tuple[ComparedDriver, ...]:
    """Return the drivers that stand for each other.

    Of each kind those do that move the points alike at the common pose, else those of the same name or rank.
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
    """Yield two drivers of one kind each, with what makes them unlike, and the sign of one in the other's sense."""
    one, other = common.one.structure.driven_angles, common.other.structure.driven_angles
    for i, name in enumerate(common.one.motion.drives):
        for j, partner in enumerate(common.other.motion.drives):
            if one[name] == other[partner]:
                like = float(likeness[i, j])
                yield -round(abs(like), 3), name != partner, abs(i - j), -1 if like < 0.0 else 1, name, partner


def _likeness(common: CommonPose) -> Number:
    """Return how alike drivers move the points, 1 for the same way and -1 for the opposite one, 0 where unknown."""
    one = _rates(common.one, common.values, list(common.points))
    other = _rates(common.other, common.other_values, list(common.points.values()))
    product = (one.conj().T @ other).real
    size = np.linalg.norm(one, axis=0)[:, None] * np.linalg.norm(other, axis=0)
    known = np.isfinite(size) & np.isfinite(product) & (size > 0.0)
    return np.where(known, product / np.where(known, size, 1.0), 0.0)


def _rates(side: ComparedMechanism, values: Mapping[str, float], letters: list[str]) -> Number:
    """Return how fast each driver moves points, (points, drivers)."""
    found = side.rates(values)[1]
    return found[[side.letters.index(letter) for letter in letters]]


def _reach(driver: ComparedDriver, one: ComparedMechanism, other: ComparedMechanism) -> tuple[float, float]:
    """Return the displacements from the common pose that are in the own range of both."""
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
