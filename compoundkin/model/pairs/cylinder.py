"""Cylinders: a barrel and a rod between two pins, written as one element and driven by its length."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.model.fields import (
    DeclaredKeys,
    Item,
    NameWording,
    constructor,
    link_key,
    name_problems,
    point_key,
    value_key,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.symbols import Mark, Sliding


@dataclass(frozen=True, eq=False)
class Stroke(Prismatic):
    """The slide in a cylinder: its displacement is the length between the pins."""

    def passed(self, here: str, there: str, is_end: bool) -> str:
        """Return the message that the cylinder is longer or shorter than its stroke allows."""
        return f"{self.name} is {here} long, {'more' if is_end else 'less'} than its stroke allows, {there}"

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return a barrel and a rod, as long as it is used."""
        marks = super().glyph(ends, poses)
        return tuple(mark._replace(is_cylinder=True) for mark in marks if isinstance(mark, Sliding))

    def with_ends(
        self, marks: tuple[Mark, ...], bounds: tuple[Number, Number], ends: Ends, poses: Poses
    ) -> tuple[Mark, ...]:
        """Return a barrel and a rod of the whole stroke."""
        return super().with_ends(marks, bounds, ends, poses) if np.isfinite(bounds[1]) else marks


@dataclass(frozen=True, eq=False)
class Cylinder(Item):
    """A hydraulic cylinder, a gas spring, a linear actuator.

    Its rod is pinned to the point `point` of `link`, its barrel to the point `at` of the link `to`. It is driven by its
    length between the two pins, ``drive(name, values=lengths)``; not driven, it follows. Where it is named NAME, its
    barrel is the link "NAME barrel", its rod "NAME rod", and the slide between them has its own name.

    >>> cylinder("boom", "D", to="frame", at="C", stroke=(0.8, 1.3)).name
    'boom cylinder'
    """

    name: str = field(
        default="", kw_only=True, metadata=value_key("name", "What it is called; LINK cylinder where it is left out.")
    )
    link: str = field(metadata=link_key("The link that the rod is pinned to."))
    point: str = field(metadata=point_key("link", "The point of that link at which it is."))
    _: KW_ONLY
    to: str = field(default=FRAME, metadata=link_key("The link that the barrel is pinned to."))
    at: str = field(metadata=point_key("to", "The point of that link at which it is."))
    stroke: Any = field(
        default=None, metadata=value_key("two", "The least and the greatest length between the two pins.")
    )
    keys = DeclaredKeys()
    wording: ClassVar[NameWording] = NameWording("push", "name two links")

    def __post_init__(self) -> None:
        """A cylinder without a name is called after its link."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    def called(self) -> str:
        """Its default name."""
        return f"{self.link} cylinder"

    @property
    def members(self) -> tuple[str, ...]:
        """The links at its two ends, that of the barrel first."""
        return self.to, self.link

    @property
    def barrel(self) -> str:
        """The name of the barrel's link."""
        return f"{self.name} barrel"

    @property
    def rod(self) -> str:
        """The name of the rod's link."""
        return f"{self.name} rod"

    @property
    def slide(self) -> Stroke:
        """The slide between barrel and rod. A length is never negative."""
        reach = (0.0, None) if self.stroke is None else tuple(self.stroke)
        return Stroke(self.rod, on=self.barrel, at=self.point, through=self.at, name=self.name, reach=reach)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid stroke. `links` maps each link to its points."""
        yield from name_problems(self, links, where, self.wording)
        if self.point == self.at:
            yield Problem(f"{where}.at", f"both ends are at {self.at!r}", "name two points with different letters")
        if self.name in links:
            what = f"a link is called {self.name!r} as well"
            yield Problem(f"{where}.name", what, f"give the cylinder another name, such as {self.called!r}")
        yield from self._stroke_problems(f"{where}.stroke")

    def _stroke_problems(self, where: str) -> Iterator[Problem]:
        if self.stroke is None:
            return
        how = "write the least and the greatest length, such as (0.8, 1.3)"
        try:
            low, high = (np.asarray(length, dtype=float) for length in self.stroke)
        except (TypeError, ValueError):
            yield Problem(where, f"{self.stroke!r} is not two lengths", how)
            return
        if not (np.isfinite(low).all() and np.isfinite(high).all() and low.size and high.size):
            yield Problem(where, f"{self.stroke!r} is empty or not finite", how)
        elif not (np.all(low > 0) and np.all(low < high)):
            what = f"a stroke from {np.ravel(low)[0]:g} to {np.ravel(high)[0]:g} is not possible"
            yield Problem(where, what, "give two lengths above zero between the pins, the lesser first")


cylinder = constructor("cylinder", Cylinder)
