"""Quantities of a motion, by what they are called: "G.velocity", "bar.angle", "slot.rate"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import degrees
from compoundkin.base.display import way
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.contract import HasQuantities, Lack, OfMotion, motion_of
from compoundkin.model.attributes import (
    ALSO,
    CATALOGUE,
    DEGREES,
    DERIVED,
    LENGTH,
    PARTS,
    RADIANS,
    Attribute,
    Dimension,
    Kind,
    coordinate_dimension,
    course_figure,
    readable,
    unit_of,
    vector_of,
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
        return f"{self.name} [{readable(self.unit)}]".lstrip() if self.unit else self.name

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


def known_owners(motion: HasQuantities) -> list[str]:
    """List what has quantities: points, links, pairs and drivers, each once."""
    return list(dict.fromkeys(name for kind in CATALOGUE for name in getattr(motion, kind)))


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
    of, figure = course_figure(name)
    if figure:
        return way("course")(motion, of, figure), ""
    try:
        return _whole(motion, name), ""
    except UnknownName:
        vector, _, part = name.rpartition(".")
        if not vector_of(name)[1] and not _is_known(motion, vector):
            raise
    found = _whole(motion, vector)
    if not found.is_vector:
        raise UnknownName(Problem(name, f"{vector} is no vector", f"leave .{part} out"))
    if part not in PARTS:
        raise UnknownName(Problem(name, f"{vector} has no {part!r}", nearest(part, list(PARTS))))
    return found, part


def _is_known(motion: HasQuantities, name: str) -> bool:
    """Tell whether a name is that of an owner with one of its attributes."""
    owner, _, word = name.rpartition(".")
    return any(owner in getattr(motion, k) and owner_of(motion, k, owner).has(word) for k in CATALOGUE)


def _whole(motion: HasQuantities, name: str) -> Quantity:
    """Return a quantity that is no part of another."""
    owner, dot, word = name.rpartition(".") if "." in name else (name, "", "")
    found = [owner_of(motion, kind, owner) for kind in CATALOGUE if owner in getattr(motion, kind)]
    if not found:
        what = f"there is no point, link, pair or driver {owner!r}"
        raise UnknownName(Problem(name, what, nearest(owner, known_owners(motion))))
    for one in found:
        if not dot or one.has(word):
            return replace(one.read(word if dot else next(iter(one.attributes))), name=name)
    for lack in filter(None, (one.lack(word) for one in found)):
        raise UnknownName(Problem(name, f"{owner!r} has no {word!r}: {lack.reason}", lack.remedy))
    words = list(dict.fromkeys(word for one in found for word in one.words))
    others = ", ".join(kind for kind in DERIVED if word in DERIVED[kind])
    what = f"{owner!r} has no {word!r}{f', which only {others} have' if others else ''}"
    raise UnknownName(Problem(name, what, _nearest(owner, word, words)))


class Owner(NamedTuple):
    """A point, link, pair or driver of a motion. Its name, the attributes it has, the unit of each order."""

    name: str
    kind: Kind
    whole: HasQuantities
    dimension: Dimension
    attributes: Mapping[str, Attribute]

    def read(self, word: str) -> Quantity:
        """Return the quantity of an attribute."""
        if word not in self.attributes:
            return self._derived(word)
        found, motion = self.attributes[word], getattr(self.whole, self.kind)[self.name]
        known = hasattr(type(motion), word)
        return self._quantity(found, getattr(motion, word) if known else motion.derivative(found.order))

    def has(self, word: str) -> bool:
        """Tell whether it has an attribute, or what is derived of such an owner."""
        return word in self.attributes or (word in DERIVED[self.kind] and self.lack(word) is None)

    def lack(self, word: str) -> Lack | None:
        """Return why it has not what is derived of others. None where there is no reason."""
        return FIGURES[self.kind][word].lack(self.whole, self.name) if word in DERIVED[self.kind] else None

    @property
    def words(self) -> list[str]:
        """All that it has."""
        return [word for word in (*self.attributes, *DERIVED[self.kind]) if self.has(word)]

    def _derived(self, word: str) -> Quantity:
        figure = FIGURES[self.kind][word]
        found = self._quantity(DERIVED[self.kind][word], figure.values(self.whole, self.name))
        return replace(found, **figure.own(self.whole, self.name))

    def _quantity(self, found: Attribute, values: Any) -> Quantity:
        dimension, symbol = found.dimension or self.dimension, f"{found.symbol}({self.name})"
        unit = unit_of(self.whole.mechanism.unit, dimension, found.order)
        return Quantity(f"{self.name}.{found.word}", unit, np.asarray(values), found.order, dimension, symbol)


def owner_of(motion: HasQuantities, kind: Kind, name: str) -> Owner:
    """Return a point, link, pair or driver as the owner of quantities."""
    if kind not in ("pairs", "drives"):
        return Owner(name, kind, motion, "length" if kind == "points" else "angle", CATALOGUE[kind])
    dimension = coordinate_dimension(getattr(motion, kind)[name].is_angle)
    return Owner(name, kind, motion, dimension, {**CATALOGUE[kind], **ALSO[dimension]})


def _nearest(owner: str, word: str, known: list[str]) -> str:
    remedy = nearest(word, known)
    return f"did you mean '{owner}.{remedy.split(chr(39))[1]}'?" if remedy.startswith("did") else remedy
