"""The equivalent linkage of lower pairs for higher pairs at one pose.

Source: two profiles that touch move, up to accelerations, as if a bar joined their centres of curvature; e.g.
I. I. Artobolevskii, Theory of Mechanisms and Machines, on the replacement of higher pairs by lower ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import entry, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.model.attributes import RATES
from compoundkin.model.elements import Drive, Link, drawn, drive
from compoundkin.model.fields import Item
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Osculation, osculation
from compoundkin.model.pairs.prismatic import slide

# A centre of curvature farther away than this many times the mechanism's size belongs to a straight profile.
STRAIGHT = 1e8
# A centre nearer to a point of its link than this part of the size is that point.
SAME = 1e-9


@dataclass(frozen=True)
class Replacement:
    """The replacement of one higher pair: `link` is a bar of a `length`, or a block where that is None."""

    pair: Pair
    link: str
    length: float | None
    centres: tuple[complex | None, complex | None]

    def __str__(self) -> str:
        if self.length is None:
            return f"{self.pair.name} ({self.pair.title}): a block"
        return f"{self.pair.name} ({self.pair.title}): a bar of length {self.length:.6g}"


@checked
def equivalent_linkage(motion: Motion, at: int = 0) -> Mechanism:
    """Return the mechanism of lower pairs with the same velocities and accelerations at one pose.

    `at` is the pose's flat index. A bar between the centres of curvature replaces every higher pair, or a block where
    one profile is straight; a bar on the line of action replaces gears and belts. Raises InvalidInput for a pose that
    is not assembled.

    >>> import compoundkin as ck
    >>> wheel = ck.Mechanism(
    ...     "Quick return", ck.link("frame", A=0, C=-2j), ck.link("crank", A=0, B=1), ck.link("arm", C=0, D=3),
    ...     ck.slot("crank", on="arm", at="B", through="C"), ck.drive("crank"))
    >>> linkage = equivalent_linkage(ck.solve(wheel), at=3)
    >>> [group.name for group in ck.decompose(linkage).groups]
    ['RPR']
    """
    return replaced(motion, at)[0]


def replaced(motion: Motion, at: int = 0) -> tuple[Mechanism, tuple[Replacement, ...]]:
    """Return the equivalent linkage, and the replacement of each higher pair."""
    builder = _Builder(motion, at)
    return builder.mechanism(), tuple(builder.found)


class _Builder:
    """The links of the equivalent linkage with their additional points."""

    def __init__(self, motion: Motion, at: int) -> None:
        if not 0 <= at < motion.failed.size or not motion.regular.flat[at]:
            what = f"pose {at} is not assembled, or at a limit position"
            raise InvalidInput(Problem("at", what, f"give the index of one of the {motion.failed.size} poses"))
        self.motion = motion
        self.at = at
        design, pose = divmod(at, motion.inputs.poses)
        self.inputs: Inputs = motion.inputs.pick(np.array([design]), np.array([float(pose)]))
        self.poses = {name: _at(pose_, (design, pose)) for name, pose_ in motion.poses.items()}
        self.on = {spin.link: spin.on for spin in motion.structure.passive}
        self.points = {name: dict(self._points(name)) for name in motion.mechanism.links if name not in self.on}
        self.found: list[Replacement] = []

    def mechanism(self) -> Mechanism:
        """Return the linkage."""
        pairs = [item for pair in self.motion.mechanism.written_pairs for item in self._pair(pair)]
        links = [Link(name, points) for name, points in self.points.items()]
        drives = [self._drive(item) for item in self.motion.mechanism.drives]
        places = {k: self._world(name, p) for name, points in self.points.items() for k, p in points.items()
                  if name in self.poses}  # fmt: skip
        title = f"Equivalent linkage of {self.motion.mechanism.title}"
        return Mechanism(title, *links, *pairs, *drives, drawn(**places), unit=self.motion.mechanism.unit)

    def _points(self, name: str) -> Iterator[tuple[str, complex]]:
        back = self.poses[name].inverse()
        for letter in self.motion.mechanism.links[name].points:
            yield letter, complex(back.at(self.motion.points[letter].position.flat[self.at]).c[0])

    def _world(self, name: str, p: complex) -> complex:
        return complex(self.poses[name].at(p).c[0])

    def _drive(self, item: Drive) -> Drive:
        value, *rates = (float(first_entry(v)) for v in self.inputs.drives[item.name])
        return drive(item.link, on=item.on, pair=item.pair, values=value, name=item.name,
                     **dict(zip(RATES, rates, strict=True)))  # fmt: skip

    def _pair(self, pair: Pair) -> Iterator[Item]:
        poses = tuple(self.poses[name] for name in pair.members)
        ends = self.inputs.ends[pair.name]
        found = osculation(pair, ends, poses)
        if found is not None:
            yield from self._replaced(pair, _plain(found, self.motion.size))
        elif pair.is_simple and not pair.free_is_angle:
            on, link = pair.members
            start, block = (self._letter(*side, pair.name) for side in zip(pair.members, ends, strict=True))
            angle, turn = _angle(ends[0]), -_angle(ends[1])
            yield slide(link, on=on, at=block, through=start, angle=angle, turn=turn, name=pair.name)
        else:
            yield pair

    def _letter(self, name: str, end: End, pair: str) -> str:
        """Return the letter of a pair's side on a link."""
        return self._named(name, self._world(name, complex(first_entry(end.point))), pair)

    def _replaced(self, pair: Pair, found: Osculation) -> Iterator[Item]:
        """Yield the slide of the bar or block that replaces a pair."""
        first, second = (self.on.get(name, name) for name in pair.members[:2])
        new = f"{pair.name} {'block' if None in found[:2] else 'bar'}"
        if found.first is not None and found.second is not None:
            letters = [self._named(*side, pair.name) for side in ((first, found.first), (second, found.second))]
            length = abs(found.second - found.first)
            self.points[new] = {letters[0]: 0j, letters[1]: complex(length)}
            self.found.append(Replacement(pair, new, length, found[:2]))
            return
        on, other, centre = (first, second, found.second) if found.first is None else (second, first, found.first)
        letter = self._named(other, centre, pair.name)
        self.points[new] = {letter: 0j}
        along = self.poses[on].inverse().u.c[0] * found.normal * 1j
        yield slide(new, on=on, at=letter, through=self._named(on, centre, f"{pair.name} guide", letter),
                    angle=float(np.angle(along)), name=f"{pair.name} slide")  # fmt: skip
        self.found.append(Replacement(pair, new, None, found[:2]))

    def _named(self, name: str, place: complex, wanted: str, taken: str = "") -> str:
        """Return the letter of a link's point at a place of the world, which it gains if needed."""
        local = complex(self.poses[name].inverse().at(place).c[0])
        for letter, p in self.points[name].items():
            if abs(p - local) <= SAME * self.motion.size and letter != taken:
                return letter
        letter, count = wanted, 1
        while letter in self.motion.mechanism.carriers or letter in self.points or self._used(letter):
            count += 1
            letter = f"{wanted} {count}"
        self.points[name][letter] = local
        return letter

    def _used(self, letter: str) -> bool:
        return any(letter in points for points in self.points.values())


def _angle(end: End) -> float:
    """Return the direction of a side, as an angle in its link's frame."""
    return float(first_entry(end.along.angle().c[0]))


def _plain(found: Osculation, size: float) -> Osculation:
    """Return centres of curvature as numbers, None for a centre too far away."""
    centres = (None if v is None else complex(first_entry(v)) for v in found[:2])
    first, second = (None if v is None or not abs(v) < STRAIGHT * size else v for v in centres)
    return Osculation(first, second, complex(first_entry(found.normal)))


def _at(pose: Pose, at: tuple[int, ...]) -> Pose:
    """Return one pose of a motion, without derivatives."""
    z, u = (complex(entry(series.c[0], at)) for series in (pose.z, pose.u))
    return Pose(constant(z), constant(u), constant(float(entry(pose.angle.c[0], at))))
