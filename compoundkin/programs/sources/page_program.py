"""The program of a page: all links and some outputs of a mechanism, of its dimensions, at every pose of a motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput
from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.graph.input_kinds import DRIVE, SEED
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.solved_designs import ProgramConfiguration
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, recorded
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.recorded_outputs import ProgramOutput, recorded_outputs
from compoundkin.programs.sources.operation_table import OperationTable, operation_table

# Pages show positions, velocities and accelerations.
HIGHEST = 2


@dataclass(frozen=True, repr=False)
class PageProgram(PrintsShort):
    """A mechanism as operations on its dimensions and drivers.

    It is in the configuration of a motion. `dimensions` are single numbers, results nodes of the graph of the
    `mechanism`.
    """

    motion: Motion
    mechanism: RecordedMechanism
    dimensions: tuple[FreeDimension, ...]
    outputs: tuple[ProgramOutput, ...]
    recorded: tuple[RecordedNumber, ...]

    @classmethod
    def of(
        cls, motion: Motion, dimensions: Sequence[FreeDimension], outputs: Sequence[ProgramOutput] = ()
    ) -> PageProgram:
        """Record a motion of one design; outputs that no program tells are left out."""
        order = min(HIGHEST, motion.order)
        signs = ProgramConfiguration.of(motion).signs
        recording = Recording(
            motion.solving_order, signs, tuple(dimensions), order, _still(motion, order), motion.inputs.ends
        )
        mechanism = recorded(recording)
        found = dict(_told(mechanism, [one for one in outputs if one.attribute.order <= order]))
        return cls(motion, mechanism, tuple(dimensions), tuple(found), tuple(found.values()))

    @property
    def order(self) -> int:
        """The highest derivative that it tells."""
        return self.mechanism.recording.order

    @cached_property
    def drives(self) -> tuple[InputNumber, ...]:
        """The values and rates of drivers, all that there may be."""
        names = self.mechanism.drives
        return tuple(InputNumber(DRIVE, name, str(k)) for name in names for k in range(HIGHEST + 1))

    @cached_property
    def goods(self) -> tuple[tuple[int, int], ...]:
        """The truths on which its groups and ends of guides hang, in order."""
        return tuple((index, self.mechanism.number(good).x) for index, good in self.mechanism.block.goods)

    def link(self, name: str, k: int) -> tuple[int, int, int]:
        """Return the nodes of a link's origin and angle, or of their k-th derivatives."""
        found = RecordedMotion(self.mechanism).links[name]
        turned = (found.angle, found.angular_velocity, found.angular_acceleration)[k] if k else found.angle
        z = self.mechanism.number(found.origin.derivative(k))
        return z.real.x, z.imag.x, self.mechanism.number(turned).x

    @cached_property
    def first(self) -> tuple[int, ...]:
        """The nodes of all positions, and of what keeps groups from closing."""
        places = (node for name in self.mechanism.block.world for node in self.link(name, 0))
        return (*dict.fromkeys((*places, *(node for _, node in self.goods))),)

    @cached_property
    def then(self) -> tuple[int, ...]:
        """The nodes of rates and outputs."""
        orders = range(1, self.order + 1)
        rates = (node for name in self.mechanism.block.world for k in orders for node in self.link(name, k))
        told = (node for one in self.recorded for node in (one.x, one.y) if node is not None)
        return (*dict.fromkeys((*rates, *told)),)

    @cached_property
    def seeds(self) -> tuple[InputNumber, ...]:
        """What is found outside of it: states of groups, counted turns."""
        graph = self.mechanism.graph
        inputs = (graph.nodes[k].given for k in graph.inputs((*self.first, *self.then)))
        return tuple(one for one in inputs if one is not None and one.kind == SEED)

    @cached_property
    def table(self) -> OperationTable:
        """Its operations."""
        fixed = [given for one in self.dimensions for given in one.inputs]
        return operation_table(self.mechanism.graph, self.first, self.then, fixed, (*self.drives, *self.seeds))


def _still(motion: Motion, order: int) -> frozenset[tuple[str, int]]:
    """Return the rates of drivers that are zero at all poses."""
    drives = motion.inputs.drives.items()
    return frozenset((name, k) for name, values in drives for k in range(1, order + 1) if not np.any(values[k]))


def _told(mechanism: RecordedMechanism, outputs: Sequence[ProgramOutput]) -> Iterator[tuple[ProgramOutput, Number]]:
    for output in outputs:
        try:
            yield output, recorded_outputs(mechanism, [output])[0]
        except InvalidInput:
            # a figure that is no straight-line arithmetic stays that of the mechanism as it was
            continue
