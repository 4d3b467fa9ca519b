"""Two mechanisms moved alike from a common pose, and how far apart their points and links come."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.analysis.comparison.common_pose import CommonPose
from compoundkin.analysis.comparison.comparison_findings import ComparedDriver, PlaceDifference, TurnDifference
from compoundkin.analysis.comparison.point_partners import partners_by_place, tracers_by_name
from compoundkin.base.arrays import Number, wrapped
from compoundkin.kinematics import Motion

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
