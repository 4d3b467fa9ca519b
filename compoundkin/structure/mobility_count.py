"""The mobility by the count of links and pairs, and the parts that a decomposed mechanism consists of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from compoundkin.base.display import count_phrase
from compoundkin.base.poses import Pose
from compoundkin.model.elements import Drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable


@dataclass(frozen=True)
class PairCount:
    """How many pairs of one kind there are. Its letter, what one of them holds, and their number."""

    code: str
    held: int
    number: int


@dataclass(frozen=True)
class Mobility:
    """The mobility by the count of Chebyshev and Gruebler. F = 3 (n - 1) - the sum of what the pairs hold.

    A multiple pin of k links counts as k - 1 pairs. Passive freedoms, such as a roller's spin, are no mobility:
    `passive` of them are subtracted.

    >>> count = Mobility(6, (PairCount("R", 2, 6), PairCount("P", 2, 1)), 1)
    >>> count.freedoms, count.is_determinate
    (1, True)
    >>> count.formula
    'F = 3 (n - 1) - 2 p = 3 (6 - 1) - 2 * 7 = 1, p = 6 R + 1 P'
    """

    links: int
    pairs: tuple[PairCount, ...]
    drivers: int
    passive: int = 0

    @property
    def freedoms(self) -> int:
        """The mobility F."""
        return 3 * (self.links - 1) - sum(count.held * count.number for count in self.pairs) - self.passive

    @property
    def is_determinate(self) -> bool:
        """Whether there are as many drivers as freedoms."""
        return self.drivers == self.freedoms

    @property
    def formula(self) -> str:
        """The count with its numbers substituted."""
        held = sorted({count.held for count in self.pairs}, reverse=True)
        total = {h: sum(c.number for c in self.pairs if c.held == h) for h in held}
        # a pair's index is the number of freedoms that it leaves
        letter = {h: "p" if len(held) == 1 else f"p{LINK_FREEDOMS - h}" for h in held}
        symbols = "".join(f" - {_times(h)}{letter[h]}" for h in held)
        numbers = "".join(f" - {h} * {total[h]}" if h > 1 else f" - {total[h]}" for h in held)
        kinds = [f", {letter[h]} = {self._kinds(h)}" for h in held]
        if self.passive:
            symbols, numbers = f"{symbols} - f0", f"{numbers} - {self.passive}"
            kinds.append(f", f0 = {count_phrase(self.passive, 'passive freedom')}")
        return f"F = 3 (n - 1){symbols} = 3 ({self.links} - 1){numbers} = {self.freedoms}{''.join(kinds)}"

    @property
    def verdict(self) -> str:
        """How the drivers compare with the freedoms, in a sentence.

        >>> Mobility(4, (PairCount("R", 2, 4),), 0).verdict
        'mobility 1 and no driver: 1 driver is missing'
        >>> Mobility(3, (PairCount("R", 2, 3),), 0).verdict
        'mobility 0 and no driver: a structure that does not move'
        """
        drivers = count_phrase(self.drivers, "driver") if self.drivers else "no driver"
        missing = self.freedoms - self.drivers
        outcome = "the motion is determined" if self.drivers else "a structure that does not move"
        if self.freedoms < 0 and not self.drivers:
            outcome = f"{count_phrase(-self.freedoms, 'constraint')} too many for a structure that just holds"
        elif missing:
            outcome = f"{count_phrase(abs(missing), 'driver')} {'is' if abs(missing) == 1 else 'are'} "
            outcome += "missing" if missing > 0 else "too many"
        return f"mobility {self.freedoms} and {drivers}: {outcome}"

    def _kinds(self, held: int) -> str:
        return " + ".join(f"{count.number} {count.code}" for count in self.pairs if count.held == held)


def mobility_of(mechanism: Mechanism, pairs: Sequence[Pair], passive: Sequence[Passive]) -> Mobility:
    """Return the mobility of a mechanism with all its pairs and passive freedoms. Multiple pins count one by one.

    What leads points and turns links adds nothing to it and is not counted.
    """
    numbers: dict[tuple[str, int], int] = {}
    for pair in pairs:
        numbers[pair.code, pair.held] = numbers.get((pair.code, pair.held), 0) + 1
    for letter, names in mechanism.pins.items():
        led = sum(name in mechanism.auxiliary_links for name in names)
        if led:
            kind = next((pair.code, pair.held) for pair in pairs if pair.letters == (letter,) and pair.free_is_angle)
            numbers[kind] -= led
    for pair in mechanism.written_pairs:
        if not mechanism.auxiliary_links.isdisjoint(pair.members):
            numbers[pair.code, pair.held] -= 1
    counts = tuple(PairCount(code, held, number) for (code, held), number in numbers.items() if number)
    return Mobility(len(mechanism.links) - len(mechanism.auxiliary_links), counts, len(mechanism.drives), len(passive))


def _times(held: int) -> str:
    return f"{held} " if held > 1 else ""


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

    @cached_property
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
