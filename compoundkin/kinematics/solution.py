"""Solving: from a mechanism and driver values to a motion with every derivative asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import (
    ChangePointWarning,
    DrawnBeyondEnd,
    FewDigits,
    InvalidInput,
    NotAssembled,
    NotDetermined,
    Problem,
    UnassembledPoses,
    warn,
)
from compoundkin.base.poses import Pose
from compoundkin.kinematics.approach import drawn_value
from compoundkin.kinematics.block import places
from compoundkin.kinematics.chosen_modes import Shown, shown_by, signs_of
from compoundkin.kinematics.configuration import Configuration, dimensions_at, numbers_at, placed_at
from compoundkin.kinematics.driver_values import by_name, inputs, times_of
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.likely_slips import warn_of_degrees
from compoundkin.kinematics.lost_digits import Told, without_lost
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.redundant_pairs import check_redundant, diagnosing, rank_diagnosis
from compoundkin.kinematics.solved_blocks import settled, with_branch
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.attributes import HIGHEST_ORDER
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose
from compoundkin.structure.kinematic_structure import Structure


@checked
def solve(
    mechanism: Mechanism | Structure,
    values: Any = None,
    *,
    time: Any = None,
    speed: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    order: int = 2,
    modes: Mapping[str, int] | str | Configuration | None = None,
    hint: Mapping[str, Any] | None = None,
) -> Motion:
    """Solve a mechanism group by group, for position and its derivatives. They go up to `order` (0 to 3).

    `values` gives each driver's coordinate (radians or lengths; arrays, the last axis the motion); `speed`,
    `acceleration`, `jerk` its rates, a number for a single driver or a mapping by name. What is not given
    comes from the mechanism's drives; a driver of a pin without values makes a full turn.

    In time: at the times `time` (seconds, any order; the last axis is the motion) drivers with a law are where it
    takes them, with its derivatives; others move from their single value (0 where they have none) by their speed,
    acceleration and jerk. Where `time` is not given, drivers with laws that are given no values move at the mechanism's
    own times, else over the range on which their laws agree.

    The assembly mode of each group is that of `modes` (a link of the group: +1 or -1, or its configuration's number),
    else the one nearest to `hint` (points near their places at the first pose), else nearest to the mechanism's
    drawing. By default a dyad that closes a four-bar loop of pins stands open at the first pose (the larger area of
    its loop), another has mode +1, a larger group the configuration farthest from being singular. `modes` may also be
    one of `configurations()`, from which the motion then starts, or the name of one at the first pose.

    A mechanism that moves though it is overconstrained is solved without what is redundant, which is then checked.

    Raises NotDetermined where the structure cannot be solved, InvalidInput for values that do not fit,
    NotAssembled where a group has no pose at all or a redundant pair opens; warns UnassembledPoses where some poses do
    not close, DrawnBeyondEnd where the drawing is beyond an end of a guide, ChangePointWarning where drivers rest
    exactly at a change point (the smooth motion goes on), FewDigits where rates next to a limit position have fewer
    than three digits; those without any are NaN.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> solve(crank, {"crank": [0.0, np.pi / 2]}, speed=3.0).points["B"].velocity.xy.round(12).tolist()
    [[0.0, 6.0], [-6.0, 0.0]]
    """
    _check_order(order)
    solving_order = solving_order_of(mechanism)
    with np.errstate(all="ignore"):
        values = by_name(solving_order.structure.mechanism, values)
        times = times_of(solving_order.structure.mechanism, values, time)
        given = inputs(solving_order, values, speed, acceleration, jerk, times, order)
        signs, shown = signs_of(solving_order, modes), shown_by(solving_order, modes, hint)
        told = solved(solving_order, given, signs, shown, order)
    motion = told.motion if times is None else replace(told.motion, time=times)
    if times is None:
        warn_of_degrees(motion.structure, given)
    _warn(motion, told.poor)
    return motion


def solved(solving_order: SolvingOrder, given: Inputs, signs: Mapping[int, int], shown: Shown, order: int) -> Told:
    """Return the motion of some inputs. Raises as `solve`, and warns of nothing."""
    with diagnosing(solving_order.structure):
        tracker = Tracker(solving_order, given, signs, shown)
    told = without_lost(*settled(tracker.solving_order, tracker.given, tracker, order))
    if solving_order.structure.relaxation:
        check_redundant(told.motion)
    return told


def _warn(motion: Motion, poor: int) -> None:
    """Warn of poses not assembled, of rates with few digits, of rests at change points, of drawings beyond ends."""
    if motion.solving_order.guide_ends.pairs:
        _warn_of_drawing(motion.tracker)
    if any(motion.tracker.rests.values()):
        warn(_rest(motion), ChangePointWarning)
    missing = int(np.count_nonzero(motion.failed))
    if missing:
        how_many = f"{missing} of {motion.failed.size} poses cannot be assembled"
        warn(f"{how_many}: Motion.assembled masks them, gaps() explains", UnassembledPoses)
    if poor:
        how_many = f"rates at {poor} of {motion.failed.size} poses have fewer than three digits"
        warn(f"{how_many}, next to limit positions: Motion.error(order) tells where", FewDigits)


def _rest(motion: Motion) -> str:
    """Return where drivers rest at a change point for the first time, and which branch is taken from there."""
    group, (design, pose) = next((k, found[0]) for k, found in motion.tracker.rests.items() if found)
    values = {
        name: np.broadcast_to(v[0], motion.failed.shape)[design, pose] for name, v in motion.inputs.drives.items()
    }
    angles = motion.structure.driven_angles
    told = (f"{name} = {np.rad2deg(v) if angles[name] else v:.6g}{' degrees' if angles[name] else ''}"
            for name, v in values.items())  # fmt: skip
    links = ", ".join(motion.structure.groups[group].links)
    where = f"at pose {pose}, {', '.join(told)}, the drivers rest at a change point of {links}"
    return f"{where}: either branch may go on from there, and the smooth motion is taken"


def _warn_of_drawing(tracker: Tracker) -> None:
    """Warn where the pose drawn, at the driver values it shows, is beyond an end of a guide."""
    solving_order, shown = tracker.solving_order, tracker.shown
    drivers = solving_order.structure.driven
    given = tracker.given
    if any(drawn_value(solving_order, given, name, shown.poses, shown.beside) is None for name in drivers):
        return
    first = tracker.approach_path.cut(slice(None), slice(0, 1))
    with np.errstate(all="ignore"):
        block = tracker.run(first, 0, *places(slice(0, given.designs), slice(0, 1)), on_approach=True)
        failed = np.broadcast_to(block.failed, block.shape).ravel()
        passed = [solving_order.guide_ends.passed(int(index), block, k) for k, index in enumerate(failed)]
    for reason in dict.fromkeys(one.reason for one in passed if one):
        warn(f"as it is drawn, {reason}", DrawnBeyondEnd)


def _check_order(order: int) -> None:
    """Raise InvalidInput for what is no order of derivatives."""
    if isinstance(order, bool) or not isinstance(order, int) or order not in range(HIGHEST_ORDER + 1):
        remedy = "0 position, 1 velocity, 2 acceleration, 3 jerk"
        raise InvalidInput(Problem("order", f"{order!r} is not an order", remedy))


def solving_order_of(mechanism: Mechanism | Structure) -> SolvingOrder:
    """Return the solving order of a mechanism, made once and kept with it."""
    owner = mechanism.mechanism if isinstance(mechanism, Structure) else mechanism
    solving_order: SolvingOrder | None = owner.__dict__.get("_solving_order")
    if solving_order is None:
        structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
        if structure.faults:
            problems = [Problem("structure", fault.text, fault.remedy) for fault in structure.faults]
            raise NotDetermined(problems, heading=f"{owner.title!r} cannot be solved{rank_diagnosis(structure)}")
        solving_order = owner.__dict__["_solving_order"] = SolvingOrder(structure)
    return solving_order


def starting_configuration(
    solving_order: SolvingOrder, values: Mapping[str, float], design: int
) -> Configuration | None:
    """Return the configuration in which `solve` begins at these values. None where it does not close there."""
    given = inputs(solving_order, values, None, None, None)
    try:
        tracker = Tracker(solving_order, given, signs_of(solving_order), shown_by(solving_order))
    except NotAssembled:
        return None
    if tracker.lost:
        with_branch(tracker)
    block = tracker.run(tracker.given, 0, *places(slice(0, given.designs), slice(0, given.poses)))
    if np.broadcast_to(block.failed, block.shape)[design, 0]:
        return None
    return _picked(solving_order.structure, values, block.world, (design, 0))


def first_configuration(motion: Motion, design: int) -> Configuration | None:
    """Return the configuration of the first assembled pose of a motion, without its modes. None where it has none."""
    known = np.flatnonzero(motion.failed[design] == 0)
    if not known.size:
        return None
    at = design, int(known[0])
    values = numbers_at({name: v[0] for name, v in motion.inputs.drives.items()}, at)
    return _picked(motion.structure, values, motion.poses, at)


def _picked(
    structure: Structure, values: Mapping[str, float], poses: Mapping[str, Pose], at: tuple[int, int]
) -> Configuration:
    return Configuration(structure, dict(values), placed_at(poses, at), {}, {}, dimensions_at(structure, *at))
