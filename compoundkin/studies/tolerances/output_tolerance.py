"""The tolerance of one output: its slopes, worst case, standard deviation, contributions, and random sample.

Statistics of the sample have the standard errors of their estimates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import ExplainsAttributes
from compoundkin.model.attributes import Dimension
from compoundkin.studies.tolerances.error_sources import ErrorSource


@dataclass(frozen=True, eq=False, repr=False)
class OutputTolerance(ShortRepr, ExplainsAttributes):
    """The tolerance of an output: numbers for figures, arrays over the poses for courses; angles are radians.

    `nominal` is its value at the mechanism's
    own dimensions, `slopes` are by the coordinates that have tolerances, in units of the output by those of the
    dimension. All else is to first order, but `sample`, which is the output in random designs.
    """

    name: str
    unit: str
    dimension: Dimension
    nominal: Number
    slopes: Mapping[str, Number]
    sources: tuple[ErrorSource, ...]
    sample: SampledOutput

    def _instead(self, name: str) -> str:
        return "write tolerance(..., percentiles=(5, 95)), then .sample.percentiles" if "percentile" in name else ""

    @property
    def is_course(self) -> bool:
        """Whether it has a value at every pose."""
        return np.ndim(self.nominal) > 0

    @cached_property
    def worst_parts(self) -> Mapping[str, Number]:
        """The part of each source in `worst`."""
        return self._of_each(lambda source, slopes: source.worst(slopes))

    @cached_property
    def worst(self) -> Number:
        """The greatest error to either side: the sum of those of all sources."""
        return sum(self.worst_parts.values())

    @property
    def low(self) -> Number:
        """The least value at worst."""
        return self.nominal + self._middle - self.worst

    @property
    def high(self) -> Number:
        """The greatest value at worst."""
        return self.nominal + self._middle + self.worst

    @cached_property
    def mean(self) -> Number:
        """The mean value, the nominal one for symmetric tolerances."""
        return self.nominal + sum(self._of_each(lambda source, slopes: source.mean(slopes)).values())

    @cached_property
    def variances(self) -> Mapping[str, Number]:
        """The part of each source in the variance."""
        return self._of_each(lambda source, slopes: source.variance(slopes))

    @cached_property
    def deviation(self) -> Number:
        """The standard deviation, where errors of the sources do not depend on each other."""
        return np.sqrt(sum(self.variances.values()))

    @cached_property
    def contributions(self) -> Mapping[str, Number]:
        """The share of each source in the variance, zero where the variance is."""
        whole = sum(self.variances.values())
        return {name: part / np.where(whole > 0, whole, 1.0) for name, part in self.variances.items()}

    @cached_property
    def _middle(self) -> Number:
        return sum(self._of_each(lambda source, slopes: source.middle(slopes)).values())

    def _of_each(self, found: Callable[[ErrorSource, Sequence[Number]], Number]) -> Mapping[str, Number]:
        slopes = self.slopes
        return {one.name: found(one, [slopes[name] for name in one.coordinates]) for one in self.sources}


@dataclass(frozen=True, eq=False, repr=False)
class SampledOutput(ShortRepr):
    """An output in the random designs that assemble over the whole motion.

    `values` are (designs,) of a figure, (designs, poses) of a course; `percents` are the levels of percentiles.
    """

    values: Number
    percents: tuple[float, ...]

    @property
    def count(self) -> int:
        """The number of designs."""
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
        """The standard errors of `percentiles` for any distribution.

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
