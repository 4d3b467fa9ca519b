"""What tolerances do to a mechanism: its outputs by name, and where their errors come from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance


@dataclass(frozen=True, eq=False, repr=False)
class ToleranceAnalysis(Mapping[str, OutputTolerance]):
    """Outputs by name, each with what tolerances do to it.

    `sources` are what errors come from.
    """

    motion: Motion
    sources: tuple[ErrorSource, ...]
    outputs: Mapping[str, OutputTolerance]

    def __getitem__(self, name: str) -> OutputTolerance:
        """Return an output by its name; raises UnknownName."""
        if name not in self.outputs:
            raise UnknownName(Problem(str(name), "there is no such output", nearest(str(name), list(self.outputs))))
        return self.outputs[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.outputs)

    def __len__(self) -> int:
        return len(self.outputs)

    def __repr__(self) -> str:
        title, sources = self.motion.mechanism.title, ", ".join(one.name for one in self.sources)
        return f"ToleranceAnalysis({title!r}: {', '.join(self.outputs)} by {sources})"
