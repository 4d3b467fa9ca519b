"""Forward differentiation: how nodes change when inputs do, as new nodes of the same graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compoundkin.programs.derivatives.scaled_nodes import ScaledNode, scaled_sum
from compoundkin.programs.derivatives.slope_rules import slopes
from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import TOTAL


def forward(graph: OperationGraph, wanted: Sequence[int], changes: Mapping[int, float]) -> list[int]:
    """Return how fast some nodes change when inputs change at given rates.

    Other inputs do not change; what depends on none of them has the constant zero.

    >>> from compoundkin.programs.graph.operation_graph import InputNumber
    >>> graph = OperationGraph()
    >>> x, y = (graph.input(InputNumber("parameter", name)) for name in "xy")
    >>> forward(graph, [graph.apply("mul", x, y)], {x: 1.0}) == [y]
    True
    """
    found: dict[int, ScaledNode] = {
        k: ScaledNode(graph.constant(1.0), rate) for k, rate in changes.items() if rate != 0.0
    }
    for k in graph.needed(wanted):
        if any(n in found for n in graph.nodes[k].operands):
            rate = _tangent(graph, k, found)
            if rate is not None:
                found[k] = rate
    return [found[k].written(graph) if k in found else graph.constant(0.0) for k in wanted]


def _tangent(graph: OperationGraph, k: int, found: Mapping[int, ScaledNode]) -> ScaledNode | None:
    node = graph.nodes[k]
    if node.operation == TOTAL:
        inner = found[node.operands[0]]
        return ScaledNode(graph.apply(TOTAL, inner.node), inner.factor)
    return scaled_sum(graph, [slope(found[n]) for n, slope in slopes(graph, k) if n in found])
