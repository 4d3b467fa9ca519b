"""The poses of a motion on its configuration curve: where they are, and what they pass between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.block import Block, Root
from compoundkin.kinematics.curve.configuration_curve import ChosenModes, ConfigurationCurve
from compoundkin.kinematics.curve.driver_path import CLOSE, SAME, PosePlaces, driver_path
from compoundkin.kinematics.curve.modes import StatedModes
from compoundkin.kinematics.curve.turn_counting import recounted
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder


@dataclass(frozen=True)
class _ModesAlong(ChosenModes):
    """The choice at places along a motion."""

    poses: PosePlaces

    @cached_property
    def reached(self) -> Number:
        """The places on the path."""
        return self.curve.nearest_reached(self.designs, self.poses.at(self.designs, self.places))


@dataclass(frozen=True, repr=False, eq=False)
class FollowedPoses(ShortRepr):
    """The poses of a motion on its configuration curve.

    `given` are its inputs, `poses` tells where on the curve they are. `expanded` are the designs and indices of poses
    that are solved through the double root of some groups. Places here are along the motion: indices of poses, and
    between them.
    """

    curve: ConfigurationCurve
    given: Inputs
    poses: PosePlaces
    expanded: tuple[Number, Number, Sequence[int]] | None = None

    @property
    def solving_order(self) -> SolvingOrder:
        """The solving order, with what is followed on the curve."""
        return self.curve.solving_order

    def run(
        self,
        part: Inputs,
        order: int,
        s: Number,
        designs: Number,
        upto: int | None = None,
        roots: Mapping[int, Root] | None = None,
    ) -> Block:
        """Solve a block of inputs in the configuration at places `s` along the motion, up to a group."""
        return _ModesAlong(self.curve, designs, s, self.poses).solved(part, order, upto, roots)

    def sign(self, k: int, designs: Number, s: Number) -> Number:
        """Return the sign of a dyad's mode at places along the motion."""
        return _ModesAlong(self.curve, designs, s, self.poses).sign(k)

    def places_on_path(self, designs: Number, s: Number) -> Number:
        """Return the places on the drivers' path of places along the motion."""
        return self.curve.nearest_reached(designs, self.poses.at(designs, s))

    @cached_property
    def change_points(self) -> Mapping[int, Number]:
        """Where groups pass change points along the motion, (designs, count), padded with inf.

        Twice where the motion turns back from one.
        """
        every = self.curve.change_points
        if self.given.poses == 1:
            return {k: np.full((self.given.designs, 1), np.inf) for k in every}
        places = np.broadcast_to(self.poses.of_poses, (self.given.designs, self.given.poses))
        found = {}
        for k, flips in every.items():
            rows = [sorted(s for f in row[np.isfinite(row)] for s in _passings(places[d], f))
                    for d, row in enumerate(flips)]  # fmt: skip
            found[k] = np.full((len(rows), max(1, *map(len, rows))), np.inf)
            for row, own in zip(found[k], rows, strict=True):
                row[: len(own)] = own
        return found

    @cached_property
    def rests(self) -> Mapping[int, Sequence[tuple[int, int]]]:
        """By group, the designs and poses from which on the drivers rest at a change point."""
        places = np.broadcast_to(self.poses.of_poses, (self.given.designs, self.given.poses))
        found: dict[int, list[tuple[int, int]]] = {}
        for k, flips in self.curve.change_points.items() if self.given.poses > 1 else ():
            for d, row in enumerate(flips):
                for f in row[np.isfinite(row)]:
                    there = np.abs(places[d] - f) < SAME
                    both = np.flatnonzero(there[1:] & there[:-1])
                    found.setdefault(k, []).extend((d, int(i)) for i in both[:1])
        return found

    def leaves_branch(self, designs: Number, begin: Number, end: Number) -> Number:
        """Return whether a group goes over to its other branch between poses, by their indices."""
        low, high = (self.places_on_path(designs, at.astype(float)) for at in (begin, end))
        found: Number = np.zeros(len(designs), dtype=bool)
        for places in self.curve.left.values():
            there = places[designs]
            passes = (there - low[:, None]) * (there - high[:, None]) <= 0.0
            found |= np.any(passes & np.isfinite(there), axis=1)
        return found

    @cached_property
    def corners(self) -> tuple[Number, Number]:
        """The places on the path at which a design's motion turns corners, and how wide they are.

        Both are (designs, count), padded with infinity.
        """
        every = [one for missed in self.curve.near_misses.values() for one in missed]
        rows = [[one for one in every if one.design == d] for d in range(self.given.designs)]
        found = np.full((2, len(rows), max(1, *map(len, rows))), np.inf)
        for d, own in enumerate(rows):
            found[0, d, : len(own)], found[1, d, : len(own)] = [o.place for o in own], [o.wide for o in own]
        return found[0], found[1]

    @property
    def lost(self) -> bool:
        """Whether some group without a closed form was not reached at some pose."""
        if not self.curve.paths:
            return False
        places, designs = self.poses.of_poses, np.arange(self.given.designs)[:, None]
        ends = (places.min(axis=1, keepdims=True), places.max(axis=1, keepdims=True))
        return not all(np.all(self.curve.reaches(designs, end)) for end in ends)

    @property
    def is_dense(self) -> bool:
        """Whether the poses are so near to each other that no change point hides between them."""
        places, (first, last) = self.poses.of_poses, self.curve.path.ends
        steps = np.diff(places, axis=1)
        if not (np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            places = np.sort(places, axis=1)
            steps = np.diff(places, axis=1)
        widest = max(float(np.abs(steps).max(initial=0.0)), float(np.max(places.min(axis=1) - first)),
                     float(np.max(last - places.max(axis=1))))  # fmt: skip
        between = np.diff(self.curve.path.samples)
        return widest <= DENSE * float(between.max(initial=0.0)) or widest <= CLOSE


# Poses are dense where they are this part of the distance of two samples from each other: what turns four times as fast
# as the driver does not pass a change point between them unseen.
DENSE = 0.25


def _passings(places: Number, flip: float) -> Iterator[float]:
    """Yield where a motion passes a place of its path, between poses too: twice where it turns back there."""
    there = np.abs(places - flip) < SAME
    last = len(places) - 1
    if there[0]:
        yield 0.0
    if there[last]:
        # the motion is on one side of it
        yield float(np.nextafter(float(last), np.inf))
    away = np.flatnonzero(~there)
    a, b = away[:-1], away[1:]
    passes = (places[a] - flip) * (places[b] - flip) < 0.0
    for one, two, crosses in zip(a.tolist(), b.tolist(), passes.tolist(), strict=True):
        if two - one > 1:
            yield from (float(one + 1),) * (1 if crosses else 2)
        elif crosses:
            yield float(one + (flip - places[one]) / (places[two] - places[one]))


def follow(
    solving_order: SolvingOrder,
    given: Inputs,
    fixed: Mapping[int, int],
    shown: StatedModes,
    branches: Mapping[int, tuple[float, ...]] | None = None,
) -> FollowedPoses:
    """Return the poses of some inputs on their curve: modes chosen at home, other groups followed from there.

    Change points, and what comes back after gaps, are found while the poses are solved.
    """
    path, poses = driver_path(solving_order, given, shown.poses, shown.beside)
    if solving_order.turning and solving_order.structure.mechanism.geometry.drawn:
        given, knots = recounted(solving_order, (given, path.knots), path.at_home())
        path = replace(path, knots=knots)
    # only dimensions that vary along the motion ask for it
    pose = 0 if given.is_rigid else int(np.argmin(np.abs(poses.of_poses[0] - path.home)))
    curve = ConfigurationCurve(solving_order, path, fixed, shown, pose, branches=branches or {})
    return FollowedPoses(curve.chosen(), given, poses)
