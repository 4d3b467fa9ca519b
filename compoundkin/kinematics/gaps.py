"""Where a motion cannot be assembled: between which driver values, which group fails, and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, column
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.kinematics.curve.closed_states import why_no_return
from compoundkin.kinematics.motion import Motion

# Halvings of the distance between two neighbouring poses: 2**-45 of it is far below 1e-9 of any driver value.
HALVINGS = 45


@dataclass(frozen=True)
class Gap:
    """A run of poses that cannot be assembled, in one design.

    `begin` and `end` are the driver values at which the group stops and starts to close, found to 1e-9;
    where the run reaches an end of the motion (`open_begin`, `open_end`) they are the motion's own value
    there. `first` and `last` are the indices of the poses along the motion. `pair` is named where the poses
    are beyond an end of its guide, or its wheels do not fit in a design: `links` are then those that it joins, and no
    group is named. `times` are those of `begin` and `end` of a motion in time.
    """

    design: tuple[int, ...]
    first: int
    last: int
    begin: Mapping[str, float]
    end: Mapping[str, float]
    open_begin: bool
    open_end: bool
    links: tuple[str, ...]
    group: str
    reason: str
    pair: str = ""
    times: tuple[float, float] | None = None


@checked
def gaps(motion: Motion) -> tuple[Gap, ...]:
    """Return all gaps of a motion, design by design, in its order.

    >>> import warnings
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> triple_rocker = Mechanism(
    ...     "Triple rocker", link("frame", A=(0, 0), D=(7, 0)), link("crank", A=(0, 0), B=(4, 0)),
    ...     link("coupler", B=(0, 0), C=(5, 0)), link("rocker", D=(0, 0), C=(3, 0)), drive("crank"))
    >>> with warnings.catch_warnings(action="ignore"):
    ...     gap, = gaps(solve(triple_rocker))
    >>> gap.reason
    '|BD| = 11 > |BC| + |CD| = 5 + 3'
    >>> round(gap.begin["crank"], 6)
    1.552938
    """
    runs = _runs(motion.failed != 0)
    if not len(runs):
        return ()
    designs, first, last = runs[:, 0], runs[:, 1], runs[:, 2]
    with np.errstate(all="ignore"):
        places = _edges(motion, designs, first - 1, first), _edges(motion, designs, last + 1, last)
        begin, end = (_values(motion, designs, at) for at in places)
        middle = (first + last) // 2
        blames = _blames(motion, designs, middle)
    axes = motion.shape[:-1]
    found = []
    for k, (d, a, b) in enumerate(runs.tolist()):
        design = tuple(int(i) for i in np.unravel_index(d, axes)) if axes else ()
        found.append(
            Gap(
                design,
                a,
                b,
                _at(begin, k),
                _at(end, k),
                a == 0,
                b == motion.inputs.poses - 1,
                *blames[k],
                times=_times(motion, *(float(at[k]) for at in places)),
            )
        )
    return tuple(found)


def _runs(failed: Number) -> Number:
    """Return rows (design, first, last) of the runs of True along the last axis."""
    edge: Number = np.diff(np.pad(failed, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    design, first = np.nonzero(edge == 1)
    last = np.nonzero(edge == -1)[1] - 1
    return np.stack([design, first, last], axis=1)


def _edges(motion: Motion, designs: Number, good: Number, bad: Number) -> Number:
    """Find the places between an assembled pose and its neighbour that is not, by bisection."""
    inside = (good >= 0) & (good < motion.inputs.poses)
    near: Number = bad + np.where(inside, good - bad, 0.0)

    def closes(middle: Number) -> Number:
        part = motion.inputs.pick(designs, middle)
        block = motion.block(part, 0, middle[:, None], designs[:, None])
        return column(block.failed == 0, len(designs))

    return bisect_brackets(closes, near, bad.astype(float), HALVINGS)[0]


def _times(motion: Motion, begin: float, end: float) -> tuple[float, float] | None:
    """Return the times at two places along a motion; None where it is not in time."""
    if motion.time is None or np.ndim(motion.time) != 1 or len(motion.time) != motion.inputs.poses:
        return None
    first, last = np.interp([begin, end], np.arange(len(motion.time)), motion.time)
    return float(first), float(last)


def _values(motion: Motion, designs: Number, near: Number) -> dict[str, Number]:
    """Return the driver values at places along the motion."""
    drives = motion.inputs.pick(designs, near).drives
    return {name: np.broadcast_to(np.ravel(values[0]), len(designs)) for name, values in drives.items()}


class _Blame(NamedTuple):
    """What a gap says of its cause, in the order of its fields."""

    links: tuple[str, ...]
    group: str
    reason: str
    pair: str = ""


def _blames(motion: Motion, designs: Number, poses: Number) -> list[_Blame]:
    part = motion.inputs.pick(designs, poses.astype(float))
    block = motion.block(part, 0, poses.astype(float)[:, None], designs[:, None])
    found = []
    for k, index in enumerate(motion.failed[designs, poses].tolist()):
        broken = motion.solving_order.broken(index, block, k)
        if broken is not None:
            found.append(_Blame(broken.pair.members, "", broken.reason, broken.pair.name))
        else:
            group, solver = motion.structure.groups[index - 1], motion.solving_order.solvers[index - 1]
            reason = solver.why(block, k)
            if solver.is_numbered:
                curve, (d, s) = motion.followed.curve, (designs[k : k + 1], poses[k : k + 1].astype(float))
                place = float(motion.followed.places_on_path(d, s)[0])
                reason += f"; {why_no_return(curve, solver.index, curve.paths[solver.index], int(d[0]), place)}"
            found.append(_Blame(group.links, group.name, reason))
    return found


def _at(values: Mapping[str, Number], k: int) -> dict[str, float]:
    return {name: float(v[k]) for name, v in values.items()}
