"""The elements that a mechanism is written with: link, drive, drawn, mode, expect.

A driver prescribes the coordinate of a pair, or the motion of a point or of a link.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import Item, Key
from compoundkin.model.geometry import FRAME, real, vector
from compoundkin.model.prescribed_motion import PrescribedMotion

if TYPE_CHECKING:
    from compoundkin.model.laws import Law


@dataclass(frozen=True, eq=False, repr=False)
class Drive(ShortRepr, Item):
    """A driver: it prescribes the free coordinate of the pair between `link` and `on`.

    `values` (radians or a length, None for a full turn), `speed`, `acceleration` and `jerk` are numbers or
    arrays; the last axis of `values` is the motion. Or `law` says how the coordinate moves in time.
    """

    name: str
    link: str
    on: str = FRAME
    pair: str = ""
    values: Number | None = None
    speed: Number = 1.0
    acceleration: Number = 0.0
    jerk: Number = 0.0
    law: Law | None = None

    keys: ClassVar[tuple[Key, ...]] = (
        Key("name", "name", "What the driver is called; the driven link's name where it is left out."),
        Key("link", "name", "The driven link.", required=True),
        Key("on", "name", "The link it is driven against.", default=FRAME),
        Key("pair", "name", "The letter of the pin or name of the slide, where the two links share several."),
        Key("values", "values", "Values of the driven coordinate; a full turn where they are left out."),
        Key("speed", "rate", "Rate of the driven coordinate: rad/s for a pin, length/s for a slide.", default=1.0),
        Key("acceleration", "length", "Second rate, rad/s^2 or length/s^2.", default=0.0),
        Key("jerk", "length", "Third rate, rad/s^3 or length/s^3.", default=0.0),
        Key("law", "law", "How the coordinate moves in time, instead of values and rates."),
    )


@overload
def drive(
    link: str,
    *,
    on: str = ...,
    pair: str = ...,
    values: Any = ...,
    speed: Any = ...,
    acceleration: Any = ...,
    jerk: Any = ...,
    law: Any = ...,
    name: str = ...,
) -> Drive: ...


@overload
def drive(
    link: str,
    *,
    along: Any = ...,
    x: Any = ...,
    y: Any = ...,
    angle: Any = ...,
    time: Any = ...,
    law: Any = ...,
    on: str = ...,
    name: str = ...,
) -> PrescribedMotion: ...


@checked
def drive(
    link: str,
    *,
    on: str = FRAME,
    pair: str = "",
    values: Any = None,
    speed: Any = 1.0,
    acceleration: Any = 0.0,
    jerk: Any = 0.0,
    law: Any = None,
    name: str = "",
    along: Any = None,
    time: Any = None,
    x: Any = None,
    y: Any = None,
    angle: Any = None,
) -> Drive | PrescribedMotion:
    """Return a driver of the pair between `link` and `on`; or of a point.

    Angles are in radians.

    `law` is one of `constant_speed`, `constant_acceleration`, `program`, `time_table`, or a Python function
    of an array of times. Raises InvalidMechanism for anything else.

    The other way round, `link` may be a point whose motion is prescribed: `along` places at times `time`, along a line
    or a curve (two places, four or more, a profile) by a `law` of the length of arc, or along a Python function of time
    that returns complex places. Or one of its coordinates `x` and `y` is prescribed, or both, each by a law, a function
    or a number; so is the `angle` of a link that no pair joins to `on`. Coordinates and angles are those in the link
    `on`. The drivers' values are then found by solving.

    >>> drive("crank").name
    'crank'
    >>> drive("crank", law=lambda t: 0.5 * np.sin(t)).law.kind
    'function'
    >>> drive("G", along=[0, 10j], time=[0, 1]).drivers
    {'x': 'G.x', 'y': 'G.y'}
    """
    given = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    where = f"drives.{name or link}"
    prescribed = {"along": along, "x": x, "y": y, "angle": angle}
    if time is not None or any(value is not None for value in prescribed.values()):
        beside = [
            key for key, one in {"pair": pair or None, **given}.items() if one is not None and key not in _DEFAULT_RATES
        ]
        beside += [key for key, default in _DEFAULT_RATES.items() if not np.array_equal(given[key], default)]
        return _prescribed_motion(where, link, on, name, prescribed, time, law, beside)
    numbers = {key: real(f"{where}.{key}", value) for key, value in given.items()}
    return Drive(name or link, link, on, pair, **numbers, law=None if law is None else _law_of(f"{where}.law", law))


def _law_of(where: str, law: Any) -> Law | None:
    from compoundkin.model.laws import as_law

    return as_law(where, law)


# The rates of a driver where none are given.
_DEFAULT_RATES = {"speed": 1.0, "acceleration": 0.0, "jerk": 0.0}


def _prescribed_motion(
    where: str, what: str, on: str, name: str, prescribed: dict[str, Any], time: Any, law: Any, beside: list[str]
) -> PrescribedMotion:
    """Return the prescribed motion of a point or of a link."""
    from compoundkin.model.prescribed_paths import as_path, as_prescribed

    if beside:
        how = f"leave {', '.join(beside)} out"
        raise InvalidMechanism(Problem(f"{where}.{beside[0]}", "its motion is prescribed already", how))
    along = prescribed["along"]
    if along is None and (time is not None or law is not None):
        what_is = "times and a law of the length of arc are those of a path"
        raise InvalidMechanism(Problem(where, what_is, "give along=, or the law itself as x=, y= or angle="))
    path = None if along is None else as_path(f"{where}.along", along, time, _law_of(f"{where}.law", law))
    laws = {word: as_prescribed(f"{where}.{word}", prescribed[word]) for word in ("x", "y", "angle")}
    is_link = prescribed["angle"] is not None
    return PrescribedMotion(name or what, "" if is_link else what, what if is_link else "", on, path, **laws)


@dataclass(frozen=True, eq=False, repr=False)
class Link(ShortRepr, Item):
    """A rigid link: its name and its points.

    `points` maps each letter to its place in the link's own frame (complex, a number or an array), or to
    None for a link given as drawn.
    """

    name: str
    points: Mapping[str, Number | None]

    @property
    def letters(self) -> tuple[str, ...]:
        """The names of its points, as written."""
        return tuple(self.points)

    @property
    def is_drawn(self) -> bool:
        """Whether its dimensions are to be read off the drawing."""
        return any(p is None for p in self.points.values())


@dataclass(frozen=True)
class Mode(Item):
    """The assembly mode of the group that holds `links`. It is +1 or -1, as the group's kind defines it."""

    links: tuple[str, ...]
    sign: int


