"""A Latin hypercube: each dimension is cut into as many strata as there are designs, and each stratum has one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.samples.contract import UnitSample
from compoundkin.studies.samples.permutation import permuted
from compoundkin.studies.samples.random_rows import RandomSample

# Places stay so far off the sides of their strata, which are 1 wide, that rounding of 2^30 strata leaves them inside.
INSIDE = 2.0**-20


@dataclass(frozen=True)
class LatinHypercubeSample(UnitSample):
    """Designs at random places in strata, which each has for itself.

    Source: M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21 (1979) 239-245.
    """

    word: ClassVar[str] = "latin-hypercube"
    count: int
    seed: int = 0

    def units(self, columns: int, rows: range) -> Number:
        """Return places in strata.

        Which stratum is a permutation of the row, another one for each column.
        """
        numbers = np.arange(rows.start, rows.stop)
        strata = np.stack([permuted(numbers, self.count, self.seed, k) for k in range(columns)], axis=-1)
        places = RandomSample(self.count, self.seed).units(columns, rows)
        return np.asarray((strata + INSIDE + (1.0 - 2.0 * INSIDE) * places) / self.count)
