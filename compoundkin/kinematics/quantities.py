"""Quantities of a motion, by what they are called: "G.velocity", "bar.angle", "slot.rate"."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import PLAIN, degrees
from compoundkin.base.display import display_function
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.contract import HasQuantities, OfMotion, motion_of
from compoundkin.kinematics.quantity_owners import Owner, check_part, owner_and_part
from compoundkin.model.attributes import (
    DEGREES,
    DERIVED,
    LENGTH,
    PARTS,
    RADIANS,
    Attribute,
    Dimension,
    motion_figure,
    unit_of,
    with_superscripts,
)


@dataclass(frozen=True, eq=False, repr=False)
class Quantity:
    """One quantity: complex values for a planar vector, real ones otherwise. `unit` is that of `values`.

    `order` counts time derivatives of a length, an angle or another `dimension`; rounding is relative to `scale`.
    """

    name: str
    unit: str
    values: Any
    order: int = 0
    dimension: Dimension = "number"
    symbol: str = ""
    scale: float = 0.0

    @property
    def is_vector(self) -> bool:
        """Whether it is a planar vector."""
        return np.iscomplexobj(self.values)

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, and not the rate of one."""
        return self.unit in (RADIANS, DEGREES)

    @property
    def label(self) -> str:
        """The name with its unit.

        >>> Quantity("G.acceleration", "mm/s^2", np.zeros((1, 1))).label
        'G.acceleration [mm/s²]'
        """
        return f"{self.name} [{with_superscripts(self.unit)}]".lstrip() if self.unit else self.name

    @property
    def shown(self) -> Self:
        """As it is shown to people: angles in degrees.

        >>> Quantity("bar.angle", "rad", np.array([np.pi])).shown.values.tolist()
        [180.0]
        """
        return replace(self, values=degrees(self.values), unit=DEGREES) if self.unit == RADIANS else self

    def part(self, name: str) -> Self:
        """Return a component or the length of a vector."""
        symbol = f"|{self.symbol}|" if name == LENGTH else f"{self.symbol}.{name}"
        return replace(self, name=f"{self.name}.{name}", values=PARTS[name](self.values), symbol=symbol)

    @property
    def components(self) -> tuple[Self, ...]:
        """Its real numbers: both components of a vector. What is no vector is as it is."""
        return (self.part("x"), self.part("y")) if self.is_vector else (self,)

    def __repr__(self) -> str:
        shape = "x".join(map(str, np.shape(self.values))) or "1"
        kind = "vectors" if self.is_vector else "values"
        symbol = f", {self.symbol}" if self.symbol else ""
        return f"Quantity({self.name!r}{symbol}, {shape} {kind}{' in ' + self.unit if self.unit else ''})"


@checked
def quantity(motion: HasQuantities | OfMotion, name: str) -> Quantity:
    """Return the quantity of a name such as "G.velocity".

    "G" alone is G.position, "bar" bar.angle, "slot" slot.value. Points have position, velocity, acceleration, jerk, x,
    y, speed; links angle, angular_velocity, angular_acceleration, angular_jerk; pairs and drivers value, rate, second,
    third (or angle, displacement). Links of dyads have transmission_angle, those of any group transmission_index;
    guides that turn coriolis, cams pressure_angle; what moves by one driver velocity_ratio and advantage. With loads
    pairs have force and moment, drivers effort and power, the frame shaking_force. A vector has .x, .y, .length. Over a
    motion numbers have .least, .greatest, .stroke, .time_ratio, .imbalance_angle. Raises UnknownName with the nearest.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> found = quantity(solve(crank, {"crank": [0.0]}, speed=3.0), "B.velocity")
    >>> found, found.values.tolist()
    (Quantity('B.velocity', v(B), 1 vectors in mm/s), [6j])
    """
    whole, part = whole_and_part(motion_of(motion), name)
    return whole.part(part) if part else whole


def whole_and_part(motion: HasQuantities, name: str) -> tuple[Quantity, str]:
    """Return the quantity of a name, or a vector and which part is meant. Raises UnknownName."""
    if not isinstance(name, str):
        raise InvalidInput(Problem("quantity", f"{name!r} is no name", 'write "G.velocity", one text for each'))
    of, figure = motion_figure(name)
    if figure:
        return display_function("course")(motion, of, figure), ""
    owner, word, part = owner_and_part(motion, name)
    found = replace(read_of(owner, word), name=name.removesuffix(f".{part}") if part else name)
    if part:
        check_part(name, part, found.is_vector)
    return found, part


def read_of(owner: Owner, word: str) -> Quantity:
    """Return the quantity of an attribute of a point, link, pair or driver."""
    if word not in owner.attributes:
        figure = FIGURES[owner.kind][word]
        found = _quantity(owner, DERIVED[owner.kind][word], figure.values(owner.whole, owner.name))
        return replace(found, **figure.own(owner.whole, owner.name))
    attribute, motion = owner.attributes[word], getattr(owner.whole, owner.kind)[owner.name]
    known = hasattr(type(motion), word)
    return _quantity(owner, attribute, getattr(motion, word) if known else motion.derivative(attribute.order))


def _quantity(owner: Owner, found: Attribute, values: Any) -> Quantity:
    dimension, symbol = found.dimension or owner.dimension, f"{found.symbol}({owner.name})"
    unit = unit_of(owner.whole.mechanism.unit, dimension, found.order)
    # what a recorded motion has stays as it is
    plain = np.asarray(values) if isinstance(values, (np.ndarray, *PLAIN, complex)) else values
    return Quantity(f"{owner.name}.{found.word}", unit, plain, found.order, dimension, symbol)
