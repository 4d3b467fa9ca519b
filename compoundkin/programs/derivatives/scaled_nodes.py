"""Nodes with factors in front: signs, halves and doubles of derivatives meet there and cost nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from compoundkin.programs.graph.operation_graph import OperationGraph


class ScaledNode(NamedTuple):
    """A number times a node."""

    node: int
    factor: float = 1.0

    def times(self, graph: OperationGraph, node: int, factor: float = 1.0) -> ScaledNode:
        """Return it times a node and a number."""
        return ScaledNode(graph.apply("mul", self.node, node), self.factor * factor)

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
        total = graph.apply("add" if ratio > 0.0 else "sub", total, size)
    return ScaledNode(total, factor)
