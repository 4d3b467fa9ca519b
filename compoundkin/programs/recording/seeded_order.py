"""A solving order whose groups are all straight-line arithmetic: what is searched or followed is given by seeds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from compoundkin.base.series import Number
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.programs.graph.input_kinds import SEED, SIGN, TURNS, group_seed
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.local_profile import with_local_profile
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Group


def seeded_order(
    order: SolvingOrder, ends: Mapping[str, Ends], graph: OperationGraph, highest: int, steps: int = 0
) -> SolvingOrder:
    """Return a solving order on other ends, its searches replaced by seeds.

    It is run for derivatives up to the highest.
    """
    found = SolvingOrder(_with_local_profiles(order.structure, graph, highest), ends)
    for solver in order.solvers:
        # a group that has signs else, but is in a configuration that has none
        if solver.is_numbered and not found.solvers[solver.index].is_numbered:
            found = found.following(solver.index)
    return found.from_states(steps)


def _with_local_profiles(structure: Structure, graph: OperationGraph, highest: int) -> Structure:
    changed: dict[str, Pair] = {}

    def local(pair: Pair) -> Pair:
        if pair.name not in changed:
            changed[pair.name] = with_local_profile(pair, graph, highest)
        return changed[pair.name]

    def within(group: Group) -> Group:
        return replace(group, inner=tuple(map(local, group.inner)), outer=tuple(map(local, group.outer)))

    return replace(structure, pairs=tuple(map(local, structure.pairs)), groups=tuple(map(within, structure.groups)))


@dataclass(frozen=True)
class SeededChoice:
    """The choice of known signs. Others are inputs, as states and counted turns are."""

    graph: OperationGraph
    signs: Mapping[int, Number]

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the sign of a group, or its state."""
        if solver.width:
            return [self._seed(group_seed(solver.index), str(k)) for k in range(solver.width)]
        sign = self.signs.get(solver.index)
        return self._seed(group_seed(solver.index), SIGN) if sign is None else float(sign)

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return about which angle a link has."""
        return self._seed(link, TURNS)

    def _seed(self, name: str, part: str) -> RecordedNumber:
        return RecordedNumber.given(self.graph, InputNumber(SEED, name, part))
