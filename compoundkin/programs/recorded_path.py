"""A compiled path recorded: its mechanism, its outputs, and what it asks to be found outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from compoundkin.kinematics.motion import Motion
from compoundkin.programs.call_numbers import CallNumbers
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions
from compoundkin.programs.graph.flat_program import Carried
from compoundkin.programs.graph.operation_graph import SEED, SIDE, InputNumber
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_march import RecordedMarch
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, record_mechanism
from compoundkin.programs.recording.recorded_motion import ProgramOutput, record_outputs
from compoundkin.programs.recording.recorded_number import RecordedNumber


@dataclass(frozen=True)
class RecordedPath:
    """A mechanism recorded, and its outputs."""

    mechanism: RecordedMechanism
    outputs: tuple[RecordedNumber, ...]
    march: RecordedMarch | None = None

    @classmethod
    def of(cls, recording: Recording, outputs: Sequence[ProgramOutput], marches: bool = True) -> RecordedPath:
        """Record a mechanism and outputs of it."""
        mechanism = record_mechanism(recording)
        march = RecordedMarch.of(mechanism) if marches and recording.steps else None
        return cls(mechanism, record_outputs(mechanism, outputs), march)

    @cached_property
    def nodes(self) -> tuple[tuple[int, ...], ...]:
        """The nodes of each output: one, or two of a vector."""
        return tuple((o.x,) if o.y is None else (o.x, o.y) for o in self.outputs)

    @cached_property
    def least(self) -> int:
        """The node of the least margin of a design."""
        return RecordedLimits(self.mechanism).least

    @cached_property
    def seeds(self) -> tuple[InputNumber, ...]:
        """What it asks to be found outside."""
        graph = self.mechanism.graph
        needed = graph.inputs([*(k for nodes in self.nodes for k in nodes), RecordedLimits(self.mechanism).certain.x])
        found = (given for k in needed if (given := graph.nodes[k].given) and given.kind == SEED)
        return tuple(given for given in found if given.part != SIDE)

    @property
    def can_march(self) -> bool:
        """Whether all that it asks for are states that a march carries."""
        return self.march is not None and {*self.seeds} <= {*self.march.seeds}

    def carried(self, numbers: CallNumbers) -> tuple[Carried, ...]:
        """Return the numbers that are carried along the motion."""
        return self.march.carried if self.march and numbers.marches else ()


class PathVariants(Protocol):
    """What is asked of a compiled path by its sources and functions of JAX."""

    @property
    def reference(self) -> Motion:
        """Its motion."""

    @property
    def outputs(self) -> tuple[ProgramOutput, ...]:
        """What it computes."""

    @property
    def dimensions(self) -> tuple[FreeDimension, ...]:
        """What is free."""

    @property
    def stated(self) -> StatedDimensions:
        """All dimensions of its mechanism."""

    def variant(self, still: frozenset[tuple[str, int]]) -> RecordedPath:
        """Return it recorded where some rates of drivers are zero."""
