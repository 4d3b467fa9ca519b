"""What a text carries from pose to pose: states of groups without a closed form, angles counted over full turns."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.model.attributes import ANGLE
from compoundkin.programs.graph.input_kinds import SEED, TURNS, group_seed
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_march import side_of, state_seeds
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber

# From a pose five degrees away four of Newton's steps reach rounding; the last one is that of the recorded mechanism.
STEPS = 4
# What moves farther than this in one call (parts of the size, radians) is not followed.
LEAP = 0.5


@dataclass(frozen=True)
class CarriedState:
    """A number that is given as it was at the pose before, and answered.

    `kept` is the truth that it does not leap. It `is_corrected` where Newton's steps lead to it.
    """

    given: InputNumber
    now: RecordedNumber
    name: str
    meaning: str
    is_angle: bool = False
    is_corrected: bool = False
    kept: RecordedNumber | None = None


def carried_states(mechanism: RecordedMechanism, wanted: Collection[int]) -> tuple[CarriedState, ...]:
    """Return what some nodes depend on from the pose before. Raises InvalidInput for what no text can find."""
    graph = mechanism.graph
    inputs = (graph.nodes[k].given for k in graph.inputs(wanted))
    given = [one for one in inputs if one is not None and one.kind == SEED]
    states = [_state(mechanism, one) for one in given]
    groups = {one.name for one, state in zip(given, states, strict=True) if state.is_corrected}
    solvers = [solver for solver in mechanism.order.solvers if group_seed(solver.index) in groups]
    return (*states, *(_side(mechanism, solver) for solver in solvers))


def _state(mechanism: RecordedMechanism, given: InputNumber) -> CarriedState:
    if given.part == TURNS:
        angle = mechanism.number(mechanism.block.world[given.name].angle.c[0])
        what = f"angle of {given.name}, full turns too"
        return CarriedState(given, angle, f"{given.name}.{ANGLE}", what, is_angle=True)
    for solver in mechanism.order.solvers:
        if given.name == group_seed(solver.index) and solver.width:
            k = int(given.part)
            now = mechanism.number(solver.state(mechanism.block)[k])
            is_angle = k % 3 == 2
            far = LEAP * (1.0 if is_angle else mechanism.order.size)
            kept = abs(now - RecordedNumber.given(mechanism.graph, given)) <= far
            what = f"number {k + 1} of the state of {', '.join(solver.group.links)}"
            return CarriedState(given, now, f"{solver.index + 1}.{k + 1}", what, is_angle, True, kept)
    what = "its contact with a profile is searched, which no text does"
    raise InvalidInput(Problem(given.name, what, "solve the mechanism, or call the compiled path"))


def _side(mechanism: RecordedMechanism, solver: GroupSolver) -> CarriedState:
    """On which side of a singularity a group is: it cannot pass to the other."""
    given = side_of(solver)
    state = [RecordedNumber.given(mechanism.graph, one) for one in state_seeds(solver)]
    now = mechanism.number(solver.side(mechanism.block, state))
    kept = now * RecordedNumber.given(mechanism.graph, given) >= 0.0
    what = f"on which side of a singularity {', '.join(solver.group.links)} are, zero where it is not known"
    return CarriedState(given, now, f"{solver.index + 1}.{given.part}", what, kept=kept)


def followed(graph: OperationGraph, states: Sequence[CarriedState], wanted: Collection[int]) -> Mapping[int, int]:
    """Return nodes after Newton's steps from the given states."""
    given = {graph.input(one.given): one for one in states if one.is_corrected}
    now = {k: k for k in given}
    for _ in range(STEPS if given else 0):
        found = replaced(graph, [one.now.x for one in given.values()], now)
        now = {k: found[one.now.x] for k, one in given.items()}
    return replaced(graph, [*wanted, *(one.now.x for one in states)], now)


def replaced(graph: OperationGraph, wanted: Collection[int], others: Mapping[int, int]) -> dict[int, int]:
    """Return nodes with others in the place of some that they depend on.

    >>> graph = OperationGraph()
    >>> x = graph.input(InputNumber("seed", "x"))
    >>> y = graph.apply("add", x, graph.constant(2.0))
    >>> graph.nodes[replaced(graph, [y], {x: graph.constant(3.0)})[y]].value
    5.0
    """
    found = dict(others)
    for k in graph.needed(wanted):
        if k not in found:
            node = graph.nodes[k]
            found[k] = graph.apply(node.operation, *(found[n] for n in node.operands)) if node.operands else k
    return found
