"""What `decompose` finds: composite links, Assur groups in solving order, mobility, loops and faults."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from compoundkin.mechanism import Mechanism
from compoundkin.pairs import Pair
from compoundkin.words import Drive

if TYPE_CHECKING:
    import networkx as nx

    from compoundkin.structure.loops import Loop
    from compoundkin.structure.mobility import Mobility


@dataclass(frozen=True)
class DrivenPair:
    """One driven pair inside a composite link: `link` is placed from `parent` by the driver's value.

    A passive freedom, such as the spin of a roller, is held at zero as by a driver that nobody wrote: `is_passive`.
    """

    drive: Drive
    pair: Pair
    parent: str
    link: str
    is_passive: bool = False


@dataclass(frozen=True)
class Body:
    """A composite link: links joined by driven pairs, `links[0]` the base, `driven` leading out from it.

    Most bodies are a single link.
    """

    links: tuple[str, ...]
    driven: tuple[DrivenPair, ...] = ()


@dataclass(frozen=True)
class Group:
    """An Assur group: its bodies, its inner pairs and the outer pairs that attach it to what is solved.

    `name` is the pairs' letters (RRR, RRP ...; inner and outer letters for a larger group). A dyad's
    `bodies[k]` carries `outer[k]`. A pair's members are links; an outer pair has one member in the group.
    """

    bodies: tuple[Body, ...]
    inner: tuple[Pair, ...]
    outer: tuple[Pair, ...]
    name: str
    class_: int
    order: int

    @property
    def links(self) -> tuple[str, ...]:
        """All its links."""
        return tuple(link for body in self.bodies for link in body.links)

    @property
    def uses(self) -> tuple[str, ...]:
        """The links outside that it is attached to, in the order of its outer pairs."""
        own = set(self.links)
        known = [link for pair in (*self.outer, *self.inner) for link in pair.members if link not in own]
        return tuple(dict.fromkeys(known))


@dataclass(frozen=True)
class Passive:
    """A freedom that moves nothing else: `link` may turn about the pin `at` on the link `on`, as a roller does."""

    link: str
    on: str
    at: str

    def __str__(self) -> str:
        return f"{self.link} may turn about {self.at} on {self.on} without moving anything else"


@dataclass(frozen=True)
class Fault:
    """A part that is over- or under-constrained: which links, by how much, and what to add or remove."""

    kind: str  # "over", "under"
    links: tuple[str, ...]
    amount: int
    text: str
    remedy: str


@dataclass(frozen=True)
class Structure:
    """A mechanism taken apart: the frame with its driven links, then the Assur groups in solving order.

    `pairs` lists every pair, a multiple pin of k links as k - 1 of them. Where `faults` is not empty the
    mechanism cannot be solved, and `groups` holds what could be decomposed.
    """

    mechanism: Mechanism
    pairs: tuple[Pair, ...]
    ground: Body
    groups: tuple[Group, ...]
    mobility: Mobility
    faults: tuple[Fault, ...]
    passive: tuple[Passive, ...] = ()

    @cached_property
    def graph(self) -> nx.MultiGraph:
        """The kinematic graph: links are nodes, pairs are edges keyed by their names."""
        from compoundkin.structure.graph import kinematic_graph

        return kinematic_graph(self)

    @cached_property
    def loops(self) -> tuple[Loop, ...]:
        """A short basis of independent loops."""
        from compoundkin.structure.loops import independent_loops

        return independent_loops(self)
