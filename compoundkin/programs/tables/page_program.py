"""The program of a page: all links and some outputs of a mechanism, of its dimensions, at every pose of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.groups.reasons import Reason
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import OF_LINKS
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.input_kinds import DRIVE, SEED
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.solved_designs import ProgramConfiguration
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, recorded
from compoundkin.programs.recording.recorded_motion import RecordedLink, RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.recorded_outputs import ProgramOutput, recorded_outputs
from compoundkin.programs.sources.carried_states import CarriedState, carried_states
from compoundkin.programs.sources.told_configuration import changed_modes
from compoundkin.programs.tables.changeable_dimensions import buildable_dimensions, consistent_dimensions
from compoundkin.programs.tables.node_values import node_values
from compoundkin.programs.tables.operation_table import OperationTable, operation_table

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

    It is in the configuration of a motion of one design. Results are nodes of the graph of the `mechanism`.
    """

    motion: Motion
    stated: StatedDimensions
    mechanism: RecordedMechanism
    outputs: tuple[ProgramOutput, ...]
    recorded: tuple[RecordedNumber, ...]

    @classmethod
    def of(cls, motion: Motion, outputs: Sequence[ProgramOutput] = ()) -> PageProgram:
        """Record a motion; outputs that no program tells are left out.

        Raises InvalidInput where it passes a change point, or has profiles.
        """
        if links := changed_modes(motion):
            what = "the motion passes a change point, where a group goes on in its other mode"
            raise InvalidInput(Problem(", ".join(links), what, "leave the change point out"))
        order = min(HIGHEST, motion.order)
        signs, still, ends = ProgramConfiguration.of(motion).signs, _still(motion, order), motion.inputs.ends
        stated = StatedDimensions(motion.mechanism, ends)
        # coordinates of points, and numbers of pairs
        single = [one for one in stated.known.values() if not one.is_of_law and not one.is_vector]
        free = buildable_dimensions(stated, single)
        mechanism = recorded(Recording(motion.solving_order, signs, free, order, still, ends))
        found = dict(_told(mechanism, [one for one in outputs if one.attribute.order <= order]))
        program = cls(motion, stated, mechanism, tuple(found), tuple(found.values()))
        if contacts := [one.name for one in program.seeds if one.name in mechanism.order.pairs]:
            what = "contacts with a profile are searched for at every pose"
            raise InvalidInput(Problem(contacts[0], what, "solve the mechanism for each dimension"))
        return program

    @cached_property
    def dimensions(self) -> tuple[FreeDimension, ...]:
        """Single numbers of which each may be changed alone.

        They are coordinates of points, and numbers of pairs that something depends on.
        """
        free = self.mechanism.recording.free
        read = [one for one in free if one.is_of_link or not self._inputs.isdisjoint(one.inputs)]
        return consistent_dimensions(self.motion, self.mechanism, self.carried[0], self.stated, read)

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

    @cached_property
    def links(self) -> Mapping[str, tuple[tuple[int, int, int], ...]]:
        """The nodes of each link's origin and angle, and of their derivatives in order."""
        found = RecordedMotion(self.mechanism).links
        return {name: tuple(self._moved(found[name], k) for k in range(self.order + 1)) for name in found}

    def _moved(self, link: RecordedLink, k: int) -> tuple[int, int, int]:
        z = self.mechanism.number(link.origin.derivative(k))
        return z.real.x, z.imag.x, self.mechanism.number(getattr(link, OF_LINKS[k])).x

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
        places = (node for moved in self.links.values() for node in moved[0])
        rates = (node for moved in self.links.values() for nodes in moved[1:] for node in nodes)
        told = (node for one in self.recorded for node in (one.x, one.y) if node is not None)
        return tuple(node for _, node in self.goods), _once(places), _once((*rates, *told))

    @cached_property
    def seeds(self) -> tuple[InputNumber, ...]:
        """What is found outside of it: states of groups, counted turns."""
        return tuple(one for one in self._inputs if one.kind == SEED)

    @cached_property
    def _inputs(self) -> Set[InputNumber]:
        """What anything depends on, in order."""
        graph = self.mechanism.graph
        inputs = (graph.nodes[k].given for k in graph.inputs(_once(k for part in self._results for k in part)))
        return {one: None for one in inputs if one is not None}.keys()

    @cached_property
    def carried(self) -> tuple[tuple[CarriedState, ...], tuple[CarriedState, ...]]:
        """What becomes of its seeds in their order; sides of singularities."""
        found = carried_states(self.mechanism, [k for part in self._results for k in part])
        return found[: len(self.seeds)], found[len(self.seeds) :]

    def own(self, nodes: Sequence[int], poses: Number) -> list[Number]:
        """Return values of nodes, with the mechanism's own dimensions, at some poses."""
        motion, given = self.motion, seed_values(self.seeds, self.motion)
        for one in self.drives:
            given[one] = np.broadcast_to(motion.inputs.drives[one.name][int(one.part)], motion.failed.shape)
        numbers: dict[InputNumber, Number] = {one: values[0, poses] for one, values in given.items()}
        for free in self.mechanism.recording.free:
            numbers[free.inputs[0]] = float(np.ravel(self.stated.own(free))[0])
        return node_values(self.mechanism.graph, nodes, numbers)

    @cached_property
    def table(self) -> OperationTable:
        """Its operations, in four sections: what closes groups, positions, rates and outputs, reasons."""
        closing, places, rates = self._results
        carried = (one.now.x for part in self.carried for one in part)
        reasons = (node for each in self.reasons for one in each for node in (one.holds, *one.words))
        told = _once(node for node in reasons if isinstance(node, int))
        shown = {one.inputs[0]: None for one in self.dimensions}
        free = self.mechanism.recording.free
        known = {one.inputs[0]: float(np.ravel(self.stated.own(one))[0]) for one in free if one.inputs[0] not in shown}
        sections = _once((*closing, *carried)), places, rates, told
        return operation_table(self.mechanism.graph, sections, tuple(shown), (*self.drives, *self.seeds), known)


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
