"""An output in random designs: its percentiles, mean and deviation, each with the standard error of the sample."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr


@dataclass(frozen=True, eq=False, repr=False)
class SampledOutput(ShortRepr):
    """An output in the random designs that assemble over the whole motion.

    `values` are (designs,) of a figure, (designs, poses) of a course; `percents` say which percentiles there are.
    """

    values: Number
    percents: tuple[float, ...]

    @property
    def count(self) -> int:
        """How many designs it is of."""
        return len(self.values)

    @cached_property
    def mean(self) -> Number:
        """The mean value."""
        return self.values.mean(axis=0)

    @property
    def mean_error(self) -> Number:
        """The standard error of `mean`."""
        return self.deviation / np.sqrt(self.count)

    @cached_property
    def deviation(self) -> Number:
        """The standard deviation."""
        return self.values.std(axis=0, ddof=1)

    @cached_property
    def deviation_error(self) -> Number:
        """The standard error of `deviation`, by the fourth moment. Source: C. R. Rao 1973, section 6a.2."""
        square = self.values.var(axis=0)
        fourth = ((self.values - self.mean) ** 4).mean(axis=0)
        spread = np.sqrt(np.maximum(fourth - square**2, 0.0) / self.count)
        return spread / (2.0 * np.where(square > 0, np.sqrt(square), 1.0))

    @cached_property
    def percentiles(self) -> Number:
        """The percentiles at `percents`, which are the first axis."""
        return self._quantiles(self._levels)

    @cached_property
    def percentile_errors(self) -> Number:
        """The standard errors of `percentiles`, whatever the distribution is.

        As many designs lie below a percentile as a binomial distribution has: half of the distance between those that
        are one standard deviation of it apart to either side. Source: W. J. Conover, Practical Nonparametric
        Statistics, 3rd ed. 1999, section 3.2.
        """
        aside = np.sqrt(self._levels * (1.0 - self._levels) / self.count)
        low, high = np.clip((self._levels - aside, self._levels + aside), 0.0, 1.0)
        return (self._quantiles(high) - self._quantiles(low)) / 2.0

    @property
    def _levels(self) -> Number:
        return np.array(self.percents) / 100.0

    def _quantiles(self, levels: Number) -> Number:
        return np.quantile(self.values, levels, axis=0)
