"""Attributes of points, links, pairs and drivers, as in "G.velocity", with symbols, dimensions and units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number

Kind: TypeAlias = Literal["points", "links", "pairs", "drives"]
Dimension: TypeAlias = Literal["length", "angle", "time", "number", "force", "moment", "power"]
# Their units follow from those that a mechanism states.
OF_FORCES: tuple[Dimension, ...] = ("force", "moment", "power")
PER_SECOND = ("", "/s", "/s^2", "/s^3")
HIGHEST_ORDER = len(PER_SECOND) - 1
RADIANS, DEGREES = "rad", "deg"
# Degrees as people read them; files that programs read have the word.
DEGREE_SIGN = "°"
SUPERSCRIPTS = {"^2": "²", "^3": "³"}


class Attribute(NamedTuple):
    """A word that may follow a name. It has its symbol, and how many time derivatives it takes.

    Its dimension is that of its owner unless it has one of its own.
    """

    word: str
    symbol: str
    order: int
    dimension: Dimension | None = None


def _catalogue(*rows: tuple[str, str, int] | tuple[str, str, int, Dimension]) -> Mapping[str, Attribute]:
    return MappingProxyType({row[0]: Attribute(*row) for row in rows})


# The first attribute is meant by a name alone; the first of each order is a column of a whole table.
POINT = _catalogue(
    ("position", "r", 0), ("velocity", "v", 1), ("acceleration", "a", 2), ("jerk", "j", 3),
    ("x", "x", 0), ("y", "y", 0), ("speed", "|v|", 1),
)  # fmt: skip
LINK = _catalogue(
    ("angle", "θ", 0), ("angular_velocity", "ω", 1), ("angular_acceleration", "α", 2), ("angular_jerk", "α'", 3)
)
PAIR = _catalogue(("value", "q", 0), ("rate", "q'", 1), ("second", "q''", 2), ("third", "q'''", 3))
DRIVER: Mapping[str, Attribute] = MappingProxyType(
    {**PAIR, **_catalogue(("speed", "q'", 1), ("acceleration", "q''", 2), ("jerk", "q'''", 3))}
)
# By what a motion calls its tables of them, in the order in which a name is tried.
CATALOGUE: Mapping[Kind, Mapping[str, Attribute]] = MappingProxyType(
    {"points": POINT, "links": LINK, "pairs": PAIR, "drives": DRIVER}
)
# What the value of a pair or a driver is called besides, by what it is.
ALIASES: Mapping[Dimension, Mapping[str, Attribute]] = MappingProxyType(
    {"angle": _catalogue(("angle", "q", 0)), "length": _catalogue(("displacement", "q", 0))}
)
# What is derived at each pose of those that have it: by name alone, and no column of a whole table.
_RATIOS = _catalogue(("velocity_ratio", "m_V", 1, "number"), ("advantage", "m_A", 1, "number"))
_TRANSMISSION = _catalogue(("transmission_angle", "μ", 0, "angle"), ("transmission_index", "TI", 0, "number"))
_GUIDES = _catalogue(("pressure_angle", "φ", 0, "angle"), ("coriolis", "a_cor", 2, "length"))
# What forces have beside motions. It takes accelerations, those of the masses.
_ON_FRAME = _catalogue(("shaking_force", "F_s", 2, "force"), ("shaking_moment", "M_s", 2, "moment"))
_IN_PAIRS = _catalogue(
    ("force", "F", 2, "force"), ("moment", "M", 2, "moment"),
    # by the kind of pair: what presses across it and where, what teeth, strands and rolling wheels pass on
    ("normal", "N", 2, "force"), ("eccentricity", "e_N", 2, "length"), ("tangential", "F_t", 2, "force"),
    ("needed_friction", "μ_0", 2, "number"), ("separating", "F_r", 2, "force"), ("tooth_force", "F_z", 2, "force"),
    ("flank", "s", 2, "number"), ("first_pull", "S_1", 2, "force"), ("second_pull", "S_2", 2, "force"),
)  # fmt: skip
_OF_DRIVERS = _catalogue(("effort", "T", 2, "force"), ("power", "P", 2, "power"))
FORCES: Mapping[Kind, Mapping[str, Attribute]] = MappingProxyType(
    {"points": {}, "links": _ON_FRAME, "pairs": _IN_PAIRS, "drives": _OF_DRIVERS}
)
DERIVED: Mapping[Kind, Mapping[str, Attribute]] = MappingProxyType(
    {
        **{"points": {}, "links": {**_TRANSMISSION, **_RATIOS, **_ON_FRAME}},
        **{"pairs": {**_GUIDES, **_RATIOS, **_IN_PAIRS}, "drives": {**_RATIOS, **_OF_DRIVERS}},
    }
)
FORCE, MOMENT, NORMAL, ECCENTRICITY, TANGENTIAL, NEEDED_FRICTION, *_OF_WHEELS = _IN_PAIRS
SEPARATING, TOOTH_FORCE, FLANK, FIRST_PULL, SECOND_PULL = _OF_WHEELS
EFFORT, POWER = _OF_DRIVERS
SHAKING_FORCE, SHAKING_MOMENT = _ON_FRAME
VELOCITY_RATIO, ADVANTAGE = _RATIOS
TRANSMISSION_ANGLE, TRANSMISSION_INDEX = _TRANSMISSION
PRESSURE_ANGLE, CORIOLIS = _GUIDES
# The words of the derivatives, from the zeroth on, that a whole table has of each.
OF_POINTS, OF_LINKS, OF_PAIRS = tuple(POINT)[:4], tuple(LINK), tuple(PAIR)
OF_DRIVERS = (OF_PAIRS[0], *tuple(DRIVER)[4:])
# Those that are asked for by name elsewhere.
POSITION, VELOCITY, ACCELERATION = OF_POINTS[:3]
ANGLE, ANGULAR_VELOCITY, ANGULAR_ACCELERATION = OF_LINKS[:3]
VALUE, DISPLACEMENT, TIME = OF_PAIRS[0], *ALIASES["length"], "time"
# The length of a point's velocity; the rates of a driver.
SPEED, RATES = tuple(POINT)[-1], OF_DRIVERS[1:]
TABULATED: Mapping[Kind, tuple[str, ...]] = MappingProxyType(
    {"drives": OF_DRIVERS, "points": OF_POINTS, "links": OF_LINKS, "pairs": OF_PAIRS}
)
# The real numbers of a planar vector, as they are called behind its name.
LENGTH = "length"
PARTS: Mapping[str, Callable[[Number], Number]] = MappingProxyType({"x": np.real, "y": np.imag, LENGTH: np.abs})
# What a quantity has over a whole motion, as it is called behind its name.
MOTION_FIGURES = ("least", "greatest", "stroke", "time_ratio", "imbalance_angle")
LEAST, GREATEST, STROKE, TIME_RATIO, IMBALANCE = MOTION_FIGURES
# What may be the time derivative of an attribute, the first that there is; nothing means the attribute of a bare name.
RATE_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **{a: (b,) for words in (OF_DRIVERS, OF_LINKS, OF_PAIRS) for a, b in pairwise(words)},
        **dict.fromkeys(("", OF_LINKS[0]), (OF_LINKS[1], OF_PAIRS[1])),
        **dict.fromkeys(ALIASES["length"], (OF_PAIRS[1],)),
        **{xy: (f"{OF_POINTS[1]}.{xy}",) for xy in ("x", "y")},
        **{f"{a}.{xy}": (f"{b}.{xy}",) for a, b in pairwise(OF_POINTS) for xy in ("x", "y")},
    }
)


def unit_of(length: str, dimension: Dimension, order: int = 0) -> str:
    """Return the unit of a dimension or of its time derivative. `length` is that of lengths, if it has a name.

    >>> unit_of("mm", "length", 2), unit_of("", "length"), unit_of("", "angle", 1)
    ('mm/s^2', 'length', 'rad/s')
    """
    units = {"length": length or LENGTH, "angle": RADIANS, TIME: "s", "number": ""}
    return units.get(dimension, "") + PER_SECOND[order]


def ratio_unit(length: str, over: Dimension, under: Dimension) -> str:
    """Return the unit of a rate divided by another. A radian is a number.

    >>> ratio_unit("mm", "length", "angle"), ratio_unit("mm", "angle", "length"), ratio_unit("mm", "angle", "angle")
    ('mm', '1/mm', '')
    """
    if over == under:
        return ""
    return unit_of(length, "length") if over == "length" else f"1/{unit_of(length, 'length')}"


def is_angle_word(word: str) -> bool:
    """Tell whether an attribute is always an angle. Files have it in degrees.

    >>> is_angle_word("transmission_angle"), is_angle_word("value")
    (True, False)
    """
    return word == ANGLE or any(word in of and of[word].dimension == "angle" for of in DERIVED.values())


def coordinate_dimension(is_angle: bool) -> Dimension:
    """Return the dimension of a pair's or driver's coordinate."""
    return "angle" if is_angle else "length"


def unit_suffix(is_angle: bool, length: str) -> str:
    """Return the unit of a coordinate as it follows a number. It is empty where lengths have none."""
    return with_unit("", DEGREES if is_angle else length)


def with_unit(number: str, unit: str) -> str:
    """Return a number with its unit as texts have it: degrees as a sign, without a blank.

    >>> with_unit("30", "deg"), with_unit("30", "mm"), with_unit("30", "")
    ('30°', '30 mm', '30')
    """
    return f"{number}{DEGREE_SIGN}" if unit in (DEGREES, DEGREE_SIGN) else f"{number} {unit}".rstrip()


def plain_unit(unit: str) -> str:
    """Return a unit as terminals have it: with the sign of degrees, powers as they are typed.

    >>> plain_unit("deg"), plain_unit("deg/s"), plain_unit("mm/s^2")
    ('°', '°/s', 'mm/s^2')
    """
    return unit.replace(DEGREES, DEGREE_SIGN, 1) if unit in (DEGREES, f"{DEGREES}/s", f"{DEGREES}/s^2") else unit


def typeset_unit(unit: str) -> str:
    """Return a unit as pages and pictures have it: with the sign of degrees, and raised powers.

    >>> typeset_unit("deg"), typeset_unit("mm/s^2")
    ('°', 'mm/s²')
    """
    unit = plain_unit(unit)
    for plain, raised in SUPERSCRIPTS.items():
        unit = unit.replace(plain, raised)
    return unit


def derivative_order(name: str) -> int:
    """Tell from its name how many time derivatives a quantity takes.

    >>> [derivative_order(name) for name in ("G.velocity", "bar.angular_jerk", "G", "G.velocity.x")]
    [1, 3, 0, 1]
    """
    of = motion_figure(name)[0]
    word = vector_and_part(of)[0].rpartition(".")[2] if "." in of else ""
    tables = (POINT, LINK, DRIVER, *DERIVED.values())
    return max((table[word].order for table in tables if word in table), default=0)


def motion_figure(name: str) -> tuple[str, str]:
    """Return the quantity and the figure of its whole course. The figure is empty where none is named.

    >>> motion_figure("ram.displacement.stroke"), motion_figure("ram.displacement")
    (('ram.displacement', 'stroke'), ('ram.displacement', ''))
    """
    of, _, word = name.rpartition(".")
    return (of, word) if of and word in MOTION_FIGURES else (name, "")


def vector_and_part(name: str) -> tuple[str, str]:
    """Return the vector and the part that a name may mean. The part is empty where it can mean none.

    >>> vector_and_part("G.velocity.x"), vector_and_part("G.x"), vector_and_part("G.length")
    (('G.velocity', 'x'), ('G.x', ''), ('G', 'length'))
    """
    owner, _, part = name.rpartition(".")
    return (owner, part) if part == LENGTH or (part in PARTS and "." in owner) else (name, "")


def driver_and_rate(key: str, drivers: Sequence[str]) -> tuple[str, str]:
    """Return the driver of a key such as "crank.speed", and which rate. It is "" for the value, as of "G.x".

    >>> driver_and_rate("crank.speed", ["crank"]), driver_and_rate("G.x", ["G.x"])
    (('crank', 'speed'), ('G.x', ''))
    """
    if key in drivers:
        return key, ""
    name, dot, rate = key.rpartition(".")
    return (name, rate) if dot and (rate in RATES or name in drivers) else (key, "")


# The parts of a vector that make it up; its length does not.
AXES = tuple(PARTS)[:2]


def component_names(name: str) -> tuple[str, ...]:
    """Return the names of both components of a point or vector.

    >>> component_names("G.position")
    ('G.position.x', 'G.position.y')
    """
    return tuple(f"{name}.{axis}" for axis in AXES)
