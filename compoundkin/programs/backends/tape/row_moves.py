"""What goes between the rows of a block and the arrays of a call: loads, stores, and sums over poses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.programs.backends.tape.block_layout import PIECE, PoseBlock
from compoundkin.programs.graph.operations import REDUCTIONS


class RowLoad:
    """Fills a row from a part of an array."""

    __slots__ = ("part", "place", "row")

    def __init__(self, row: Any, place: int) -> None:
        self.row, self.place = row, place

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the part of the array that the next call reads."""
        self.part = sources[self.place][block.window()]

    def __call__(self) -> None:
        """Copy."""
        self.row[...] = self.part


class RowStore:
    """Copies a row into a part of an array."""

    __slots__ = ("part", "place", "row")

    def __init__(self, row: Any, place: int) -> None:
        self.row, self.place = row, place

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the part of the array that the next call writes."""
        self.part = targets[self.place][block.window()]

    def __call__(self) -> None:
        """Copy."""
        self.part[...] = self.row


class RowReduction:
    """Reduces a row over its poses, piece by piece. A march adds one pose after another."""

    __slots__ = ("adds", "operation", "part", "place", "row", "starts")

    def __init__(self, row: Any, place: int, operation: str) -> None:
        self.row, self.place = row, place
        self.operation: np.ufunc = REDUCTIONS[operation].__self__  # type: ignore[attr-defined]
        self.starts = np.arange(0, row.shape[1], PIECE)
        self.adds = False

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the pieces that the next call writes."""
        self.part = targets[self.place][block.pieces()]
        self.adds = block.pose % PIECE != 0

    def __call__(self) -> None:
        """Reduce."""
        if self.adds:
            self.operation(self.part, self.row, out=self.part)
        else:
            self.operation.reduceat(self.row, self.starts, axis=1, out=self.part)
