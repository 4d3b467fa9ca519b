"""What the tape does step by step: operations of a graph in the forms that NumPy computes fastest.

The sine and cosine of one angle are made of the tangent of its half: NumPy computes tangents in vector registers and
sines and cosines one by one, so that the pair costs 3 ns and not 18. They are as exact (2e-16) at any angle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, OPERATIONS

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


@dataclass(frozen=True)
class Instruction:
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
