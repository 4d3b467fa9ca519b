"""Real operations, and a graph of them: each made once, constants folded, in an order in which it can be computed.

The registry has how NumPy computes each. Operations take simpler forms: neutral numbers vanish, signs move outwards,
roots and reciprocals are undone.
"""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field
from math import frexp, inf, nan
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.display import ShortRepr


@dataclass(frozen=True)
class Operation:
    """One operation.

    How many operands it has, how NumPy computes it, and whether it answers true or false. Truths are held as booleans
    by NumPy; other back ends choose.
    """

    name: str
    operands: int
    compute: Callable[..., Any]
    is_truth: bool = False
    is_commutative: bool = False


def _reciprocal(x: Any, out: Any = None) -> Any:
    return np.divide(1.0, x, out=out)


def _chosen(truth: Any, one: Any, other: Any, out: Any = None) -> Any:
    if out is None:
        return np.where(truth, one, other)
    np.copyto(out, other)
    np.copyto(out, one, where=truth)
    return out


# The registry: what is not listed here cannot be recorded.
OPERATIONS: dict[str, Operation] = {
    one.name: one
    for one in (
        Operation("add", 2, np.add, is_commutative=True),
        Operation("sub", 2, np.subtract),
        Operation("mul", 2, np.multiply, is_commutative=True),
        Operation("neg", 1, np.negative),
        Operation("inv", 1, _reciprocal),
        Operation("sqrt", 1, np.sqrt),
        Operation("abs", 1, np.abs),
        Operation("sin", 1, np.sin),
        Operation("cos", 1, np.cos),
        Operation("atan2", 2, np.arctan2),
        Operation("exp", 1, np.exp),
        Operation("log", 1, np.log),
        # NumPy's maximum and minimum keep a NaN; fmin and fmax leave it out where the other operand is a number
        Operation("max", 2, np.maximum, is_commutative=True),
        Operation("min", 2, np.minimum, is_commutative=True),
        Operation("fmax", 2, np.fmax, is_commutative=True),
        Operation("fmin", 2, np.fmin, is_commutative=True),
        Operation("floor", 1, np.floor),
        Operation("ceil", 1, np.ceil),
        Operation("rint", 1, np.rint),
        Operation("ge", 2, np.greater_equal, is_truth=True),
        Operation("gt", 2, np.greater, is_truth=True),
        Operation("eq", 2, np.equal, is_truth=True, is_commutative=True),
        Operation("and", 2, np.logical_and, is_truth=True, is_commutative=True),
        Operation("or", 2, np.logical_or, is_truth=True, is_commutative=True),
        Operation("not", 1, np.logical_not, is_truth=True),
        Operation("select", 3, _chosen),
    )
}

COMMUTATIVE = frozenset(name for name, one in OPERATIONS.items() if one.is_commutative)

# Reductions over the poses of a design: what comes out is fixed by the design. The least keeps a NaN.
TOTAL, LEAST = "total", "least"
REDUCTIONS: dict[str, Callable[..., Any]] = {TOTAL: np.add.reduce, LEAST: np.minimum.reduce}
# Leaves: a number, a number given at each call.
CONSTANT, INPUT = "constant", "input"


class InputNumber(NamedTuple):
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


class OperationNode(NamedTuple):
    """One node: an operation on earlier nodes, a constant, or an input."""

    operation: str
    operands: tuple[int, ...] = ()
    value: float = 0.0
    given: InputNumber | None = None


