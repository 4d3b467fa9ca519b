"""How many random designs are made, and which of their percentiles are told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Self

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.samples.contract import held_count, held_seed
from compoundkin.studies.samples.random_rows import RandomSample


@dataclass(frozen=True)
class Chances:
    """Random designs, and the percentiles that are told of them.

    Limits lie `sigmas` standard deviations from the middle.
    """

    sample: RandomSample
    percentiles: tuple[float, ...]
    sigmas: float

    @classmethod
    def of(cls, count: int, seed: int, percentiles: Sequence[float], sigmas: float) -> Self:
        """Return what is given.

        Raises InvalidInput for what cannot be, and for too few designs.
        """
        found = real_numbers("percentiles", percentiles)
        if found.ndim != 1 or not found.size or not ((found > 0) & (found < 100)).all():
            what = f"{short_repr(percentiles)} are no percentiles"
            raise InvalidInput(Problem("percentiles", what, "give numbers between 0 and 100, as (5, 50, 95)"))
        if not (np.isfinite(sigmas) and sigmas > 0):
            what = f"{short_repr(sigmas)} is no number of standard deviations"
            raise InvalidInput(Problem("sigmas", what, "give 3"))
        sample = RandomSample(held_count(count), held_seed(seed))
        outermost = float(np.minimum(found, 100 - found).min())
        # of fewer designs none lies beyond the percentile on the average, so that the sample does not tell it
        needed = max(2, ceil(100 / outermost))
        if sample.count < needed:
            what = f"{sample.count} random designs are too few for percentile {outermost:g} or {100 - outermost:g}"
            raise InvalidInput(Problem("count", what, f"count={needed} or more"))
        return cls(sample, tuple(found.tolist()), float(sigmas))
