"""Simpler forms of operations: neutral numbers, signs moved outwards, roots and reciprocals undone."""

from __future__ import annotations

from collections.abc import Callable
from math import frexp
from typing import TYPE_CHECKING

from compoundkin.programs.graph.operations import CONSTANT

if TYPE_CHECKING:
    from compoundkin.programs.graph.operation_graph import OperationGraph


def folded(graph: OperationGraph, operation: str, operands: tuple[int, ...]) -> int | None:
    """Return a cheaper node of the same value; None where there is none.

    A product with the number zero is zero: what is not a number there is masked by the group that failed.
    """
    rule = _RULES.get(operation)
    return None if rule is None else rule(graph, *operands)


def _inner(graph: OperationGraph, node: int, operation: str) -> int | None:
    """Return the operand of a node of one operation."""
    found = graph.nodes[node]
    return found.operands[0] if found.operation == operation else None


def _add(graph: OperationGraph, a: int, b: int) -> int | None:
    for one, other in ((a, b), (b, a)):
        if graph.is_constant(one, 0.0):
            return other
        minus = _inner(graph, one, "neg")
        if minus is not None:
            return graph.apply("sub", other, minus)
    return _joined(graph, a, b)


def _joined(graph: OperationGraph, a: int, b: int) -> int | None:
    """Return the sum of what is chosen where a truth is and what is chosen where it is not, as one choice."""
    for one, other in ((a, b), (b, a)):
        x, y = graph.nodes[one], graph.nodes[other]
        if x.operation == y.operation == "select" and x.operands[0] == y.operands[0]:
            truth, here, there = x.operands[0], x.operands[1], y.operands[2]
            if graph.is_constant(x.operands[2], 0.0) and graph.is_constant(y.operands[1], 0.0):
                return graph.apply("select", truth, here, there)
    return None


def _sub(graph: OperationGraph, a: int, b: int) -> int | None:
    if graph.is_constant(b, 0.0):
        return a
    if graph.is_constant(a, 0.0):
        return graph.apply("neg", b)
    if a == b:
        return graph.constant(0.0)
    minus = _inner(graph, b, "neg")
    if minus is not None:
        return graph.apply("add", a, minus)
    minus = _inner(graph, a, "neg")
    return None if minus is None else graph.apply("neg", graph.apply("add", minus, b))


def _mul(graph: OperationGraph, a: int, b: int) -> int | None:
    x, y = graph.nodes[a], graph.nodes[b]
    for node, one, other in ((x, a, b), (y, b, a)):
        if node.operation == CONSTANT:
            return _by_number(graph, one, other)
        if node.operation == "neg":
            return graph.apply("neg", graph.apply("mul", node.operands[0], other))
        opposite = graph.there("sub", *node.operands[::-1]) if node.operation == "sub" else None
        if opposite is not None and opposite < one:
            # a difference that was taken the other way round before
            return graph.apply("neg", graph.apply("mul", opposite, other))
    return x.operands[0] if a == b and x.operation == "sqrt" else None


def _by_number(graph: OperationGraph, one: int, other: int) -> int | None:
    """Return a simpler product with a number."""
    factor = graph.nodes[one].value
    if factor == 0.0:
        return one
    if factor == 1.0:
        return other
    if factor < 0.0:
        return graph.apply("neg", graph.apply("mul", graph.constant(-factor), other))
    minus = _inner(graph, other, "neg")
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
    minus = _inner(graph, a, "neg")
    if minus is not None:
        return minus
    node = graph.nodes[a]
    return graph.apply("sub", *reversed(node.operands)) if node.operation == "sub" else None


def _inv(graph: OperationGraph, a: int) -> int | None:
    twice, minus = _inner(graph, a, "inv"), _inner(graph, a, "neg")
    if twice is not None:
        return twice
    return None if minus is None else graph.apply("neg", graph.apply("inv", minus))


def _even(operation: str) -> Callable[[OperationGraph, int], int | None]:
    def rule(graph: OperationGraph, a: int) -> int | None:
        minus = _inner(graph, a, "neg")
        return None if minus is None else graph.apply(operation, minus)

    return rule


def _sin(graph: OperationGraph, a: int) -> int | None:
    minus = _inner(graph, a, "neg")
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
