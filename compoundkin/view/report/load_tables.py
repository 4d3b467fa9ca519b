"""Tables of what is written of forces: masses and loads."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.model.elements import Load
from compoundkin.view.report.report_data import Column, TableBlock
from compoundkin.view.report.wording import number


def masses_table(forces: Forces) -> TableBlock:
    """Return the masses as they are written, the first of several designs."""
    units, mechanism = forces.units, forces.motion.mechanism
    columns = (Column("link"), Column("mass", units.mass, "each"), Column("mass centre"),
               Column("inertia about it", f"{units.mass} {units.length}^2", "each"))  # fmt: skip
    rows = [(one.link, _first(one.mass), _place(one.at), _first(one.inertia)) for one in mechanism.masses.values()]
    return TableBlock(columns, tuple(rows))


def loads_table(forces: Forces) -> TableBlock:
    """Return the loads as written. What each is, on which links, with which numbers."""
    rows = [(one.name, one.title, ", ".join(one.links), _told(one)) for one in forces.motion.mechanism.loads.values()]
    return TableBlock((Column("load"), Column("kind"), Column("on"), Column("as written")), tuple(rows))


def _told(load: Load) -> str:
    """The numbers of a load, by what they are called."""
    names = [f.name for f in fields(load) if f.name not in ("name", *load.link_keys)]
    values = {name: _value(getattr(load, name)) for name in names}
    return ", ".join(f"{name} {value}" for name, value in values.items() if value)


def _value(value: Any) -> str:
    if value is None or isinstance(value, bool | str):
        return str(value or "")
    if callable(value):
        return "a function"
    values = np.ravel(np.asarray(value))
    if np.iscomplexobj(values):
        parts = [_range(values.real), _range(values.imag)]
        return f"({', '.join(parts)})"
    return _range(values)


def _range(values: Number) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return number(low) if low == high else f"{number(low)} to {number(high)}"


def _place(at: Any) -> str:
    if isinstance(at, str):
        return at
    place = complex(_first(at))
    return f"({number(place.real)}, {number(place.imag)})"


def _first(value: Any) -> Any:
    return first_entry(value) if np.ndim(value) else value
