"""The circle diagram of links and of the centres that pairs give. No dimensions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Line, as_turn_counting
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import DrivenPair

Couple = tuple[int, int]


@dataclass(frozen=True)
class Primary:
    """A pair as a side of the circle diagram. Every two of `links` have their centre there.

    `kind` is "point", "ideal" (a point at infinity), "line", or "weld" for two links that do not move relative to each
    other; `pair` is the name of the pair that places it. A pitch point lies on the line of the two primaries `on`.
    """

    text: str
    pair: str
    links: tuple[int, ...]
    kind: str
    on: tuple[int, ...] = ()


@dataclass(frozen=True)
class DrivenCentre:
    """A driven pair that moves `second` relative to `first` about `primary`.

    Its rate is the driver's rate times `sign`.
    """

    driver: str
    first: int
    second: int
    primary: int
    sign: int


@dataclass(frozen=True)
class Diagram:
    """Links and pairs alone. Two mechanisms with equal diagrams have the same derivation of centres."""

    links: tuple[str, ...]
    primaries: tuple[Primary, ...]
    drives: tuple[DrivenCentre, ...]

    @property
    def couples(self) -> tuple[Couple, ...]:
        """Every two links, by index: one centre each."""
        return tuple(combinations(range(len(self.links)), 2))

    @cached_property
    def edges(self) -> tuple[tuple[int, int, int], ...]:
        """(first link, second link, primary). Each pair once, a pin of k links k - 1 times."""
        return tuple((p.links[0], other, k) for k, p in enumerate(self.primaries) for other in p.links[1:])

    def generic(self) -> list[Number]:
        """Draw random homogeneous coordinates for every primary, of its kind. They are the same every time."""
        rng = np.random.default_rng(len(self.links))
        places = [_unit(rng.standard_normal(3), p.kind) for p in self.primaries]
        for k, primary in enumerate(self.primaries):
            if primary.on:
                one, two = (places[j] for j in primary.on)
                places[k] = _unit(one * rng.standard_normal() + two * rng.standard_normal(), primary.kind)
        return places


def couple(i: int, j: int) -> Couple:
    """Return the two links in the order in which they are written.

    >>> couple(3, 1)
    (1, 3)
    """
    return (i, j) if i < j else (j, i)


def diagram_of(structure: Structure) -> Diagram:
    """Return a structure's circle diagram, with the pairs' centres as known sides.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0), link("crank", A=0, B=1)
    >>> diagram_of(decompose(Mechanism("m", *bars, drive("crank")))).primaries
    (Primary(text='pin A', pair='A', links=(0, 1), kind='point', on=()),)
    """
    links = tuple(structure.mechanism.links)
    number = {name: k for k, name in enumerate(links)}
    primaries = tuple(_on_lines(tuple(_primaries(structure, number)), structure, number))
    ordered = [structure.driven[d.name] for d in structure.mechanism.drives if d.name in structure.driven]
    return Diagram(links, primaries, tuple(_driven(d, primaries, number) for d in ordered))


def _primaries(structure: Structure, number: dict[str, int]) -> Iterator[Primary]:
    written = {pair.name for pair in structure.mechanism.written_pairs}
    by_letter = {pair.letters[0]: pair for pair in structure.pairs if pair.name not in written}
    still = {spin.link: spin for spin in structure.passive}
    dropped = structure.relaxation.dropped if structure.relaxation else ()
    for letter, carriers in structure.mechanism.pins.items():
        pair = by_letter[letter]
        off = tuple(part.off for part in dropped if part.name == letter and part.off)
        for on_pin in _apart(carriers, off):
            moving = [name for name in on_pin if name not in still or still[name].at != letter]
            if len(moving) > 1:
                yield Primary(f"pin {letter}", pair.name, tuple(number[name] for name in moving), _kind(pair))
    for spin in structure.passive:
        text = f"pin {spin.at}, passive"
        yield Primary(text, by_letter[spin.at].name, (number[spin.on], number[spin.link]), "weld")
    left_out = {part.name for part in dropped if not part.off}
    kept = [part.kept for part in dropped if part.kept is not None]
    for pair in (*(pair for pair in structure.mechanism.written_pairs if pair.name not in left_out), *kept):
        if _kind(pair):
            members = tuple(number[name] for name in pair.members[:2])
            yield Primary(f"{pair.title} {pair.name}", pair.name, members, _kind(pair))


def _apart(carriers: tuple[str, ...], off: tuple[tuple[str, ...], ...]) -> list[tuple[str, ...]]:
    """Return the links on a pin. Those that are taken off it because others hold them already, on their own."""
    taken = {name for links in off for name in links}
    return [tuple(name for name in carriers if name not in taken), *off]


def _on_lines(primaries: tuple[Primary, ...], structure: Structure, number: dict[str, int]) -> Iterator[Primary]:
    """Yield the primaries, each pitch point with the centres on its line.

    That is where one link, such as the carrier of two gears, has a pair with both.
    """
    turning = {pair.name for pair in structure.mechanism.written_pairs if as_turn_counting(pair) and pair.held == 1}
    for primary in primaries:
        on: tuple[int, ...] = ()
        if primary.pair in turning:
            a, b = primary.links
            carriers = (number[name] for name in structure.mechanism.links)
            found = ((_joining(primaries, a, c), _joining(primaries, c, b)) for c in carriers if c not in (a, b))
            on = next(((j, k) for j, k in found if j is not None and k is not None and j != k), ())
        yield replace(primary, on=on)


def _joining(primaries: tuple[Primary, ...], a: int, b: int) -> int | None:
    """Return the first primary centre of two links."""
    kinds = ("point", "ideal")
    return next((k for k, p in enumerate(primaries) if p.kind in kinds and {a, b} <= set(p.links)), None)


def _kind(pair: Pair) -> str:
    """Say what the pair says about the centre, asked at random geometry. "" where it says nothing."""
    ends = pair.generic(np.random.default_rng(0))
    centre = pair.centre(ends, (FIXED,) * len(ends))
    if isinstance(centre, Line):
        return "line"
    return "ideal" if np.all(centre.w == 0.0) else "point"


def _driven(driven: DrivenPair, primaries: tuple[Primary, ...], number: dict[str, int]) -> DrivenCentre:
    first, second = (number[name] for name in driven.pair.members[:2])
    at = next(k for k, p in enumerate(primaries) if _places(p, driven.pair) and {first, second} <= set(p.links))
    return DrivenCentre(driven.drive.name, first, second, at, driven.pair.driven_by(driven.drive.link))


def _places(primary: Primary, pair: Pair) -> bool:
    return primary.pair == pair.name or primary.text == f"pin {pair.letters[0]}"


def _unit(vector: Number, kind: str) -> Number:
    if kind == "ideal":
        vector[2] = 0.0
    return vector / np.linalg.norm(vector)
