"""The equation of motion of one driver as a table over its coordinate: Chebyshev polynomials, piece by piece.

Of one freedom everything but time and speed is a function of the coordinate. It is solved once at Chebyshev's points of
pieces that are halved until the polynomials hold to rounding, and read off them afterwards.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 4.
"""

from __future__ import annotations

import warnings
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import CompoundkinError
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.simulation.table_bridge import with_bridges
from compoundkin.dynamics.simulation.table_piece import NODES, POINTS, TO_COEFFICIENTS, TablePiece
from compoundkin.dynamics.work.mass_motion import mass_motions
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair

# Pieces of a table to begin with, and how often they are halved.
PIECES, HALVED = 16, 7
# Polynomials hold where their last coefficients are this part of the largest: some hundred units of rounding.
HOLDS, LAST = 3e-14, 3
# Next to a change point accelerations have some ten digits; a corner of a load is still far above this.
HOLDS_NEAR = 1e-8
# Poses of the motion by which the configuration is kept.
POSES = 145


@dataclass(frozen=True, eq=False)
class DriveTable:
    """A table over a range of a driver. Pieces in order; where nothing holds there is none."""

    low: float
    high: float
    pieces: Sequence[TablePiece]
    starts: Sequence[float]
    motion: Motion

    def piece(self, value: float) -> TablePiece | None:
        """Return the piece at a value."""
        k = bisect_right(self.starts, value) - 1
        found = self.pieces[k] if k >= 0 else None
        return found if found is not None and value <= found.high else None

    def sign(self, k: int, value: float) -> float:
        """Return the sign of a dyad's mode at a value."""
        place = _places(np.array([[value]]), (self.low, self.high))
        return float(np.ravel(self.motion.tracker.sign(k, np.array([[0]]), place))[0])


def drive_table(
    first: Configuration, driver: str, low: float, high: float, loads: Sequence[Sequence[Load]], pairs: Sequence[Pair]
) -> DriveTable | None:
    """Return the table of a driver around a configuration. None where that cannot be solved."""
    mechanism = first.structure.mechanism
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            values = np.linspace(low, high, POSES)
            motion = solve(mechanism, {driver: values}, speed=1.0, acceleration=0.0, order=2, modes=first)
            found = _pieces(motion, low, high, loads, pairs)
    except CompoundkinError:
        return None
    return DriveTable(low, high, found, [piece.low for piece in found], motion)


def _pieces(
    motion: Motion, low: float, high: float, loads: Sequence[Sequence[Load]], pairs: Sequence[Pair]
) -> list[TablePiece]:
    """Return the pieces that hold, in order."""
    edges, found = np.linspace(low, high, PIECES + 1), []
    todo = list(pairwise(edges.tolist()))
    for _ in range(HALVED + 1):
        made = _solved(motion, todo, (low, high), loads, pairs)
        found += [piece for piece in made if _holds(piece)]
        broken = [piece for piece in made if not _holds(piece)]
        todo = [part for one in broken for part in pairwise([one.low, (one.low + one.high) / 2, one.high])]
        if not todo:
            break
    else:
        if motion.change_points:
            found += [piece for piece in broken if _holds(piece, HOLDS_NEAR)]
    return with_bridges(sorted(found, key=lambda piece: piece.low), high - low)


def _holds(piece: TablePiece, part: float = HOLDS) -> bool:
    scales = np.max(np.abs(piece.terms), axis=1)
    # the bias is a derivative of the inertia, and the forces are alike
    scales = np.array([scales[:2].max()] * 2 + [scales[2:].max()] * 2)
    return bool(np.all(np.abs(piece.terms[:, -LAST:]) <= part * scales[:, None]))


def _solved(
    motion: Motion,
    parts: Sequence[tuple[float, float]],
    ends: tuple[float, float],
    loads: Sequence[Sequence[Load]],
    pairs: Sequence[Pair],
) -> list[TablePiece]:
    """Return pieces, solved all at once."""
    values = np.concatenate([(a + b) / 2.0 + (b - a) / 2.0 * NODES for a, b in parts])
    at = between(motion, 0, _places(values, ends))
    rows = _terms(at, loads)
    # beyond an end of a guide groups close all the same
    rows[:, (at.failed[0] > 0) & (at.failed[0] <= len(motion.structure.groups))] = np.nan
    ratios = _ratios(at, pairs)
    cuts = [slice(k * POINTS, (k + 1) * POINTS) for k in range(len(parts))]
    return [TablePiece(float(a), float(b), rows[:, cut] @ TO_COEFFICIENTS.T, float(np.max(ratios[cut])), at.poses, cut)
            for (a, b), cut in zip(parts, cuts, strict=True)]  # fmt: skip


def _places(values: Number, ends: tuple[float, float]) -> Number:
    """Return where along the motion of a table values are."""
    places: Number = np.clip((values - ends[0]) / (ends[1] - ends[0]), 0.0, 1.0) * (POSES - 1)
    return places


def _terms(motion: Motion, loads: Sequence[Sequence[Load]]) -> Number:
    """Return inertia, bias, stored forces and others at all poses of a motion at unit speed."""
    mechanism = motion.mechanism
    factor, fall = mechanism.stated_units.inertia, complex(first_entry(mechanism.free_fall))
    rows = np.zeros((4, motion.failed.shape[1]))
    for own in mass_motions(motion):
        rows[0] += np.ravel(own.product(1, own, 1)) * factor
        rows[1] += np.ravel(own.product(1, own, 2)) * factor
        rows[2] += np.ravel((np.conj(fall) * own.centre[1]).real * own.mass) * factor
    for loaded in loaded_blocks(motion):
        for row, some in zip(rows[2:], loads, strict=True):
            for load in some:
                for link, wrench in load.wrenches(loaded):
                    row[loaded.poses] += np.ravel(loaded.freed(link, wrench).power(loaded.pose(link)))
    return rows


def _ratios(motion: Motion, pairs: Sequence[Pair]) -> Number:
    """Return how fast the fastest of some pairs moves, each by its scale."""
    found = np.zeros(motion.failed.shape[1])
    for pair in pairs:
        scale = 1.0 if pair.free_is_angle else motion.size
        found = np.fmax(found, np.abs(np.ravel(motion.pairs[pair.name].rate)) / scale)
    return found
