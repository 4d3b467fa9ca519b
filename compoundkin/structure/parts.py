"""The parts of a mechanism that is taken apart. Composite links, Assur groups, passive freedoms, faults."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from compoundkin.base.poses import Pose
from compoundkin.model.elements import Drive
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable

# How many freedoms a link has in the plane.
LINK_FREEDOMS = 3
# So many links are named where a group is printed.
SHOWN_LINKS = 8


@dataclass(frozen=True)
class DrivenPair:
    """One driven pair inside a composite link. `link` is placed from `parent` by the driver's value.

    A passive freedom, such as the spin of a roller, is held at zero as by a driver that nobody wrote: `is_passive`.
    """

    drive: Drive
    pair: Drivable
    parent: str
    link: str
    is_passive: bool = False


@dataclass(frozen=True)
class Body:
    """A composite link of links joined by driven pairs, `links[0]` its base.

    Most bodies are a single link.
    """

    links: tuple[str, ...]
    driven: tuple[DrivenPair, ...] = ()


@dataclass(frozen=True, repr=False)
class Group:
    """An Assur group with its bodies, its inner pairs and its outer pairs.

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
        """The links outside that it is attached to, by its outer pairs."""
        own = set(self.links)
        known = [link for pair in (*self.outer, *self.inner) for link in pair.members if link not in own]
        return tuple(dict.fromkeys(known))

    def __repr__(self) -> str:
        attached = f" on {', '.join(self.uses)}" if len(self.links) <= SHOWN_LINKS else ""
        links = ", ".join(self.links[:SHOWN_LINKS]) + (" ..." if len(self.links) > SHOWN_LINKS else "")
        return f"Group({self.name!r}: {links}{attached})"


@dataclass(frozen=True)
class Passive:
    """A freedom that moves nothing else. `link` may turn about the pin `at` on the link `on`, as a roller does."""

    link: str
    on: str
    at: str

    def __str__(self) -> str:
        return f"{self.link} may turn about {self.at} on {self.on} without moving anything else"


@dataclass(frozen=True)
class Fault:
    """A part that is over- or under-constrained. Which links, by how much, and what to add or remove."""

    kind: str  # "over", "under"
    links: tuple[str, ...]
    amount: int
    text: str
    remedy: str


@dataclass(frozen=True)
class Dropped:
    """Part of a redundant pair that is left out when a mechanism is solved.

    `name` is the letter of a pin, taken off there are the links `off`, all of one body; or the name of a written
    pair. What it still holds is the pair `kept`, None where that is nothing; `freed` says in words what is left out.
    """

    name: str
    off: tuple[str, ...]
    kept: Pair | None
    freed: str

    def __str__(self) -> str:
        return f"{self.name} {self.freed}"


@dataclass(frozen=True)
class Relaxation:
    """What is dropped of a mechanism that moves though it is overconstrained. An assembled pose by points and links.

    The pose is the drawn one made exact, or one that was found where nothing is drawn.
    """

    dropped: tuple[Dropped, ...]
    places: Mapping[str, complex] = field(default_factory=dict)
    poses: Mapping[str, Pose] = field(default_factory=dict)
