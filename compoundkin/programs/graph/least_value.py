"""The least of a value over the poses, with what keeps the order of numbers done once a design."""

from __future__ import annotations

from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, LEAST


def least_value(graph: OperationGraph, node: int) -> int:
    """Return the least of a value over the poses.

    It is no number where any part is none. Roots, and factors and summands that are known, are taken of the least
    instead of at every pose.

    >>> from compoundkin.programs.graph.operation_graph import InputNumber
    >>> graph = OperationGraph()
    >>> distance = graph.apply("sqrt", graph.input(InputNumber("drive", "crank", "0")))
    >>> found = least_value(graph, graph.apply("min", graph.constant(1.0), distance))
    >>> graph.nodes[found].operation, graph.nodes[found - 1].operation, graph.nodes[found - 2].operation
    ('min', 'sqrt', 'least')
    """
    if graph.nodes[node].operation == CONSTANT:
        return graph.apply(LEAST, node)  # as an array of all designs
    return _inner(graph, node)


def _inner(graph: OperationGraph, node: int) -> int:
    found = graph.nodes[node]
    known = [k for k in found.operands if graph.nodes[k].operation == CONSTANT]
    if found.operation == CONSTANT:
        return node
    # where one operand is no number `fmin` has the other; that it is none is on the side of caution
    if found.operation in ("min", "fmin"):
        return graph.apply("min", *(_inner(graph, k) for k in found.operands))
    if found.operation == "sqrt" or (known and _keeps_order(graph, node, known[0])):
        return graph.apply(found.operation, *(_inner(graph, k) for k in found.operands))
    return graph.apply(LEAST, node)


def _keeps_order(graph: OperationGraph, node: int, known: int) -> bool:
    """Tell whether a larger number has a larger value here, given what is known."""
    found = graph.nodes[node]
    if found.operation == "mul":
        return 0.0 < graph.nodes[known].value < float("inf")
    return found.operation == "add" or (found.operation == "sub" and found.operands[1] == known)
