"""The result of a tolerance analysis: outputs by name, contributions of each source, and bands over the poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any, Self

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, display_function, short_repr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity, Table
from compoundkin.model.attributes import DEGREES, RADIANS
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.samples.design_sample import checked_count, checked_seed
from compoundkin.studies.samples.random_samples import RandomSample
from compoundkin.studies.tolerances.error_sources import ErrorSource
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance


@dataclass(frozen=True, eq=False, repr=False)
class ToleranceAnalysis(Mapping[str, OutputTolerance], DisplaysHtml):
    """The effect of tolerances on outputs by name.

    `motion` is that of the original mechanism, `sources` are the sources of errors. `unassembled` of the random
    designs could not be assembled over the whole motion, and are left out.
    """

    motion: Motion
    sources: tuple[ErrorSource, ...]
    outputs: Mapping[str, OutputTolerance]
    chances: Chances
    unassembled: int

    @property
    def mechanism(self) -> Mechanism:
        """The original mechanism."""
        return self.motion.mechanism

    @property
    def count(self) -> int:
        """The number of random designs."""
        return self.chances.sample.count

    @property
    def percentiles(self) -> tuple[float, ...]:
        """The levels of their percentiles."""
        return self.chances.percentiles

    def table(self, *names: str) -> Table:
        """Return a row for each source, with its contributions to the named outputs, by default to all.

        For a course they are at the pose with the greatest deviation. Raises UnknownName.
        """
        chosen = [self[name] for name in names or self]
        return contribution_table(self.mechanism.title, self.sources, chosen)

    def bands(self, *names: str) -> Table:
        """Return a row for each pose, with the bands of the named courses, by default of all.

        Raises UnknownName, and InvalidInput for a figure.
        """
        chosen = [self[name] for name in names] or [one for one in self.values() if one.is_course]
        return band_table(self.motion, chosen)

    def plot(self, *names: str, **options: Any) -> Any:
        """Plot outputs with their bands; see `plots.bands`."""
        return display_function("study_plot")(self, *names, **options)

    def __getitem__(self, name: str) -> OutputTolerance:
        """Return an output by its name; raises UnknownName."""
        if name not in self.outputs:
            raise UnknownName(Problem(str(name), "there is no such output", suggestion(str(name), list(self.outputs))))
        return self.outputs[name]

    def __contains__(self, name: object) -> bool:
        return name in self.outputs

    def __iter__(self) -> Iterator[str]:
        return iter(self.outputs)

    def __len__(self) -> int:
        return len(self.outputs)

    def __repr__(self) -> str:
        outputs, sources = short_repr(tuple(self.outputs)), short_repr(tuple(one.name for one in self.sources))
        return f"ToleranceAnalysis({self.mechanism.title!r}: {outputs} by {sources})"


LOWER, UPPER, UNIT = "lower", "upper", "unit"


@dataclass(frozen=True, eq=False, repr=False)
class ContributionTable(Table):
    """A row for each source of errors, with limits in its own `unit`."""

    @property
    def shown(self) -> Table:
        """The table for display, with angles in degrees."""
        rows = self[UNIT].values == RADIANS
        columns = [column.shown for column in self.columns]
        for k, column in enumerate(columns):
            if column.name in (LOWER, UPPER):
                columns[k] = replace(column, values=np.where(rows, np.rad2deg(column.values), column.values))
            elif column.name == UNIT:
                columns[k] = replace(column, values=np.where(rows, DEGREES, column.values))
        return Table(self.title, tuple(columns))


def contribution_table(title: str, sources: Sequence[ErrorSource], outputs: Sequence[OutputTolerance]) -> Table:
    """Return a row for each source of errors.

    Columns are its limits, and for each output its part of the worst case, its deviation and its share of the variance;
    for a course at the pose with the greatest deviation.
    """
    limits = np.array([one.limits for one in sources])
    columns = [
        Quantity("source", "", np.array([one.name for one in sources])),
        Quantity(LOWER, "", limits[:, 0]),
        Quantity(UPPER, "", limits[:, 1]),
        Quantity(UNIT, "", np.array([one.unit for one in sources])),
    ]
    for one in outputs:
        columns += _contributions(one)
    return ContributionTable(title, tuple(columns))


def _contributions(one: OutputTolerance) -> Iterator[Quantity]:
    pose = int(np.argmax(one.deviation)) if one.is_course else None

    def picked(parts: Mapping[str, Number]) -> Number:
        return np.array([part if pose is None else part[pose] for part in parts.values()], dtype=float)

    yield Quantity(f"{one.name}.worst", one.unit, picked(one.worst_parts), dimension=one.dimension)
    yield Quantity(f"{one.name}.deviation", one.unit, np.sqrt(picked(one.variances)), dimension=one.dimension)
    yield Quantity(f"{one.name}.share", "", picked(one.contributions))


def band_table(motion: Motion, outputs: Sequence[OutputTolerance]) -> Table:
    """Return a row for each pose.

    Columns are the drivers, and the values of each course with their bands. Raises InvalidInput for a figure.
    """
    for one in outputs:
        if not one.is_course:
            what = "it is a figure of the whole motion, and has no bands over the poses"
            raise InvalidInput(Problem(one.name, what, f"take [{one.name!r}].sample.percentiles"))
    drivers = motion.table(next(iter(motion.drives))).columns[:-2]
    return Table(motion.mechanism.title, (*drivers, *(column for one in outputs for column in _bands(one))))


def _bands(one: OutputTolerance) -> Iterator[Quantity]:
    sample = one.sample
    bands = {"": one.nominal, ".low": one.low, ".high": one.high, ".deviation": one.deviation}
    for percent, values, errors in zip(sample.percents, sample.percentiles, sample.percentile_errors, strict=True):
        bands |= {f".percentile_{percent:g}": values, f".percentile_{percent:g}_error": errors}
    for word, values in bands.items():
        yield Quantity(f"{one.name}{word}", one.unit, values, dimension=one.dimension)


@dataclass(frozen=True)
class Chances:
    """The random sample, its percentiles, and `sigmas`, the standard deviations from the middle to the limits."""

    sample: RandomSample
    percentiles: tuple[float, ...]
    sigmas: float

    @classmethod
    def of(cls, count: int, seed: int, percentiles: Sequence[float], sigmas: float) -> Self:
        """Return checked arguments. Raises InvalidInput for invalid ones, and for too few designs."""
        found = real_numbers("percentiles", percentiles)
        if found.ndim != 1 or not found.size or not ((found > 0) & (found < 100)).all():
            what = f"{short_repr(percentiles)} are no percentiles"
            raise InvalidInput(Problem("percentiles", what, "give numbers between 0 and 100, as (5, 50, 95)"))
        if not (np.isfinite(sigmas) and sigmas > 0):
            what = f"{short_repr(sigmas)} is no number of standard deviations"
            raise InvalidInput(Problem("sigmas", what, "give 3"))
        sample = RandomSample(checked_count(count), checked_seed(seed))
        outermost = float(np.minimum(found, 100 - found).min())
        # with fewer designs none lies beyond the percentile on average
        needed = max(2, ceil(100 / outermost))
        if sample.count < needed:
            what = f"{sample.count} random designs are too few for percentile {outermost:g} or {100 - outermost:g}"
            raise InvalidInput(Problem("count", what, f"count={needed} or more"))
        return cls(sample, tuple(found.tolist()), float(sigmas))
