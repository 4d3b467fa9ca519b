"""What the tolerances do to one output: its slopes, the worst case, the deviation, and who contributes what."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.model.attributes import Dimension
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.sampled_output import SampledOutput


@dataclass(frozen=True, eq=False, repr=False)
class OutputTolerance(ShortRepr):
    """An output by its name.

    Figures have numbers, courses arrays over the poses; angles are radians. `nominal` is its value at the mechanism's
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

    @property
    def is_course(self) -> bool:
        """Whether it has a value at every pose."""
        return np.ndim(self.nominal) > 0

    @cached_property
    def worst_parts(self) -> Mapping[str, Number]:
        """What each source adds to `worst`."""
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
        """The mean value: the nominal one where tolerances lie evenly."""
        return self.nominal + sum(self._of_each(lambda source, slopes: source.mean(slopes)).values())

    @cached_property
    def variances(self) -> Mapping[str, Number]:
        """What each source adds to the square of the deviation."""
        return self._of_each(lambda source, slopes: source.variance(slopes))

    @cached_property
    def deviation(self) -> Number:
        """The standard deviation, where errors of the sources do not depend on each other."""
        return np.sqrt(sum(self.variances.values()))

    @cached_property
    def contributions(self) -> Mapping[str, Number]:
        """The share of each source in the variance; zeros where there is none."""
        whole = sum(self.variances.values())
        return {name: part / np.where(whole > 0, whole, 1.0) for name, part in self.variances.items()}

    @cached_property
    def _middle(self) -> Number:
        return sum(self._of_each(lambda source, slopes: source.middle(slopes)).values())

    def _of_each(self, found: Callable[[ErrorSource, Sequence[Number]], Number]) -> Mapping[str, Number]:
        slopes = self.slopes
        return {one.name: found(one, [slopes[name] for name in one.coordinates]) for one in self.sources}
