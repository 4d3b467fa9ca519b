"""The program of the NumPy tape: phases over one kind of blocks, their instructions, and the row of each value.

The sine and cosine of one angle are made of the tangent of its half: NumPy computes tangents in vector registers and
sines and cosines one by one, so that the pair costs 3 ns and not 18. They are as exact (2e-16) at any angle. Rows are
taken again as soon as nothing needs what they hold.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, Carried, FlatProgram
from compoundkin.programs.graph.operation_graph import CONSTANT, INPUT, OPERATIONS, REDUCTIONS, OperationGraph


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
    needed = _needed_nodes(program, [*(sink.value for sink in sinks), *marched], given)
    sources = [k for k in needed if k in given and k not in begun]
    spare = count(-1, -1)
    parts = ([k for k in needed if strata[k] == s] for s in range(4))
    steps = [_stage_steps(program, part, sources, sinks, begun, spare) for part in parts]
    users = [{value for step in part for value in step.used()} for part in steps]
    stages = [
        Stage(tuple(part), allocate_rows(part, marched.union(*(users[n] for n in range(4) if n != s))))
        for s, part in enumerate(steps)
    ]
    carries = tuple(
        Carry(c.given, _carried_operand(program, c.start), _carried_operand(program, c.next)) for c in carried
    )
    return TapePhase(axes, tuple(stages), tuple(sources), tuple(sinks), carries)


def _carried_operand(program: FlatProgram, node: int) -> Operand:
    known = program.graph.nodes[node]
    return known.value if known.operation == CONSTANT else node


def _needed_nodes(program: FlatProgram, wanted: Iterable[int], given: set[int]) -> list[int]:
    """Return what must be computed or loaded for some nodes, in order."""
    found, waiting, nodes = set[int](), list(wanted), program.graph.nodes
    while waiting:
        k = waiting.pop()
        if k not in found and nodes[k].operation != CONSTANT:
            found.add(k)
            waiting.extend(() if k in given else nodes[k].operands)
    return sorted(found)


def _stage_steps(
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
                steps.extend(_store_steps(sink, place, step, spare))
    return steps


def _store_steps(sink: Sink, place: int, step: Instruction, spare: Iterator[int]) -> list[Instruction]:
    """Return the instructions that store a value; a truth is reduced as a number."""
    if step.is_truth and sink.kind != STORE:
        number = next(spare)
        return [Instruction(NUMBER, (sink.value,), number), Instruction(sink.kind, (number,), place=place)]
    return [Instruction(sink.kind, (sink.value,), place=place)]


# A value that is computed (a node of the graph, or a negative number for what only the tape knows), or a number.
Operand = int | float


LOAD, BEGIN, STORE, SELECT, NUMBER = "load", "begin", "store", "select", "number"


# What answers truths takes truths or numbers; all else takes a truth as 0.0 or 1.0.
LOGICAL = {"and", "or", "not"}


KERNELS: dict[str, Callable[..., Any]] = {
    **{name: one.compute for name, one in OPERATIONS.items()},
    "div": np.divide,
    "tan": np.tan,
    "different": np.not_equal,
}


class Instruction(NamedTuple):
    """One step: an operation on values, and its result. `place` is the array of loads and stores."""

    operation: str
    operands: tuple[Operand, ...] = ()
    result: int | None = None
    is_truth: bool = False
    place: int = 0

    def used(self) -> list[int]:
        """Return the values that are read."""
        return [each for each in self.operands if isinstance(each, int)]

    def overwritable(self) -> list[int]:
        """Return the values whose row may take the result."""
        if self.operation != SELECT:
            return self.used()
        truth, one, other = self.operands
        return [other] if isinstance(other, int) and other not in (truth, one) else []


class InstructionList:
    """Instructions as they are written, operation by operation. `spare` names further values."""

    def __init__(self, graph: OperationGraph, spare: Iterator[int]) -> None:
        self.graph, self.spare = graph, spare
        self.written: list[Instruction] = []
        self._numbers: dict[int, int] = {}

    def add(self, operation: str, *operands: Operand, result: int | None = None, is_truth: bool = False) -> int:
        """Write one instruction and return its result."""
        if result is None:
            result = next(self.spare)
        self.written.append(Instruction(operation, operands, result, is_truth))
        return result

    def number(self, node: int) -> Operand:
        """Return a node as a number. A constant is known, a truth becomes 0.0 or 1.0."""
        if self.graph.nodes[node].operation == CONSTANT:
            return self.graph.nodes[node].value
        if not self.graph.is_truth(node):
            return node
        if node not in self._numbers:
            self._numbers[node] = self.add(NUMBER, node)
        return self._numbers[node]

    def truth(self, node: int) -> Operand:
        """Return a node as a truth."""
        return node if self.graph.is_truth(node) else self.add("different", self.number(node), 0.0, is_truth=True)

    def operation(self, node: int) -> None:
        """Write the operation of a node."""
        name, operands = self.graph.nodes[node].operation, self.graph.nodes[node].operands
        if name == "inv":
            self.add("div", 1.0, self.number(operands[0]), result=node)
        elif name == SELECT:
            truth = self.truth(operands[0])
            self.add(SELECT, truth, *(self.number(k) for k in operands[1:]), result=node)
        elif name in LOGICAL:
            self.add(name, *(self.truth(k) for k in operands), result=node, is_truth=True)
        else:
            self.add(name, *(self.number(k) for k in operands), result=node, is_truth=self.graph.is_truth(node))

    def turn(self, angle: int, cosine: int, sine: int) -> None:
        """Write the cosine and the sine of an angle. Both follow from the tangent of its half."""
        tangent = self.add("tan", self.add("mul", self.number(angle), 0.5))
        square = self.add("mul", tangent, tangent)
        share = self.add("div", 1.0, self.add("add", square, 1.0))
        self.add("mul", self.add("add", tangent, tangent), share, result=sine)
        self.add("mul", self.add("sub", 1.0, square), share, result=cosine)


def instructions(graph: OperationGraph, nodes: Sequence[int], spare: Iterator[int]) -> list[Instruction]:
    """Return the instructions that compute some nodes, given in order."""
    found = InstructionList(graph, spare)
    named = {(graph.nodes[k].operation, graph.nodes[k].operands): k for k in nodes}
    done: set[int] = set()
    for k in nodes:
        node = graph.nodes[k]
        both = [named.get((name, node.operands)) for name in ("cos", "sin")] if node.operation in ("sin", "cos") else []
        if k not in done and len(both) == 2 and both[0] is not None and both[1] is not None:
            found.turn(node.operands[0], both[0], both[1])
            done |= {both[0], both[1]}
        elif k not in done:
            found.operation(k)
    return found.written


@dataclass
class RowAllocation:
    """The row of each value; truths have rows of their own.

    A result goes where an operand that is needed no more was, so that as few rows as possible stay in the cache.
    """

    rows: dict[int, tuple[bool, int]] = field(default_factory=dict)
    counts: dict[bool, int] = field(default_factory=lambda: {False: 0, True: 0})
    _free: dict[bool, list[int]] = field(default_factory=lambda: {False: [], True: []})

    def take(self, value: int, is_truth: bool) -> None:
        """Give a value the row that was last set free, or a new one."""
        if not self._free[is_truth]:
            self._free[is_truth].append(self.counts[is_truth])
            self.counts[is_truth] += 1
        self.rows[value] = is_truth, self._free[is_truth].pop()

    def release(self, value: int) -> None:
        """Set the row of a value free."""
        is_truth, row = self.rows[value]
        self._free[is_truth].append(row)


def allocate_rows(steps: Sequence[Instruction], kept: Collection[int]) -> RowAllocation:
    """Give every result of some instructions a row. What is `kept` stays in its own."""
    read = [step.used() for step in steps]
    last = {value: at for at, values in enumerate(read) for value in values}
    found = RowAllocation()
    for at, (step, values) in enumerate(zip(steps, read, strict=True)):
        ending = dict.fromkeys([v for v in values if last[v] == at and v in found.rows and v not in kept])
        for value in dict.fromkeys(step.overwritable()) if ending else ():
            if value in ending:
                found.release(value)
                del ending[value]
        if step.result is not None:
            found.take(step.result, step.is_truth)
            if step.result not in last and step.result not in kept:
                found.release(step.result)
        for value in ending:
            found.release(value)
    return found
