"""Pieces across places where nothing can be solved to enough digits: change points, passed smoothly.

Rates next to a change point have few digits, but they are smooth functions. What holds on both sides is continued: one
polynomial through both, where there is one.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.simulation.table_piece import NODES, POINTS, TO_COEFFICIENTS, TablePiece

# A bridge rests on so many widths of the gap to both sides, and its polynomial is of this degree.
BESIDE, DEGREE = 1.9, 12
# No gap is bridged that is more than this part of the table; what is less than this part of a piece is rounding.
WIDEST, NO_GAP = 1.0 / 200.0, 1e-9
# The polynomial goes through what it continues within this part of the largest value.
FITS = 1e-9


class BridgePiece(TablePiece):
    """A piece that continues what is beside it."""

    beside: Sequence[tuple[TablePiece, float]]  # pieces to both sides with places there

    def polynomials(self, link: str) -> Number:
        """Make the polynomials of a link's origin and orientation, each with its rate."""
        return self.through(lambda piece: piece.of(link))[0]

    def through(self, polynomials: Callable[[TablePiece], Number]) -> tuple[Number, float]:
        """Return polynomials through those beside it, and by how much they miss them."""
        places = np.array([place for _, place in self.beside])
        values = np.array([polynomials(piece) @ piece.basis(place) for piece, place in self.beside])
        middle, reach = (self.low + self.high) / 2.0, (BESIDE + 0.5) * (self.high - self.low)
        rows = np.polynomial.chebyshev.chebvander((places - middle) / reach, DEGREE)
        fitted = np.linalg.lstsq(rows, values, rcond=None)[0]
        inside = np.polynomial.chebyshev.chebvander(NODES / (2.0 * BESIDE + 1.0), DEGREE)
        return (inside @ fitted).T @ TO_COEFFICIENTS.T, float(np.max(np.abs(rows @ fitted - values)))


def with_bridges(pieces: Sequence[TablePiece], width: float) -> list[TablePiece]:
    """Return pieces in order, with others where narrow gaps are between them."""
    starts, found = [piece.low for piece in pieces], list(pieces[:1])
    for left, right in pairwise(pieces):
        gap = right.low - left.high
        is_narrow = NO_GAP * (left.high - left.low) < gap <= WIDEST * width
        bridge = _bridge(pieces, starts, left, right) if is_narrow else None
        found += [right] if bridge is None else [bridge, right]
    return found


def _bridge(
    pieces: Sequence[TablePiece], starts: Sequence[float], left: TablePiece, right: TablePiece
) -> BridgePiece | None:
    """Return the piece between two others. None where no one polynomial continues what is on both sides."""
    made = BridgePiece(left.high, right.low, left.terms, max(left.ratio, right.ratio), left.nodes, left.place)
    spread = (NODES[:: POINTS // DEGREE] + 1.0) / 2.0 * BESIDE * (made.high - made.low)
    places = np.concatenate([made.low - spread, made.high + spread]).tolist()
    known = [(pieces[max(bisect_right(starts, place) - 1, 0)], place) for place in places]
    if not all(piece.low <= place <= piece.high for piece, place in known):
        return None
    made.beside = known
    made.terms, off = made.through(lambda piece: piece.terms)
    return made if off <= FITS * float(np.max(np.abs(left.terms))) else None
