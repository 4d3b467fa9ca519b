"""The initial values of the drivers, and the range over which one driver is followed.

The range is a full turn, several turns of gears until they repeat, or all lengths within reach.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry, row
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.configurations.segment_poses import Sweep, drawn_angle
from compoundkin.configurations.segments import Segments, driver_segment
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.curve.driver_path import driver_path
from compoundkin.kinematics.driver_values import inputs
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import SolvingOrder, run
from compoundkin.model.elements import Drive

# A turn begins here: special positions lie at round angles, and none may fall on the seam.
BEGIN = -2.5066282746310002
# Gears that do not repeat within so many turns of the driver, as with racks and trains of many teeth, count as never
# repeating: the driver is then followed one turn each way.
MOST_TURNS = 60
# Orientations nearer than this are equal: rounding of angles of many turns.
SAME = 1e-9
# Lengths are followed beyond the reach by this factor: a limit position may lie at the reach itself.
BEYOND = 1.25


def driver_range(sweep: Sweep, between: Sequence[float] | None, start: float) -> tuple[Segments, float]:
    """Return the segment of the driver alone, and its value's period.

    The period is 0 for a driver without one; `start` is one of its values.

    Raises InvalidInput for an invalid range, and for gears whose full turns are not determined.
    """
    if between is not None:
        low, high = _checked(between)
        return driver_segment(low, high, periodic=False), 0.0
    driven = sweep.solving_order.structure.driven[sweep.driver]
    if driven.pair.free_is_angle:
        turns = _turns(sweep)
        if turns is None:
            return driver_segment(start - TURN, start + TURN, periodic=False), 0.0
        return driver_segment(BEGIN, BEGIN + TURN * turns, periodic=True), TURN * turns
    reach = BEYOND * (greatest_reach(sweep.solving_order) + abs(start))
    on_frame = driven.link in sweep.solving_order.structure.ground.links
    return driver_segment(-reach if on_frame else 0.0, reach, periodic=False), 0.0


def _checked(between: Sequence[float]) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in between)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("between", f"{between!r} is not a range", "give two values (low, high)")) from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise InvalidInput(Problem("between", f"{low:g} to {high:g} is not a range", "give two values (low, high)"))
    return low, high


def greatest_reach(solving_order: SolvingOrder) -> float:
    """Return a length that no displacement of pinned links exceeds: the sum of the links' extents."""
    points = solving_order.structure.mechanism.geometry.points.values()
    return float(sum(_extent(list(placed.values())) for placed in points)) or solving_order.size


def _extent(points: list[Number]) -> float:
    if len(points) < 2:
        return 0.0
    x, y = ([part(p) for p in points] for part in (np.real, np.imag))
    wide, high = (max(float(np.max(v)) for v in c) - min(float(np.min(v)) for v in c) for c in (x, y))
    return float(np.hypot(wide, high))


def _turns(sweep: Sweep) -> int | None:
    """Return the number of turns of the driver after which gears and racks repeat, None if they do not.

    Raises InvalidInput where the full turns of links that groups solve matter to gears on them.
    """
    if not any(solver.counted_from for solver in sweep.solving_order.solvers):
        return 1
    places = _gear_poses(sweep, BEGIN + TURN * np.arange(MOST_TURNS + 1), 0.0)
    again = np.flatnonzero(_apart(sweep, places, places[:, :1])[1:] < SAME)
    if np.max(_apart(sweep, places[:, :1], _gear_poses(sweep, np.array([BEGIN]), TURN))) > SAME:
        what = "its gears ride on links whose full turns circuits do not count"
        raise InvalidInput(Problem("circuits", what, "follow it with solve(), which counts them"))
    return int(again[0]) + 1 if len(again) else None


def _gear_poses(sweep: Sweep, s: Number, more: float) -> Number:
    """Return origins and orientations of all bodies that gears and racks place, (2 bodies, values).

    Links that groups solve have turned by `more` than their orientations.
    """
    solving_order = sweep.solving_order
    upto = min(solving_order.numbered, default=len(solving_order.solvers))
    block = run(solving_order, sweep.start(s[None]), _Turned(solving_order, more), upto)
    links = [link for solver in solving_order.solvers[:upto] if solver.counted_from for link in solver.group.links]
    values = [value for link in links for value in (block.world[link].z.c[0], block.world[link].u.c[0])]
    return np.array([row(value, len(s)) for value in values]).reshape(-1, len(s))


@dataclass(frozen=True)
class _Turned:
    """The choice of the first mode of every group, with all links turned by more than drawn."""

    solving_order: SolvingOrder
    more: float

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return mode +1."""
        return 1.0

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return the drawn angle of a link plus `more`."""
        return drawn_angle(self.solving_order, link) + self.more


def _apart(sweep: Sweep, one: Number, other: Number) -> Number:
    """Return the largest difference of any body, at each value."""
    size = np.tile([sweep.solving_order.size, 1.0], len(one) // 2)[:, None]
    return np.max(np.nan_to_num(np.abs(one - other) / size), axis=0, initial=0.0)


def starting_values(solving_order: SolvingOrder, values: Mapping[str, Any]) -> dict[str, float]:
    """Return one value of each driver: from `values`, else as drawn, else the first of its own.

    Raises InvalidInput for unknown drivers and values other than one number.
    """
    unknown = [name for name in values if name not in solving_order.structure.driven]
    if unknown:
        raise InvalidInput([Problem(f"values.{name}", f"there is no driver {name!r}") for name in unknown])
    first = {drive.name: _first(solving_order, drive) for drive in solving_order.structure.mechanism.drives}
    drawn = _drawn(solving_order, first)
    return {name: _number(name, values[name]) if name in values else drawn.get(name, first[name]) for name in first}


def _first(solving_order: SolvingOrder, drive: Drive) -> float:
    if drive.values is not None:
        return float(first_entry(drive.values))
    return 0.0 if solving_order.structure.driven_angles[drive.name] else solving_order.size / 2.0


def _number(name: str, value: Any) -> float:
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem(f"values.{name}", f"{value!r} is not one number")) from None
    if not np.isfinite(found):
        raise InvalidInput(Problem(f"values.{name}", "the value is not finite"))
    return found


def _drawn(solving_order: SolvingOrder, first: Mapping[str, float]) -> dict[str, float]:
    """Return the drawn values of the drivers, empty without a drawing."""
    mechanism = solving_order.structure.mechanism
    if not mechanism.sketch:
        return {}
    given = inputs(solving_order, first, None, None, None)
    path, _ = driver_path(solving_order, given, mechanism.drawn_poses, mechanism.geometry.sketch)
    return {name: float(first_entry(v[0])) for name, v in path.at_home().drives.items()}
