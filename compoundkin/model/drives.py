"""Drivers: what a mechanism is moved by, prescribed at a pair or the other way round at a point or a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, overload

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number
from compoundkin.model.fields import Key
from compoundkin.model.geometry import FRAME, real
from compoundkin.model.laws import Law, as_law
from compoundkin.model.leads import Lead, as_path, as_prescribed


@dataclass(frozen=True, eq=False, repr=False)
class Drive(PrintsShort):
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
) -> Lead: ...
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
) -> Drive | Lead:
    """Return a driver of the pair between `link` and `on`; or of a point.

    Angles are in radians.

    `law` is one of `constant_speed`, `constant_acceleration`, `program`, `time_table`, or a Python function
    of an array of times. Raises InvalidMechanism for anything else.

    The other way round, `link` may be a point: it is led `along` places at times `time`, or along a line or a curve
    (two places, four or more, a profile) by a `law` of the length of way, or along a Python function of time that
    returns complex places. Or it is led by one coordinate `x` or `y`, or both, each a law, a function, a number; so is
    the `angle` of a link that no pair joins to `on`. Coordinates and angles are those in the link `on`. What drives
    is then found by solving.

    >>> drive("crank").name
    'crank'
    >>> drive("crank", law=lambda t: 0.5 * np.sin(t)).law.kind
    'function'
    >>> drive("G", along=[0, 10j], time=[0, 1]).drivers
    {'x': 'G.x', 'y': 'G.y'}
    """
    given = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    where = f"drives.{name or link}"
    told = {"along": along, "x": x, "y": y, "angle": angle}
    if time is not None or any(said is not None for said in told.values()):
        beside = [key for key, one in {"pair": pair or None, **given}.items() if one is not None and key not in _RATES]
        beside += [key for key, default in _RATES.items() if not np.array_equal(given[key], default)]
        return _lead(where, link, on, name, told, time, law, beside)
    numbers = {key: real(f"{where}.{key}", value) for key, value in given.items()}
    return Drive(name or link, link, on, pair, **numbers, law=as_law(f"{where}.law", law))


# What a driver's rates are where they are not given.
_RATES = {"speed": 1.0, "acceleration": 0.0, "jerk": 0.0}


def _lead(
    where: str, what: str, on: str, name: str, told: dict[str, Any], time: Any, law: Any, beside: list[str]
) -> Lead:
    """Return what leads a point or turns a link."""
    if beside:
        how = f"leave {', '.join(beside)} out"
        raise InvalidMechanism(Problem(f"{where}.{beside[0]}", "what is prescribed says how it moves", how))
    along = told["along"]
    if along is None and (time is not None or law is not None):
        what_is = "times and a law of the way are those of a path"
        raise InvalidMechanism(Problem(where, what_is, "give along=, or the law itself as x=, y= or angle="))
    path = None if along is None else as_path(f"{where}.along", along, time, as_law(f"{where}.law", law))
    laws = {word: as_prescribed(f"{where}.{word}", told[word]) for word in ("x", "y", "angle")}
    is_link = told["angle"] is not None
    return Lead(name or what, "" if is_link else what, what if is_link else "", on, path, **laws)
