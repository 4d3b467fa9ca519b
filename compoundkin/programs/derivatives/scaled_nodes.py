"""Nodes with factors in front: signs, halves and doubles of derivatives meet there and cost nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT


class ScaledNode(NamedTuple):
    """A number times a node."""

    node: int
    factor: float = 1.0

    def times(self, graph: OperationGraph, node: int, factor: float = 1.0) -> ScaledNode:
        """Return it times a node and a number. The numbers of both come to stand in front."""
        own, other = _scaled(graph, self.node), _scaled(graph, node)
        return ScaledNode(graph.apply("mul", own.node, other.node), self.factor * factor * own.factor * other.factor)

    def where(self, graph: OperationGraph, truth: int, kept: bool = True) -> ScaledNode:
        """Return it where a truth is, or where it is not, and zero elsewhere.

        What is not a number elsewhere is left out.
        """
        zero = graph.constant(0.0)
        operands = (self.node, zero) if kept else (zero, self.node)
        return ScaledNode(graph.apply("select", truth, *operands), self.factor)

    def written(self, graph: OperationGraph) -> int:
        """Return its node."""
        if self.factor < 0.0:
            return graph.apply("neg", ScaledNode(self.node, -self.factor).written(graph))
        return graph.apply("mul", graph.constant(self.factor), self.node)


def scaled_sum(graph: OperationGraph, terms: Sequence[ScaledNode]) -> ScaledNode | None:
    """Return the sum of some terms, or None where all are zero.

    The factor of the first stands in front.

    >>> graph = OperationGraph()
    >>> x = graph.apply("sqrt", graph.constant(2.0))
    >>> scaled_sum(graph, [ScaledNode(x, 2.0), ScaledNode(graph.constant(0.0)), ScaledNode(x, -2.0)]).factor
    2.0
    """
    left = [term for term in terms if term.factor != 0.0 and not graph.is_constant(term.node, 0.0)]
    if not left:
        return None
    total, factor = left[0]
    for term in left[1:]:
        ratio = term.factor / factor
        size = graph.apply("mul", graph.constant(abs(ratio)), term.node)
        total = graph.apply("add", total, size) if ratio > 0.0 else _difference(graph, total, size)
    return ScaledNode(total, factor)


def _scaled(graph: OperationGraph, node: int) -> ScaledNode:
    """Return a node as a number times another."""
    known = graph.nodes[node]
    if known.operation == "neg":
        inner = _scaled(graph, known.operands[0])
        return ScaledNode(inner.node, -inner.factor)
    if known.operation == CONSTANT:
        return ScaledNode(graph.constant(1.0), known.value)
    if known.operation == "mul":
        for one, other in (known.operands, known.operands[::-1]):
            if graph.nodes[one].operation == CONSTANT:
                return ScaledNode(other, graph.nodes[one].value)
    return ScaledNode(node)


def _difference(graph: OperationGraph, one: int, other: int) -> int:
    """Return a difference; one less than something else, taken from it, is that."""
    known = graph.nodes[other]
    if known.operation == "sub" and known.operands[0] == one:
        return known.operands[1]
    return graph.apply("sub", one, other)
