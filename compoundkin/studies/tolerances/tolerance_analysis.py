"""What tolerances do to a mechanism: its outputs by name, and where their errors come from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from compoundkin.base.display import DisplaysHtml, display_function, short_repr
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.table import Table
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.tolerances.chances import Chances
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_tables import band_table, contribution_table


@dataclass(frozen=True, eq=False, repr=False)
class ToleranceAnalysis(Mapping[str, OutputTolerance], DisplaysHtml):
    """Outputs by name, each with what tolerances do to it.

    `motion` is that of the mechanism as it stands, `sources` are what errors come from. `unassembled` of the random
    designs could not be assembled over the whole motion, and are left out.
    """

    motion: Motion
    sources: tuple[ErrorSource, ...]
    outputs: Mapping[str, OutputTolerance]
    chances: Chances
    unassembled: int

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism as it stands."""
        return self.motion.mechanism

    @property
    def count(self) -> int:
        """How many random designs were made."""
        return self.chances.sample.count

    @property
    def percentiles(self) -> tuple[float, ...]:
        """Which percentiles are told of them."""
        return self.chances.percentiles

    def table(self, *names: str) -> Table:
        """Return a row for each source, with what it contributes to outputs.

        These are all outputs without names. Of a course they are those at the pose where its deviation is greatest.
        Raises UnknownName.
        """
        chosen = [self[name] for name in names or self]
        return contribution_table(self.mechanism.title, self.sources, chosen)

    def bands(self, *names: str) -> Table:
        """Return a row for each pose, with the bands of courses.

        These are all courses without names. Raises UnknownName, and InvalidInput for a figure.
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
