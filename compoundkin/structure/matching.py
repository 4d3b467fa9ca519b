"""Which unknown each constraint row determines: a maximum matching, and the strong components in solving order."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import count

FREE = -1


@dataclass(frozen=True)
class Matching:
    """`owner[row]` is the unknown a row determines, or FREE. `owned[unknown]` its rows; `room` what lacks."""

    rows: Sequence[tuple[int, ...]]
    owner: list[int]
    owned: list[list[int]]
    room: list[int]


def maximum_matching(rows: Sequence[tuple[int, ...]], freedoms: Sequence[int]) -> Matching:
    """Assign as many rows as possible to unknowns, within their freedoms.

    Breadth-first augmentation in phases that share their marks; each phase is linear in the rows, and few
    are needed after the greedy start. Source: A. Pothen and C.-J. Fan, ACM Trans. Math. Softw. 16 (1990) 303.

    >>> maximum_matching([(0, 1), (0, 1), (1,)], [1, 2]).owner
    [0, 1, 1]
    """
    matching = Matching(rows, [FREE] * len(rows), [[] for _ in freedoms], list(freedoms))
    _start(matching)
    waiting = [row for row, owner in enumerate(matching.owner) if owner == FREE]
    progress = True
    while waiting and progress:
        seen = bytearray(len(matching.room))
        left = [row for row in waiting if not _augment(matching, row, seen)]
        progress = len(left) < len(waiting)
        waiting = left
    return matching


def _start(matching: Matching) -> None:
    """Give rows to the unknown that is forced. Where none is, the one with the least room gets them."""
    rows, room = matching.rows, matching.room
    touching: list[list[int]] = [[] for _ in room]
    for row, unknowns in enumerate(rows):
        for unknown in unknowns:
            touching[unknown].append(row)
    forced = deque(row for row, unknowns in enumerate(rows) if len(unknowns) == 1)
    for fallback in range(len(rows)):
        forced.append(fallback)
        while forced:
            row = forced.popleft()
            open_to = [u for u in rows[row] if room[u]] if matching.owner[row] == FREE else []
            if not open_to:
                continue
            unknown = min(open_to, key=room.__getitem__)
            _give(matching, row, unknown)
            if not room[unknown]:
                forced.extend(r for r in touching[unknown] if matching.owner[r] == FREE)


def _give(matching: Matching, row: int, unknown: int) -> None:
    matching.owner[row] = unknown
    matching.owned[unknown].append(row)
    matching.room[unknown] -= 1


def _augment(matching: Matching, row: int, seen: bytearray) -> bool:
    """Find a place for a row by moving others along a shortest path."""
    before: dict[int, int] = {}
    queue = deque([row])
    while queue:
        current = queue.popleft()
        for unknown in matching.rows[current]:
            if matching.room[unknown]:
                _shift(matching, current, unknown, before)
                return True
            if not seen[unknown]:
                seen[unknown] = 1
                for displaced in matching.owned[unknown]:
                    before[displaced] = current
                    queue.append(displaced)
    return False


def _shift(matching: Matching, row: int, unknown: int, before: dict[int, int]) -> None:
    while True:
        left = matching.owner[row]
        if left != FREE:
            matching.owned[left].remove(row)
            matching.room[left] += 1
        _give(matching, row, unknown)
        if left == FREE:
            return
        row, unknown = before[row], left


def overdetermined(matching: Matching) -> list[bool]:
    """Return which unknowns more rows hold than they have freedoms.

    They are the vertical part of Dulmage and Mendelsohn.

    >>> overdetermined(maximum_matching([(0,), (0,), (1,)], [1, 1]))
    [True, False]
    """
    marked = [False] * len(matching.room)
    queue = deque(row for row, owner in enumerate(matching.owner) if owner == FREE)
    while queue:
        for unknown in matching.rows[queue.popleft()]:
            if not marked[unknown]:
                marked[unknown] = True
                queue.extend(matching.owned[unknown])
    return marked


def underdetermined(matching: Matching) -> list[bool]:
    """Return which unknowns are free or depend on a free one.

    They are the horizontal part of Dulmage and Mendelsohn.

    >>> underdetermined(maximum_matching([(0, 1), (2,)], [1, 1, 1]))
    [True, True, False]
    """
    touching: list[list[int]] = [[] for _ in matching.room]
    for row, unknowns in enumerate(matching.rows):
        for unknown in unknowns:
            touching[unknown].append(row)
    marked = [room > 0 for room in matching.room]
    queue = deque(unknown for unknown, free in enumerate(marked) if free)
    while queue:
        for row in touching[queue.popleft()]:
            owner = matching.owner[row]
            if owner != FREE and not marked[owner]:
                marked[owner] = True
                queue.append(owner)
    return marked


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
