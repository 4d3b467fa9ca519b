"""What can be wrong with the masses and loads of a mechanism, and what is most often a slip."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.errors import LikelySlip, Problem, nearest, warn
from compoundkin.model.attributes import TIME
from compoundkin.model.elements import Friction, Gravity, Load, Mass, Pretension
from compoundkin.model.loads.amounts import tables_of
from compoundkin.model.loads.contract import WrittenNames
from compoundkin.model.loads.uniform_bodies import uniform_body
from compoundkin.model.number_problems import is_finite
from compoundkin.model.written import Written

GRAVITY = "gravity"
# An inertia below this part of that of a uniform bar or plate through the link's points is most often one in another
# unit: kg m^2 among millimetres are a millionth, kg cm^2 a hundredth.
SLIGHT = 1e-3
# What of a load holds numbers, and may be an array over the motion.
_NUMBERS = ("length", "amount", "planar", "point", "spot", "coordinate")

Weighed: TypeAlias = Mass | Load | Friction | Pretension


def load_problems(mechanism: Written, names: WrittenNames, has_units: bool) -> list[Problem]:
    """Return what is wrong with masses and loads. They need units, well written or not."""
    found = [] if has_units else list(_without_units(mechanism))
    for where, item in placed_loads(mechanism):
        numbers = list(_no_numbers(where, item))
        found += numbers
        if not numbers:
            # a load on a pin is one on a link of it
            whole = item.completed(names) if isinstance(item, Load) else item
            found += whole.problems(names, where)
            found += _unknown_tables(where, item, names)
    return [*found, *_used_twice(mechanism, names), *_gravities(mechanism), *_shapes(mechanism)]


def placed_loads(mechanism: Written) -> Iterator[tuple[str, Weighed]]:
    """Yield each mass and load with its place in a file."""
    count: dict[str, int] = {}
    for item in mechanism.items:
        if isinstance(item, Mass | Load | Friction | Pretension):
            index = count.get(item.table, 0)
            count[item.table] = index + 1
            yield f"{item.table}[{index}]", item


def _without_units(mechanism: Written) -> Iterator[Problem]:
    """Find masses and forces of a mechanism that does not say what they are in."""
    said = next((item for _, item in placed_loads(mechanism)), None)
    if said is not None:
        what = f"it has a {said.title}, and masses and forces need units"
        yield Problem("units", what, 'write units={"length": "mm", "mass": "kg", "force": "N"}')


def _numbers_of(item: Weighed) -> Iterator[tuple[str, Any]]:
    """Yield the numbers and arrays that an item holds, by their keys."""
    for key in item.keys:
        held = getattr(item, key.name)
        if key.kind in _NUMBERS and not isinstance(held, str) and held is not None:
            for part in held if isinstance(held, tuple) else (held,):
                if isinstance(part, int | float | complex | np.ndarray):
                    yield key.name, part


def load_designs(mechanism: Written) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of masses and loads over designs with their places.

    The motion's axis is left out.
    """
    for where, item in placed_loads(mechanism):
        for key, value in _numbers_of(item):
            if np.ndim(value) > 1:
                yield f"{where}.{key}", value[..., :1]


def _no_numbers(where: str, item: Weighed) -> Iterator[Problem]:
    """Find what is empty or not finite, and a mass that would change along the motion."""
    for key, value in _numbers_of(item):
        if not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif isinstance(item, Mass | Friction) and np.ndim(value) and np.shape(value)[-1] > 1:
            what = f"it holds {np.shape(value)[-1]} numbers along the motion, in which it cannot change"
            yield Problem(f"{where}.{key}", what, "give one number, or one for each design: [[1.0], [2.0]]")
    for needed in item.keys:
        if needed.required and needed.kind in _NUMBERS and getattr(item, needed.name) is None:
            yield Problem(f"{where}.{needed.name}", "it is missing", needed.doc)


def _unknown_tables(where: str, item: Weighed, names: WrittenNames) -> Iterator[Problem]:
    """Find tables over what there is not."""
    for key in item.amounts if isinstance(item, Load) else ():
        for table in tables_of(getattr(item, key)):
            if table.over not in ("", TIME) and names.coordinate(table.over) is None:
                what = f"there is no pair, pin or driver {table.over!r}"
                yield Problem(f"{where}.{key}.over", what, nearest(table.over, [TIME, *names.pairs]))


def _used_twice(mechanism: Written, names: WrittenNames) -> Iterator[Problem]:
    """Find two masses of a link, two frictions of a pair by whichever names, and names of two loads."""
    seen = set[tuple[str, object]]()
    for where, item in placed_loads(mechanism):
        kind = "load" if isinstance(item, Load) else item.title
        if isinstance(item, Load) and not (item.name.isprintable() and not set(item.name) & set(".,")):
            yield Problem(f"{where}.name", f"{item.name!r} is not a name", "use printable text without dots, commas")
        if (kind, meant := _meant(item, names)) in seen and isinstance(item, Load):
            yield Problem(where, f"the name {item.name!r} is used twice", "names are unique: give one of them a name")
        elif (kind, meant) in seen:
            yield Problem(where, f"{item.name!r} has a {kind} already", "leave one of them out, or add them up")
        seen.add((kind, meant))


def _meant(item: Weighed, names: WrittenNames) -> object:
    """Return what an item may be once of: a name, or the two links of a pair and where."""
    pair = names.pair(item.pair) if isinstance(item, Friction | Pretension) else None
    return item.name if pair is None else (pair.title, pair.letters, frozenset(pair.members))


def _gravities(mechanism: Written) -> Iterator[Problem]:
    given = [item.vector for item in mechanism.items if isinstance(item, Gravity)]
    if len(given) > 1:
        yield Problem(GRAVITY, "it is given twice", "leave one of them out")
    for value in given:
        if not is_finite(value):
            yield Problem(GRAVITY, "the value is empty or not finite")


def _shapes(mechanism: Written) -> Iterator[Problem]:
    """Find arrays of loads that do not broadcast with each other and with the points of links."""
    total: tuple[int, ...] = ()
    points = [(f"links.{name}.points.{letter}", np.shape(place)) for name, link in mechanism.links.items()
              for letter, place in link.points.items() if isinstance(place, np.ndarray)]  # fmt: skip
    held = [(f"{where}.{key}", np.shape(value)) for where, item in placed_loads(mechanism)
            for key, value in _numbers_of(item)]  # fmt: skip
    for place, shape in [*points, *held] if any(shape for _, shape in held) else ():
        try:
            total = np.broadcast_shapes(total, shape)
        except ValueError:
            what = f"shape {shape} does not broadcast with {total}"
            yield Problem(place, what, "give a new axis to designs: the last axis is the motion")


def load_warnings(mechanism: Any) -> None:
    """Warn of inertias that are far too small for their links."""
    told = [item for item in mechanism.items if isinstance(item, Mass) and item.inertia is not None]
    for item in told if not mechanism.unplaced else ():
        points = list(mechanism.geometry.points[item.link].values())
        uniform = np.asarray(mechanism.masses[item.link].mass * uniform_body(points).inertia)
        if np.any((np.asarray(item.inertia) > 0.0) & (item.inertia < SLIGHT * uniform)):
            part = float(np.min(item.inertia / uniform))
            what = f"masses.{item.link}.inertia: it is {part:.2g} of that of a uniform body through the link's points"
            warn(f"{what}; it is in {mechanism.units.mass} {mechanism.units.length}^2", LikelySlip)
