"""Coulomb friction in pairs."""

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
from compoundkin.model.loads.attachments import PairProperty
from compoundkin.model.loads.contract import NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Friction(PairProperty):
    """Coulomb friction in a pair, or in all pairs of a multiple pin."""

    pair: str = field(metadata=value_key("name", "The pair by its name, or the letter of a pin."))
    coefficient: Number | None = field(
        default=None, metadata=value_key("length", "The coefficient of friction; of a wheel, of rolling resistance.")
    )
    radius: Number | None = field(default=None, metadata=value_key("length", "The radius of the pin."))
    length: Number | None = field(
        default=None,
        metadata=value_key("length", "The length of the guide that a block touches, its point in the middle."),
    )

    efficiency: Number | None = field(
        default=None,
        metadata=value_key("length", "Of gears, belts and racks, the part of the torque that reaches the second one."),
    )

    title: ClassVar[str] = "friction"
    table: ClassVar[str] = "frictions"
    is_steady: ClassVar[bool] = True

    @property
    def factor(self) -> Number:
        """What the normal force is multiplied by: the coefficient, or the part of a torque that is lost."""
        if self.efficiency is not None:
            return 1.0 - self.efficiency
        return 0.0 if self.coefficient is None else self.coefficient

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, a pin without a radius, and negative numbers."""
        several = written.at_pin(self.pair)
        pair = written.pair(several[0] if several else self.pair)
        if pair is None:
            yield from self.unknown(written, where)
        elif not set(written.carriers.get(pair.letters[0], ())) <= set(written.letters) and pair.is_simple:
            what = f"the motion of the pin {pair.letters[0]} is prescribed: the force in it is not known"
            yield Problem(f"{where}.pair", what, "leave it out")
        elif self.title not in pair.takes:
            what = f"{self.pair!r} is a {pair.title}, whose friction is not known here"
            yield Problem(
                f"{where}.pair", what, "name a pin, a slide, a slot, a cam, a wheel, a gear pair, a rack or a belt"
            )
        elif "efficiency" in pair.takes:
            yield from self._problems_of_mesh(pair.title, where)
        elif self.efficiency is not None:
            what = f"a {pair.title} has a coefficient, not an efficiency"
            yield Problem(f"{where}.efficiency", what, f'friction("{self.pair}", 0.1)')
        elif pair.is_simple and pair.free_is_angle:
            if self.radius is None:
                remedy = f'friction("{self.pair}", ..., radius=5)'
                yield Problem(f"{where}.radius", "friction at a pin needs its radius", remedy)
            if self.length is not None:
                yield Problem(f"{where}.length", "a pin has no guide", "leave the length out")
        elif self.radius is not None:
            yield Problem(f"{where}.radius", f"a {pair.title} has no pin of a radius", "leave the radius out")
        if self.coefficient is None and pair is not None and "efficiency" not in pair.takes:
            what = f"the coefficient of a {pair.title} is missing"
            yield Problem(f"{where}.coefficient", what, f'friction("{self.pair}", 0.1)')
        yield from self._problems_of_numbers(where)

    def _problems_of_numbers(self, where: str) -> Iterator[Problem]:
        """Find a negative coefficient, and lengths that are not above zero."""
        if self.coefficient is not None and np.any(np.asarray(self.coefficient) < 0.0):
            yield Problem(f"{where}.coefficient", "a coefficient of friction is not negative")
        for key, value in (("radius", self.radius), ("length", self.length)):
            if value is not None and not np.all(np.asarray(value) > 0.0):
                yield Problem(f"{where}.{key}", f"a {key} is above zero")

    def _problems_of_mesh(self, title: str, where: str) -> Iterator[Problem]:
        if self.efficiency is None:
            yield Problem(f"{where}.efficiency", f"the losses of a {title} are told by its efficiency",
                          f'friction("{self.pair}", efficiency=0.98)')  # fmt: skip
        elif not np.all((np.asarray(self.efficiency) > 0.0) & (np.asarray(self.efficiency) <= 1.0)):
            yield Problem(f"{where}.efficiency", f"{self.efficiency!r} is no efficiency", "above 0, up to 1")
        for key, value in (("coefficient", self.coefficient), ("radius", self.radius), ("length", self.length)):
            if value is not None:
                yield Problem(f"{where}.{key}", f"a {title} has none: its efficiency is known", "leave it out")


@checked
def friction(
    pair: str, coefficient: Any = None, *, radius: Any = None, length: Any = None, efficiency: Any = None
) -> Friction:
    """Return Coulomb friction in a pair. A pin needs its `radius`; a slide may have the `length` of its guide.

    A wheel that rolls has a coefficient of rolling resistance: the moment over normal force and radius. Gears, belts
    and racks have an `efficiency`: where the first wheel or the rack drives, the second or the pinion gives that part
    of the torque without losses, seen from the carrier or the rack.

    The letter of a multiple pin stands for every pair of that pin. Numbers, or arrays for designs.

    >>> friction("slot", 0.1, length=30).length
    30.0
    """
    where = f"frictions.{pair}"
    numbers = {"coefficient": coefficient, "radius": radius, "length": length, "efficiency": efficiency}
    return Friction(pair, **{key: real(f"{where}.{key}", value) for key, value in numbers.items()})
