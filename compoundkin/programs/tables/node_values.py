"""Values of nodes, computed once over arrays: where no program is worth being made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS


def node_values(graph: OperationGraph, wanted: Sequence[int], given: Mapping[InputNumber, Number]) -> list[Number]:
    """Return the values of some nodes, which broadcast with those given.

    >>> graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    >>> node_values(graph, [graph.apply("mul", graph.input(x), graph.constant(2.0))], {x: np.array([1.0, 2.0])})
    [array([2., 4.])]
    """
    found: dict[int, Number] = {}
    with np.errstate(all="ignore"):
        for k in graph.needed(wanted):
            node = graph.nodes[k]
            if node.operation == INPUT:
                assert node.given is not None
                found[k] = given[node.given]
            elif node.operation == CONSTANT:
                found[k] = np.float64(node.value)
            else:
                found[k] = OPERATIONS[node.operation].compute(*(found[n] for n in node.operands))
    return [found[k] for k in wanted]
