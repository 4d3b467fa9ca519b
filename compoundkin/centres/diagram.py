"""The circle diagram: which links there are, and which of their centres the pairs give; no dimensions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from compoundkin.pairs import Pair
from compoundkin.pairs.contract import Line
from compoundkin.poses import FIXED
from compoundkin.series import Number
from compoundkin.structure.model import DrivenPair, Structure

Couple = tuple[int, int]


@dataclass(frozen=True)
class Primary:
    """A pair as a side of the circle diagram: every two of `links` have their centre there.

    `kind` is "point", "ideal" (a point at infinity) or "line"; `pair` is the name of the pair that places it.
    """

    text: str
    pair: str
    links: tuple[int, ...]
    kind: str


@dataclass(frozen=True)
class Driven:
    """A driven pair: `primary` moves link `second` relative to link `first` at the driver's rate times `sign`."""

    driver: str
    first: int
    second: int
    primary: int
    sign: int


@dataclass(frozen=True)
class Diagram:
    """Links and pairs alone: two mechanisms with equal diagrams have the same derivation of centres."""

    links: tuple[str, ...]
    primaries: tuple[Primary, ...]
    drives: tuple[Driven, ...]

    @property
    def couples(self) -> tuple[Couple, ...]:
        """Every two links, by index: one centre each."""
        return tuple(combinations(range(len(self.links)), 2))

    @cached_property
    def edges(self) -> tuple[tuple[int, int, int], ...]:
        """(first link, second link, primary): each pair once, a pin of k links k - 1 times."""
        return tuple((p.links[0], other, k) for k, p in enumerate(self.primaries) for other in p.links[1:])

    def generic(self) -> list[Number]:
        """Random homogeneous coordinates for every primary, of its kind; the same ones every time."""
        rng = np.random.default_rng(len(self.links))
        return [_unit(rng.standard_normal(3), p.kind) for p in self.primaries]


def couple(i: int, j: int) -> Couple:
    """The two links in the order in which they are written.

    >>> couple(3, 1)
    (1, 3)
    """
    return (i, j) if i < j else (j, i)


def diagram_of(structure: Structure) -> Diagram:
    """The circle diagram of a structure, with the pairs' centres as its known sides.

    >>> from compoundkin.mechanism import Mechanism
    >>> from compoundkin.words import drive, link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0), link("crank", A=0, B=1)
    >>> diagram_of(decompose(Mechanism("m", *bars, drive("crank")))).primaries
    (Primary(text='pin A', pair='A', links=(0, 1), kind='point'),)
    """
    links = tuple(structure.mechanism.links)
    number = {name: k for k, name in enumerate(links)}
    primaries = tuple(_primaries(structure, number))
    bodies = (structure.ground, *(body for group in structure.groups for body in group.bodies))
    drives = {d.drive.name: d for body in bodies for d in body.driven}
    ordered = [drives[d.name] for d in structure.mechanism.drives if d.name in drives]
    return Diagram(links, primaries, tuple(_driven(d, primaries, number) for d in ordered))


def _primaries(structure: Structure, number: dict[str, int]) -> Iterator[Primary]:
    written = {pair.name for pair in structure.mechanism.written_pairs}
    by_letter = {pair.letters[0]: pair for pair in structure.pairs if pair.name not in written}
    for letter, carriers in structure.mechanism.pins.items():
        pair = by_letter[letter]
        yield Primary(f"pin {letter}", pair.name, tuple(number[name] for name in carriers), _kind(pair))
    for pair in structure.mechanism.written_pairs:
        if _kind(pair):
            members = tuple(number[name] for name in pair.members[:2])
            yield Primary(f"{pair.title} {pair.name}", pair.name, members, _kind(pair))


def _kind(pair: Pair) -> str:
    """What the pair says about the centre, asked at random geometry; "" where it says nothing."""
    centre = pair.centre(pair.generic(np.random.default_rng(0)), (FIXED, FIXED))
    if centre is None:
        return ""
    if isinstance(centre, Line):
        return "line"
    return "ideal" if np.all(centre.w == 0.0) else "point"


def _driven(driven: DrivenPair, primaries: tuple[Primary, ...], number: dict[str, int]) -> Driven:
    first, second = (number[name] for name in driven.pair.members[:2])
    at = next(k for k, p in enumerate(primaries) if _places(p, driven.pair) and {first, second} <= set(p.links))
    return Driven(driven.drive.name, first, second, at, driven.pair.driven_by(driven.drive.link))


def _places(primary: Primary, pair: Pair) -> bool:
    return primary.pair == pair.name or primary.text == f"pin {pair.letters[0]}"


def _unit(vector: Number, kind: str) -> Number:
    if kind == "ideal":
        vector[2] = 0.0
    return vector / np.linalg.norm(vector)
