"""The configuration that a text stays in: its assembly modes, and states carried from pose to pose.

Carried are states of groups without a closed form, and angles counted over full turns.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import ANGLE, coordinate_dimension, unit_of
from compoundkin.programs.graph.operation_graph import SEED, SIGN, TURNS, InputNumber, OperationGraph, group_seed
from compoundkin.programs.recording.recorded_march import side_of, state_seeds
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber

# So many stretches of a motion are told.
RANGES_SHOWN = 6


def changed_modes(motion: Motion) -> tuple[GroupSolver, ...]:
    """Return the groups that change their modes along a motion of one design."""
    places = np.arange(motion.shape[-1], dtype=float)[None, :]
    return tuple(
        solver
        for solver in motion.solving_order.solvers
        if not solver.is_numbered and np.ptp(motion.followed.sign(solver.index, np.array([[0]]), places))
    )


def configuration_notes(motion: Motion, order: int, has_states: bool = False) -> Iterator[str]:
    """Yield paragraphs on a motion whose configuration a program keeps."""
    signed = [(mode.links, mode.sign) for mode in motion.modes.values() if mode.sign is not None]
    told = "; ".join(f"{', '.join(links)}: {sign:+d}" for links, sign in signed)
    yield f"Assembly modes, which it keeps: {told}." if told else "It has one assembly mode."
    yield f"With the dimensions of the mechanism it can be assembled {_assembled_range(motion)}."
    if has_states:
        first = np.arange(motion.failed.size) == np.argmax(np.ravel(motion.assembled))
        begin = ", ".join(_driver_range(motion, name, first) for name in motion.drives)
        yield (
            "It goes from pose to pose: what is called state is given as it was at the pose before, and answered as "
            f"it is. Begin with the numbers told above, which are those at {begin}; take steps of a few degrees."
        )
    if order:
        yield "At a limit position, where it can just be assembled, rates are no finite numbers or have no digits."


def _assembled_range(motion: Motion) -> str:
    good = np.ravel(motion.assembled)
    ranges = ", ".join(_driver_range(motion, name, np.ones_like(good)) for name in motion.drives)
    if good.all():
        return f"at all {len(good)} poses that were tried: {ranges}"
    few = f"at {np.count_nonzero(good)} of {len(good)} poses that were tried"
    if len(motion.drives) > 1:
        return f"{few}, {ranges}"
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
    parts = edges.reshape(-1, 2).tolist()
    name = next(iter(motion.drives))
    told = [_driver_range(motion, name, _pose_range(len(good), start, stop)) for start, stop in parts[:RANGES_SHOWN]]
    return f"{few}: {', '.join(told)}{' and elsewhere' if len(parts) > RANGES_SHOWN else ''}"


def _pose_range(count: int, start: int, stop: int) -> Number:
    return (np.arange(count) >= start) & (np.arange(count) < stop)


def _driver_range(motion: Motion, name: str, wanted: Number) -> str:
    """The range of a driver at some poses."""
    values = np.broadcast_to(np.ravel(motion.drives[name].value), wanted.shape)[wanted.astype(bool)]
    unit = unit_of(motion.mechanism.unit, coordinate_dimension(motion.structure.driven_angles[name]))
    low, high = values.min(), values.max()
    return f"{name} {low:.6g} {unit}" if low == high else f"{name} from {low:.6g} to {high:.6g} {unit}"


# From a pose five degrees away four of Newton's steps reach rounding; the last one is that of the recorded mechanism.
NEWTON_STEPS = 4


# What moves farther than this in one call (parts of the size, radians) is not followed.
LARGEST_STEP = 0.5


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


def carried_states(
    mechanism: RecordedMechanism, wanted: Collection[int], but: Collection[str] = ()
) -> tuple[CarriedState, ...]:
    """Return what some nodes depend on from the pose before, but for seeds of some names.

    Raises InvalidInput for what no text can find.
    """
    graph = mechanism.graph
    inputs = (graph.nodes[k].given for k in graph.inputs(wanted))
    given = [one for one in inputs if one is not None and one.kind == SEED and one.name not in but]
    states = [_carried_state(mechanism, one) for one in given]
    groups = {one.name for one, state in zip(given, states, strict=True) if state.is_corrected}
    solvers = [solver for solver in mechanism.order.solvers if group_seed(solver.index) in groups]
    return (*states, *(_side(mechanism, solver) for solver in solvers))


def _carried_state(mechanism: RecordedMechanism, given: InputNumber) -> CarriedState:
    if given.part == TURNS:
        angle = mechanism.number(mechanism.block.world[given.name].angle.c[0])
        what = f"angle of {given.name}, full turns too"
        return CarriedState(given, angle, f"{given.name}.{ANGLE}", what, is_angle=True)
    for solver in mechanism.order.solvers:
        if given.name == group_seed(solver.index) and given.part == SIGN:
            what = f"sign of the mode of {', '.join(solver.group.links)}"
            return CarriedState(given, RecordedNumber.given(mechanism.graph, given), f"{solver.index + 1}.{SIGN}", what)
        if given.name == group_seed(solver.index) and solver.width:
            k = int(given.part)
            now = mechanism.number(solver.state(mechanism.block)[k])
            is_angle = k % 3 == 2
            far = LARGEST_STEP * (1.0 if is_angle else mechanism.order.size)
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


def follow_states(graph: OperationGraph, states: Sequence[CarriedState], wanted: Collection[int]) -> Mapping[int, int]:
    """Return nodes after Newton's steps from the given states."""
    given = {graph.input(one.given): one for one in states if one.is_corrected}
    now = {k: k for k in given}
    for _ in range(NEWTON_STEPS if given else 0):
        found = substituted(graph, [one.now.x for one in given.values()], now)
        now = {k: found[one.now.x] for k, one in given.items()}
    return substituted(graph, [*wanted, *(one.now.x for one in states)], now)


def substituted(graph: OperationGraph, wanted: Collection[int], others: Mapping[int, int]) -> dict[int, int]:
    """Return nodes with others in the place of some that they depend on.

    >>> graph = OperationGraph()
    >>> x = graph.input(InputNumber("seed", "x"))
    >>> y = graph.apply("add", x, graph.constant(2.0))
    >>> graph.nodes[substituted(graph, [y], {x: graph.constant(3.0)})[y]].value
    5.0
    """
    found = dict(others)
    for k in graph.needed(wanted):
        if k not in found:
            node = graph.nodes[k]
            found[k] = graph.apply(node.operation, *(found[n] for n in node.operands)) if node.operands else k
    return found
