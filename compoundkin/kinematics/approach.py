"""The approach path from the drawn pose to the motion, from which modes are carried; how far drivers go on a way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# Samples lie at most so far apart: radians of a driver's angle, or parts of the size of its length.
SPACING = np.pi / 36.0
# No step of a driver is cut into more: a block may travel far on a mechanism whose own dimensions are tiny.
MOST = 1000
# Two places along the motion nearer than this part of a pose's distance are one: a double root is known to the
# square root of rounding.
CLOSE = 1e-6


def approach_path(
    solving_order: SolvingOrder, given: Inputs, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> tuple[Inputs, float]:
    """Return the way from the drawn drivers to the motion, and its place there.

    It leads to the place, between two poses too, that is nearest to the drawing. It is one pose where the drawing
    shows no driver, or shows them at a place of the motion.
    """
    shown = {name: drawn_value(solving_order, given, name, drawn, sketch) for name in solving_order.structure.driven}
    values = {name: value for name, value in shown.items() if value is not None}
    if not values:
        first = given.cut(slice(None), slice(0, 1))
        here = {name: (rest[0] + np.zeros((1, 1)),) for name, rest in first.drives.items()}
        return first.driven(here).of_poses(1), 0.0
    at = _nearest(solving_order, given, values)
    between_poses = at != np.floor(at)
    end = given.at(np.array([at])) if between_poses else given.cut(slice(None), slice(int(at), int(at) + 1))
    ways: dict[str, Number] = {}
    for name, rest in end.drives.items():
        way = rest[0] - values.get(name, rest[0])
        if solving_order.structure.driven_angles[name]:
            way = way - whole_turns(way)
        ways[name] = way
    count = 1 + max((spacings(solving_order, name, way) for name, way in ways.items()), default=0)
    ramp = np.linspace(-1.0, 0.0, count)[None] if count > 1 else np.zeros((1, 1))
    path = end.driven({name: (rest[0] + ways[name] * ramp,) for name, rest in end.drives.items()})
    return path.of_poses(count), at


def drawn_value(
    solving_order: SolvingOrder, given: Inputs, name: str, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> Number | None:
    """Return the driver's coordinate as the drawing shows it, a number or (designs, 1). None where it does not."""
    driven = solving_order.structure.driven[name]
    pair = driven.pair
    told = pair.drawn_value(drawn, sketch)
    if told is not None:
        return first_of(told)
    if any(link not in drawn for link in pair.members):
        length = pair.drawn_length(sketch)
        return None if length is None else _signed(first_of(length), given.drives[name][0])
    ends = given.cut(slice(None), slice(0, 1)).ends[pair.name]
    poses = (column(drawn[pair.members[0]]), column(drawn[pair.members[1]]))
    return pair.drawn_coordinate(ends, poses) * pair.driven_by(driven.drive.link)


def _signed(length: Number, values: Number) -> Number:
    """Return a length that is drawn without its sign. Its sign is the one that brings it nearer to some value."""
    ahead, behind = (np.min(np.abs(np.atleast_2d(values - way)), axis=-1, keepdims=True) for way in (length, -length))
    return np.where(ahead <= behind, length, -length)


def _nearest(solving_order: SolvingOrder, given: Inputs, values: Mapping[str, Number]) -> float:
    """Return the place, between poses too, whose drivers are nearest to the drawn ones, over all designs.

    Of places that are equally near, as the ends of a full turn, it is the one whose values are nearest by themselves.
    """
    if given.poses == 1:
        return 0.0
    # from each pose to the next the drivers go straight on: the foot of the perpendicular to that line
    here = [_off(solving_order, given, name, value)[:, :-1] for name, value in values.items()]
    steps = [_step(given.drives[name][0]) / solving_order.unit(name) for name in values]
    square = sum((step**2).sum(axis=0) for step in steps)
    back = sum((step * off).sum(axis=0) for step, off in zip(steps, here, strict=True))
    share = np.divide(-back, square, out=np.zeros(given.poses - 1), where=square > 0.0)
    share = np.where(share < CLOSE, 0.0, np.where(share > 1.0 - CLOSE, 1.0, share))
    near = np.arange(given.poses - 1)
    for turns in (False, True):
        offs = (_off(solving_order, given, name, value, turns)[:, :-1] for name, value in values.items())
        worst = sum(np.abs(off + share * step) for off, step in zip(offs, steps, strict=True)).max(axis=0)[near]
        # equal but for rounding
        near = near[worst <= worst.min() + CLOSE]
        if len(near) == 1:
            break
    return float(near[0] + share[near[0]])


def _off(solving_order: SolvingOrder, given: Inputs, name: str, value: Number, turns: bool = False) -> Number:
    """Return how far a driver is from where it is drawn, with whole turns or without.

    It is (1 or designs, poses), in radians or parts of the size.
    """
    off = given.drives[name][0] - value
    if solving_order.structure.driven_angles[name] and not turns:
        off = off - whole_turns(off)
    off = np.atleast_2d(off / solving_order.unit(name))
    return off if off.shape[1] == given.poses else np.broadcast_to(off, (len(off), given.poses))


def first_of(value: Number) -> Number:
    """Return a dimension at the first pose of each design. It is a number, or an array (designs, 1)."""
    if isinstance(value, complex | float) or np.ndim(value) == 0:
        return value
    array = np.asarray(value)
    return array[..., :1].reshape(-1, 1)


def column(pose: Pose) -> Pose:
    """Return a pose at the first pose of each design."""
    return pose.mapped(lambda series: constant(first_of(series.c[0])))


def spacings(solving_order: SolvingOrder, name: str, way: Number) -> int:
    """Return how many spacings the longest of some ways of a driver takes. It is 0 where it stands still."""
    return max(0, int(np.ceil(min(_spacings(solving_order, name, way) - CLOSE, MOST))))


def between(solving_order: SolvingOrder, given: Inputs) -> int:
    """Return the spacings of a driver's longest step between poses of a motion.

    A step goes from one pose to the next.
    """
    return max((spacings(solving_order, name, steps) for name, steps in _steps(given)), default=0)


def spacings_between(solving_order: SolvingOrder, given: Inputs) -> Number:
    """Return the spacings from each pose of a motion to the next, as fractions. They are those of the fastest."""
    found = np.zeros(max(given.poses - 1, 0))
    for name, steps in _steps(given):
        found = np.maximum(found, np.max(np.abs(steps), axis=0) / solving_order.unit(name) / SPACING)
    return found


def pace(solving_order: SolvingOrder, given: Inputs) -> float:
    """Return the spacings of a driver's longest step, as a fraction. A step goes from one pose to the next."""
    return max((_spacings(solving_order, name, steps) for name, steps in _steps(given)), default=0.0)


def _spacings(solving_order: SolvingOrder, name: str, way: Number) -> float:
    return float(np.max(np.abs(way))) / solving_order.unit(name) / SPACING


def _steps(given: Inputs) -> Iterator[tuple[str, Number]]:
    """Return the steps of every driver that moves."""
    for name, (value, *_) in given.drives.items():
        if np.ndim(value) > 1 and np.shape(value)[-1] > 1:
            yield name, _step(value)


def _step(value: Number) -> Number:
    """Return the steps of a driver's values from pose to pose, (1 or designs, poses - 1). They may be one zero."""
    return value[:, 1:] - value[:, :-1] if np.ndim(value) > 1 and value.shape[1] > 1 else np.zeros((1, 1))
