"""One design of a solved motion, by itself: what concerns one costs no more where there are many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arguments import check_design
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, NotDetermined
from compoundkin.base.poses import FIXED
from compoundkin.base.series import Series
from compoundkin.kinematics.curve.configuration_curve import ConfigurationCurve
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.curve.group_paths import GroupPath
from compoundkin.kinematics.curve.modes import StatedModes
from compoundkin.kinematics.driver_values import Inputs, inputs, mapped, times_of
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve, solving_order_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import RATES
from compoundkin.model.mechanism import Mechanism, mechanism_of_design, values_of_design
from compoundkin.structure import decompose
from compoundkin.structure.kinematic_structure import Structure


def shape_of(what: Mechanism | Structure) -> tuple[int, ...]:
    """Return the shape of the motion over the drivers' own ranges. Raises InvalidInput where they have none."""
    solving_order = solving_order_of(what)
    times = times_of(solving_order.structure.mechanism, None, None)
    return inputs(solving_order, None, None, None, None, times, 0).shape


def alone(what: Mechanism | Structure, design: int) -> tuple[Mechanism | Structure, int]:
    """Return the mechanism that one of several designs is, and its index there, 0.

    What has one design, or cannot be solved over its drivers' own ranges, stays as it is.
    """
    try:
        shape = shape_of(what)
    except (InvalidInput, NotDetermined):
        return what, design
    if prod(shape[:-1]) == 1:
        return what, design
    check_design(design, prod(shape[:-1]))
    return mechanism_of_design(what.mechanism if isinstance(what, Structure) else what, shape, design), 0


def motion_of_design(motion: Motion, design: int) -> Motion:
    """Return the motion of one of several designs, by itself.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> lengths = np.array([[1.0], [2.0]])
    >>> cranks = Mechanism("m", link("frame", A=0), link("crank", A=0, B=lengths), drive("crank"))
    >>> motion_of_design(solve(cranks, {"crank": [0.0, 1.0]}), 1).points["B"].position[0]
    np.complex128(2+0j)
    """
    if motion.inputs.designs == 1:
        return motion
    shape, own = motion.shape, _Design(design)
    structure = decompose(mechanism_of_design(motion.mechanism, shape, design))
    given = own.inputs(motion.inputs)
    time = values_of_design(motion.time, shape, design)
    if [group.links for group in structure.groups] != [group.links for group in motion.structure.groups]:
        # other pairs are redundant in it than in all of them
        values, *rates = ({name: held[k] for name, held in given.drives.items()} for k in range(4))
        return replace(solve(structure, values, **dict(zip(RATES, rates, strict=True)), order=motion.order), time=time)
    poses = {name: pose if pose is FIXED else pose.mapped(own.series) for name, pose in motion.poses.items()}
    followed = own.followed(motion.followed, structure, given, shape)
    failed = own.row(motion.failed)
    return replace(motion, structure=structure, inputs=given, poses=poses, failed=failed, followed=followed, time=time)


@dataclass(frozen=True)
class _Design:
    """One design, and its part of whatever is over (1 or designs, ...)."""

    index: int

    def row(self, value: Number) -> Number:
        """Return its part of an array, which is of one row then."""
        return value if np.ndim(value) == 0 or len(value) == 1 else value[self.index : self.index + 1]

    def series(self, series: Series) -> Series:
        """Return its part of a series."""
        return Series(tuple([self.row(c) for c in series.c]))

    def rows(self, values: Mapping[int, Number]) -> dict[int, Number]:
        """Return its part of what groups have."""
        return {k: self.row(value) for k, value in values.items()}

    def inputs(self, given: Inputs) -> Inputs:
        """Return its numbers as those of a motion without designs."""
        ends = {name: tuple(mapped(end, self._number) for end in sides) for name, sides in given.ends.items()}
        drives = {name: tuple(map(self._number, values)) for name, values in given.drives.items()}
        return Inputs((given.poses,), ends, drives)

    def followed(
        self, followed: FollowedPoses, structure: Structure, given: Inputs, shape: tuple[int, ...]
    ) -> FollowedPoses:
        """Return its poses on the curve: all that was chosen and found of it."""
        poses = followed.poses._replace(places=self.row(followed.poses.places))
        expanded = followed.expanded
        if expanded is not None:
            designs, index, groups = expanded
            here = index[designs == self.index]
            expanded = np.zeros_like(here), here, groups
        return FollowedPoses(self._curve(followed.curve, structure, shape), given, poses, expanded)

    def _curve(self, curve: ConfigurationCurve, structure: Structure, shape: tuple[int, ...]) -> ConfigurationCurve:
        return replace(
            curve,
            solving_order=_followed(solving_order_of(structure), curve.solving_order),
            path=replace(curve.path, knots=self.inputs(curve.path.knots)),
            shown=self._shown(curve.shown, shape),
            signs=self.rows(curve.signs),
            flips=self.rows(curve.flips),
            left=self.rows(curve.left),
            near_misses={
                k: tuple(one._replace(design=0) for one in missed if one.design == self.index)
                for k, missed in curve.near_misses.items()
            },
            paths={k: self._path(path) for k, path in curve.paths.items()},
            turns={link: replace(turns, angles=self.row(turns.angles)) for link, turns in curve.turns.items()},
        )

    def _number(self, value: Number) -> Number:
        row = self.row(value)
        return row.item() if np.size(row) == 1 and np.ndim(row) else row

    def _path(self, path: GroupPath) -> GroupPath:
        s, states, slopes, reach, side = map(self.row, (path.s, path.states, path.slopes, path.reach, path.side))
        repeats = path.repeats and path.repeats._replace(gone=self.row(path.repeats.gone))
        return GroupPath(s, states, slopes, reach, side, tuple(self._path(one) for one in path.returns), repeats)

    def _shown(self, shown: StatedModes, shape: tuple[int, ...]) -> StatedModes:
        def own(value: Any) -> Any:
            return values_of_design(value, shape, self.index)

        poses = {
            name: pose if pose is FIXED else pose.mapped(lambda series: Series(own(series.c)))
            for name, pose in shown.poses.items()
        }
        return StatedModes(shown.source, own(shown.points), poses, own(shown.beside))


def _followed(own: SolvingOrder, whole: SolvingOrder) -> SolvingOrder:
    """Return a solving order in which those groups are followed that are in another."""
    for k, (one, other) in enumerate(zip(own.solvers, whole.solvers, strict=True)):
        if other.is_numbered and not one.is_numbered:
            own = own.following(k)
    return own
