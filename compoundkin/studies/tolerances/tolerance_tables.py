"""Tolerances as tables: what each source contributes, and bands over the poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity
from compoundkin.kinematics.table import Table
from compoundkin.model.attributes import DEGREES, RADIANS
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance

LOWER, UPPER, UNIT = "lower", "upper", "unit"


@dataclass(frozen=True, eq=False, repr=False)
class ContributionTable(Table):
    """A row for each source of errors. The limits of each are in a `unit` of their own."""

    @property
    def shown(self) -> Table:
        """As it is shown to people: angles in degrees."""
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

    It has its limits, and of each output its part of the worst case, its deviation and its share of the variance. Of a
    course they are those of the pose with the greatest deviation.
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

    It has the drivers, and of each course its values with their bands. Raises InvalidInput for a figure, which has no
    poses.
    """
    for one in outputs:
        if not one.is_course:
            what = "it is one number of the whole motion, and has no bands over the poses"
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
