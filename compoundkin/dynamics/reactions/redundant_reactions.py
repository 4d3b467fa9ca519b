"""Forces in a mechanism's own pairs, where only part of some was used because others hold what they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.wrenches import Wrench
from compoundkin.model.pairs import Pair
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Dropped


@dataclass(frozen=True)
class LeftOut:
    """What was left out of a pair, between two of its links.

    `way` are the mechanism's own pairs from the first to the second, each with its sign: several at a multiple pin.
    """

    dropped: Dropped
    first: str
    second: str
    way: tuple[tuple[Pair, float], ...]


def parts_left_out(structure: Structure) -> tuple[LeftOut, ...]:
    """Return what was left out of an overconstrained mechanism's pairs."""
    return tuple(_left_out(structure, one) for one in structure.relaxation.dropped) if structure.relaxation else ()


def own_wrenches(structure: Structure, wrenches: Mapping[str, Wrench], shape: tuple[int, int]) -> dict[str, Wrench]:
    """Return the wrenches of a mechanism's own pairs. What was kept of a pair is the force in it.

    Pairs without any have zeros of a shape.
    """
    found = {
        pair.name: wrenches.get(pair.name) or Wrench(np.zeros(shape, dtype=complex), np.zeros(shape))
        for pair in structure.pairs
    }
    for part in parts_left_out(structure):
        if part.dropped.kept is not None:
            add(found, part, wrenches[part.dropped.kept.name])
    return found


def add(wrenches: dict[str, Wrench], part: LeftOut, wrench: Wrench) -> None:
    """Add a wrench to the pairs between two links. It is on the second one."""
    for pair, sign in part.way:
        wrenches[pair.name] = wrenches[pair.name] + wrench.times(sign)


def _left_out(structure: Structure, dropped: Dropped) -> LeftOut:
    named = [pair for pair in structure.pairs if pair.name == dropped.name]
    if not dropped.off:
        first, second = named[0].members[:2] if dropped.kept is None else dropped.kept.members[:2]
        return LeftOut(dropped, first, second, ((named[0], 1.0 if second == named[0].members[1] else -1.0),))
    written = {pair.name for pair in structure.mechanism.written_pairs}
    pins = [pair for pair in structure.pairs if pair.name not in written and pair.letters[0] == dropped.name]
    if dropped.kept is not None:
        first, second = dropped.kept.members[:2]
    else:
        first, second = next(p.members for p in pins if sum(link in dropped.off for link in p.members) == 1)
    return LeftOut(dropped, first, second, tuple(_way(pins, first, second)))


def _way(pins: list[Pair], first: str, second: str) -> Iterator[tuple[Pair, float]]:
    """Yield the pairs of a pin from one of its links to another. They are a tree."""
    reached: dict[str, tuple[tuple[Pair, float], ...]] = {first: ()}
    while second not in reached:
        for pair in pins:
            one, two = pair.members
            if one in reached and two not in reached:
                reached[two] = (*reached[one], (pair, 1.0))
            elif two in reached and one not in reached:
                reached[one] = (*reached[two], (pair, -1.0))
    yield from reached[second]
