"""Types of all four-bars and slider-cranks of a mechanism: which links turn fully, and how such a linkage is called.

A slider-crank is judged like a four-bar: of its two links with two pins the shorter, r, turns fully against all others
where r + |e| < l, e the distance between the lines along which the slide's two pins move.
Source: R. L. Norton, Design of Machinery, sections 2.13 to 2.16.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np

from compoundkin.analysis.characteristics.four_bar_types import EQUAL, FourBar, four_bar_code
from compoundkin.analysis.characteristics.four_links import FourLinks, loops_of_four
from compoundkin.base.arguments import check_design, checked
from compoundkin.base.arrays import Number, cross
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
        """The longer bar less the shorter one and the offset. Negative: none turns fully."""
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
        """What such a linkage is called, by its base."""
        if self.links[0] in self.bars:
            return f"inverted slider-crank, {self._guide} guide"
        line = "in-line" if self.offset <= EQUAL * sum(self.lengths) else "offset"
        kind = "slider-crank" if self._pinned in self.turns else "slider-rocker"
        return f"{line} {kind}{', at change points' if self.is_change_point else ''}"

    @property
    def _pinned(self) -> str:
        """The bar that is pinned to the base, where that is no bar itself."""
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

    Of several designs that of one, by its index; `four_bar_code` takes arrays of lengths. Raises InvalidInput for a
    design that is not there.

    >>> import compoundkin as ck
    >>> linkage_types(ck.catalog.load_named("crank-rocker"))[0].name
    'crank-rocker'
    """
    structure = decompose(what) if isinstance(what, Mechanism) else what
    check_design(design, _designs(structure))
    measured = Measured(structure, design)
    found = (
        measured.slider_crank(loop) if loop.slide else measured.four_bar(loop) for loop in loops_of_four(structure)
    )
    return tuple(one for one in found if one is not None)


def _designs(structure: Structure) -> int:
    """Tell how many designs the dimensions of the links are of: the product of all axes but the last."""
    shapes = (np.shape(value) for points in structure.mechanism.geometry.points.values() for value in points.values())
    return prod(np.broadcast_shapes(*shapes)[:-1])


@dataclass(frozen=True)
class Measured:
    """Loops of one design with their lengths, those of the first pose."""

    structure: Structure
    design: int = 0

    def four_bar(self, loop: FourLinks) -> FourBar | None:
        """Return a loop of four pins with its type.

        None where two of its pins are at one place.
        """
        base, one, coupler, other = (
            self._distance(link, loop.joints[k - 1], loop.joints[k]) for k, link in enumerate(loop.links)
        )
        if not min(base, one, coupler, other) > 0:
            return None
        code = str(four_bar_code(base, one, coupler, other))
        return FourBar(loop.links, loop.joints, (base, one, coupler, other), code, loop.driven)

    def slider_crank(self, loop: FourLinks) -> SliderCrank | None:
        """Return a loop with a slide and its type, or None.

        There is none where a bar has no length.
        """
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
        """Return how far apart the lines are along which the pins on the two sides of a slide move."""
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
