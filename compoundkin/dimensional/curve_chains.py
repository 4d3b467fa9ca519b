"""Chains whose points trace curves: crank-driven linkages with free dimensions, as programs over many designs.

A chain is a four-bar or a slider-crank; each dyad more lies on two of its links. With a dyad on two links of a four-bar
that are not both its crank and frame this gives the six-bars of Watt and Stephenson that a crank on the frame drives
through dyads alone (E. A. Dijksman, Motion Geometry of Mechanisms, Cambridge 1976).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import ShortRepr
from compoundkin.dimensional.candidates import COUPLER, POINT
from compoundkin.model.attributes import POSITION, component_names
from compoundkin.model.elements import Item, Link, drive, link, mode
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import slide
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile

CRANK, ROCKER, SLIDER, ROD, LEVER, GUIDE = "crank", "rocker", "slider", "rod", "lever", "guide"
GUIDE_OFFSET = f"{GUIDE}.offset"
# From where to where lengths of cranks and of other links are drawn, coordinates of points and offsets of guides on
# either side of zero; the frame of a four-bar is two long.
CRANKS, LENGTHS, PLACES, OFFSETS = (0.1, 1.2), (0.4, 6.0), (-4.0, 4.0), (-1.5, 1.5)


class FreeNumber(NamedTuple):
    """A number that designs choose: a length, drawn evenly over its logarithm, or a coordinate of `point`."""

    name: str
    low: float
    high: float
    is_length: bool
    point: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class CurveChain(ShortRepr):
    """A chain whose point P traces a closed curve; `numbers` are what its designs choose.

    Designs are arrays (designs, numbers): the logarithms of lengths, and coordinates as they are.
    """

    title: str
    links: int
    mechanism: Mechanism
    numbers: tuple[FreeNumber, ...]

    @cached_property
    def program(self) -> CompiledPath:
        """Its program: the place of P for dimensions and the crank's angle."""
        some = self.dimensions(np.zeros((1, len(self.numbers))))
        return compile(self.mechanism, [f"{POINT}.{POSITION}"], free=list(some))

    def designs(self, units: Number) -> Number:
        """Return designs of an array (designs, numbers) of numbers from 0 to 1."""
        low, high = np.array([[np.log(one[1:3]) if one.is_length else one[1:3]] for one in self.numbers]).T
        return low[0] + (high[0] - low[0]) * units

    def dimensions(self, designs: Number) -> dict[str, Number]:
        """Return the dimensions of designs by name, arrays (designs, 1)."""
        values = {one.name: np.exp(column) if one.is_length else column
                  for one, column in zip(self.numbers, designs.T[:, :, None], strict=True)}  # fmt: skip
        points = {one.point: component_names(one.point) for one in self.numbers if one.point}
        found = {name: values[x] + 1j * values[y] for name, (x, y) in points.items()}
        return found | {one.name: values[one.name] for one in self.numbers if not one.point}

    def size(self, designs: Number) -> Number:
        """Return the greatest length or coordinate of each design."""
        lengths = np.array([one.is_length for one in self.numbers])
        return np.where(lengths, np.exp(np.where(lengths, designs, 0.0)), np.abs(designs)).max(axis=1)

    def curves(self, designs: Number, poses: int) -> tuple[Number, Number]:
        """Return the curves of designs over a turn, (designs, poses), and which designs are clear of limits."""
        found, clear = self.program.programs.unscreened(self._call(designs, poses))
        return found[f"{POINT}.{POSITION}"], clear

    def slopes(self, designs: Number, poses: int) -> tuple[Number, Number, Number, Number]:
        """Return curves, their slopes by the designs' numbers and by the crank, and which designs are clear.

        Slopes are (numbers, designs, poses).
        """
        path = self.program
        found, clear = path.sensitivities.unscreened(self._call(designs, poses))
        output, shape = f"{POINT}.{POSITION}", (len(designs), poses)
        by = [np.broadcast_to(found[output, one.name], shape) for one in self.numbers]
        by = [slope * np.exp(designs[:, [k]]) if one.is_length else slope
              for k, (one, slope) in enumerate(zip(self.numbers, by, strict=True))]  # fmt: skip
        return found[output, ""], np.array(by), found[output, CRANK], clear

    def _call(self, designs: Number, poses: int) -> Call:
        return Call({CRANK: np.arange(poses) * (TURN / poses)}, self.dimensions(designs))


