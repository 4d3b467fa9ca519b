"""The branch of the drawn pose over its driver's value, to which a motion comes through a whole turn or after a gap."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import TURN, Number, whole_turns
from compoundkin.kinematics.approach import SPACING, spacings
from compoundkin.kinematics.group_paths import GroupPath
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# Motions are differentiated over places a little beyond their ends too: nearer than this (of a place) the state of the
# end is near enough for Newton.
BESIDE = 0.5


@dataclass(frozen=True)
class Begin:
    """A place where the pose drawn is known to be. It has the dyads' signs and the other groups' states there.

    After `period` places the way is the same again.
    """

    at: float
    signs: Mapping[int, Number]
    states: Mapping[int, Number]
    period: float

    def way(self, given: Inputs) -> tuple[Inputs, float]:
        """Return the approach path, which is one pose, and its place."""
        return given.at(np.array([self.at])).of_poses(1), self.at


@dataclass(frozen=True)
class Course:
    """The values of the one driver that moves, over which a branch is tracked.

    At the place `at` of the course the driver is at `start`, (1 or designs, 1), as drawn; from place to place it takes
    a `step`. Where it `wraps`, values that differ by a whole turn are the same pose.
    """

    driver: str
    start: Number
    step: float
    at: float
    count: int
    wraps: bool

    @property
    def period(self) -> float:
        """After how many places the driver is at the same pose again."""
        return TURN / self.step if self.wraps else np.inf

    def inputs(self, given: Inputs) -> Inputs:
        """Return it as the inputs of a motion. The other drivers stand where they are in `given`."""
        first = given.cut(slice(None), slice(0, 1))
        drives = {name: (values[0],) for name, values in first.drives.items()}
        way = self.step * (np.arange(self.count)[None] - self.at)
        return first.driven({**drives, self.driver: (self.start + way,)}).of_poses(self.count)

    def places(self, value: Number, designs: Number) -> tuple[Number, ...]:
        """Return the places of a driver's values. The nearest to the drawn one comes first."""
        way = value - (self.start if len(self.start) == 1 else self.start[designs[:, 0]])
        if not self.wraps:
            place = self.at + way / self.step
            inside = np.clip(place, 0.0, self.count - 1.0)
            return (np.where(np.abs(place - inside) < BESIDE, inside, place),)
        way = way - whole_turns(way)
        return tuple(self.at + around / self.step for around in (way, way - np.copysign(TURN, way)))


@dataclass(frozen=True)
class TrackedBranch:
    """The tracked states of groups, by index, along a course."""

    course: Course
    paths: Mapping[int, GroupPath]

    def seeds(self, k: int, drives: Mapping[str, tuple[Number, ...]], designs: Number, s: Number) -> Number:
        """Return the states of a group at the drivers' values. They are NaN where the branch does not reach."""
        places = self.course.places(drives[self.course.driver][0], designs)
        found, *others = (
            self.paths[k].seeds(designs, np.broadcast_to(place, np.broadcast_shapes(np.shape(place), s.shape)))
            for place in places
        )
        for other in others:
            found = np.where(np.isnan(found), other, found)
        return found


def course_of(solving_order: SolvingOrder, given: Inputs, approach_path: Inputs) -> Course | None:
    """Return the course of a motion. None where more than one driver moves, or dimensions vary."""
    moving = {name for way in (given, approach_path) for name, values in way.drives.items() if _moves(values[0])}
    if len(moving) != 1 or not given.is_rigid:
        return None
    (name,) = moving
    start = np.atleast_2d(approach_path.drives[name][0])[:, :1]
    angle = solving_order.structure.driven_angles[name]
    if angle and not solving_order.turning:
        each = round(TURN / SPACING)
        return Course(name, start, TURN / each, float(each), 2 * each + 1, wraps=True)
    ways = given.drives[name][0] - start
    low, high = min(float(np.min(ways)), 0.0), max(float(np.max(ways)), 0.0)
    count = max(2, 1 + spacings(solving_order, name, np.array(high - low)))
    step = (high - low) / (count - 1)
    return Course(name, start, step, -low / step, count, wraps=False)


def _moves(value: Number) -> bool:
    return np.ndim(value) > 1 and bool(np.any(value != value[:, :1]))
