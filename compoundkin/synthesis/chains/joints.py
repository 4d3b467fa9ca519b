"""A mechanism's graph as links and joints.

A slide counts as a revolute pair at infinity, a higher pair as a binary link between two revolute pairs, and
a pin of k links as k - 1 pairs: one of the trees of pairs on its links, each of which is a chain of its own.
Source: F. Freudenstein and L. Dobrjanskyj, On a theory for the type synthesis of mechanisms, Proc. 11th Int.
Congress of Applied Mechanics (1964) 420.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from compoundkin.model.pairs import KINDS
from compoundkin.structure.cycles import find
from compoundkin.synthesis.chains.coloured_graphs import Canonical, Coloured, canonical

# The two simple pairs: one turns, one shifts.
REVOLUTE, SLIDE = (
    next(code for code, kind in KINDS.items() if kind.is_simple and kind.free_is_angle is turns)
    for turns in (True, False)
)
LOWER_HOLDS = 2


@dataclass(frozen=True)
class Joint:
    """Where links are joined. Their numbers, the letter of the pair, how much it holds.

    `guide` is the link that carries the guide of a slide, if that is known; `kind` is what a pair is called
    that is neither revolute nor a slide.
    """

    links: tuple[int, ...]
    code: str = REVOLUTE
    held: int = LOWER_HOLDS
    guide: int | None = None
    kind: str = ""

    @property
    def pairs(self) -> int:
        """How many pairs it counts: a pin of k links is k - 1."""
        return len(self.links) - 1

    @property
    def is_higher(self) -> bool:
        """Whether it holds less than a revolute or a prismatic pair."""
        return self.held < LOWER_HOLDS


@dataclass(frozen=True)
class Joints:
    """The links of a mechanism by name, and its joints."""

    links: tuple[str, ...]
    joints: tuple[Joint, ...]

    @property
    def mobility(self) -> int:
        """The mobility F by the count of Chebyshev and Gruebler."""
        return 3 * (len(self.links) - 1) - sum(joint.held * joint.pairs for joint in self.joints)

    @cached_property
    def degrees(self) -> tuple[int, ...]:
        """How many joints each link has."""
        counts = [0] * len(self.links)
        for joint in self.joints:
            for link in joint.links:
                counts[link] += 1
        return tuple(counts)

    @property
    def multiple(self) -> tuple[Joint, ...]:
        """The pins of more than two links."""
        return tuple(joint for joint in self.joints if joint.pairs > 1)

    def canonical(self, marks: Mapping[int, str] | None = None) -> Canonical:
        """Return the canonical form: links by their marks ("frame", ...), joints by their letters. Links come first."""
        links = [(marks or {}).get(link, "link") for link in range(len(self.links))]
        ends = [(link, len(links) + k) for k, joint in enumerate(self.joints) for link in joint.links]
        return canonical(Coloured.of([*links, *(f"pair {joint.code}" for joint in self.joints)], ends))

    def merged(self, link: str, into: str) -> Joints:
        """Return the same with one link taken for a part of another. What joins the two is gone.

        >>> Joints(("a", "b", "c"), (Joint((0, 1)), Joint((1, 2)))).merged("b", "a").joints[0].links
        (0, 1)
        """
        gone, kept = self.links.index(link), self.links.index(into)
        left = [k for k in range(len(self.links)) if k != gone]
        number = {**{k: n for n, k in enumerate(left)}, gone: left.index(kept)}
        joints = []
        for joint in self.joints:
            links = tuple(dict.fromkeys(number[k] for k in joint.links))
            if len(links) > 1:
                guide = None if joint.guide is None else number[joint.guide]
                joints.append(replace(joint, links=links, guide=guide))
        return Joints(tuple(self.links[k] for k in left), tuple(joints))

    @cached_property
    def pieces(self) -> int:
        """How many pieces there are that nothing joins.

        >>> Joints(("a", "b", "c"), (Joint((0, 1)),)).pieces
        2
        """
        leader, pieces = list(range(len(self.links))), len(self.links)
        for joint in self.joints:
            first, *others = joint.links
            for other in others:
                one, two = find(leader, first), find(leader, other)
                pieces -= one != two
                leader[two] = one
        return pieces

    @property
    def has_loop_of_slides(self) -> bool:
        """Whether slides alone close a loop. No link of it turns, and it moves where the count says it does not.

        >>> Joints(("a", "b", "c"), tuple(Joint(ends, "P") for ends in ((0, 1), (1, 2), (2, 0)))).has_loop_of_slides
        True
        """
        leader = list(range(len(self.links)))
        for joint in self.joints:
            if joint.code == SLIDE:
                first, second = (find(leader, link) for link in joint.links)
                if first == second:
                    return True
                leader[second] = first
        return False

    def distances(self, start: int) -> list[int]:
        """Return how many joints each link is away from one of them. Links that cannot be reached are farthest.

        >>> Joints(("a", "b", "c"), (Joint((0, 1)), Joint((1, 2)))).distances(0)
        [0, 1, 2]
        """
        far = len(self.links)
        found = [far] * far
        found[start], step = 0, 0
        while step in found:
            for joint in self.joints:
                if any(found[link] == step for link in joint.links):
                    for link in joint.links:
                        found[link] = min(found[link], step + 1)
            step += 1
        return found

    def part(self, links: Sequence[int]) -> Joints:
        """Return some of the links, with the joints between them."""
        number = {link: k for k, link in enumerate(links)}
        kept = []
        for joint in self.joints:
            inside = tuple(number[link] for link in joint.links if link in number)
            if len(inside) > 1:
                guide = None if joint.guide is None else number.get(joint.guide)
                kept.append(replace(joint, links=inside, guide=guide))
        return Joints(tuple(self.links[link] for link in links), tuple(kept))

    def names(self, numbers: Iterable[int]) -> tuple[str, ...]:
        """Return the names of links by their numbers. Joints are numbered after them, and named by the links they join.

        >>> Joints(("a", "b"), (Joint((0, 1)),)).names([1, 2])
        ('b', 'a-b')
        """
        count = len(self.links)
        return tuple(
            self.links[k] if k < count else "-".join(self.links[link] for link in self.joints[k - count].links)
            for k in numbers
        )

    def blocks(self) -> tuple[tuple[int, ...], ...]:
        """Return the links of each part that has a loop of its own."""
        found = []
        count = len(self.links)
        # joints are nodes after the links
        edges = [(link, count + k) for k, joint in enumerate(self.joints) for link in joint.links]
        for nodes in biconnected(count + len(self.joints), edges):
            links = tuple(sorted(node for node in nodes if node < count))
            if len(links) > 1 and len(nodes) > 2:
                found.append(links)
        return tuple(sorted(found))


def biconnected(nodes: int, edges: Iterable[tuple[int, int]]) -> list[set[int]]:
    """Return the blocks of a graph: the nodes of each greatest part that no single node separates.

    A node without an edge is in none, a node in several separates them.
    Source: J. Hopcroft and R. Tarjan, Efficient algorithms for graph manipulation, Comm. ACM 16 (1973) 372.

    >>> biconnected(5, [(0, 1), (1, 2), (2, 0), (2, 3)])
    [{2, 3}, {0, 1, 2}]
    """
    beside: list[list[int]] = [[] for _ in range(nodes)]
    for one, other in edges:
        beside[one].append(other)
        beside[other].append(one)
    depth, low = [-1] * nodes, [0] * nodes
    found: list[set[int]] = []
    path: list[_Visited] = []
    unassigned: list[int] = []

    def visit(node: int) -> None:
        depth[node] = low[node] = len(path)
        path.append(_Visited(node, len(unassigned), iter(beside[node])))
        unassigned.append(node)

    for root in range(nodes):
        if depth[root] < 0:
            visit(root)
        while path:
            node, first, ways = path[-1]
            other = next(ways, -1)
            if other >= 0 and depth[other] < 0:
                visit(other)
            elif other >= 0:
                # on the way back to the node above it, it reaches no farther than that
                low[node] = min(low[node], depth[other])
            else:
                path.pop()
                above = path[-1].node if path else node
                low[above] = min(low[above], low[node])
                if path and low[node] >= depth[above]:
                    found.append({above, *unassigned[first:]})
                    del unassigned[first:]
        unassigned.clear()
    return found


class _Visited(NamedTuple):
    """A node on the way from the root, how many nodes were in no block before it, and its edges not yet followed."""

    node: int
    first: int
    ways: Iterator[int]