def _length(name: str, between: tuple[float, float] = LENGTHS) -> FreeNumber:
    return FreeNumber(name, *between, True)


def _place(link_name: str, letter: str) -> list[FreeNumber]:
    point = f"{link_name}.{letter}"
    return [FreeNumber(name, *PLACES, False, point) for name in component_names(point)]


# The two links of a four-bar that a second dyad lies on, and what the six-bar is then called.
_SIX_BARS = {
    (COUPLER, FRAME): "Stephenson III",
    (ROCKER, FRAME): "Watt II",
    (COUPLER, ROCKER): "Watt I",
    (CRANK, COUPLER): "Watt I, its ternary link driven",
    (CRANK, ROCKER): "Stephenson I",
}
# Those of a slider-crank.
_SIX_BARS_WITH_SLIDER = {(COUPLER, FRAME): "Stephenson III with slider", (CRANK, COUPLER): "Watt I with slider"}
_POINTS = {"E": 1.0 + 1.0j, "F": 0.5 + 1.5j, POINT: 1.0 + 0.8j}


@cache
def curve_chains(links: int = 6) -> tuple[CurveChain, ...]:
    """Return the chains of at most so many links: four, or six.

    >>> [len(curve_chains(links)) for links in (4, 6)]
    [2, 24]
    """
    found = [_four_links(False), _four_links(True)]
    if links >= 6:
        for with_slider in (False, True):
            for pair, title in (_SIX_BARS_WITH_SLIDER if with_slider else _SIX_BARS).items():
                # a link on the frame traces a circle
                traced = (ROD,) if FRAME in pair else (ROD, LEVER)
                found += [_six_links(title, with_slider, pair, name, sign) for sign in (1, -1) for name in traced]
    return tuple(found)


def guide(angle: float, offset: float) -> Item:
    """Return the guide of a slider at a distance from the crank's pivot."""
    return slide(SLIDER, on=FRAME, at="C", through="A", angle=angle, offset=offset, name=GUIDE)


def _base(with_slider: bool, extra: dict[str, dict[str, complex]]) -> tuple[list[Item], list[FreeNumber]]:
    """Return the items of a four-bar or a slider-crank with more points on its links, and its numbers."""

    def points(name: str, **own: complex) -> Link:
        return link(name, **own, **extra.get(name, {}))

    crank, numbers = points(CRANK, A=0, B=0.5), [_length("crank.B.x", CRANKS), _length("coupler.C.x")]
    items: list[Item]
    if with_slider:
        items = [points(FRAME, A=0), crank, points(COUPLER, B=0, C=2), link(SLIDER, C=0)]
        items += [guide(0.0, 0.3), mode(1, SLIDER)]
        return items, [*numbers, FreeNumber(GUIDE_OFFSET, *OFFSETS, False)]
    items = [points(FRAME, A=0, D=2), crank, points(COUPLER, B=0, C=2), points(ROCKER, D=0, C=2), mode(1, ROCKER)]
    return items, [*numbers, _length("rocker.C.x")]


def _four_links(with_slider: bool) -> CurveChain:
    items, numbers = _base(with_slider, {COUPLER: {POINT: _POINTS[POINT]}})
    title = "Slider-crank" if with_slider else "Four-bar"
    return CurveChain(title, 4, Mechanism(title, *items, drive(CRANK)), (*numbers, *_place(COUPLER, POINT)))


def _six_links(title: str, with_slider: bool, pair: tuple[str, str], traced: str, sign: int) -> CurveChain:
    first, second = pair
    items, numbers = _base(with_slider, {first: {"E": _POINTS["E"]}, second: {"F": _POINTS["F"]}})
    rod, lever = ({POINT: _POINTS[POINT]} if name == traced else {} for name in (ROD, LEVER))
    dyad: list[Item] = [link(ROD, E=0, G=2.5, **rod), link(LEVER, F=0, G=2.5, **lever), mode(sign, LEVER)]
    numbers += [*_place(first, "E"), *_place(second, "F"), _length("rod.G.x"), _length("lever.G.x")]
    mechanism = Mechanism(title, *items, *dyad, drive(CRANK))
    return CurveChain(title, 6, mechanism, (*numbers, *_place(traced, POINT)))
