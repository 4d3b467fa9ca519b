"""The two compared mechanisms, each solved over its drivers' ranges, and which of their points and links correspond.

Points correspond that are in the same places and move alike, links that share most of their points.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.nearest_pose import exactly_drawn, pose_nearest_to_drawing
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure


@dataclass(frozen=True, eq=False)
class ComparedMechanism:
    """A mechanism solved over its drivers' own ranges, its lengths times `scale`.

    `there` is one pose: the drawn one, or the pose of its motion nearest to an inexact drawing.
    """

    motion: Motion
    there: Motion
    scale: float = 1.0

    @property
    def structure(self) -> Structure:
        """Its structure."""
        return self.motion.structure

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.structure.mechanism

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """The points, without those of auxiliary links alone."""
        auxiliary = self.mechanism.auxiliary_links
        return tuple(k for k, names in self.mechanism.carriers.items() if not auxiliary.issuperset(names))

    @cached_property
    def fixed(self) -> frozenset[str]:
        """The points of the frame."""
        return frozenset(k for k in self.letters if FRAME in self.mechanism.carriers[k])

    @cached_property
    def marks(self) -> tuple[str, ...]:
        """The points that identify a pose: the moving pins, or without any all moving points."""
        moving = [k for k in self.letters if k not in self.fixed]
        return tuple(k for k in moving if k in self.mechanism.pins) or tuple(moving)

    @cached_property
    def tracers(self) -> tuple[str, ...]:
        """The moving points of one link without a pair."""
        used = {k for pair in self.mechanism.written_pairs for k in pair.letters}.union(self.fixed, self.mechanism.pins)
        return tuple(k for k in self.letters if k not in used)

    @property
    def drawn_values(self) -> dict[str, float]:
        """The drivers' values at the pose nearest to the drawing."""
        return _values(self.there, 0)

    @property
    def size(self) -> float:
        """The length scale."""
        return self.motion.size * self.scale

    def values(self, pose: int) -> dict[str, float]:
        """Return the drivers' values at a pose of its own motion."""
        return _values(self.motion, pose)

    def speed(self, name: str) -> float:
        """Return the speed of a driver at the start of its own motion."""
        return float(np.ravel(self.motion.drives[name].rate)[0])

    def at(self, values: Mapping[str, Number], order: int = 1) -> Motion:
        """Return its motion at other values of the drivers, without warnings."""
        return quietly_solved(self.structure, {k: np.atleast_1d(v) for k, v in values.items()}, order)

    def rates(self, values: Mapping[str, float]) -> tuple[Number, Number]:
        """Return the places of its points, and their rates by each driver alone at unit speed, (points, drivers)."""
        rates = np.zeros((len(self.letters), len(values)), dtype=complex)
        motion = self.there
        for column, moved in enumerate(values):
            motion = quietly_solved(self.structure, values, 1, {name: float(name == moved) for name in values})
            rates[:, column] = [np.ravel(motion.points[k].velocity)[0] for k in self.letters]
        return self.places(motion)[0], rates * self.scale

    def places(self, motion: Motion) -> Number:
        """Return the places of its points, (poses, points)."""
        found = [np.broadcast_to(motion.points[k].position, motion.shape).ravel() for k in self.letters]
        return np.stack(found, axis=-1) * self.scale

    def scaled(self, scale: float) -> ComparedMechanism:
        """Return the same in another unit."""
        return replace(self, scale=scale)


def compared_mechanism(structure: Structure) -> ComparedMechanism:
    """Return a mechanism solved over its own ranges. Raises InvalidInput for several designs, and as `solve`."""
    motion = quietly_solved(structure, None, 1)
    if motion.inputs.designs > 1:
        what = f"it has {motion.inputs.designs} designs"
        raise InvalidInput(Problem(motion.mechanism.title, what, "compare one design of it"))
    drawn = exactly_drawn(motion)
    if drawn is None:
        drawn = quietly_solved(structure, _values(motion, pose_nearest_to_drawing(motion)), 1)
    return ComparedMechanism(motion, drawn)


def _values(motion: Motion, pose: int) -> dict[str, float]:
    """Return the drivers' values at a pose of a motion."""
    return {name: float(np.ravel(drive.value)[pose]) for name, drive in motion.drives.items()}


# Points nearer to each other than this part of the size are in the same place: files of other programs are rounded to
# three decimals, and drawings may be in numbers of one digit.
SAME_PLACE = 1e-3
# Distances below this part of the size are equal: names decide.
_ALIKE = 1e-9


