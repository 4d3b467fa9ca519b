"""A graph of real operations: each made once, constants folded, in an order in which it can be computed."""

from __future__ import annotations

import struct
import threading
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS, REDUCTIONS
from compoundkin.programs.graph.simpler_forms import folded


@dataclass(frozen=True)
class InputNumber:
    """One real number that a program is given.

    It has its kind, what it is of, and which part of that.

    Kinds: `dimension` ("crank.D", part "x" or "y"), `drive` ("crank", part "0" value, "1" speed, "2" acceleration, "3"
    jerk), `seed` (found outside: signs, counted turns, states of general groups), `parameter` (of an objective).
    """

    kind: str
    name: str
    part: str = ""

    @property
    def full_name(self) -> str:
        """Its name, with its part if it has one."""
        return f"{self.name}.{self.part}" if self.part else self.name


@dataclass(frozen=True)
class OperationNode:
    """One node: an operation on earlier nodes, a constant, or an input."""

    operation: str
    operands: tuple[int, ...] = ()
    value: float = 0.0
    given: InputNumber | None = None


@dataclass
class OperationGraph(PrintsShort):
    """Nodes in the order in which they were made. Operands come first; equal nodes are one.

    >>> graph = OperationGraph()
    >>> x = graph.input(InputNumber("drive", "crank", "0"))
    >>> graph.apply("add", x, graph.apply("mul", graph.constant(2.0), graph.constant(3.0))), graph.nodes[3].value
    (4, 6.0)
    """

    nodes: list[OperationNode] = field(default_factory=list)
    _seen: dict[object, int] = field(default_factory=dict)
    # a path that several threads call at first grows in all of them
    _grows: threading.Lock = field(default_factory=threading.Lock, repr=False, compare=False)

    def constant(self, value: float) -> int:
        """Return the node of a number."""
        # by its bits, since NaN does not equal itself and -0.0 equals 0.0
        key = CONSTANT, struct.pack("d", value)
        found = self._seen.get(key)
        return self._new(key, OperationNode(CONSTANT, value=float(value))) if found is None else found

    def input(self, given: InputNumber) -> int:
        """Return the node of an input."""
        found = self._seen.get(given)
        return self._new(given, OperationNode(INPUT, given=given)) if found is None else found

    def apply(self, operation: str, *operands: int) -> int:
        """Return the node of an operation, or a simpler one of the same value."""
        key = operation, operands
        found = self._seen.get(key)
        if found is None:
            simpler = self._simpler(operation, operands) if operation in OPERATIONS else None
            if simpler is None:
                return self._new(key, OperationNode(operation, operands))
            found = self._seen[key] = simpler
        return found

    def there(self, operation: str, *operands: int) -> int | None:
        """Return the node of an operation that was made before, if any."""
        return self._seen.get((operation, operands))

    def _simpler(self, operation: str, operands: tuple[int, ...]) -> int | None:
        """Return a node that is there already, or cheaper; None where there is none."""
        known = [self.nodes[k] for k in operands]
        if all(node.operation == CONSTANT for node in known):
            with np.errstate(all="ignore"):
                return self.constant(float(OPERATIONS[operation].compute(*(node.value for node in known))))
        if OPERATIONS[operation].is_commutative and operands[0] > operands[1]:
            return self.apply(operation, *operands[::-1])
        return folded(self, operation, operands)

    def _new(self, key: object, node: OperationNode) -> int:
        with self._grows:
            found = self._seen.get(key)
            if found is None:
                found = len(self.nodes)
                self.nodes.append(node)
                self._seen[key] = found
        return found

    def is_constant(self, node: int, value: float) -> bool:
        """Tell whether a node is this number."""
        return self.nodes[node].operation == CONSTANT and self.nodes[node].value == value

    def is_truth(self, node: int) -> bool:
        """Tell whether a node answers true or false."""
        found = OPERATIONS.get(self.nodes[node].operation)
        return found is not None and found.is_truth

    def needed(self, wanted: Iterable[int]) -> list[int]:
        """Return all nodes that some nodes are computed from, and themselves, in order."""
        found, waiting = set[int](), list(wanted)
        while waiting:
            node = waiting.pop()
            if node not in found:
                found.add(node)
                waiting.extend(self.nodes[node].operands)
        return sorted(found)

    def count(self, wanted: Iterable[int]) -> int:
        """Return how many operations it takes to compute some nodes."""
        return sum(self.nodes[k].operation not in (CONSTANT, INPUT) for k in self.needed(wanted))

    def inputs(self, wanted: Iterable[int]) -> list[int]:
        """Return the inputs that some nodes depend on, in order."""
        return [k for k in self.needed(wanted) if self.nodes[k].operation == INPUT]

    def reduced(self, node: int) -> bool:
        """Tell whether a node is a reduction over poses."""
        return self.nodes[node].operation in REDUCTIONS

    def __repr__(self) -> str:
        return f"OperationGraph({len(self.nodes)} nodes)"
