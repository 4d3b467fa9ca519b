"""Loops of four links in a mechanism: four pins, or three pins and a slide, in the order in which links are solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure


@dataclass(frozen=True)
class FourLinks:
    """A loop of four links. Each joins the next by a pin's letter, or once at most by a slide's name.

    The first is the frame, or where all move the one that is solved first; of its neighbours the second is solved
    before the fourth. `driven` is the one of the other three that is solved first, "" where none is before the rest.
    """

    links: tuple[str, str, str, str]
    joints: tuple[str, str, str, str]
    slide: str
    driven: str


def loops_of_four(structure: Structure) -> tuple[FourLinks, ...]:
    """Return all loops of four links, those with the frame first.

    >>> import compoundkin as ck
    >>> loops_of_four(ck.decompose(ck.catalog.load_named("slider-crank")))[0].links
    ('frame', 'crank', 'rod', 'piston')
    """
    order = _solved_in(structure)
    joined = _joined(structure.mechanism)
    slides = {pair.name for pair in structure.mechanism.written_pairs}
    place = {link: k for k, link in enumerate(joined)}
    found = [_as_solved(loop, order, slides) for loop in _cycles(joined, place) if _has_pins(loop, slides)]
    rank = {link: k for k, link in enumerate(structure.mechanism.links)}
    return tuple(sorted(found, key=lambda loop: (loop.links[0] != FRAME, [order[name] for name in loop.links],
                                                 [rank[name] for name in loop.links])))  # fmt: skip


def _solved_in(structure: Structure) -> dict[str, int]:
    """Tell when each link is solved: the frame and its driven links one by one, then the groups."""
    order = {link: k for k, link in enumerate(structure.ground.links)}
    for group in structure.groups:
        after = len(order)
        order.update(dict.fromkeys(group.links, after))
    return {FRAME: 0, **dict.fromkeys(structure.mechanism.links, len(order)), **order}


def _joined(mechanism: Mechanism) -> dict[str, list[tuple[str, str]]]:
    """Return which links each link is joined to, and by what."""
    joints = [(letter, links) for letter, links in mechanism.pins.items()]
    joints += [(p.name, p.members) for p in mechanism.written_pairs if p.is_simple and not p.free_is_angle]
    found: dict[str, list[tuple[str, str]]] = {link: [] for link in mechanism.links}
    for name, links in joints:
        for link in links:
            found[link] += [(other, name) for other in links if other != link]
    return found


def _cycles(
    joined: Mapping[str, list[tuple[str, str]]], place: Mapping[str, int]
) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Find every loop of four links once: from its first link on, to the earlier of that one's neighbours."""
    for first in joined:
        later = [(link, by) for link, by in joined[first] if place[link] > place[first]]
        # two steps from the first link to the one opposite
        across: dict[str, list[tuple[str, str, str]]] = {}
        for link, by in later:
            for other, next_by in joined[link]:
                if place[other] > place[first]:
                    across.setdefault(other, []).append((link, by, next_by))
        for opposite, ways in across.items():
            for k, (one, a, b) in enumerate(ways):
                for other, d, c in ways[k + 1 :]:
                    if one != other and len({a, b, c, d}) == 4:
                        yield (first, one, opposite, other), (a, b, c, d)


def _has_pins(loop: tuple[tuple[str, ...], tuple[str, ...]], slides: set[str]) -> bool:
    return sum(name in slides for name in loop[1]) <= 1


def _as_solved(loop: tuple[tuple[str, ...], tuple[str, ...]], order: Mapping[str, int], slides: set[str]) -> FourLinks:
    """Turn a loop so that its base comes first and then the earlier of its neighbours."""
    links, joints = loop
    k = min(range(4), key=lambda i: (links[i] != FRAME, order[links[i]], i))
    links, joints = links[k:] + links[:k], joints[k:] + joints[:k]
    if order[links[3]] < order[links[1]]:
        links, joints = (links[0], *links[:0:-1]), joints[::-1]
    when = sorted((order[name], name) for name in links[1:])
    driven = when[0][1] if when[0][0] < when[1][0] else ""
    slide = next((name for name in joints if name in slides), "")
    one, two, three, four = links
    a, b, c, d = joints
    return FourLinks((one, two, three, four), (a, b, c, d), slide, driven)
