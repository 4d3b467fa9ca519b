"""The table of a motion that `compoundkin solve` writes: all columns, or those of chosen quantities."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files import motion_tables
from compoundkin.files.atomic import write_atomically
from compoundkin.kinematics.quantities import degrees, quantity

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion


@dataclass(frozen=True, eq=False)
class Values:
    """A column: one value a pose; angles in radians."""

    name: str
    unit: str
    values: Any

    @property
    def shown(self) -> Values:
        """As files for people have it: angles in degrees."""
        return Values(self.name, "deg", degrees(self.values)) if self.unit == "rad" else self


Columns: TypeAlias = tuple[Values, ...]


def columns(motion: Motion, outputs: Sequence[str] = ()) -> Columns:
    """The columns of a motion: designs, drivers and the outputs (everything where none are named), `assembled`.

    Raises UnknownName for an output the mechanism does not have.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> [c.name for c in columns(solve(crank, {"crank": [0.0]}), ["B.velocity"])]
    ['crank.value', 'B.velocity.x', 'B.velocity.y', 'assembled']
    """
    chosen = [part for name in outputs for part in _parts(motion, name)]
    units = motion_tables.units(motion)
    found = [Values(name, units.get(name, ""), values) for name, values in motion_tables.columns(motion).items()]
    if not outputs:
        return tuple(found)
    kept = {"assembled", "time", *(f"{name}.value" for name in motion.drives)}
    designs = max(len(motion.shape) - 1, 0)
    *first, last = [*found[:designs], *(c for c in found[designs:] if c.name in kept)]
    return (*first, *chosen, last)


def _parts(motion: Motion, name: str) -> Iterator[Values]:
    found = quantity(motion, name)
    values = np.broadcast_to(found.values, motion.shape).reshape(-1)
    if found.is_vector:
        yield Values(f"{name}.x", found.unit, values.real)
        yield Values(f"{name}.y", found.unit, values.imag)
    else:
        yield Values(name, found.unit, values)


def writer(path: str) -> Callable[[Columns], None]:
    """What writes a table to a file, by its suffix; raises InvalidInput for an unknown one."""
    write = WRITERS.get(Path(path).suffix.lower())
    if write is None:
        problem = Problem(path, "the name does not tell the format", f"tables end in {', '.join(WRITERS)}")
        raise InvalidInput(problem)
    return lambda found: write_atomically(path, write(found))


def csv_bytes(found: Columns) -> bytes:
    """The table as CSV, with units in the heads; every digit is written."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    shown = [column.shown for column in found]
    rows.writerow([f"{c.name} [{c.unit}]" if c.unit else c.name for c in shown])
    rows.writerows(zip(*(c.values.tolist() for c in shown), strict=True))
    return text.getvalue().encode("utf-8")


def json_bytes(found: Columns) -> bytes:
    """The table as JSON: {"columns": [{"name", "unit", "values"}]}, null where a pose is not assembled."""
    shown = [column.shown for column in found]
    tables = [{"name": c.name, "unit": c.unit, "values": list(map(_plain, c.values.tolist()))} for c in shown]
    return (json.dumps({"columns": tables}, ensure_ascii=False, allow_nan=False) + "\n").encode("utf-8")


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value


def _npz(found: Columns) -> Callable[[BinaryIO], Any]:
    save: Any = np.savez
    return lambda file: save(file, **{c.name: c.values for c in found})


def _parquet(found: Columns) -> Callable[[BinaryIO], Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InvalidInput(Problem("", "this needs pyarrow", "pip install 'compoundkin[parquet]'")) from None
    arrays = [pyarrow.array(c.values) for c in found]
    fields = [
        pyarrow.field(c.name, a.type, metadata={"unit": c.unit} if c.unit else None)
        for c, a in zip(found, arrays, strict=True)
    ]
    whole = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields))
    return lambda file: pyarrow.parquet.write_table(whole, file)


WRITERS: dict[str, Callable[[Columns], Callable[[BinaryIO], Any]]] = {
    ".csv": lambda found: lambda file: file.write(csv_bytes(found)),
    ".json": lambda found: lambda file: file.write(json_bytes(found)),
    ".npz": _npz,
    ".parquet": _parquet,
}
