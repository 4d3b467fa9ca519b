"""How each operation changes with its operands: one rule for each, read by tangents and by adjoints alike.

Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, section 3.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import TypeAlias

from compoundkin.programs.derivatives.scaled_nodes import ScaledNode
from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT

# A change of a node times its slope by an operand, either way: of tangents upwards, of adjoints downwards.
Slope: TypeAlias = Callable[[ScaledNode], ScaledNode]
# The nodes that a node changes with, not always its own operands, and the slopes by them.
SlopeRule: TypeAlias = Callable[[OperationGraph, int], list[tuple[int, Slope]]]


def slopes(graph: OperationGraph, node: int) -> list[tuple[int, Slope]]:
    """Return the nodes that a node changes with, and how."""
    return SLOPE_RULES[graph.nodes[node].operation](graph, node) if graph.nodes[node].operands else []


def _scale(factor: float) -> Slope:
    return lambda change: ScaledNode(change.node, change.factor * factor)


def _factor(graph: OperationGraph, node: int, factor: float = 1.0) -> Slope:
    return lambda change: change.times(graph, node, factor)


def _operands(graph: OperationGraph, node: int) -> tuple[int, ...]:
    return graph.nodes[node].operands


def _linear(*factors: float) -> SlopeRule:
    return lambda graph, k: [(n, _scale(c)) for n, c in zip(_operands(graph, k), factors, strict=True)]


def _level(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    """Return the slopes of what is level between its jumps: none."""
    return []


def _mul(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    a, b = _operands(graph, k)
    return [(a, _factor(graph, a, 2.0))] if a == b else [(a, _factor(graph, b)), (b, _factor(graph, a))]


def _inv(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    return [(_operands(graph, k)[0], _factor(graph, graph.apply("mul", k, k), -1.0))]


def _sqrt(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    slope = graph.apply("inv", k)
    if _is_square(graph, a):
        # the length of a vector that is zero has no slope: as good as any is none
        zero = graph.constant(0.0)
        slope = graph.apply("select", graph.apply("gt", k, zero), slope, zero)
    return [(a, _factor(graph, slope, 0.5))]


def _is_square(graph: OperationGraph, node: int) -> bool:
    """Tell whether a node is the square of a vector's length."""
    parts = [graph.nodes[n] for n in _operands(graph, node)] if graph.nodes[node].operation == "add" else []
    return bool(parts) and all(each.operation == "mul" and each.operands[0] == each.operands[1] for each in parts)


def _abs(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    sign = graph.apply("select", graph.apply("ge", a, graph.constant(0.0)), graph.constant(1.0), graph.constant(-1.0))
    return [(a, _factor(graph, sign))]


def _sin(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("cos", a)))]


def _cos(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("sin", a), -1.0))]


def _atan2(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    y, x = _operands(graph, k)
    put = graph.apply
    inverse = put("inv", put("add", put("mul", x, x), put("mul", y, y)))
    return [(y, _factor(graph, put("mul", x, inverse))), (x, _factor(graph, put("mul", y, inverse), -1.0))]


def _exp(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    return [(_operands(graph, k)[0], _factor(graph, k))]


def _log(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("inv", a)))]


def _selected(graph: OperationGraph, truth: int, one: int, other: int) -> list[tuple[int, Slope]]:
    return [(one, lambda change: change.where(graph, truth)), (other, lambda change: change.where(graph, truth, False))]


def _extreme(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    """Return the slopes of a maximum or minimum: it changes with the operand that it is."""
    a, b = _operands(graph, k)
    return _selected(graph, graph.apply("eq", k, a), a, b)


def _select(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    truth, one, other = _operands(graph, k)
    for masked, kept in ((one, other), (other, one)):
        if graph.nodes[masked].operation == CONSTANT and isnan(graph.nodes[masked].value):
            return [(_unclipped(graph, kept), _scale(1.0))]
    return _selected(graph, truth, one, other)


def _unclipped(graph: OperationGraph, node: int) -> int:
    """Return what a guard clips at zero: a discriminant that rounding makes negative still has its slope."""
    found = graph.nodes[node]
    if found.operation == "max":
        for zero, other in (found.operands, found.operands[::-1]):
            if graph.is_constant(zero, 0.0):
                return other
    return node


SLOPE_RULES: dict[str, SlopeRule] = {
    "add": _linear(1.0, 1.0),
    "sub": _linear(1.0, -1.0),
    "mul": _mul,
    "neg": _linear(-1.0),
    "inv": _inv,
    "sqrt": _sqrt,
    "abs": _abs,
    "sin": _sin,
    "cos": _cos,
    "atan2": _atan2,
    "exp": _exp,
    "log": _log,
    "max": _extreme,
    "min": _extreme,
    "fmax": _extreme,
    "fmin": _extreme,
    "select": _select,
    **dict.fromkeys(("floor", "ceil", "rint", "ge", "gt", "eq", "and", "or", "not"), _level),
}
