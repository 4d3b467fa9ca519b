"""Phases of the tape: what is computed together over one kind of blocks, ready for any number of designs and poses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

from compoundkin.programs.backends.tape.row_allocation import RowAllocation, allocated
from compoundkin.programs.backends.tape.tape_instructions import (
    BEGIN,
    LOAD,
    NUMBER,
    STORE,
    Instruction,
    Operand,
    instructions,
)
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, Carried, FlatProgram
from compoundkin.programs.graph.operations import CONSTANT, INPUT, REDUCTIONS


@dataclass(frozen=True)
class Sink:
    """Where a value goes. It is an output, for later phases, or for a reduction."""

    kind: str
    node: int
    value: int
    stratum: int
    output: int | None = None


@dataclass(frozen=True)
class Stage:
    """Instructions on arrays of one shape, and the rows they use."""

    steps: tuple[Instruction, ...]
    allocation: RowAllocation


class Carry(NamedTuple):
    """A number carried along the motion. `start` is its first value, `next` that at the next pose."""

    given: int
    start: Operand
    next: Operand


@dataclass(frozen=True)
class TapePhase:
    """Four stages by stratum. They read the sources, fill the sinks, and carry what a march carries."""

    axes: int
    stages: tuple[Stage, ...]
    sources: tuple[int, ...]
    sinks: tuple[Sink, ...]
    carries: tuple[Carry, ...] = ()


def tape_phases(program: FlatProgram, axes: int) -> list[TapePhase]:
    """Cut a program into phases. `axes` tells which of BY_DESIGN and BY_POSE have several places.

    First comes what does not vary by design, if there are several; then what does; last what needs reductions.
    """
    several, graph = axes & BY_DESIGN, program.graph
    strata = {k: stratum & axes for k, stratum in program.strata.items()}
    late, sinks = set(program.after), _sinks(program, strata)
    begun = [sink for sink in sinks if several and sink.stratum == BY_POSE]
    ended = [sink for sink in sinks if sink.value in late]
    given, by_pose = set(program.inputs), {k for k in program.by_pose if several and strata[k] == BY_POSE}
    main = _phase(
        program, axes, strata, [s for s in sinks if s not in begun and s not in ended], given | by_pose, program.carried
    )
    begun.extend(Sink(STORE, k, k, BY_POSE) for k in main.sources if k in by_pose)
    first = _phase(program, BY_POSE, strata, begun, given)
    last = _phase(program, several, strata, ended, given | {k for k in program.loop if graph.reduced(k)})
    return [phase for phase in (first, main, last) if phase.sinks]


def _sinks(program: FlatProgram, strata: Mapping[int, int]) -> list[Sink]:
    """Return where the values go that are stored or reduced."""
    nodes, begun = program.graph.nodes, {one.given for one in program.carried}
    found = []
    for place, k in enumerate(program.outputs):
        if k in begun or nodes[k].operation not in (CONSTANT, INPUT, *REDUCTIONS):
            found.append(Sink(STORE, k, k, strata[k], place))
    for k in program.loop:
        value = nodes[k].operands[0]
        if program.graph.reduced(k) and nodes[value].operation != CONSTANT:
            found.append(Sink(nodes[k].operation, k, value, strata[value]))
    return found


def _phase(
    program: FlatProgram,
    axes: int,
    strata: Mapping[int, int],
    sinks: Sequence[Sink],
    given: set[int],
    carried: Sequence[Carried] = (),
) -> TapePhase:
    """Return the phase that fills some sinks from the nodes given."""
    begun = {one.given for one in carried}
    marched = {k for one in carried for k in (one.given, one.start, one.next)}
    needed = _needed(program, [*(sink.value for sink in sinks), *marched], given)
    sources = [k for k in needed if k in given and k not in begun]
    spare = count(-1, -1)
    parts = ([k for k in needed if strata[k] == s] for s in range(4))
    steps = [_steps(program, part, sources, sinks, begun, spare) for part in parts]
    users = [{value for step in part for value in step.used()} for part in steps]
    stages = [
        Stage(tuple(part), allocated(part, marched.union(*(users[n] for n in range(4) if n != s))))
        for s, part in enumerate(steps)
    ]
    carries = tuple(Carry(c.given, _operand(program, c.start), _operand(program, c.next)) for c in carried)
    return TapePhase(axes, tuple(stages), tuple(sources), tuple(sinks), carries)


def _operand(program: FlatProgram, node: int) -> Operand:
    known = program.graph.nodes[node]
    return known.value if known.operation == CONSTANT else node


def _needed(program: FlatProgram, wanted: Iterable[int], given: set[int]) -> list[int]:
    """Return what must be computed or loaded for some nodes, in order."""
    found, waiting, nodes = set[int](), list(wanted), program.graph.nodes
    while waiting:
        k = waiting.pop()
        if k not in found and nodes[k].operation != CONSTANT:
            found.add(k)
            waiting.extend(() if k in given else nodes[k].operands)
    return sorted(found)


def _steps(
    program: FlatProgram,
    nodes: Sequence[int],
    sources: Sequence[int],
    sinks: Sequence[Sink],
    begun: set[int],
    spare: Iterator[int],
) -> list[Instruction]:
    """Return the instructions of a stage; what is asked for is stored as soon as it is there."""
    places = {k: place for place, k in enumerate(sources)}
    computed = instructions(program.graph, [k for k in nodes if k not in places and k not in begun], spare)
    given = [Instruction(BEGIN, result=k) for k in nodes if k in begun]
    given.extend(Instruction(LOAD, (), k, program.graph.is_truth(k), places[k]) for k in nodes if k in places)
    steps: list[Instruction] = []
    for step in [*given, *computed]:
        steps.append(step)
        for place, sink in enumerate(sinks):
            if sink.value == step.result:
                steps.extend(_into(sink, place, step, spare))
    return steps


def _into(sink: Sink, place: int, step: Instruction, spare: Iterator[int]) -> list[Instruction]:
    """Return the instructions that store a value; a truth is reduced as a number."""
    if step.is_truth and sink.kind != STORE:
        number = next(spare)
        return [Instruction(NUMBER, (sink.value,), number), Instruction(sink.kind, (number,), place=place)]
    return [Instruction(sink.kind, (sink.value,), place=place)]
