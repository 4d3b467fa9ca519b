"""Designs in a file: a CSV or Parquet table with a column for each dimension."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import file_format
from compoundkin.files.parquet_library import parquet
from compoundkin.model.attributes import DEGREES

# Headers of CSV files, as `save` writes them: a name, and perhaps its unit.
_HEAD = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*)\])?")


def table_columns(path: str | os.PathLike[str]) -> dict[str, Number]:
    """Return the columns of a table by their names.

    Coordinates of points are columns of their own, "plate.C.x". Columns in degrees say so, as tables that `save`
    writes do: "slot.angle [deg]" in the head of a CSV file, the unit of a field in Parquet; they are returned in
    radians. Raises InvalidInput for an invalid table.
    """
    form = file_format("table", path)
    if form not in _READERS:
        raise InvalidInput(Problem(str(path), "designs are not read from such a file", "write a .csv or .parquet"))
    try:
        columns = _READERS[form](path)
    except (OSError, UnicodeDecodeError) as error:
        what = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidInput(Problem(str(path), f"it cannot be read: {what}")) from None
    names = [name for name, _, _ in columns]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InvalidInput(Problem(str(path), f"there are two columns {twice!r}", "one for each dimension"))
    return {name: np.deg2rad(values) if unit == DEGREES else values for name, unit, values in columns}


def _csv_columns(path: str | os.PathLike[str]) -> list[tuple[str, str, Number]]:
    with open(path, newline="", encoding="utf-8-sig") as file:
        heads = [_HEAD.fullmatch(head.strip()) for head in next(csv.reader([file.readline()]), [])]
        lines = file.readlines() or [""]
        try:
            # without rows it would warn
            rows = np.loadtxt(lines, delimiter=",", ndmin=2, comments=None) if lines[0] else np.empty((0, 0))
        except ValueError as error:
            raise InvalidInput(
                Problem(str(path), _csv_message(str(error)), "write numbers alone, apart by commas")
            ) from None
    if not rows.size or rows.shape[1] != len(heads):
        what = f"it has {len(heads)} names in its first line and {rows.shape[1]} columns of numbers"
        raise InvalidInput(Problem(str(path), what, "a name for each column, and a line for each design"))
    return [(head["name"], head["unit"] or "", rows[:, k]) for k, head in enumerate(heads) if head]


def _csv_message(error: str) -> str:
    """Return NumPy's message with lines of the file instead of rows."""
    shorter = error.partition(";")[0].replace(" to float64", "").rstrip(".")
    # it counts rows from 1 where their lengths differ, else from 0
    before = 1 if "changed" in shorter else 2
    return re.sub(r"at row (\d+)", lambda found: f"in line {int(found[1]) + before}", shorter)


def _parquet_columns(path: str | os.PathLike[str]) -> list[tuple[str, str, Number]]:
    read_table, broken = parquet(str(path)).read_table, import_module("pyarrow").ArrowInvalid
    try:
        whole = read_table(path)
    except broken:
        raise InvalidInput(Problem(str(path), "it is no Parquet file")) from None
    found = []
    for field in whole.schema:
        values = real_numbers(f"{path}: {field.name}", whole[field.name].to_numpy())
        found.append((field.name, (field.metadata or {}).get(b"unit", b"").decode(), values))
    return found


_READERS: Mapping[str, Callable[[str | os.PathLike[str]], list[tuple[str, str, Number]]]] = MappingProxyType(
    {"csv": _csv_columns, "parquet": _parquet_columns}
)
