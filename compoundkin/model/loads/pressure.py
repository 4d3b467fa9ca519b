"""Pressure on a piston: a thrust along a slide from the pressures on both sides and the areas they act on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.amounts import Amount, as_amount, needs_rates, value_of
from compoundkin.model.loads.attachments import VARIABLES, PairLoad
from compoundkin.model.loads.contract import COORDINATE, LoadedPoses, NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Pressure(PairLoad):
    """Pressures on both sides of a piston along a slide: on the pair's second link, the opposite on the first.

    The `pressure` acts on the whole piston and drives the coordinate up; the pressure `back` acts on what the rod
    leaves of it on the other side, and drives it down.
    """

    pressure: Amount = field(
        kw_only=True, metadata=value_key("amount", "The pressure that drives the coordinate up, force over area.")
    )
    back: Amount = field(
        default=0.0, kw_only=True, metadata=value_key("amount", "The pressure on the side of the rod.")
    )
    bore: Number | None = field(
        default=None, kw_only=True, metadata=value_key("length", "The diameter of the piston; or its area.")
    )
    area: Number | None = field(default=None, kw_only=True, metadata=value_key("length", "The area of the piston."))
    rod: Number = field(default=0.0, kw_only=True, metadata=value_key("length", "The diameter of the rod."))

    title: ClassVar[str] = "pressure"
    table: ClassVar[str] = "pressures"
    amounts: ClassVar[tuple[str, ...]] = ("pressure", "back")
    own_variable: ClassVar[str] = COORDINATE
    has_rate: ClassVar[bool] = True

    @property
    def needs_rates(self) -> bool:
        """Whether a pressure depends on the rate of the coordinate."""
        return needs_rates(self.pressure) or needs_rates(self.back)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find a pair that is no slide, and a piston without an area, or none beside its rod."""
        yield from super().problems(written, where)
        pair = written.pair(self.pair)
        if pair is not None and pair.free_is_angle:
            yield Problem(f"{where}.pair", f"{self.pair!r} turns, and a piston slides", "name a slide or a cylinder's")
        if (self.bore is None) == (self.area is None):
            yield Problem(where, "it needs the bore or the area, one of both", "give bore=50, or area=1963.5")
            return
        for key in ("bore", "area"):
            value = getattr(self, key)
            if value is not None and not np.all(np.asarray(value) > 0.0):
                yield Problem(f"{where}.{key}", "it is not above zero", "give that of the piston")
                return
        if not np.all((np.asarray(self.rod) >= 0.0) & (_circle(self.rod) < self._piston)):
            yield Problem(f"{where}.rod", "it is not thinner than the piston", "give its diameter")

    @property
    def _piston(self) -> Number:
        """The area of the piston."""
        if self.area is not None:
            return self.area
        assert self.bore is not None
        return _circle(self.bore)

    def effort(self, at: LoadedPoses) -> Number:
        """Return the thrust of both pressures."""
        own = self.variables(at)
        front, back = (value_of(self.where, amount, at, own) for amount in (self.pressure, self.back))
        piston, rod = at.fitted(self._piston, self.where), at.fitted(_circle(self.rod), self.where)
        return front * piston - back * (piston - rod)


def _circle(diameter: Number) -> Number:
    return np.pi * np.square(diameter) / 4.0


@checked
def pressure(
    pair: str, pressure: Any, *, bore: Any = None, area: Any = None, rod: Any = 0.0, back: Any = 0.0, name: str = ""
) -> Pressure:
    """Return pressure on a piston along a slide, such as that between barrel and rod of a cylinder.

    The pair is meant as of `effort`. The `pressure` drives the coordinate up on the whole piston, of a diameter `bore`
    or an `area`; the pressure `back` drives it down on what a `rod` of a diameter leaves of it. Pressures are in units
    of force over area, N/mm^2 is MPa or 10 bar; they are amounts as of `effort`: numbers, functions of coordinate
    ``q``, rate ``w``, time ``t``, or tables.

    >>> pressure("boom cylinder", 16.0, bore=50, rod=28, back=0.2).name
    'pressure along boom cylinder'
    """
    where = f"pressures.{name or pair}"
    front, other = (as_amount(f"{where}.{key}", given, *VARIABLES)
                    for key, given in (("pressure", pressure), ("back", back)))  # fmt: skip
    own, whole = (None if given is None else real(f"{where}.{key}", given)
                  for key, given in (("bore", bore), ("area", area)))  # fmt: skip
    thin = real(f"{where}.rod", rod)
    return Pressure(pair, pressure=front, back=other, bore=own, area=whole, rod=thin, name=name)
