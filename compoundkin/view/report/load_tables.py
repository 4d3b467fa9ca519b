"""Tables of what is written of forces: masses and loads."""

from __future__ import annotations

from dataclasses import Field, fields
from typing import Any

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.model.elements import Load
from compoundkin.model.loads.amounts import LoadFunction
from compoundkin.model.loads.load_table import LoadTable
from compoundkin.view.report.report_data import Column, TableBlock
from compoundkin.view.report.wording import number


def masses_table(forces: Forces) -> TableBlock:
    """Return the masses as they are written, the first of several designs."""
    units, mechanism = forces.units, forces.motion.mechanism
    columns = (Column("link"), Column("mass", units.mass, "each"), Column("mass centre"),
               Column("inertia about it", f"{units.mass} {units.length}^2", "each"))  # fmt: skip
    rows = [
        (one.link, first_number(one.mass), _place(one.at), first_number(one.inertia))
        for one in mechanism.masses.values()
    ]
    return TableBlock(columns, tuple(rows))


def loads_table(forces: Forces) -> TableBlock:
    """Return the loads as written. What each is, on which links, with which numbers."""
    rows = [(one.name, one.title, ", ".join(one.links), _told(one)) for one in forces.motion.mechanism.loads.values()]
    return TableBlock((Column("load"), Column("kind"), Column("on"), Column("as written")), tuple(rows))


def _told(load: Load) -> str:
    """The numbers of a load that are not as where nothing is said, by what they are called."""
    written = {key.name for key in load.keys} - {"name", *load.link_keys}
    own = [field for field in fields(load) if field.name in written]
    values = {field.name: _value(value) for field in own if not _is_usual(value := getattr(load, field.name), field)}
    return ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in values.items() if value)


def _is_usual(value: Any, field: Field[Any]) -> bool:
    return not np.ndim(value) and isinstance(value, type(field.default)) and bool(value == field.default)


def _value(value: Any) -> str:
    if value is None or isinstance(value, bool | str):
        return str(value or "")
    if isinstance(value, tuple):
        return f"({'; '.join(map(_value, value))})"
    if isinstance(value, LoadFunction):
        return "a function"
    if isinstance(value, LoadTable):
        over = f" over {value.over}" if value.over else ""
        return f"{_range(value.values)}, a table{over}"
    values = np.ravel(np.asarray(value))
    return f"({_range(values.real)}, {_range(values.imag)})" if np.iscomplexobj(values) else _range(values)


def _range(values: Number) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return number(low) if low == high else f"{number(low)} to {number(high)}"


def _place(at: Any) -> str:
    if isinstance(at, str):
        return at
    place = complex(first_number(at))
    return f"({number(place.real)}, {number(place.imag)})"


def first_number(value: Any) -> Any:
    """Return the first number of an array, or the number."""
    return first_entry(value) if np.ndim(value) else value
