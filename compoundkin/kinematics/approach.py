"""The way from the drawn pose to the motion: where the assembly modes are read off and carried from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import TURN, whole_turns
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.sampling import CLOSE, spacings
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs.optional_answers import as_turn_counting


def approach(
    plan: SolvingOrder, given: Inputs, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> tuple[Inputs, int, float]:
    """The lead, from the drawn drivers to the motion's pose `at` nearest to them; `at`; and the home of the modes.

    The lead is one pose where the drawing shows no driver. The home is the place along the motion to which
    the modes belong: just before `at` where the lead comes from before, else just after.
    """
    shown = {name: _drawn_value(plan, given, name, drawn, sketch) for name in plan.driven}
    values = {name: value for name, value in shown.items() if value is not None}
    at = _nearest(plan, given, values) if values else 0
    end = given.cut(slice(None), slice(at, at + 1))
    ways: dict[str, Number] = {}
    for name, rest in end.drives.items():
        way = rest[0] - values.get(name, rest[0])
        if plan.driven[name].pair.free_is_angle:
            way = way - whole_turns(way)
        ways[name] = way
    count = 1 + max((spacings(plan, name, way) for name, way in ways.items()), default=0)
    ramp = np.linspace(-1.0, 0.0, count)[None] if count > 1 else np.zeros((1, 1))
    lead = end.driven({name: (rest[0] + ways[name] * ramp,) for name, rest in end.drives.items()})
    return lead.of_poses(count), at, at + _side(given, at, ways) * CLOSE


def recounted(plan: SolvingOrder, ways: tuple[Inputs, ...], home: Inputs) -> tuple[Inputs, ...]:
    """The motion and its lead with phases read off a drawing taken on by the turns that drivers have made at home.

    A drawing shows the angle of a driven link within half a turn; its driver may be any number of turns ahead.
    """
    drawn, rounds = _as_drawn(plan, home)
    turns = dict(_turns_at(plan, _counted_on(plan, drawn, rounds, {})))
    return tuple(_counted_on(plan, way, rounds, turns) for way in ways)


def _as_drawn(plan: SolvingOrder, home: Inputs) -> tuple[Inputs, dict[str, Number]]:
    """The home with drivers as drawn, in the turn they are in at home; and that turn, by driven pair."""
    rounds: dict[str, Number] = {}
    for name, driven in plan.driven.items():
        value = _drawn_value(plan, home, name, plan.structure.mechanism.geometry.drawn, {})
        if value is None:
            continue
        if driven.pair.free_is_angle:
            turns = np.round((home.drives[name][0] - value) / TURN)
            rounds[driven.pair.name] = turns * driven.pair.driven_by(driven.drive.link)
            value = value + TURN * turns
        home = home.driven({**home.drives, name: (value,)})
    return home, rounds


def _counted_on(plan: SolvingOrder, way: Inputs, rounds: Mapping[str, Number], turns: Mapping[str, Number]) -> Inputs:
    """A way with the phases of driven pairs taken on by their turns, those of others by the turns of their links."""
    geometry = plan.structure.mechanism.geometry
    ends = dict(way.ends)
    for name, pair in plan.pairs.items():
        ahead = tuple(turns.get(member, 0.0) for member in pair.members)
        counting = as_turn_counting(pair)
        if counting and name in rounds:
            ends[name] = counting.with_driver_turns(ends[name], geometry, rounds[name])
        elif counting and any(np.any(turn != 0.0) for turn in ahead):
            ends[name] = counting.with_link_turns(ends[name], geometry, ahead)
    return replace(way, ends=ends)


def _turns_at(plan: SolvingOrder, drawn: Inputs) -> Iterator[tuple[str, Number]]:
    """By how many turns each driven link is ahead of its drawn angle, relative to the base of its composite link."""
    poses = plan.structure.mechanism.geometry.drawn
    start = plan.start(drawn.ends, drawn.series(0), 0, (drawn.designs, 1))
    for body in plan.bodies:
        base = body.links[0]
        for link in (link for link in body.links[1:] if link in poses and base in poses and link in plan.turning):
            pose = start.world.get(link) or start.local[link]
            gap = column(poses[base]).angle.c[0] + pose.angle.c[0] - column(poses[link]).angle.c[0]
            yield link, np.round(gap / TURN)


def _drawn_value(
    plan: SolvingOrder, given: Inputs, name: str, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> Number | None:
    """The driver's coordinate as the drawing shows it, a number or (designs, 1); None where it does not."""
    driven = plan.driven[name]
    pair = driven.pair
    if any(link not in drawn for link in pair.members):
        value = pair.drawn_coordinate(sketch)
        return None if value is None else first_of(value)
    ends = given.cut(slice(None), slice(0, 1)).ends[pair.name]
    poses = (column(drawn[pair.members[0]]), column(drawn[pair.members[1]]))
    return pair.coordinate(ends, poses).c[0] * pair.driven_by(driven.drive.link)


def _nearest(plan: SolvingOrder, given: Inputs, values: Mapping[str, Number]) -> int:
    """The index of the pose whose drivers are nearest to the drawn ones, over all designs."""
    total: Number = np.zeros((1, 1))
    for name, value in values.items():
        gap = np.abs(given.drives[name][0] - value)
        if plan.driven[name].pair.free_is_angle:
            gap = np.abs(gap - whole_turns(gap))
        total = total + gap
    return int(np.argmin(np.broadcast_to(total.max(axis=0), given.poses)))


def _side(given: Inputs, at: int, ways: Mapping[str, Number]) -> float:
    """-1 where the lead reaches the motion's pose `at` in the direction of the motion, else +1."""
    leads = given.poses > 1 and any(np.any(way != 0.0) for way in ways.values())
    step = given.at(np.array([float(at)])).drives if leads else {}
    along = sum(float(np.sum(np.sign(values[1] * ways[name]))) for name, values in step.items())
    return -1.0 if along > 0.0 else 1.0


def first_of(value: Number) -> Number:
    """A dimension at the first pose of each design: a number, or an array (designs, 1)."""
    if np.ndim(value) == 0:
        return value
    array = np.asarray(value)
    return array[..., :1].reshape(-1, 1)


def column(pose: Pose) -> Pose:
    """A pose at the first pose of each design."""
    theta = None if pose.theta is None else constant(first_of(pose.theta.c[0]))
    return Pose(constant(first_of(pose.z.c[0])), constant(first_of(pose.u.c[0])), theta)
