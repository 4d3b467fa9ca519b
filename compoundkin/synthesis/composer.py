"""Mechanisms composed as theory has it: the frame, driven links, then Assur groups one after another.

Source: L. V. Assur, Investigation of plane hinged mechanisms, 1914: attaching a group changes no mobility.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, NamedTuple, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics.groups import DYADS
from compoundkin.model.elements import drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME, vector
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.synthesis.chains import AssurGroup, assur_group
from compoundkin.synthesis.chains.joints import REVOLUTE, SLIDE
from compoundkin.synthesis.chains.skeletons import layout, lettered

_TOWARD = " toward "
DYAD_NAMES = tuple(DYADS)


class AttachmentPoint(NamedTuple):
    """A point of attachment: a link, a point on it, and for a guide a second one; "" for new points."""

    link: str
    point: str = ""
    toward: str = ""


@dataclass
class _GroupPair:
    """A pair of a group: its letter, the two links (the first carries the guide), its points."""

    code: str
    first: str
    second: str
    point: str = ""
    toward: str = ""


@dataclass
class LetteredLinks:
    """Links by name with the letters of their points. Links that share a letter are pinned there.

    Points without a name get the letters A, B, C, ...
    """

    links: dict[str, list[str]] = field(default_factory=lambda: {FRAME: []}, kw_only=True)
    places: dict[str, complex] = field(default_factory=dict, kw_only=True)
    carriers: dict[str, list[str]] = field(default_factory=dict, kw_only=True)
    guiding: dict[str, int] = field(default_factory=dict, kw_only=True)
    _letters: Iterator[str] = field(default_factory=lambda: _endless(), kw_only=True)

    def place(self, **points: Any) -> Self:
        """Place points in the drawing: ``place(A=(0, 0), B=3+1j)``, before or after their use.

        Raises InvalidMechanism for an invalid point.

        >>> LetteredLinks().place(A=(0, 1)).places
        {'A': 1j}
        """
        self.places.update({letter: complex(vector(f"place.{letter}", p)) for letter, p in points.items()})
        return self

    def point(self, on: str, letter: str) -> Self:
        """Add a point to a link: a tracing point, or one to place.

        >>> LetteredLinks().point("frame", "A").links
        {'frame': ['A']}
        """
        self.carry(self.link(on), letter)
        return self

    def link(self, name: str) -> str:
        """Return the name of a link. Raises UnknownName for an unknown one."""
        if name not in self.links:
            raise UnknownName(Problem(name, "there is no such link yet", suggestion(name, list(self.links))))
        return name

    def new_links(self, names: Sequence[str], wanted: int, where: str) -> None:
        """Add links without points. Raises InvalidInput for a wrong number of them, or a used name."""
        if isinstance(names, str) or len(names) != wanted:
            raise InvalidInput(Problem("links", f"{where} has {wanted} links", f"name {wanted} new links"))
        for name in names:
            if name in self.links or list(names).count(name) > 1:
                raise InvalidInput(Problem("links", f"there is a link {name!r} already", "name new links"))
        self.links.update({name: [] for name in names})

    def carry(self, name: str, letter: str) -> str:
        """Put a point on a link, a new one without a letter."""
        letter = letter or next(k for k in self._letters if k not in self.carriers and k not in self.places)
        if letter in self.links[name]:
            return letter
        if letter in self.carriers:
            others = self.carriers[letter]
            what = f"{letter} is a point of {' and '.join(others)}, not of {name}"
            remedy = f"attach to {others[0]} there, or take a letter that is not in use"
            raise InvalidInput(Problem(f"{letter}{ON}{name}", what, remedy))
        return self.share(name, letter)

    def share(self, name: str, letter: str) -> str:
        """Put a point on a link that others may share: a pin."""
        self.carriers.setdefault(letter, []).append(name)
        self.links[name].append(letter)
        return letter

    def free(self, name: str) -> str:
        """Return a point of a link without a joint, or ""."""
        alone = (k for k in self.links[name] if len(self.carriers[k]) == 1 and k not in self.guiding)
        return next(alone, "")

    def placed(self) -> dict[str, complex]:
        """Return the places of all points, generic ones around the placed points for the others."""
        letters = list(dict.fromkeys(letter for carried in self.links.values() for letter in carried))
        number = {letter: k for k, letter in enumerate(letters)}
        generic = layout(len(letters), [[number[k] for k in carried] for carried in self.links.values()])
        given = np.array(list(self.places.values()))
        middle = complex(np.mean(given)) if given.size else 0j
        size = float(np.max(np.abs(given - middle))) if given.size > 1 else 1.0
        return {letter: self.places.get(letter, middle + (size or 1.0) * generic[number[letter]]) for letter in letters}


@dataclass(repr=False)
class Composer(LetteredLinks):
    """Builds a mechanism group by group; `mechanism()` is the result, as drawn.

    Points without a name get the letters A, B, C, ...; points without a place get generic ones, so that the mechanism
    always assembles as drawn.

    >>> composer = Composer("Six-bar")
    >>> composer.drive("crank").attach("RRR", ("coupler", "rocker"), to=("crank", "frame")).mechanism()
    Mechanism('Six-bar': 4 links, 1 driver)
    """

    title: str
    _slides: list[dict[str, Any]] = field(default_factory=list)
    _drives: list[dict[str, Any]] = field(default_factory=list)

    def __repr__(self) -> str:
        return f"Composer({self.title!r}: {len(self.links)} links)"

    def drive(self, name: str, to: str = FRAME, pair: str = REVOLUTE, **words: Any) -> Composer:
        """Add a driven link, pinned (`pair` "R") or sliding ("P") on the frame or another link.

        `to` is a link, or ``"A on frame"``; `words` are those of `drive` without the links. Raises InvalidInput for
        another pair or a used name, UnknownName for an unknown link.

        >>> Composer("m").drive("crank", "A on frame").links
        {'frame': ['A'], 'crank': ['A']}
        """
        place = self._place(to)
        self.new_links((name,), 1, "drive")
        if pair not in (REVOLUTE, SLIDE):
            raise InvalidInput(Problem("pair", f"{pair!r} is no pair to drive", f"known: {REVOLUTE}, {SLIDE}"))
        letter = self._write(_GroupPair(pair, place.link, name, place.point, place.toward))
        self._drives.append({"link": name, "on": place.link, "pair": letter, **words})
        return self

    def attach(
        self, group: str | AssurGroup, links: Sequence[str], to: Sequence[str], at: Sequence[str] = ()
    ) -> Composer:
        """Attach an Assur group: a dyad by its letters, or a group of revolute pairs of the atlas by its name.

        `links` name its links, those of a larger group in the order of its numbering. `to` has one entry for each outer
        pair: a link, ``"B on crank"``, or for a guide ``"E toward F on frame"``. `at` may
        name the points of its inner pairs. An outer slide has its guide on the known link, an inner one on the first.

        Raises UnknownName for an unknown group or link, InvalidInput for wrong numbers of entries.

        >>> composer = Composer("Class III").drive("a").drive("b").drive("c")
        >>> _ = composer.attach("4-link group 2", ("base", "x", "y", "z"), to=("a", "b", "c"))
        >>> composer.mechanism().pins["G"]
        ('base', 'z')
        """
        pairs, outer, size = pairs_of(group)
        self.new_links(links, size, str(group))
        places = [self._place(entry) for entry in to]
        inner = [pair for pair in pairs if None not in pair[1:]]
        _fits("to", len(places), outer, "outer pairs")
        if at:
            _fits("at", len(at), len(inner), "inner pairs")
        outside, written = iter(places), []
        named = iter(at or [""] * len(inner))
        for code, first, second in pairs:
            place = (
                next(outside) if first is None else AttachmentPoint(links[first], *next(named).partition(_TOWARD)[::2])
            )
            written.append(_GroupPair(code, place.link, links[second], place.point, place.toward))
        # pins first: a slide then runs at the pin of its block
        for pair in sorted(written, key=lambda pair: pair.code != REVOLUTE):
            self._write(pair)
        return self

    def mechanism(self, **words: Any) -> Mechanism:
        """Return the composed mechanism, as drawn. `words` are those of `Mechanism`, such as `unit`.

        Raises InvalidMechanism for impossible places, such as two pins of a link at one.

        >>> Composer("m").drive("crank").mechanism(unit="mm").unit
        'mm'
        """
        for driven in [fields["link"] for fields in self._drives]:
            if len(self.links[driven]) == 1:
                # the angle of a driven link needs two points
                self.carry(driven, "")
        places = self.placed()
        items: list[Item] = [link(name, *letters) for name, letters in self.links.items() if letters]
        items += [slide(**fields) for fields in self._slides]
        items += [drive(**self._driver(fields, places)) for fields in self._drives]
        return Mechanism(self.title, *items, drawn(**places), **words)

    def _place(self, text: str) -> AttachmentPoint:
        """Return the attachment "crank", "B on crank" or "E toward F on frame"."""
        if text in self.links:
            return AttachmentPoint(text)
        points, on, name = text.partition(ON)
        if not on:
            points, name = "", text
        point, _, toward = points.partition(_TOWARD)
        return AttachmentPoint(self.link(name), point.strip(), toward.strip())

    def _write(self, pair: _GroupPair) -> str:
        """Add a pair; return its letter, or the name of the slide."""
        if pair.code == REVOLUTE:
            return self.share(pair.second, self.carry(pair.first, pair.point or self.free(pair.first)))
        block = self.links[pair.second]
        at = block[0] if block else self.carry(pair.second, "")
        through = self.carry(pair.first, pair.point or self.free(pair.first))
        toward = self.carry(pair.first, pair.toward)
        self._slides.append({"link": pair.second, "on": pair.first, "at": at, "through": through, "toward": toward})
        for letter in (at, through, toward):
            self.guiding[letter] = self.guiding.get(letter, 0) + 1
        if len(block) == 1 and self.guiding[at] > 1:
            # a block with two guides needs a direction, that is two points
            self.carry(pair.second, "")
        return f"{pair.second}/{pair.first}"

    def _driver(self, words: dict[str, Any], places: dict[str, complex]) -> dict[str, Any]:
        """Return the arguments of a driver; a slide without values stays as drawn."""
        written = next((s for s in self._slides if f"{s['link']}/{s['on']}" == words["pair"]), None)
        if written is None or "values" in words:
            return words
        at, through, toward = (places[written[key]] for key in ("at", "through", "toward"))
        along = (toward - through) / abs(toward - through)
        return {**words, "values": ((at - through) * along.conjugate()).real}


def pairs_of(group: str | AssurGroup) -> tuple[list[tuple[str, int | None, int]], int, int]:
    """Return a group's pairs as code, first body (None: outside) and second; the number of outer pairs and of links."""
    if isinstance(group, str) and group in DYADS:
        return [(group[0], None, 0), (group[1], 0, 1), (group[2], None, 1)], 2, 2
    found = assur_group(group, [*DYADS]) if isinstance(group, str) else group
    return [(REVOLUTE, *ends) for ends in found.joined], found.outer, found.links


