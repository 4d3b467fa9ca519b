"""Quantities of a motion by what they are called: "G.velocity", "bar.angle", "slot.rate"."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.errors import Problem, UnknownName, nearest

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion

PER_SECOND = ("", "/s", "/s^2", "/s^3")

# What may follow a name, with how many derivatives it takes; the first is meant by the name alone.
POINT = {"position": 0, "velocity": 1, "acceleration": 2, "jerk": 3, "x": 0, "y": 0, "speed": 1}
LINK = {"angle": 0, "angular_velocity": 1, "angular_acceleration": 2, "angular_jerk": 3}
PAIR = {"value": 0, "rate": 1, "second": 2, "third": 3}
DRIVER = {**PAIR, "speed": 1, "acceleration": 2, "jerk": 3}

HIGHEST_ORDER = 3


@dataclass(frozen=True, eq=False)
class Quantity:
    """One quantity over a motion: complex values for a vector, real ones otherwise; `unit` is that of `values`.

    `order` is how many time derivatives it takes. Angles are radians: `is_angle`.
    """

    name: str
    values: Any
    unit: str
    order: int
    is_angle: bool

    @property
    def is_vector(self) -> bool:
        """Whether it is a planar vector."""
        return np.iscomplexobj(self.values)

    @property
    def shown(self) -> Quantity:
        """As it is shown to people: angles in degrees.

        >>> Quantity("bar.angle", np.array([np.pi]), "rad", 0, True).shown.values.tolist()
        [180.0]
        """
        if not self.is_angle:
            return self
        return Quantity(self.name, degrees(self.values), "deg", self.order, True)


def degrees(angle: Any) -> Any:
    """Radians as degrees; a short decimal that the conversion misses by its own rounding is that decimal.

    >>> float(np.rad2deg(np.deg2rad(30.0))), float(degrees(np.deg2rad(30.0)))
    (29.999999999999996, 30.0)
    """
    exact = np.rad2deg(angle)
    short = np.round(exact, 9)
    return np.where(np.abs(short - exact) <= 2.0 * np.spacing(np.abs(exact)), short, exact)


def quantity(motion: Motion, name: str) -> Quantity:
    """The quantity of a name such as "G.velocity"; "G" alone is G.position, "bar" bar.angle, "slot" slot.value.

    Points have position, velocity, acceleration, jerk, x, y, speed; links angle, angular_velocity,
    angular_acceleration, angular_jerk; pairs and drivers value, rate, second, third (and angle or
    displacement for value). Raises UnknownName with the nearest known name.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> found = quantity(solve(crank, {"crank": [0.0]}, speed=3.0), "B.velocity")
    >>> found.values.tolist(), found.unit
    ([6j], 'mm/s')
    """
    owner, dot, attribute = name.rpartition(".") if "." in name else (name, "", "")
    owners = list(_owners(motion, owner))
    if not owners:
        known = nearest(owner, known_owners(motion))
        raise UnknownName(Problem(name, f"there is no point, link, pair or driver {owner!r}", known))
    for one in owners:
        if attribute in one.attributes or not dot:
            return one.read(name, attribute if dot else next(iter(one.attributes)))
    attributes = list(dict.fromkeys(a for one in owners for a in one.attributes))
    raise UnknownName(Problem(name, f"{owner!r} has no {attribute!r}", _nearest(owner, attribute, attributes)))


def order_of(name: str) -> int:
    """How many time derivatives a quantity takes, as far as its name tells.

    >>> order_of("G.velocity"), order_of("bar.angular_jerk"), order_of("G")
    (1, 3, 0)
    """
    attribute = name.rpartition(".")[2] if "." in name else ""
    return max((table.get(attribute, 0) for table in (POINT, LINK, DRIVER)), default=0)


def known_owners(motion: Motion) -> list[str]:
    """All that has quantities: points, links, pairs and drivers, each once."""
    tables: tuple[Mapping[str, Any], ...] = (motion.points, motion.links, motion.pairs, motion.drives)
    return list(dict.fromkeys(name for table in tables for name in table))


@dataclass(frozen=True)
class _Owner:
    """A point, link, pair or driver of a motion, the attributes it has and the unit of its position."""

    motion: Any
    unit: str
    attributes: Mapping[str, int]

    def read(self, name: str, attribute: str) -> Quantity:
        """The quantity of an attribute."""
        order = self.attributes[attribute]
        known = hasattr(type(self.motion), attribute)
        values = getattr(self.motion, attribute) if known else self.motion.derivative(order)
        unit = self.unit + PER_SECOND[order]
        return Quantity(name, np.asarray(values), unit, order, unit == "rad")


def _owners(motion: Motion, name: str) -> Iterator[_Owner]:
    """All that a name may mean, in the order in which it is tried."""
    length = motion.mechanism.unit or "length"
    if name in motion.points:
        yield _Owner(motion.points[name], length, POINT)
    if name in motion.links:
        yield _Owner(motion.links[name], "rad", LINK)
    for table, attributes in ((motion.pairs, PAIR), (motion.drives, DRIVER)):
        if name in table:
            found = table[name]
            synonym = {"angle": 0} if found.is_angle else {"displacement": 0}
            yield _Owner(found, "rad" if found.is_angle else length, {**attributes, **synonym})


def _nearest(owner: str, attribute: str, known: list[str]) -> str:
    remedy = nearest(attribute, known)
    return f"did you mean '{owner}.{remedy.split(chr(39))[1]}'?" if remedy.startswith("did") else remedy
