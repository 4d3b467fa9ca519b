"""What a study computes: rows of designs with their dimensions, outputs and states, the same in any chunk."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.model.attributes import component_names
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.design_blocks import designs_at_once
from compoundkin.studies.responses.designs import Designs, StudiedPath
from compoundkin.studies.runs.design_states import STATES, design_states
from compoundkin.studies.samples.contract import DesignSample
from compoundkin.studies.variations.contract import Variation

# Rows are computed in blocks that begin at a multiple of this many: whatever chunk asks, the arithmetic is the same to
# the last bit.
BLOCK = 4096
ROW = "row"
ColumnKind: TypeAlias = Literal["dimension", "output", "state"]


class StudyColumn(NamedTuple):
    """A column of a study.

    `width` is how many numbers a row has in it, where those are the poses of a course.
    """

    name: str
    unit: str
    kind: ColumnKind
    width: int | None = None

    @property
    def is_figure(self) -> bool:
        """Whether it is one number of each design: a dimension or a figure."""
        return self.kind != "state" and not self.width


@dataclass(frozen=True, eq=False, repr=False)
class StudyProgram(ShortRepr):
    """What a study computes of every row of its sample."""

    variations: Mapping[str, Variation]
    sample: DesignSample
    path: StudiedPath
    responses: tuple[Response, ...]

    @property
    def count(self) -> int:
        """How many rows there are."""
        return self.sample.count

    @cached_property
    def block(self) -> int:
        """How many rows are computed at once: a power of two."""
        return min(BLOCK, 1 << (designs_at_once(self.path.reference.inputs.poses).bit_length() - 1))

    @cached_property
    def columns(self) -> tuple[StudyColumn, ...]:
        """The columns besides the number of the row: dimensions, outputs, states."""
        dimensions = [StudyColumn(name, unit, "dimension") for name, unit in self._dimensions()]
        return (*dimensions, *self._outputs(), *(StudyColumn(name, "", "state") for name in STATES))

    def _dimensions(self) -> Iterator[tuple[str, str]]:
        programs = self.path.compiled.programs
        units = {one.name: programs.stated.unit(one) for one in programs.dimensions}
        coordinates = {one.name: one.coordinates for one in programs.dimensions}
        for name in self.variations:
            yield from ((coordinate, units[name]) for coordinate in coordinates[name])

    def _outputs(self) -> Iterator[StudyColumn]:
        poses = self.path.reference.inputs.poses
        for one in self.responses:
            for name in component_names(one.name) if one.is_vector else (one.name,):
                yield StudyColumn(name, one.unit, "output", poses if one.is_course else None)

    def rows(self, rows: range) -> dict[str, Number]:
        """Return the columns of some rows by name: "row", then those of `columns`.

        Points and vectors are two columns, ``.x`` and ``.y``; courses are (rows, poses). A chunk that begins and ends
        at multiples of `block` computes nothing twice.
        """
        parts = [self._cut(start, rows) for start in range(rows.start - rows.start % self.block, rows.stop, self.block)]
        if not parts:
            return self._cut(0, range(0))
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _cut(self, start: int, rows: range) -> dict[str, Number]:
        """Return what of a whole block is asked for."""
        whole = range(start, min(start + self.block, self.count))
        asked = slice(max(rows.start - start, 0), max(min(rows.stop, whole.stop) - start, 0))
        return {name: values[asked] for name, values in self._computed(whole).items()}

    def _computed(self, rows: range) -> dict[str, Number]:
        """Compute a block."""
        dimensions = self.sample.designs(self.variations, rows)
        with suppress_pose_warnings():
            designs = self.path.designs(dimensions)
            found = {ROW: np.arange(rows.start, rows.stop)}
            for name, value in dimensions.items():
                found |= _columns(name, np.broadcast_to(value, len(rows)))
            for one in self.responses:
                found |= _columns(one.name, self._values(one, designs))
            return found | design_states(designs)

    @staticmethod
    def _values(one: Response, designs: Designs) -> Number:
        shape = (designs.number, designs.poses) if one.is_course else (designs.number,)
        return np.broadcast_to(one.values(designs), shape)


def _columns(name: str, values: Number) -> dict[str, Number]:
    """Return a column, or two of a planar vector."""
    if not np.iscomplexobj(values):
        return {name: np.asarray(values)}
    return dict(zip(component_names(name), (values.real, values.imag), strict=True))
