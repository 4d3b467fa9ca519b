"""Random designs within tolerances: what errors of all sources make of the dimensions, and the outputs of those."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, suppress_pose_warnings
from compoundkin.studies.responses import Designs, Response, StudiedPath
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.design_blocks import blocks
from compoundkin.studies.samples.random_rows import RandomSample
from compoundkin.studies.tolerances.contract import ErrorSource

# The values of all random designs are kept: so many numbers at most, a gibibyte.
MOST_VALUES = 2**27


@dataclass(frozen=True, eq=False, repr=False)
class TolerancedDesigns(ShortRepr):
    """The mechanism as it stands, and random designs within the tolerances."""

    path: StudiedPath
    sources: tuple[ErrorSource, ...]
    sample: RandomSample

    @cached_property
    def own(self) -> dict[str, Number]:
        """The dimensions without errors, (1,) each."""
        stated = self.path.compiled.programs.stated
        return {one.name: np.reshape(stated.own(one), 1) for one in self.path.compiled.programs.dimensions}

    @cached_property
    def nominal(self) -> Designs:
        """The one design without errors."""
        return self.path.designs(self.own)

    def found(self, responses: Sequence[Response]) -> tuple[dict[str, Number], Number]:
        """Return the values of responses by name, and which designs assemble."""
        self._hold_room(responses)
        parts: dict[str, list[Number]] = {one.name: [] for one in responses}
        assembled = []
        for rows in blocks(self.sample.count, self.path.reference.inputs.poses):
            with suppress_pose_warnings():
                designs = self.designs(rows)
                assembled.append(assembled_range(designs).assembled)
                for one in responses:
                    shape = (designs.number, designs.poses)[: 1 + one.is_course]
                    parts[one.name].append(np.broadcast_to(one.values(designs), shape))
        return {name: np.concatenate(part) for name, part in parts.items()}, np.concatenate(assembled)

    def _hold_room(self, responses: Sequence[Response]) -> None:
        """Raise InvalidInput where the values of all designs would not stay in memory."""
        poses = self.path.reference.inputs.poses
        each = sum((poses if one.is_course else 1) * (1 + one.is_vector) for one in responses)
        if self.sample.count * each > MOST_VALUES:
            what = f"{self.sample.count} designs of {each} values each do not stay in memory"
            raise InvalidInput(Problem("count", what, f"at most {MOST_VALUES // each}; a study keeps more in a folder"))

    def designs(self, rows: range) -> Designs:
        """Return some of them."""
        errors = self._errors(rows)
        found = {}
        for one in self.path.compiled.programs.dimensions:
            parts = [errors[name] for name in one.coordinates]
            found[one.name] = self.own[one.name] + (parts[0] + 1j * parts[1] if one.is_vector else parts[0])
        return self.path.designs(found)

    def _errors(self, rows: range) -> dict[str, Number]:
        """Return the errors of all coordinates, (designs,) each."""
        units = self.sample.units(sum(source.columns for source in self.sources), rows)
        found, column = {name: np.zeros(len(rows)) for name in self.path.coordinates}, 0
        for source in self.sources:
            errors = source.errors(units[:, column : column + source.columns])
            for name, error in zip(source.coordinates, errors, strict=True):
                found[name] = found[name] + error
            column += source.columns
        return found
