"""The order in which values are computed in a text: few wait at once, and each stands near where it is used."""

from __future__ import annotations

from collections.abc import Sequence

from compoundkin.programs.graph.operation_graph import OperationGraph


def reading_order(graph: OperationGraph, wanted: Sequence[int]) -> list[int]:
    """Return all nodes that some nodes need, operands first.

    What is wanted first comes first. Of the operands of a node, the one for which more values have to wait is computed
    first (Sethi and Ullman, The generation of optimal code for arithmetic expressions, J. ACM 17, 1970, p. 715).
    """
    waits = _waiting(graph, wanted)
    found: dict[int, None] = {}
    for root in wanted:
        waiting = [(root, False)]
        while waiting:
            node, is_ready = waiting.pop()
            if node in found:
                continue
            if is_ready:
                found[node] = None
                continue
            waiting.append((node, True))
            # the last one put is the first one taken
            operands = sorted(enumerate(graph.nodes[node].operands), key=lambda one: (waits[one[1]], -one[0]))
            waiting.extend((operand, False) for _, operand in operands)
    return list(found)


def _waiting(graph: OperationGraph, wanted: Sequence[int]) -> dict[int, int]:
    """How many values have to be kept at once to compute each node, as if nothing were shared."""
    found: dict[int, int] = {}
    for node in graph.needed(wanted):
        needs = sorted((found[k] for k in graph.nodes[node].operands), reverse=True)
        found[node] = max((need + k for k, need in enumerate(needs)), default=1)
    return found