@checked
def random_mechanism(
    groups: int = 1000, seed: int = 0, kinds: Sequence[str | AssurGroup] = DYAD_NAMES, multiple: float = 0.2
) -> Mechanism:
    """Return a crank with so many random groups, the same for the same seed.

    A share `multiple` of outer pins joins existing pins. Links of group k are "k-0", "k-1", ... It assembles as drawn,
    where the crank stays, but perhaps not far from there. Raises InvalidInput for a negative number of groups,
    UnknownName for an unknown kind.

    >>> random_mechanism(groups=3, seed=1)
    Mechanism('3 random groups, seed 1': 8 links, 1 driver)
    """
    if groups < 0:
        raise InvalidInput(Problem("groups", f"{groups} is no number of groups", "give 0 or more"))
    if not (kinds := [*kinds]):
        raise InvalidInput(Problem("kinds", "there is no kind to choose from", f"name some of {', '.join(DYAD_NAMES)}"))
    chosen = random.Random(seed)
    known, composer = [FRAME, "crank"], Composer(f"{groups} random groups, seed {seed}").drive("crank", values=0.0)
    for k in range(groups):
        kind = chosen.choice(kinds)
        pairs, outer, size = pairs_of(kind)
        links = [f"{k}-{n}" for n in range(size)]
        around = chosen.sample(known, outer) if len(known) >= outer else chosen.choices(known, k=outer)
        codes = [code for code, first, _ in pairs if first is None]
        to = [_entry(composer, chosen, code, on, multiple) for code, on in zip(codes, around, strict=True)]
        composer.attach(kind, links, to if len({entry.partition(ON)[0] for entry in to}) == outer else around)
        known += links
    composer.place(**{letter: (chosen.uniform(-3.0, 3.0), chosen.uniform(-3.0, 3.0)) for letter in composer.carriers})
    mechanism = composer.mechanism()
    angle = float(mechanism.geometry.drawn["crank"].angle.c[0])
    return mechanism.replace(drive("crank", pair=composer.links["crank"][0], values=angle))


def _entry(composer: Composer, chosen: random.Random, code: str, on: str, multiple: float) -> str:
    """Return the attachment of an outer pair: a link, or at times one of its pins."""
    if code == REVOLUTE and composer.links[on] and chosen.random() < multiple:
        return f"{chosen.choice(composer.links[on])}{ON}{on}"
    return on


def _fits(where: str, given: int, wanted: int, what: str) -> None:
    if given != wanted:
        raise InvalidInput(
            Problem(where, f"there are {wanted} {what}, but entries for {given}", f"give {wanted} entries")
        )


# Separator of a point and its link: "B on crank".
ON = " on "


def _endless() -> Iterator[str]:
    """Yield a, B, ..., Z, A2, ..."""
    for turn in count(1):
        yield from (letter if turn == 1 else f"{letter}{turn}" for letter in lettered(26))
