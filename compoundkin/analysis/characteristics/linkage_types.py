"""Types of all four-bars and slider-cranks of a mechanism: which links turn fully, and the name of the type.

With the lengths s shortest, l longest, p and q, the shortest link turns fully against all others where s + l < p + q
(Grashof). A slider-crank is judged like a four-bar: of its two links with two pins the shorter, r, turns fully against
all others where r + |e| < l, e the distance between the lines along which the slide's two pins move.

Sources: R. L. Norton, Design of Machinery, sections 2.13 to 2.16; C. R. Barker, A complete classification of planar
four-bar linkages, Mechanism and Machine Theory 20 (1985) 535-554.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arguments import check_design, checked, real_numbers
from compoundkin.base.arrays import LONGEST, Number, cross
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose


@dataclass(frozen=True)
class SliderCrank:
    """A loop of three pins and a slide. `links` as in the loop, the base first; `bars` are its two links of two pins.

    `lengths` are those of the bars, `offset` the distance of the lines along which the slide's two pins move.
    """

    links: tuple[str, str, str, str]
    slide: str
    bars: tuple[str, str]
    lengths: tuple[float, float]
    offset: float
    driven: str
    # Barker's codes are those of four-bars only
    code: str = ""

    @property
    def shortest(self) -> str:
        """The shorter of the bars."""
        return self.bars[0] if self.lengths[0] <= self.lengths[1] else self.bars[1]

    @property
    def margin(self) -> float:
        """The longer bar minus the shorter one and the offset; negative if none turns fully."""
        return max(self.lengths) - min(self.lengths) - self.offset

    @property
    def is_change_point(self) -> bool:
        """Whether the longer bar is as long as the shorter one and the offset."""
        return abs(self.margin) <= EQUAL * (sum(self.lengths) + self.offset)

    @property
    def turns(self) -> tuple[str, ...]:
        """The links that can turn fully against the base."""
        if self.margin < 0 and not self.is_change_point:
            return ()
        short = min(self.lengths) * (1.0 + EQUAL)
        cranks = tuple(bar for bar, length in zip(self.bars, self.lengths, strict=True) if length <= short)
        return self.links[1:] if self.links[0] in cranks else cranks

    @property
    def name(self) -> str:
        """The name of the type, by its base."""
        if self.links[0] in self.bars:
            return f"inverted slider-crank, {self._guide} guide"
        line = "in-line" if self.offset <= EQUAL * sum(self.lengths) else "offset"
        kind = "slider-crank" if self._pinned in self.turns else "slider-rocker"
        return f"{line} {kind}{', at change points' if self.is_change_point else ''}"

    @property
    def _pinned(self) -> str:
        """The bar pinned to a base that is no bar itself."""
        return self.bars[0] if self.bars[0] in (self.links[1], self.links[3]) else self.bars[1]

    @property
    def _guide(self) -> str:
        if self.is_change_point:
            return "change-point"
        return "turning" if self.links[0] == self.shortest and self.turns else "oscillating"

    def __repr__(self) -> str:
        lengths = ", ".join(f"{n} {v:.6g}" for n, v in zip(self.bars, self.lengths, strict=True))
        return f"SliderCrank({self.name}: {lengths}, offset {self.offset:.6g})"


@checked
def linkage_types(what: Mechanism | Structure, design: int = 0) -> tuple[FourBar | SliderCrank, ...]:
    """Return the type of every loop of four links, those with the frame first.

    `design` is the index of one of several designs; `four_bar_code` takes arrays of lengths. Raises InvalidInput for an
    unknown design.

    >>> import compoundkin as ck
    >>> linkage_types(ck.load("crank-rocker"))[0].name
    'crank-rocker'
    """
    structure = decompose(what) if isinstance(what, Mechanism) else what
    check_design(design, _designs(structure))
    measured = MeasuredLoops(structure, design)
    found = (
        measured.slider_crank(loop) if loop.slide else measured.four_bar(loop) for loop in loops_of_four(structure)
    )
    return tuple(one for one in found if one is not None)


def _designs(structure: Structure) -> int:
    """Return the number of designs of the dimensions: the product of all axes but the last."""
    shapes = (np.shape(value) for points in structure.mechanism.geometry.points.values() for value in points.values())
    return prod(np.broadcast_shapes(*shapes)[:-1])


@dataclass(frozen=True)
class MeasuredLoops:
    """Loops of one design with their lengths, those of the first pose."""

    structure: Structure
    design: int = 0

    def four_bar(self, loop: FourLinks) -> FourBar | None:
        """Return a loop of four pins with its type, None if two of its pins coincide."""
        base, one, coupler, other = (
            self._distance(link, loop.joints[k - 1], loop.joints[k]) for k, link in enumerate(loop.links)
        )
        if not min(base, one, coupler, other) > 0:
            return None
        code = str(four_bar_code(base, one, coupler, other))
        return FourBar(loop.links, loop.joints, (base, one, coupler, other), code, loop.driven)

    def slider_crank(self, loop: FourLinks) -> SliderCrank | None:
        """Return a loop with a slide and its type, None if a bar has no length."""
        at = loop.joints.index(loop.slide)
        sides = loop.links[at], loop.links[(at + 1) % 4]
        k = [(at + 2) % 4, (at + 3) % 4]
        bars = {loop.links[i]: self._distance(loop.links[i], loop.joints[i - 1], loop.joints[i]) for i in k}
        if not min(bars.values()) > 0:
            return None
        first, second = sorted(bars, key=loop.links.index)
        offset = self._offset(loop.slide, {sides[0]: loop.joints[at - 1], sides[1]: loop.joints[(at + 1) % 4]})
        return SliderCrank(loop.links, loop.slide, (first, second), (bars[first], bars[second]), offset, loop.driven)

    def _distance(self, link: str, first: str, second: str) -> float:
        points = self.structure.mechanism.geometry.points[link]
        return abs(complex(self._one(points[second] - points[first])))

    def _offset(self, slide: str, pins: dict[str, str]) -> float:
        """Return the distance of the lines along which the pins on the two sides of a slide move."""
        geometry = self.structure.mechanism.geometry
        pair = next(pair for pair in self.structure.mechanism.written_pairs if pair.name == slide)
        across = []
        for member, end in zip(pair.members, pair.ends(geometry), strict=True):
            arm = geometry.points[member][pins[member]] - end.point
            across.append(float(self._one(cross(end.along.c[0] + 0j, arm + 0j))))
        return abs(across[0] - across[1])

    def _one(self, value: Number) -> Number:
        """Return the number of the design at the first pose."""
        if np.ndim(value) == 0:
            return value
        rows = np.reshape(value, (-1, np.shape(value)[-1]))
        return rows[min(self.design, len(rows) - 1), 0]


# Sums of lengths that differ by less than this part of the loop are equal: a change point.
EQUAL = 1e-9
# Three links that rock, before the number of the longest link.
_ROCKERS = 3 * "R"
NAMES = {
    "GCCC": "double-crank (drag link)",
    "GCRR": "crank-rocker",
    "GRCR": "Grashof double-rocker",
    "GRRC": "rocker-crank",
    **{f"{_ROCKERS}{k}": "triple-rocker" for k in range(1, 5)},
    "SCCC": "change-point double-crank",
    "SCRR": "change-point crank-rocker",
    "SRCR": "change-point double-rocker",
    "SRRC": "change-point rocker-crank",
    "S2X": "change-point linkage with two pairs of equal links",
    "S3X": "change-point linkage of four equal links",
    "": "cannot be assembled",
}
_GRASHOF, _CHANGE = ("GCCC", "GCRR", "GRCR", "GRRC"), ("SCCC", "SCRR", "SRCR", "SRRC")
# Two pairs of equal links: opposite to each other, or side by side.
PARALLELOGRAM, KITE = "parallelogram (or antiparallelogram)", "kite (deltoid)"


@dataclass(frozen=True)
class FourBar:
    """A loop of four pins. Links and lengths are those of base, input, coupler and output.

    `code` is Barker's: G with C for a crank and R for a rocker at input, coupler and output; RRR with 1 to 4 for which
    link is longest; S for change points. `driven` is the link that is solved first, "" where none is before the rest.
    """

    links: tuple[str, str, str, str]
    pins: tuple[str, str, str, str]
    lengths: tuple[float, float, float, float]
    code: str
    driven: str

    @property
    def name(self) -> str:
        """The name of the type."""
        if self.code == "S2X":
            base, one, _, other = self.lengths
            return PARALLELOGRAM if abs(one - other) < min(abs(base - one), abs(base - other)) else KITE
        return NAMES[self.code]

    @property
    def turns(self) -> tuple[str, ...]:
        """The links that can turn fully against the base."""
        letters = self.code[1:] if self.code[:1] in ("G", "S") and "X" not in self.code else ""
        if self.code.endswith("X"):
            letters = "".join("C" if self._may_turn(k) else "R" for k in (1, 2, 3))
        return tuple(link for link, letter in zip(self.links[1:], letters, strict=False) if letter == "C")

    def _may_turn(self, k: int) -> bool:
        """Return whether a link can be in line with the base in both directions."""
        base, own = self.lengths[0], self.lengths[k]
        one, other = (length for i, length in enumerate(self.lengths) if i not in (0, k))
        near = EQUAL * sum(self.lengths)
        return base + own <= one + other + near and abs(base - own) >= abs(one - other) - near

    @property
    def shortest(self) -> str:
        """The shortest link, the first of several."""
        return self.links[int(np.argmin(self.lengths))]

    @property
    def margin(self) -> float:
        """The other two lengths minus the shortest and the longest; negative if no link turns fully."""
        short, second, third, long = sorted(self.lengths)
        return second + third - short - long

    def __repr__(self) -> str:
        lengths = ", ".join(f"{n} {v:.6g}" for n, v in zip(self.links, self.lengths, strict=True))
        return f"FourBar({self.name}, {self.code or 'no code'}: {lengths})"


@checked
def four_bar_code(base: Any, input: Any, coupler: Any, output: Any) -> Number:
    """Return Barker's codes of four-bars by their lengths, numbers or arrays; empty where they cannot be assembled.

    >>> four_bar_code(2.0, 1.0, [2.5, 0.7, 6.0], 2.5).tolist()
    ['GCRR', 'RRR4', '']
    """
    lengths = _lengths(base=base, input=input, coupler=coupler, output=output)
    total = lengths.sum(axis=-1)
    ranked = np.sort(lengths, axis=-1)
    margin = ranked[..., 1] + ranked[..., 2] - ranked[..., 0] - ranked[..., 3]
    near = EQUAL * total
    grashof = np.asarray(_GRASHOF)[lengths.argmin(axis=-1)]
    rockers = np.char.add(_ROCKERS, (lengths.argmax(axis=-1) + 1).astype(str))
    change = np.asarray(_CHANGE)[lengths.argmin(axis=-1)]
    pairs = ranked[..., 1] - ranked[..., 0] <= near
    change = np.where(pairs, np.where(ranked[..., 3] - ranked[..., 0] <= near, "S3X", "S2X"), change)
    closed = 2.0 * ranked[..., 3] - total <= near
    return np.where(closed, np.where(np.abs(margin) <= near, change, np.where(margin > 0, grashof, rockers)), "")


def _lengths(**given: Any) -> Number:
    """Return the lengths of links in a last axis of four. Raises InvalidInput for invalid lengths."""
    lengths = {name: real_numbers(name, value) for name, value in given.items()}
    for name, value in lengths.items():
        if not np.all((value > 0) & (value < LONGEST)):
            raise InvalidInput(Problem(name, "the length of a link of a four-bar is positive", "give positive lengths"))
    try:
        return np.stack(np.broadcast_arrays(*lengths.values()), axis=-1)
    except ValueError:
        shapes = ", ".join(str(np.shape(value)) for value in lengths.values())
        raise InvalidInput(
            Problem("lengths", f"arrays of shapes {shapes} do not fit each other", "one shape")
        ) from None


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
    >>> loops_of_four(ck.decompose(ck.load("slider-crank")))[0].links
    ('frame', 'crank', 'rod', 'piston')
    """
    order = _solving_ranks(structure)
    joined = _joined(structure.mechanism)
    slides = {pair.name for pair in structure.mechanism.written_pairs}
    place = {link: k for k, link in enumerate(joined)}
    found = [_in_solving_order(loop, order, slides) for loop in _cycles(joined, place) if _has_pins(loop, slides)]
    rank = {link: k for k, link in enumerate(structure.mechanism.links)}
    return tuple(sorted(found, key=lambda loop: (loop.links[0] != FRAME, [order[name] for name in loop.links],
                                                 [rank[name] for name in loop.links])))  # fmt: skip


def _solving_ranks(structure: Structure) -> dict[str, int]:
    """Return the rank in which each link is solved: the frame and driven links one by one, then the groups."""
    order = {link: k for k, link in enumerate(structure.ground.links)}
    for group in structure.groups:
        after = len(order)
        order.update(dict.fromkeys(group.links, after))
    return {FRAME: 0, **dict.fromkeys(structure.mechanism.links, len(order)), **order}


def _joined(mechanism: Mechanism) -> dict[str, list[tuple[str, str]]]:
    """Return the neighbours of each link, with the joints."""
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
    """Yield every loop of four links once, from its first link towards the earlier of its neighbours."""
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


def _in_solving_order(
    loop: tuple[tuple[str, ...], tuple[str, ...]], order: Mapping[str, int], slides: set[str]
) -> FourLinks:
    """Return a loop that begins with its base and the neighbour solved earlier."""
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
