"""The approach from where a path's drivers are drawn to its motions, and how far along it designs are clear."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, ascending
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.kinematics.curve.driver_path import (
    CLOSE,
    FEWEST,
    MOST,
    SPACING,
    PathOfPoses,
    approach,
    drawn_value,
    driver_path,
)
from compoundkin.kinematics.curve.modes import StatedModes
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder


def driver_spacings(order: SolvingOrder) -> Mapping[str, float]:
    """Return the spacing of each driver at which `solve` searches for change points."""
    return {name: order.unit(name) * SPACING for name in order.structure.driven}


# Margins at samples of an approach above which those between them are above NEAR, too: their roots may halve there.
CLEAR = 4.0 * NEAR
# Of so many designs it is remembered how far they are clear.
APPROACHES_KEPT = 64


class ApproachWay(NamedTuple):
    """The way of the only driver from `home`, where it is drawn, to the nearest value of a motion, `far` from there.

    It is looked at in steps of `spacing` or less, that of a length in FEWEST steps at least.
    """

    driver: str
    home: float
    far: float
    is_angle: bool
    spacing: float

    @property
    def values(self) -> Mapping[str, Number] | None:
        """The driver's values on it, (1, values); None where it is no way at all."""
        return {self.driver: self.home + self.places(self.far, self.spacing)[None]} if self.far else None

    def places(self, far: float, spacing: float) -> Number:
        """Return places from home on."""
        return np.linspace(0.0, far, max(_steps(abs(far), spacing), 1 if self.is_angle else FEWEST) + 1)


def _steps(length: float, spacing: float) -> int:
    """Return into how many steps a way is divided."""
    return min(int(np.ceil(length / spacing)), MOST)


class ClearApproaches(ShortRepr):
    """How far the only driver can go from where it is drawn, back and on, so that designs are clear of limits.

    Who asks for one pose or one motion after another approaches over the same values each time.
    """

    def __init__(self) -> None:
        self._clear: dict[tuple[float, ...], tuple[float, float]] = {}
        self._explored: dict[tuple[float, ...], tuple[float, float]] = {}
        self._last: tuple[float, ...] | None = None

    def has(self, design: tuple[float, ...] | None, way: ApproachWay) -> bool:
        """Tell whether a way is over values that are known to be clear."""
        known = (0.0, 0.0) if design is None else self._clear.get(design, (0.0, 0.0))
        return known[0] <= way.far <= known[1]

    def explore(
        self,
        design: tuple[float, ...] | None,
        way: ApproachWay,
        is_pose: bool,
        margins: Callable[[Mapping[str, Number]], Number],
    ) -> None:
        """Look how far a design is clear: a whole turn, or twice as far as a way goes.

        That pays only where more calls are to come: after one for a single pose, and where a design is asked for again.
        `margins` gives those at values of drivers, (1, values).
        """
        is_expected, self._last = is_pose or design == self._last, design
        if design is None or not is_expected:
            return
        explored = self._explored.get(design, (0.0, 0.0))
        if explored[0] <= way.far <= explored[1]:
            return
        ends = ((-0.5 * TURN, 0.5 * TURN) if way.is_angle
                else (min(explored[0], 2.0 * way.far), max(explored[1], 2.0 * way.far)))  # fmt: skip
        clear = [_clear_part(way.places(end, 0.5 * way.spacing), way, margins) for end in ends]
        if len(self._clear) >= APPROACHES_KEPT:
            self._clear.clear()
            self._explored.clear()
        self._clear[design], self._explored[design] = (clear[0], clear[1]), ends


def _clear_part(places: Number, way: ApproachWay, margins: Callable[[Mapping[str, Number]], Number]) -> float:
    """Return how far the first of some places are clear."""
    found = margins({way.driver: way.home + places[None]})[0]
    unclear = np.flatnonzero(~(found >= CLEAR))
    return float(places[max(int(unclear[0]) - 1, 0)] if len(unclear) else places[-1])


class DriverRoute(NamedTuple):
    """The drivers' values (1, values) from where they are drawn to the first pose of a motion.

    It `is_nearest` where no other pose of the motion is nearer to the drawing.
    """

    values: Mapping[str, Number]
    is_nearest: bool


