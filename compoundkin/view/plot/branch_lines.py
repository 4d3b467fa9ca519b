"""Branches of circuits as curves: quantities at places of every segment, and in which turn angles are shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import degrees, turns_above, unwrapped
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.configurations.circuit import Branch, Limit
from compoundkin.configurations.segments import CHANGE
from compoundkin.kinematics.quantities import quantity, whole_and_part
from compoundkin.model.attributes import ALSO, order_of, vector_of
from compoundkin.view.plot.branch_positions import Positions
from compoundkin.view.plot.plotted_rows import TURN, Plotted

# Where the one turn begins in which angles are shown, degrees; of equally good ones the first is taken.
OF_DRIVERS, OF_ANGLES = (0.0, -180.0), (-180.0, 0.0, -90.0)


def shown(positions: Positions, name: str) -> tuple[Plotted, ...]:
    """Return a quantity by its name, (segments, places), angles in degrees. A point as its coordinates.

    Raises UnknownName with the nearest name there is, InvalidInput for rates.
    """
    vector, _ = vector_of(name)
    if order_of(vector):
        owner = vector.rpartition(".")[0]
        what = quantity(positions, owner)
        position = "x" if what.is_vector else next(iter(ALSO[what.dimension]))
        remedy = f"take {owner}.{position}, or plot a motion: solve() it"
        raise InvalidInput(Problem(name, "circuits show positions, not rates", remedy))
    found, part = whole_and_part(positions, name)
    # angles go on from place to place, without leaps by a turn
    values = unwrapped(found.values) if found.is_angle else found.values
    one = Plotted(**vars(replace(found, values=values).shown))
    if part:
        return (one.part(part),)
    return (one.part("x"), one.part("y")) if one.is_vector else (one,)


@dataclass(frozen=True, eq=False)
class BranchCurve:
    """A quantity along a branch, in the order of its circuit. The driver `x`, the quantity `y`, and special places.

    `limits` are the indices of its ends that are limit positions, with these; `changes` those of change points.
    """

    branch: Branch
    x: Number
    y: Number
    limits: tuple[tuple[int, Limit], ...]
    changes: tuple[int, ...]


def curve_of(positions: Positions, branch: Branch, one: Plotted) -> BranchCurve:
    """Return the curve of a branch."""
    found, visits = positions.found, branch.visits
    x = np.concatenate([positions.values[v.row][:: v.sense] + v.periods * found.period for v in visits])
    y = np.concatenate([one.values[v.row][:: v.sense] for v in visits])
    ends = branch.ends if visits[0].sense > 0 else branch.ends[::-1]
    limits = tuple((k, end) for k, end in zip((0, len(x) - 1), ends, strict=True) if end is not None)
    kinds = found.placing.segments.kind
    count = positions.values.shape[1]
    changes = tuple(count * (i + 1) - 1 for i, v in enumerate(visits) if kinds[v.row, v.left] == CHANGE)
    driver = degrees(x) if positions.drives[found.driver].is_angle else x
    return BranchCurve(branch, driver, _joined(y) if one.is_angle else y, limits, changes)


def _joined(angles: Number) -> Number:
    return np.rad2deg(unwrapped(np.deg2rad(angles)))


def seam(curves: Sequence[Number], candidates: Sequence[float]) -> float:
    """Return the angle, of some, at which the fewest of several curves are cut. Of those, where they take least room.

    >>> seam([np.array([-80.0, 80.0])], (0.0, -180.0))
    -180.0
    """

    def room(low: float) -> tuple[int, float]:
        inside = np.concatenate([curve - turns_above(curve, low, TURN) for curve in curves])
        span = np.ptp(inside[np.isfinite(inside)]) if np.isfinite(inside).any() else 0.0
        # in steps of degrees, so that rounding does not decide
        return sum(len(_cuts(turns_above(curve, low, TURN))) for curve in curves), round(float(span))

    return min(candidates, key=room)


def wrapped(first: Number, second: Number, low: float) -> tuple[Number, Number]:
    """Return a curve, its first coordinate brought into the turn from `low`. It is NaN where it is cut.

    >>> [part.tolist() for part in wrapped(np.array([350.0, 370.0]), np.array([0.0, 1.0]), 0.0)]
    [[350.0, 360.0, nan, 0.0, 10.0], [0.0, 0.5, nan, 0.5, 1.0]]
    """
    away = turns_above(first, low, TURN)
    k = _cuts(away)
    border = low + np.maximum(away[k], away[k + 1])
    share = (border - first[k]) / (first[k + 1] - first[k])
    between = second[k] + share * (second[k + 1] - second[k])
    where, blank = np.repeat(k + 1, 3), np.full(len(k), np.nan)
    crossed = np.stack([border - away[k], blank, border - away[k + 1]], axis=1).ravel()
    return np.insert(first - away, where, crossed), np.insert(
        second, where, np.stack([between, blank, between], 1).ravel()
    )


def _cuts(away: Number) -> Number:
    """After which places a curve goes into another turn."""
    return np.flatnonzero(np.isfinite(away[1:] - away[:-1]) & (away[1:] != away[:-1]))