@dataclass(frozen=True, eq=False, repr=False)
class Drawn(ShortRepr, Item):
    """Points of one pose in global coordinates, drawn exactly or roughly. They choose the assembly mode."""

    points: Mapping[str, Number]


@dataclass(frozen=True)
class Expectation(Item):
    """A published value of a quantity at given driver values, with a tolerance.

    `at` holds driver values (radians or lengths) and, for "speed", "acceleration", keys such as "crank.speed".
    Angles in `value` are radians.
    """

    quantity: str
    value: complex
    tolerance: float
    at: tuple[tuple[str, float], ...] = ()


@checked
def link(name: str, *letters: str, **points: Any) -> Link:
    """Return a link with its points. ``A=(x, y)`` or complex numbers in the link's frame, or letters alone.

    Points given by letters alone are read off the drawing; without a drawing the mechanism has a structure but no
    dimensions.
    Raises InvalidMechanism for a point that is not a planar vector.

    >>> link("crank", E=(0, 0), D=(14, 0)).points["D"]
    (14+0j)
    >>> link("crank", "E", "D").is_drawn
    True
    """
    if "length" in points:
        first, second = (*letters, "A", "B")[:2] if len(letters) == 2 else ("A", "B")
        what, shown = "a link has no length of its own: its points say it", short_repr(points["length"])
        raise InvalidMechanism(Problem(f"links.{name}", what, f'write link("{name}", {first}=0, {second}={shown})'))
    if len(points) == 1 and (found := re.fullmatch("([A-Z])([A-Z])", next(iter(points)))):
        (ends, value), (first, second) = next(iter(points.items())), found.groups()
        if isinstance(value, int | float) and value:
            what = f"{ends!r} would be a single point, not the length from {first} to {second}"
            remedy = f'write link("{name}", {first}=0, {second}={short_repr(value)})'
            raise InvalidMechanism(Problem(f"links.{name}", what, remedy))
    both = [letter for letter in letters if letter in points]
    if both or (letters and points) or len(set(letters)) < len(letters):
        what = "points are given twice, or partly as drawn"
        raise InvalidMechanism(Problem(f"links.{name}", what, "give all by letters or all by coordinates"))
    placed = _points(f"links.{name}.points", points)
    return Link(name, placed if placed else dict.fromkeys(letters))


@checked
def drawn(**points: Any) -> Drawn:
    """Return points as drawn, in global coordinates. The dimensions of links given by letters, and the assembly mode.

    >>> drawn(A=(3, 4)).points["A"]
    (3+4j)
    """
    return Drawn(_points("drawn", points))


@checked
def mode(sign: int, *links: str) -> Mode:
    """Return the choice of an assembly mode, +1 or -1, for the links' group.

    >>> mode(-1, "coupler", "rocker").sign
    -1
    """
    if sign not in (1, -1):
        raise InvalidMechanism(Problem("modes", f"an assembly mode is +1 or -1, not {sign!r}"))
    return Mode(links, sign)


@checked
def expect(quantity: str, value: Any, tolerance: float, **at: float) -> Expectation:
    """Return a published value to compare the solved motion with, at the given driver values.

    >>> expect("block.angle", 0.5, 1e-3, crank=1.0).at
    (('crank', 1.0),)
    """
    published = vector("expected", value)
    if np.ndim(published):
        raise InvalidMechanism(Problem("expected", f"{short_repr(value)} is not one number", "give a number or (x, y)"))
    return Expectation(quantity, complex(published), float(real("expected.tolerance", tolerance)), tuple(at.items()))


def _points(where: str, points: Mapping[str, Any]) -> dict[str, Number]:
    problems: list[Problem] = []
    placed: dict[str, Number] = {}
    for letter, value in points.items():
        try:
            placed[letter] = vector(f"{where}.{letter}", value)
        except InvalidMechanism as error:
            problems += error.problems
    if problems:
        raise InvalidMechanism(problems)
    return placed