class DrawnApproach(ShortRepr):
    """The approach from where a path's drivers are drawn to its motions, as `solve` takes it."""

    def __init__(self, reference: Motion, shown: StatedModes) -> None:
        self.reference, self.shown = reference, shown
        self._drawn: dict[str, Number | None] = {}

    @cached_property
    def has_configuration(self) -> bool:
        """Whether the mechanism is shown anywhere, so that its drivers' values can be read off there."""
        return bool(self.shown.poses or self.shown.beside)

    def values(self, values: Mapping[str, Number]) -> Mapping[str, Number] | None:
        """Return the drivers' values on the approach from where they are drawn; None where that is on the motion.

        `values` are those of the motion, (1 or designs, 1 or poses).
        """
        if self.is_passed(values):
            return None
        if (only := self.way(values)) is not None:
            return only.values
        straight = self.to_pose(values) if all(value.size == 1 for value in values.values()) else None
        if straight is not None:
            return straight if any(way.size > 1 for way in straight.values()) else None
        way = approach(*self._path(values))
        return None if way is None else {name: np.atleast_2d(drive[0]) for name, drive in way.drives.items()}

    def route(self, values: Mapping[str, Number], finer: int) -> DriverRoute | None:
        """Return the way of drivers to the first pose of a motion, as `solve` goes, in steps so much finer.

        None where that is many turns away.
        """
        if all(value.size == 1 for value in values.values()):
            straight = self.to_pose(values, finer)
            if straight is not None:
                return DriverRoute(straight, True)
        path, poses = self._path(values)
        places, home = poses.of_poses[0], path.home
        low, high = sorted((home, places[0]))
        if high - low > MOST:
            return None
        knots = ascending(path.samples[(path.samples > low) & (path.samples < high)], [low, high])
        knots = np.interp(np.arange(finer * (len(knots) - 1) + 1) / finer, np.arange(len(knots)), knots)
        own = path.at(knots[::-1] if places[0] < home else knots).drives
        ways = {name: np.array(np.broadcast_to(own[name][0], (1, len(knots)))) for name in values}
        for name, value in values.items():
            ways[name][0, -1] = value[0, 0]
        return DriverRoute(ways, bool(np.all(np.abs(places - home) > np.abs(places[0] - home) - CLOSE)))

    def _path(self, values: Mapping[str, Number]) -> PathOfPoses:
        """Return the drivers' path of a motion."""
        extent = np.broadcast_shapes(*(value.shape for value in values.values()))
        given = Inputs(extent, self.reference.inputs.ends, {name: (value,) for name, value in values.items()})
        return driver_path(self.reference.solving_order, given, self.shown.poses, self.shown.beside)

    def to_pose(self, values: Mapping[str, Number], finer: int = 1) -> Mapping[str, Number] | None:
        """Return the values of drivers from where they are drawn to one pose, (1, values), both included.

        All go straight on, angles the short way, in steps so much `finer` than `solve` searches for change points. None
        where some are not drawn, or on which side is not known.
        """
        angles, given = self.reference.structure.driven_angles, {name: value.item() for name, value in values.items()}
        homes = {name: self._home(name) for name in given}
        if not self.has_configuration or not all(
            home is not None and (angles[name] or home * given[name] >= 0.0) for name, home in homes.items()
        ):
            return None
        ways = {name: value - (homes[name] or 0.0) for name, value in given.items()}
        ways = {name: way - TURN * round(way / TURN) if angles[name] else way for name, way in ways.items()}
        count = max(_steps(abs(way), self.spacings[name]) for name, way in ways.items())
        if any(way and not angles[name] for name, way in ways.items()):
            count = max(count, FEWEST)
        count *= finer
        left = np.arange(count, -1.0, -1.0)[None] / max(count, 1)
        return {name: value - ways[name] * left for name, value in given.items()}

    def _home(self, name: str) -> float | None:
        """Return the value at which a driver is drawn at the first pose."""
        drawn = self.drawn(name)
        return None if drawn is None else float(np.ravel(drawn)[0])

    def way(self, values: Mapping[str, Number]) -> ApproachWay | None:
        """Return the way of the only driver to a motion of its own, so far 0 where that has its drawn value.

        None where there are several drivers, or several values at which they are drawn, or where motions start.
        """
        if len(values) != 1:
            return None
        ((name, value),) = values.items()
        drawn = self.drawn(name)
        if drawn is None or np.ndim(drawn) or value.shape[0] > 1:
            return None
        low, high = (value.item(),) * 2 if value.size == 1 else (float(value.min()), float(value.max()))
        is_angle = self.reference.structure.driven_angles[name]
        below = above = float(drawn)
        if is_angle:
            below += TURN * ((low - below) // TURN)
            above = below + TURN
        if low <= above <= high:
            home = end = above
        else:
            home, end = (above, high) if abs(above - high) < abs(low - below) else (below, low)
        return ApproachWay(name, home, end - home, is_angle, self.spacings[name])

    @cached_property
    def spacings(self) -> Mapping[str, float]:
        """The spacing of each driver at which `solve` searches for change points."""
        return driver_spacings(self.reference.solving_order)

    def drawn(self, name: str) -> Number | None:
        """Return the value at which a driver is drawn; None where it is not drawn."""
        if name not in self._drawn:
            order, given, shown = self.reference.solving_order, self.reference.inputs, self.shown
            value = drawn_value(order, given, name, shown.poses, shown.beside) if self.has_configuration else None
            self._drawn[name] = value
        return self._drawn[name]

    def is_passed(self, values: Mapping[str, Number]) -> bool:
        """Tell whether values need no approach: nothing is drawn, or the only driver surely passes its drawn value."""
        if not self.has_configuration:
            return True
        if len(values) != 1:
            return False
        ((name, value),) = values.items()
        drawn = self.drawn(name)
        if drawn is None:
            return True
        if np.ndim(drawn) or value.shape[0] > 1:
            return False
        is_angle = self.reference.structure.driven_angles[name]
        return passes_value(float(drawn), value.item(0), value.item(-1), is_angle)


def passes_value(drawn: float, first: float, last: float, is_angle: bool) -> bool:
    """Tell whether a driver passes its drawn value between the first and the last value of a motion.

    >>> passes_value(0.5, 6.0, 7.0, True), passes_value(0.5, 6.0, 7.0, False)
    (True, False)
    """
    low, high = (first, last) if first <= last else (last, first)
    # the first value from the lower one on at which the driver is as drawn
    after = drawn - TURN * ((drawn - low) // TURN) if is_angle else drawn
    return low <= after <= high
