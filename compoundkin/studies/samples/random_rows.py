"""Random designs by a counter: row 12345 is made without those before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.samples.contract import UnitSample

# Each count of Philox gives so many numbers.
NUMBERS_OF_A_COUNT = 4


@dataclass(frozen=True)
class RandomSample(UnitSample):
    """Independent random designs.

    Source: J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011 (Philox).
    """

    word: ClassVar[str] = "random"
    count: int
    seed: int = 0

    def units(self, columns: int, rows: range) -> Number:
        """Return random numbers, of each row those of its own counts."""
        counts = -(-columns // NUMBERS_OF_A_COUNT)
        source = np.random.Philox(self.seed)
        source.advance(rows.start * counts)
        wide = counts * NUMBERS_OF_A_COUNT
        drawn = source.random_raw(len(rows) * wide).reshape(len(rows), wide)
        # 53 bits, as many as doubles have
        return np.asarray((drawn[:, :columns] >> np.uint64(11)) * 2.0**-53)
