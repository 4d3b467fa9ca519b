"""A range of values: every value between two is as likely."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.studies.variations.contract import Variation


@dataclass(frozen=True)
class ValueRange(Variation):
    """All values between two."""

    low: float
    high: float

    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1."""
        return self.low + (self.high - self.low) * units[:, 0]

    def levels(self, count: int) -> Number:
        """Return equal steps, with both ends."""
        return np.linspace(self.low, self.high, count)

    @property
    def data(self) -> Mapping[str, Any]:
        """Its ends."""
        return {"low": self.low, "high": self.high}