@dataclass
class OperationGraph(ShortRepr):
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
        nodes = self.nodes
        for k in operands:
            if nodes[k].operation != CONSTANT:
                break
        else:
            with np.errstate(all="ignore"):
                return self.constant(float(OPERATIONS[operation].compute(*(nodes[k].value for k in operands))))
        if operation in COMMUTATIVE and operands[0] > operands[1]:
            return self.apply(operation, *operands[::-1])
        # a product with the number zero is zero: what is not a number there is masked by the group that failed
        rule = _RULES.get(operation)
        return None if rule is None else rule(self, *operands)

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

    def needed(self, wanted: Iterable[int], known: Collection[int] = ()) -> list[int]:
        """Return all nodes that some nodes are computed from, and themselves, in order; without what is `known`."""
        nodes, found, waiting = self.nodes, set[int](), list(wanted)
        while waiting:
            node = waiting.pop()
            if node not in found and node not in known:
                found.add(node)
                waiting.extend(nodes[node].operands)
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


# a dimension of a link or pair, a driver's value or rate, what is found outside the program, a number of an objective
DIMENSION, DRIVE, SEED, PARAMETER = "dimension", "drive", "seed", "parameter"


# The slope of a driver's value or rate by a number of its law: no program reads it.
LAW_SLOPE = "law slope"


# Parts of seeds: the sign of a group's mode, the angle of a link with full turns.
SIGN, TURNS = "sign", "turns"


# Part of a driver: how far it goes from a pose to the next.
STEP = "step"


# Part of a driver: its value a pose before, which back ends take from its value; at the first pose it is that.
BEFORE = "before"


# Part of a group's seeds: on which side of a singularity it was a pose before.
SIDE = "side"


# Whether a design's seeds are those of the configuration that the program is in.
HOLDS = InputNumber(SEED, "", "holds")


def group_seed(index: int) -> str:
    """Return what the seeds of a group are called.

    >>> group_seed(2)
    'group 2'
    """
    return f"group {index}"


def start_of(seed: InputNumber) -> InputNumber:
    """Return the seed at each design's first pose.

    >>> start_of(InputNumber("seed", "group 2", "0")).part
    'start 0'
    """
    return seed._replace(part=f"start {seed.part}")


def _operand_of(graph: OperationGraph, node: int, operation: str) -> int | None:
    """Return the operand of a node of one operation."""
    found = graph.nodes[node]
    return found.operands[0] if found.operation == operation else None


def _add(graph: OperationGraph, a: int, b: int) -> int | None:
    x, y = graph.nodes[a], graph.nodes[b]
    for node, other in ((x, b), (y, a)):
        operation = node.operation
        if operation == CONSTANT and node.value == 0.0:
            return other
        if operation == "neg":
            return graph.apply("sub", other, node.operands[0])
    return _merged_choice(graph, x, y) if x.operation == y.operation == "select" else None


def _merged_choice(graph: OperationGraph, one: OperationNode, other: OperationNode) -> int | None:
    """Return the sum of what is chosen where a truth is and what is chosen where it is not, as one choice."""
    for x, y in ((one, other), (other, one)):
        if x.operands[0] == y.operands[0]:
            truth, here, there = x.operands[0], x.operands[1], y.operands[2]
            if graph.is_constant(x.operands[2], 0.0) and graph.is_constant(y.operands[1], 0.0):
                return graph.apply("select", truth, here, there)
    return None


def _sub(graph: OperationGraph, a: int, b: int) -> int | None:
    x, y = graph.nodes[a], graph.nodes[b]
    if y.operation == CONSTANT and y.value == 0.0:
        return a
    if x.operation == CONSTANT and x.value == 0.0:
        return graph.apply("neg", b)
    if a == b:
        return graph.constant(0.0)
    if y.operation == "neg":
        return graph.apply("add", a, y.operands[0])
    return graph.apply("neg", graph.apply("add", x.operands[0], b)) if x.operation == "neg" else None


def _mul(graph: OperationGraph, a: int, b: int) -> int | None:
    x, y = graph.nodes[a], graph.nodes[b]
    for node, one, other in ((x, a, b), (y, b, a)):
        operation = node.operation
        if operation == CONSTANT:
            return _by_number(graph, one, other)
        if operation == "neg":
            return graph.apply("neg", graph.apply("mul", node.operands[0], other))
        if operation == "sub":
            # a difference that was taken the other way round before
            opposite = graph.there("sub", *node.operands[::-1])
            if opposite is not None and opposite < one:
                return graph.apply("neg", graph.apply("mul", opposite, other))
        elif operation == "inv" and node.operands[0] == other:
            return _by_itself(graph, other)
    return x.operands[0] if a == b and x.operation == "sqrt" else None


