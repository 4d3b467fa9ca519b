"""What reads each kind of value of a mechanism file, and the ends of guides."""

from __future__ import annotations

from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.files.single_values import (
    Reader,
    bad,
    flag,
    name,
    names,
    numbers,
    points,
    sign,
    single,
    table,
    text,
    two,
    whole,
    wrong,
)
from compoundkin.files.written_quantities import (
    coordinate,
    degrees,
    margin,
    place,
    places,
    point,
    published,
    rate,
    times,
    turn,
    values,
)
from compoundkin.model.fields import Kind


def reach(value: Any, where: str, angle: bool | None = None) -> tuple[Number | str | None, Number | str | None]:
    """Read from where to where a guide reaches.

    It is ``[from, to]``, numbers or letters; ``{from}``, ``{to}`` or both.

    >>> reach([0.8, "B"], "slides[0].reach"), reach({"to": 2}, "slides[0].reach")
    ((0.8, 'B'), (None, 2.0))
    """
    how = "write [from, to], numbers or points, or { to = ... } where it is open"
    if isinstance(value, dict) and value and value.keys() <= {"from", "to"}:
        value = [value.get("from"), value.get("to")]
    elif not isinstance(value, list) or len(value) != 2 or None in value:
        raise wrong(where, value, "two ends", how)
    low, high = (
        end if end is None or isinstance(end, str) else coordinate(end, f"{where}[{index}]", bool(angle))
        for index, end in enumerate(value)
    )
    return low, high


def spot(value: Any, where: str, angle: bool | None = None) -> Number | str:
    """Read a point of a link. It is a letter, or a place in the link's frame.

    >>> spot("A", "masses[0].at"), spot([1, 2], "masses[0].at")
    ('A', (1+2j))
    """
    return name(value, where) if isinstance(value, str) else point(value, where)


def spots(value: Any, where: str, angle: bool | None = None) -> tuple[Number | str, ...]:
    """Read a list of points of a link, letters or places.

    >>> spots(["A", [1, 2]], "outlines[0].polygon")
    ('A', (1+2j))
    """
    if not isinstance(value, list):
        raise wrong(where, value, "a list of points", 'write ["A", [3, 4], "B"]')
    return tuple(spot(one, f"{where}[{index}]") for index, one in enumerate(value))


def layers(value: Any, where: str, angle: bool | None = None) -> tuple[int, ...]:
    """Read a layer, or a list of them.

    >>> layers(1, "outlines[0].layer"), layers([0, 2], "outlines[0].layer")
    ((1,), (0, 2))
    """
    if value == []:
        raise bad(where, "the list is empty", "write a layer, or leave it out")
    if not isinstance(value, list):
        return (whole(value, where),)
    return tuple(sorted({whole(one, f"{where}[{index}]") for index, one in enumerate(value)}))


def units(value: Any, where: str, angle: bool | None = None) -> dict[str, str]:
    """Read the names of units.

    >>> units({"length": "mm", "mass": "kg", "force": "N"}, "units")["mass"]
    'kg'
    """
    if not isinstance(value, dict):
        raise wrong(where, value, "a table", 'write { length = "mm", mass = "kg", force = "N" }')
    return {key: text(unit, f"{where}.{key}") for key, unit in value.items()}


READERS: dict[Kind, Reader] = {
    "name": name,
    "spot": spot,
    "spots": spots,
    "layers": layers,
    "units": units,
    "text": text,
    "names": names,
    "length": numbers,
    "angle": degrees,
    "point": point,
    "sign": sign,
    "flag": flag,
    "two": two,
    "points": points,
    "drawing": table,
    "whole": whole,
    "span": single,
    "times": times,
    "coordinate": coordinate,
    "number": single,
    "turn": turn,
    "place": place,
    "places": places,
    "route": places,
    "values": values,
    "rate": rate,
    "at": table,
    "published": published,
    "margin": margin,
    "reach": lambda value, where, _: reach(value, where),
    "sweep": lambda value, where, _: reach(value, where, True),
}
