"""Validation of masses and loads, which need units."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.base.errors import LikelySlip, Problem, suggestion, warn
from compoundkin.model.attributes import TIME
from compoundkin.model.definition import MechanismDefinition
from compoundkin.model.loads.contract import RATE, ListedLoad, Load, NamedParts
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass, uniform_body
from compoundkin.model.validation import PRINTABLE, broadcast_problems, is_finite, is_printable, point_shapes

GRAVITY = "gravity"
# An inertia below this part of that of a uniform bar or plate through the link's points is most often one in another
# unit: kg m^2 among millimetres are a millionth, kg cm^2 a hundredth.
SMALL_INERTIA = 1e-3
# What of a load holds numbers, and may be an array over the motion.
_LOAD_NUMBERS = ("length", "amount", "planar", "point", "spot", "coordinate")


def load_problems(mechanism: MechanismDefinition, names: NamedParts, has_units: bool) -> list[Problem]:
    """Return the problems of masses and loads, which need units."""
    found = [] if has_units else list(_without_units(mechanism))
    for where, item in placed_loads(mechanism):
        numbers = list(_invalid_load_numbers(where, item))
        found += numbers
        if not numbers:
            # a load on a pin is one on a link of it
            whole = item.completed(names) if isinstance(item, Load) else item
            found += whole.problems(names, where)
            found += _unknown_tables(where, item, names)
    found += _rotors_without_masses(mechanism, names)
    return [*found, *_repeated_loads(mechanism, names), *_gravity_problems(mechanism), *_load_shape_problems(mechanism)]


def _rotors_without_masses(mechanism: MechanismDefinition, names: NamedParts) -> Iterator[Problem]:
    """Find rotors with an inertia on links without a mass, in whose inertia they would be."""
    heavy = {item.link for item in mechanism.items if isinstance(item, Mass)}
    for where, item in placed_loads(mechanism):
        rotor = item.completed(names).rotor() if isinstance(item, Load) else None
        if rotor is not None and (link := rotor[0]) and link not in heavy:
            remedy = f'write mass("{link}", ...) too, or leave the inertia out'
            yield Problem(f"{where}.inertia", f"{link!r}, which it turns, has no mass", remedy)


def placed_loads(mechanism: MechanismDefinition) -> Iterator[tuple[str, ListedLoad]]:
    """Yield each mass and load with its place in a file."""
    count: dict[str, int] = {}
    for item in mechanism.items:
        if isinstance(item, ListedLoad):
            index = count.get(item.table, 0)
            count[item.table] = index + 1
            yield f"{item.table}[{index}]", item


def _without_units(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find masses and forces of a mechanism without units."""
    first = next((item for _, item in placed_loads(mechanism)), None)
    if first is not None:
        what = f"it has a {first.title}, and masses and forces need units"
        yield Problem("units", what, 'write units={"length": "mm", "mass": "kg", "force": "N"}')


def _load_numbers(item: ListedLoad) -> Iterator[tuple[str, Any]]:
    """Yield the numbers and arrays that an item holds, by their keys."""
    for key in item.keys:
        held = getattr(item, key.name)
        if key.kind in _LOAD_NUMBERS and not isinstance(held, str) and held is not None:
            for part in held if isinstance(held, tuple) else (held,):
                if isinstance(part, int | float | complex | np.ndarray):
                    yield key.name, part


def load_designs(mechanism: MechanismDefinition) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of masses and loads over designs with their places.

    The motion's axis is left out.
    """
    for where, item in placed_loads(mechanism):
        for key, value in _load_numbers(item):
            if np.ndim(value) > 1:
                yield f"{where}.{key}", value[..., :1]


def _invalid_load_numbers(where: str, item: ListedLoad) -> Iterator[Problem]:
    """Find values that are empty or not finite, and a mass that would change along the motion."""
    for key, value in _load_numbers(item):
        if not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif item.is_steady and np.ndim(value) and np.shape(value)[-1] > 1:
            what = f"it holds {np.shape(value)[-1]} numbers along the motion, in which it cannot change"
            yield Problem(f"{where}.{key}", what, "give one number, or one for each design: [[1.0], [2.0]]")
    for needed in item.keys:
        if needed.required and needed.kind in _LOAD_NUMBERS and getattr(item, needed.name) is None:
            yield Problem(f"{where}.{needed.name}", "it is missing", needed.doc)


def _unknown_tables(where: str, item: ListedLoad, names: NamedParts) -> Iterator[Problem]:
    """Find tables over unknown coordinates."""
    for key in item.amounts if isinstance(item, Load) else ():
        own = (TIME, RATE) if isinstance(item, Load) and item.has_rate else (TIME,)
        held = getattr(item, key)
        for over in (getattr(part, "over", "") for part in (held if isinstance(held, tuple) else (held,))):
            if over not in ("", *own) and names.coordinate(over) is None:
                what = f"there is no pair, pin or driver {over!r}"
                yield Problem(f"{where}.{key}.over", what, suggestion(over, [*own, *names.pairs]))


def _repeated_loads(mechanism: MechanismDefinition, names: NamedParts) -> Iterator[Problem]:
    """Find two masses of a link, two frictions of a pair by whichever name, and two loads of one name."""
    seen = set[tuple[str, object]]()
    for where, item in placed_loads(mechanism):
        kind = "load" if isinstance(item, Load) else item.title
        if isinstance(item, Load) and not is_printable(item.name):
            yield Problem(f"{where}.name", f"{item.name!r} is not a name", PRINTABLE)
        if (kind, meant := _load_identity(item, names)) in seen and isinstance(item, Load):
            yield Problem(where, f"the name {item.name!r} is used twice", "names are unique: give one of them a name")
        elif (kind, meant) in seen:
            yield Problem(where, f"{item.name!r} has a {kind} already", "leave one of them out, or add them up")
        seen.add((kind, meant))


def _load_identity(item: ListedLoad, names: NamedParts) -> object:
    """Return what may have one such item only: a name, or a pair by its links and points."""
    pair = names.pair(item.property_of) if item.property_of else None
    return item.name if pair is None else (pair.title, pair.letters, frozenset(pair.members))


def _gravity_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    given = [item.vector for item in mechanism.items if isinstance(item, Gravity)]
    if len(given) > 1:
        yield Problem(GRAVITY, "it is given twice", "leave one of them out")
    for value in given:
        if not is_finite(value):
            yield Problem(GRAVITY, "the value is empty or not finite")


def _load_shape_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find arrays of loads that do not broadcast with each other and with the points of links."""
    shapes = [(f"{where}.{key}", np.shape(value)) for where, item in placed_loads(mechanism)
            for key, value in _load_numbers(item)]  # fmt: skip
    if any(shape for _, shape in shapes):
        yield from broadcast_problems([*point_shapes(mechanism), *shapes])


def load_warnings(mechanism: Any) -> None:
    """Warn of inertias that are far too small for their links."""
    stated = [item for item in mechanism.items if isinstance(item, Mass) and item.inertia is not None]
    for item in stated if not mechanism.unplaced else ():
        points = list(mechanism.geometry.points[item.link].values())
        uniform = np.asarray(mechanism.masses[item.link].mass * uniform_body(points).inertia)
        if np.any((np.asarray(item.inertia) > 0.0) & (item.inertia < SMALL_INERTIA * uniform)):
            part = float(np.min(item.inertia / uniform))
            what = f"masses.{item.link}.inertia: it is {part:.2g} of that of a uniform body through the link's points"
            warn(f"{what}; it is in {mechanism.units.mass} {mechanism.units.length}^2", LikelySlip)
