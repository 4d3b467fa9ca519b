"""The program of a page: all links and some outputs of a mechanism, of its dimensions, at every pose of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.groups.reasons import Reason
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.graph.input_kinds import DRIVE, SEED
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.solved_designs import ProgramConfiguration
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, recorded
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.recorded_outputs import ProgramOutput, recorded_outputs
from compoundkin.programs.sources.carried_states import CarriedState, carried_states
from compoundkin.programs.sources.operation_table import OperationTable, operation_table
from compoundkin.programs.sources.told_configuration import changed_modes

# Pages show positions, velocities and accelerations.
HIGHEST = 2


class RecordedReason(NamedTuple):
    """A reason why a pose is not assembled.

    It has the node of where it holds, None everywhere; texts, and nodes for numbers.
    """

    holds: int | None
    words: tuple[str | int, ...]


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
        """Record a motion of one design; outputs that no program tells are left out.

        Raises InvalidInput where it passes a change point, or has profiles.
        """
        if links := changed_modes(motion):
            what = "the motion passes a change point, where a group goes on in its other mode"
            raise InvalidInput(Problem(", ".join(links), what, "leave the change point out"))
        order = min(HIGHEST, motion.order)
        signs, still, ends = ProgramConfiguration.of(motion).signs, _still(motion, order), motion.inputs.ends
        mechanism = recorded(Recording(motion.solving_order, signs, tuple(dimensions), order, still, ends))
        found = dict(_told(mechanism, [one for one in outputs if one.attribute.order <= order]))
        program = cls(motion, mechanism, tuple(dimensions), tuple(found), tuple(found.values()))
        if contacts := [one.name for one in program.seeds if one.name in mechanism.order.pairs]:
            what = "contacts with a profile are searched for at every pose"
            raise InvalidInput(Problem(contacts[0], what, "solve the mechanism for each dimension"))
        return program

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
    def reasons(self) -> tuple[tuple[RecordedReason, ...], ...]:
        """Why each group is not assembled, and each guide with ends beyond them."""
        order, block = self.mechanism.order, self.mechanism.block
        found = (*(solver.reasons(block) for solver in order.solvers),
                 *(order.guide_ends.reasons(block, pair) for pair in order.guide_ends.pairs))  # fmt: skip
        return tuple(tuple(map(self._reason, reasons)) for reasons in found)

    def _reason(self, reason: Reason) -> RecordedReason:
        number = self.mechanism.number
        holds = None if reason.holds is True else number(reason.holds).x
        return RecordedReason(holds, tuple(one if isinstance(one, str) else number(one).x for one in reason.words))

    @cached_property
    def _results(self) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]:
        """The nodes of what groups hang on, of all positions, of rates and outputs."""
        world, orders = self.mechanism.block.world, range(1, self.order + 1)
        places = (node for name in world for node in self.link(name, 0))
        rates = (node for name in world for k in orders for node in self.link(name, k))
        told = (node for one in self.recorded for node in (one.x, one.y) if node is not None)
        return tuple(node for _, node in self.goods), _once(places), _once((*rates, *told))

    @cached_property
    def seeds(self) -> tuple[InputNumber, ...]:
        """What is found outside of it: states of groups, counted turns."""
        return tuple(one for one in self._inputs if one.kind == SEED)

    def reads(self, one: FreeDimension) -> bool:
        """Tell whether anything depends on a dimension."""
        return not set(one.inputs).isdisjoint(self._inputs)

    @cached_property
    def _inputs(self) -> tuple[InputNumber, ...]:
        graph = self.mechanism.graph
        inputs = (graph.nodes[k].given for k in graph.inputs(_once(k for part in self._results for k in part)))
        return tuple(one for one in inputs if one is not None)

    @cached_property
    def carried(self) -> tuple[tuple[CarriedState, ...], tuple[CarriedState, ...]]:
        """What becomes of its seeds in their order; sides of singularities."""
        found = carried_states(self.mechanism, [k for part in self._results for k in part])
        return found[: len(self.seeds)], found[len(self.seeds) :]

    @cached_property
    def table(self) -> OperationTable:
        """Its operations, in four sections: what closes groups, positions, rates and outputs, reasons."""
        closing, places, rates = self._results
        carried = (one.now.x for part in self.carried for one in part)
        reasons = (node for each in self.reasons for one in each for node in (one.holds, *one.words))
        told = _once(node for node in reasons if isinstance(node, int))
        fixed = [given for one in self.dimensions for given in one.inputs]
        sections = _once((*closing, *carried)), places, rates, told
        return operation_table(self.mechanism.graph, sections, fixed, (*self.drives, *self.seeds))


def _once(nodes: Iterable[int]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(nodes))


def _still(motion: Motion, order: int) -> frozenset[tuple[str, int]]:
    """Return the rates of drivers that are zero at all poses."""
    drives = motion.inputs.drives.items()
    return frozenset((name, k) for name, values in drives for k in range(1, order + 1) if not np.any(values[k]))


def _told(
    mechanism: RecordedMechanism, outputs: Sequence[ProgramOutput]
) -> Iterator[tuple[ProgramOutput, RecordedNumber]]:
    for output in outputs:
        try:
            yield output, recorded_outputs(mechanism, [output])[0]
        except InvalidInput:
            # a figure that is no straight-line arithmetic stays that of the mechanism as it was
            continue
