"""Sobol's sequence, scrambled: it fills the range of the dimensions more evenly than random numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from compoundkin.base.series import Number
from compoundkin.studies.samples.contract import UnitSample


@dataclass(frozen=True)
class SobolSample(UnitSample):
    """The first designs of Sobol's sequence. Source: I. M. Sobol' 1967, scrambled after A. B. Owen 1998."""

    word: ClassVar[str] = "sobol"
    count: int
    seed: int = 0

    def units(self, columns: int, rows: range) -> Number:
        """Return rows of the sequence."""
        from scipy.stats import qmc

        engine = qmc.Sobol(columns, scramble=True, rng=self.seed)
        if rows.start:
            engine.fast_forward(rows.start)
        return engine.random(len(rows))

    @property
    def data(self) -> Mapping[str, Any]:
        """Its word, count and seed."""
        return {"sample": self.word, "count": self.count, "seed": self.seed}
