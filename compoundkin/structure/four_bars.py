"""Four-bar loops of pins: which of them a dyad of three pins closes, whatever order anything is written in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Group


@dataclass(frozen=True)
class Place:
    """A point of a link."""

    link: str
    letter: str


@dataclass(frozen=True)
class FourBarLoops:
    """The loops of four pins that a dyad closes.

    They have its outer pins, in its own order, and the pins opposite its inner one. Most dyads close one such loop; on
    multiple pins it may be several, which differ in the last pin only.
    """

    first: Place
    second: Place
    opposite: tuple[Place, ...]


def four_bar_loops(structure: Structure) -> Mapping[int, FourBarLoops]:
    """Return the four-bar loops of pins that dyads close, by the groups' indices.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.structure import decompose
    >>> links = link("frame", "A", "D"), link("crank", "A", "B"), link("coupler", "B", "C"), link("rocker", "C", "D")
    >>> loops = four_bar_loops(decompose(Mechanism("m", *links, drive("crank"))))[0]
    >>> [place.letter for place in loops.opposite]
    ['A']
    """
    before = set(structure.ground.links)
    found: dict[int, FourBarLoops] = {}
    for k, group in enumerate(structure.groups):
        loops = _closed_by(structure, group, before)
        if loops is not None:
            found[k] = loops
        before.update(group.links)
    return found


def _closed_by(structure: Structure, group: Group, before: set[str]) -> FourBarLoops | None:
    """Return the loops of four pins that a group closes with two links solved before it. None where there is none."""
    if len(group.bodies) != 2 or not all(
        pair.is_simple and pair.free_is_angle for pair in (*group.inner, *group.outer)
    ):
        return None
    inner = set(group.inner[0].members)
    if not all(
        inner & set(pair.members) & set(body.links) for pair, body in zip(group.outer, group.bodies, strict=True)
    ):
        return None  # a link of changing shape has a driven pair between its two pins
    carriers, links = structure.mechanism.carriers, structure.mechanism.links
    first, second = (pair.letters[0] for pair in group.outer)
    opposite = {
        letter: Place(link, letter)
        for link in carriers[first]
        for other in carriers[second]
        if link != other and before.issuperset((link, other))
        for letter in links[link].points
        if letter in links[other].points and letter not in (first, second)
    }
    if not opposite:
        return None
    one, two = (next(Place(link, letter) for link in carriers[letter] if link in before) for letter in (first, second))
    return FourBarLoops(one, two, tuple(opposite[letter] for letter in sorted(opposite)))
