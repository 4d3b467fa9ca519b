"""Composite links: links joined by driven pairs move as one body of varying geometry."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from compoundkin.model.definition import Pins, driven_pair
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Drivable
from compoundkin.structure.cycles import find
from compoundkin.structure.mobility_count import Body, DrivenPair, Passive

GROUND = -1


@dataclass(frozen=True)
class Composites:
    """The bodies of a mechanism. The ground, the moving ones in input order, and what closes on itself.

    `body_of` maps each link to the index of its moving body, or to GROUND. `closing` are the drives whose
    links other drives join already. A link with a passive freedom is one body with the link it is pinned to.
    """

    ground: Body
    moving: tuple[Body, ...]
    pins: Pins
    body_of: dict[str, int]
    closing: tuple[Drive, ...]
    passive: tuple[Passive, ...]

    def body(self, index: int) -> Body:
        """Return the body of an index as in `body_of`."""
        return self.ground if index == GROUND else self.moving[index]


def composites(mechanism: Mechanism) -> Composites:
    """Return the bodies that the drives make of the links."""
    neighbours: dict[str, list[DrivenPair]] = {name: [] for name in mechanism.links}
    leader = {name: name for name in mechanism.links}
    pins = Pins(mechanism)
    closing = []
    for drive in mechanism.drives:
        if not _join(leader, drive.on, drive.link):
            closing.append(drive)
            continue
        pair: Drivable = driven_pair(pins, drive)
        neighbours[drive.on].append(DrivenPair(drive, pair, drive.on, drive.link))
        neighbours[drive.link].append(DrivenPair(drive, pair, drive.link, drive.on))
    passive = tuple(passive_freedoms(mechanism))
    for spin in passive:
        pair = pins.pair(spin.at, spin.on, spin.link)
        drive = Drive(spin.link, spin.link, spin.on, spin.at, 0.0, 0.0)
        neighbours[spin.on].append(DrivenPair(drive, pair, spin.on, spin.link, is_passive=True))
        neighbours[spin.link].append(DrivenPair(drive, pair, spin.link, spin.on, is_passive=True))
    ground = _outward(FRAME, neighbours)
    body_of = dict.fromkeys(ground.links, GROUND)
    moving: list[Body] = []
    for name in mechanism.links:
        if name not in body_of:
            body = _outward(name, neighbours)
            body_of.update(dict.fromkeys(body.links, len(moving)))
            moving.append(body)
    return Composites(ground, tuple(moving), pins, body_of, tuple(closing), passive)


def passive_freedoms(mechanism: Mechanism) -> Iterator[Passive]:
    """Yield the links that may turn about their only pin without moving anything.

    Not those that a driver turns.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> list(passive_freedoms(Mechanism("m", link("frame", A=0), link("crank", A=0, B=1))))
    []
    """
    driven = {name for drive in mechanism.drives for name in (drive.link, drive.on)}
    written: dict[str, list[str | None]] = {}
    for pair in mechanism.written_pairs:
        for name in pair.members:
            written.setdefault(name, []).append(pair.round_at(name))
    for name, places in written.items():
        pins = list(mechanism.pins_on[name])
        if name not in driven and name != FRAME and len(pins) == 1 and set(places) == set(pins):
            on = next(other for other in mechanism.pins[pins[0]] if other != name)
            yield Passive(name, on, pins[0])


def spanned(body: Body, links: Iterable[str]) -> tuple[DrivenPair, ...]:
    """Return the driven pairs of a composite that lie between some of its links."""
    below = dict.fromkeys(body.links, 0)
    wanted = [name for name in dict.fromkeys(links) if name in below]
    for name in wanted:
        below[name] = 1
    found = []
    for step in reversed(body.driven):
        if 0 < below[step.link] < len(wanted):
            found.append(step)
        below[step.parent] += below[step.link]
    return tuple(reversed(found))


def _outward(base: str, neighbours: dict[str, list[DrivenPair]]) -> Body:
    if not neighbours[base]:
        return Body((base,))
    links, driven = {base: None}, []
    queue = deque([base])
    while queue:
        for step in neighbours[queue.popleft()]:
            if step.link not in links:
                links[step.link] = None
                driven.append(step)
                queue.append(step.link)
    return Body(tuple(links), tuple(driven))


def _join(leader: dict[str, str], a: str, b: str) -> bool:
    """Unite two sets of links; False if they are one already."""
    a, b = find(leader, a), find(leader, b)
    leader[b] = a
    return a != b
