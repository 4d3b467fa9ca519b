"""One state of a simulation with all that loads ask for, and the forces along the drivers' coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Number, Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.motion import Motion
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.units import Units


@dataclass(frozen=True, eq=False)
class LoadedState:
    """A single pose. It answers what loads ask for, and what they do along each of `count` coordinates.

    Each pose of the `world` has in its rates those at unit rate of every coordinate, and last the true ones. `turns`
    adds to an angle of a pair the full turns that it has made.
    """

    motion: Motion
    world: Mapping[str, Pose]
    ends: Mapping[str, Ends]
    seconds: float
    count: int
    turns: Callable[[str, float], float]

    @cached_property
    def units(self) -> Units:
        """The mechanism's units."""
        units = self.motion.mechanism.units
        assert units is not None
        return units

    @cached_property
    def time(self) -> Number | None:
        """The time in seconds."""
        return np.array([[self.seconds]])

    def pose(self, link: str) -> Pose:
        """Return the true pose of a link with its velocity."""
        pose = self.world[link]
        return pose if pose is FIXED else pose.mapped(_true)

    def moved(self, link: str) -> Pose:
        """Return the pose of a link. Its rates are those at unit rate of each coordinate."""
        pose = self.world[link]
        return pose if pose is FIXED else pose.mapped(self._unit)

    def place(self, link: str, point: str | complex) -> Series:
        """Return where a point of a link is. By its letter or its place in the link."""
        own = self.motion.mechanism.geometry.points[link][point] if isinstance(point, str) else point
        return as_series(self.pose(link).at(self.fitted(own)))

    def pair(self, name: str) -> tuple[Pair, Ends]:
        """Return a pair by its name, and its sides on its links."""
        return self.motion.solving_order.pairs[name], self.ends[name]

    def coordinate(self, pair: str) -> Series:
        """Return the free coordinate of a pair, angles counted along the motion."""
        kind, ends = self.pair(pair)
        found = kind.coordinate(ends, tuple(self.pose(name) for name in kind.members))
        value = float(np.ravel(found.c[0])[0])
        return Series((self.turns(pair, value) if kind.free_is_angle else value, *found.c[1:]))

    def fitted(self, value: Any) -> Number:
        """Return a single number. Raises InvalidInput for an array along a motion."""
        if np.size(value) != 1:
            what = "it is given pose by pose, and the poses of a simulation are not known before"
            raise InvalidInput(Problem("loads", what, "give a number, or a function of time"))
        return np.ravel(value)[0].item() if isinstance(value, np.ndarray) else value

    def generalised(self) -> Number:
        """Return the forces of all loads and weights along each coordinate."""
        total = np.zeros(self.count)
        for link, wrench in self._wrenches():
            total += np.ravel(wrench.power(self.moved(link)))
        return total

    def _wrenches(self) -> Iterator[tuple[str, Wrench]]:
        for load in self.motion.mechanism.loads.values():
            yield from load.wrenches(self)

    def _unit(self, series: Series) -> Series:
        return (
            Series((_number(series.c[0]), np.ravel(series.c[1])[: self.count])) if len(series.c) > 1 else _true(series)
        )


def _true(series: Series) -> Series:
    return Series((_number(series.c[0]), *[_number(c, -1) for c in series.c[1:2]]))


def _number(value: Number, at: int = 0) -> Number:
    return value.item(at) if isinstance(value, np.ndarray) else value
