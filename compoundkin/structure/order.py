"""Strong components of the dependencies between unknowns, in solving order."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heappop, heappush
from itertools import count


def strong_components(successors: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the strong components of a directed graph, each after its successors.

    Without recursion. Source: R. Tarjan, SIAM J. Comput. 1 (1972) 146.

    >>> strong_components([[1], [0], [1]])
    [[0, 1], [2]]
    """
    size = len(successors)
    index, low = [0] * size, [0] * size
    position = [0] * size
    on_stack = bytearray(size)
    stack: list[int] = []
    components: list[list[int]] = []
    clock = count(1)
    for root in range(size):
        path = [] if index[root] else [root]
        while path:
            node = path[-1]
            if not index[node]:
                index[node] = low[node] = next(clock)
                stack.append(node)
                on_stack[node] = 1
            if position[node] < len(successors[node]):
                target = successors[node][position[node]]
                position[node] += 1
                if not index[target]:
                    path.append(target)
                elif on_stack[target]:
                    low[node] = min(low[node], index[target])
                continue
            path.pop()
            if path:
                low[path[-1]] = min(low[path[-1]], low[node])
            if low[node] == index[node]:
                components.append(_popped(stack, on_stack, node))
    return components


def _popped(stack: list[int], on_stack: bytearray, root: int) -> list[int]:
    """Return the component that ends at its root on the stack."""
    component = []
    while on_stack[root]:
        member = stack.pop()
        on_stack[member] = 0
        component.append(member)
    return sorted(component)


def solving_order(
    components: Sequence[Sequence[int]], successors: Sequence[Sequence[int]], rank: Sequence[int]
) -> list[int]:
    """Return the components, each after those it depends on. Of several possible, least `rank` comes first."""
    of = {node: k for k, component in enumerate(components) for node in component}
    needs: list[set[int]] = [set() for _ in components]
    leads: list[list[int]] = [[] for _ in components]
    for k, component in enumerate(components):
        for node in component:
            for target in successors[node]:
                other = of.get(target, k)
                if other != k and other not in needs[k]:
                    needs[k].add(other)
                    leads[other].append(k)
    waiting = [len(need) for need in needs]
    heap = [(rank[k], k) for k, count in enumerate(waiting) if not count]
    heapify(heap)
    order = []
    while heap:
        k = heappop(heap)[1]
        order.append(k)
        for follower in leads[k]:
            waiting[follower] -= 1
            if not waiting[follower]:
                heappush(heap, (rank[follower], follower))
    return order