def shares_places(one: ComparedMechanism, at_one: Number, other: ComparedMechanism, at_other: Number) -> bool:
    """Return whether all marks of one mechanism coincide with points of the other."""
    near = _near(one, at_one, other, at_other, SAME_PLACE * one.size)
    of_one = [near[k].any() for k, name in enumerate(one.letters) if name in one.marks]
    of_other = [near[:, k].any() for k, name in enumerate(other.letters) if name in other.marks]
    return bool((of_one and all(of_one)) or (of_other and all(of_other)))


def partners_by_place(
    one: ComparedMechanism, at_one: Number, other: ComparedMechanism, at_other: Number
) -> dict[str, str]:
    """Return corresponding points by their places over some poses, (poses, points).

    They are near at the first pose; of several, those correspond that move alike, then those of the same name.
    """
    near = _near(one, at_one[0], other, at_other[0], SAME_PLACE * one.size)
    pairs = ((int(i), int(j)) for i, j in np.argwhere(near))
    return _chosen(one, other, ((_apart(at_one[:, i], at_other[:, j]), i, j) for i, j in pairs))


def partners_by_name(one: ComparedMechanism, other: ComparedMechanism) -> dict[str, str]:
    """Return the points of the same name, both or neither on the frame."""
    return {k: k for k in one.letters if k in other.letters and (k in one.fixed) == (k in other.fixed)}


def tracers_by_name(one: ComparedMechanism, other: ComparedMechanism, points: Mapping[str, str]) -> dict[str, str]:
    """Return the remaining tracers of the same name on corresponding links."""
    links = link_partners(one.mechanism, other.mechanism, points)
    mine, theirs = one.mechanism.carriers, other.mechanism.carriers
    left = set(other.tracers).difference(points.values())
    return {k: k for k in one.tracers if k in left and k not in points and links.get(mine[k][0]) == theirs[k][0]}


def _near(one: ComparedMechanism, at_one: Number, other: ComparedMechanism, at_other: Number, most: float) -> Number:
    """Return whether points are near each other, both or neither on the frame."""
    fixed = [np.array([k in side.fixed for k in side.letters], dtype=bool) for side in (one, other)]
    near: Number = np.abs(at_one[:, None] - at_other) <= most
    return near & (fixed[0][:, None] == fixed[1])


def _apart(one: Number, other: Number) -> float:
    """Return the greatest distance of two points over their common poses."""
    off = np.abs(one - other)
    known = np.isfinite(off)
    return float(off[known].max()) if known.any() else 0.0


def _chosen(
    one: ComparedMechanism, other: ComparedMechanism, found: Iterable[tuple[float, int, int]]
) -> dict[str, str]:
    """Return at most one partner for each point, the likeliest first."""
    ranked = sorted(_ranked(one, other, found))
    points: dict[str, str] = {}
    taken: set[str] = set()
    for *_, letter, partner in ranked:
        if letter not in points and partner not in taken:
            points[letter] = partner
            taken.add(partner)
    return {letter: points[letter] for letter in one.letters if letter in points}


def _ranked(
    one: ComparedMechanism, other: ComparedMechanism, found: Iterable[tuple[float, int, int]]
) -> Iterator[tuple[float, bool, int, str, str]]:
    floor = _ALIKE * one.size
    for off, i, j in found:
        letter, partner = one.letters[i], other.letters[j]
        links = abs(len(one.mechanism.carriers[letter]) - len(other.mechanism.carriers[partner]))
        yield 0.0 if off <= floor else off, letter != partner, links, letter, partner


def link_partners(one: Mechanism, other: Mechanism, points: Mapping[str, str]) -> dict[str, str]:
    """Return corresponding links, those with most common points first; the frames correspond."""
    found, taken = {FRAME: FRAME}, {FRAME}
    for *_, name, partner in sorted(_shared(one, other, points)):
        if name not in found and partner not in taken:
            found[name] = partner
            taken.add(partner)
    return {name: found[name] for name in one.links if name in found}


def _shared(one: Mechanism, other: Mechanism, points: Mapping[str, str]) -> Iterator[tuple[int, bool, str, str]]:
    """Yield pairs of links with common points: their number, and whether the names differ."""
    counts: dict[tuple[str, str], int] = {}
    for letter, like in points.items():
        for name in one.carriers[letter]:
            for partner in other.carriers[like]:
                if FRAME not in (name, partner):
                    counts[name, partner] = counts.get((name, partner), 0) + 1
    for (name, partner), count in counts.items():
        yield -count, name != partner, name, partner
