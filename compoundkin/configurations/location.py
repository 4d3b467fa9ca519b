"""Where on the circuits a configuration lies, and where the mechanism is when it begins to move."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.configurations.circuit import Circuit, Place
from compoundkin.configurations.enumeration import dimensions_at
from compoundkin.configurations.segment_poses import Placing, gap_between
from compoundkin.kinematics import Motion
from compoundkin.kinematics.approach import approach
from compoundkin.kinematics.block import places
from compoundkin.kinematics.chosen_modes import signs_of
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.inputs import inputs
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.elements import Drive
from compoundkin.structure.kinematic_structure import Structure

# A configuration lies on a strand within this: it may be at a limit position, where poses are known to the square
# root of rounding, or read off a drawing that was drawn exactly.
MATCHED = 1e-5
# The other drivers stand where they stood when the circuits were found, within this.
STANDING = 1e-9


def located(placing: Placing, circuits: tuple[Circuit, ...], period: float, one: Configuration) -> Place:
    """The place of a configuration; raises InvalidInput where it lies on none of the circuits."""
    sweep, strands = placing.sweep, placing.strands
    if one.structure.mechanism != sweep.plan.structure.mechanism:
        raise InvalidInput(Problem("configuration", "it is one of another mechanism"))
    moved = [name for name, value in sweep.fixed.items() if abs(one.values[name] - value) > STANDING * (1 + abs(value))]
    if moved:
        what = f"{', '.join(moved)} stand elsewhere than in these circuits"
        raise InvalidInput(Problem("configuration", what, "find the circuits with these values of the other drivers"))
    value = one.values[sweep.driver]
    shift = period * np.floor((value - np.min(strands.low)) / period) if period else 0.0
    candidates = [(row, value - s) for s in ((shift, shift + period, shift - period) if period else (0.0,))
                  for row in _crossed(placing, value - s)]  # fmt: skip
    if candidates:
        rows, s = np.array([row for row, _ in candidates]), np.array([s for _, s in candidates])
        s = np.clip(s, strands.low[rows], strands.high[rows])
        with np.errstate(all="ignore"):
            gaps = gap_between(one, placing.run(rows, s), len(rows), sweep.plan.size)
        best = int(np.argmin(np.nan_to_num(gaps, nan=np.inf)))
        if gaps[best] < MATCHED:
            return _place(circuits, int(rows[best]), float(s[best]), value)
    raise InvalidInput(Problem("configuration", "it does not close, or lies on none of the circuits that were found"))


def _crossed(placing: Placing, s: float) -> list[int]:
    strands = placing.strands
    near = MATCHED**2 * (1.0 + abs(s))
    return np.flatnonzero((strands.low - near <= s) & (s <= strands.high + near)).tolist()


def _place(circuits: tuple[Circuit, ...], row: int, s: float, value: float) -> Place:
    found = ((c, b, v) for c in circuits for b in c.branches for v in b.visits if v.row == row)
    circuit, branch, visit = next(found)
    return Place(circuit.number, branch.number, value, visit, s)


def starting_values(plan: SolvingOrder, values: Mapping[str, Any], moved: str) -> dict[str, float]:
    """One value of each driver: that given, else where it is drawn, else the first of its own.

    Raises InvalidInput for names that are no driver's, and values that are no single number.
    """
    unknown = [name for name in values if name not in plan.driven]
    if unknown:
        raise InvalidInput([Problem(f"values.{name}", f"there is no driver {name!r}") for name in unknown])
    first = {drive.name: _first(plan, drive) for drive in plan.structure.mechanism.drives}
    drawn = _drawn(plan, first)
    return {name: _number(name, values[name]) if name in values else drawn.get(name, first[name]) for name in first}


def _first(plan: SolvingOrder, drive: Drive) -> float:
    if drive.values is not None:
        return float(np.ravel(drive.values)[0])
    return 0.0 if plan.driven[drive.name].pair.free_is_angle else plan.size / 2.0


def _number(name: str, value: Any) -> float:
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem(f"values.{name}", f"{value!r} is not one number")) from None
    if not np.isfinite(found):
        raise InvalidInput(Problem(f"values.{name}", "the value is not finite"))
    return found


def _drawn(plan: SolvingOrder, first: Mapping[str, float]) -> dict[str, float]:
    """Where the drivers are drawn; nothing where nothing is drawn."""
    if not plan.structure.mechanism.sketch:
        return {}
    geometry = plan.structure.mechanism.geometry
    lead, _, _ = approach(plan, inputs(plan, first, None, None, None), geometry.drawn, geometry.sketch)
    return {name: float(np.ravel(v[0])[0]) for name, v in lead.drives.items()}


def starting_configuration(plan: SolvingOrder, values: Mapping[str, float], design: int) -> Configuration | None:
    """The configuration in which `solve` begins at these values; None where it does not close there."""
    given = inputs(plan, values, None, None, None)
    try:
        tracker = Tracker(plan, given, signs_of(plan), {})
    except NotAssembled:
        return None
    block = tracker.run(tracker.given, 0, *places(slice(0, given.designs), slice(0, given.poses)))
    if np.broadcast_to(block.failed, (given.designs, given.poses))[design, 0]:
        return None

    return _configuration(plan.structure, values, block.world, (given.designs, given.poses), (design, 0))


def first_configuration(motion: Motion, design: int) -> Configuration | None:
    """The configuration of the first assembled pose of a motion, without its modes; None where it has none."""
    shape = motion.inputs.designs, motion.inputs.poses
    known = np.flatnonzero(np.broadcast_to(motion.failed, shape)[design] == 0)
    if not known.size:
        return None
    at = design, int(known[0])
    values = {name: float(np.broadcast_to(v[0], shape)[at]) for name, v in motion.inputs.drives.items()}
    return _configuration(motion.structure, values, motion.poses, shape, at)


def _configuration(
    structure: Structure,
    values: Mapping[str, float],
    poses: Mapping[str, Pose],
    shape: tuple[int, int],
    at: tuple[int, int],
) -> Configuration:
    """One of an array of configurations."""

    def one(value: Number) -> complex:
        return complex(np.broadcast_to(value, shape)[at])

    found = {name: Pose(constant(one(p.z.c[0])), constant(one(p.u.c[0]))) for name, p in poses.items()}
    return Configuration(structure, dict(values), found, {}, {}, dimensions_at(structure, *at))