def _by_itself(graph: OperationGraph, node: int) -> int:
    """Return a number divided by itself: one, or none where it is zero, infinite or none."""
    size, zero, infinite = graph.apply("abs", node), graph.constant(0.0), graph.constant(inf)
    is_finite = graph.apply("and", graph.apply("gt", size, zero), graph.apply("gt", infinite, size))
    return graph.apply("select", is_finite, graph.constant(1.0), graph.constant(nan))


def _by_number(graph: OperationGraph, one: int, other: int) -> int | None:
    """Return a simpler product with a number."""
    factor = graph.nodes[one].value
    if factor == 0.0:
        return one
    if factor == 1.0:
        return other
    if factor < 0.0:
        return graph.apply("neg", graph.apply("mul", graph.constant(-factor), other))
    minus = _operand_of(graph, other, "neg")
    if minus is not None:
        return graph.apply("neg", graph.apply("mul", one, minus))
    return _scaled(graph, factor, other)


def _scaled(graph: OperationGraph, factor: float, node: int) -> int | None:
    """Return a product with two numbers as one with theirs, where it is the same to the last digit."""
    inner = graph.nodes[node]
    if inner.operation != "mul":
        return None
    for one, other in (inner.operands, inner.operands[::-1]):
        known = graph.nodes[one]
        if known.operation == CONSTANT and (_is_power_of_two(factor) or _is_power_of_two(known.value)):
            return graph.apply("mul", graph.constant(factor * known.value), other)
    return None


def _is_power_of_two(value: float) -> bool:
    return abs(frexp(value)[0]) == 0.5


def _neg(graph: OperationGraph, a: int) -> int | None:
    minus = _operand_of(graph, a, "neg")
    if minus is not None:
        return minus
    node = graph.nodes[a]
    return graph.apply("sub", *reversed(node.operands)) if node.operation == "sub" else None


def _inv(graph: OperationGraph, a: int) -> int | None:
    twice, minus = _operand_of(graph, a, "inv"), _operand_of(graph, a, "neg")
    if twice is not None:
        return twice
    return None if minus is None else graph.apply("neg", graph.apply("inv", minus))


def _even(operation: str) -> Callable[[OperationGraph, int], int | None]:
    def rule(graph: OperationGraph, a: int) -> int | None:
        minus = _operand_of(graph, a, "neg")
        return None if minus is None else graph.apply(operation, minus)

    return rule


def _sin(graph: OperationGraph, a: int) -> int | None:
    minus = _operand_of(graph, a, "neg")
    return None if minus is None else graph.apply("neg", graph.apply("sin", minus))


def _select(graph: OperationGraph, truth: int, one: int, other: int) -> int | None:
    node = graph.nodes[truth]
    if node.operation == CONSTANT:
        return one if node.value else other
    return one if one == other else None


def _and(graph: OperationGraph, a: int, b: int) -> int | None:
    for one, other in ((a, b), (b, a)):
        if graph.nodes[one].operation == CONSTANT:
            return other if graph.nodes[one].value else one
    return a if a == b else None


def _or(graph: OperationGraph, a: int, b: int) -> int | None:
    for one, other in ((a, b), (b, a)):
        if graph.nodes[one].operation == CONSTANT:
            return one if graph.nodes[one].value else other
    return a if a == b else None


_RULES: dict[str, Callable[..., int | None]] = {
    "add": _add,
    "sub": _sub,
    "mul": _mul,
    "neg": _neg,
    "inv": _inv,
    "sin": _sin,
    "cos": _even("cos"),
    "abs": _even("abs"),
    "select": _select,
    "and": _and,
    "or": _or,
}
