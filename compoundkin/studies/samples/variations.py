"""The kinds of variations of a dimension: the first of this registry that fits is taken. Designs in a table's file."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.base.suffixes import file_format
from compoundkin.files.saved_files import parquet
from compoundkin.model.attributes import DEGREES
from compoundkin.programs.dimensions import FreeDimension
from compoundkin.studies.samples.distribution import Distribution
from compoundkin.studies.samples.value_ranges import AroundCentre, Levels, ValueRange
from compoundkin.studies.samples.variation import Variation

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


VARIATIONS: tuple[type[Variation], ...] = (ValueRange, Distribution, AroundCentre, Levels)
_REMEDY = "give a range (40, 60), a distribution scipy.stats.norm(40, 0.1), compoundkin.around(40, 0.1), or a list"


def variations_of(given: Mapping[str, Any] | str | os.PathLike[str]) -> dict[str, Variation]:
    """Return the variations of dimensions.

    Of a file with a table they are its columns. Raises InvalidInput with all that is wrong, each with its place, as
    dimensions.crank.B.
    """
    given = given if isinstance(given, Mapping) else table_columns(given)
    found: dict[str, Variation] = {}
    problems: list[Problem] = []
    for name, one in given.items():
        try:
            found[name] = variation_of(f"dimensions.{name}", one)
        except InvalidInput as error:
            problems += error.problems
    if not given:
        problems.append(Problem("dimensions", "there is none", 'name some: {"crank.B.x": (40, 60)}'))
    if problems:
        raise InvalidInput(problems)
    return found


def variation_of(where: str, given: Any) -> Variation:
    """Return the variation of a dimension. Raises InvalidInput for other objects."""
    if isinstance(given, Variation):
        return given
    for kind in VARIATIONS:
        found = kind.from_argument(where, given)
        if found is not None:
            return found
    raise InvalidInput(Problem(where, f"{short_repr(given)} is nothing that a dimension can be", _REMEDY))


def variation_from(where: str, data: Mapping[str, Any]) -> Variation:
    """Return the variation of plain data in a study file.

    Raises InvalidInput. Angles are in radians here, as in `Variation.data`.
    """
    fitting = [kind for kind in VARIATIONS if kind.keys[0] in data]
    if len(fitting) != 1:
        what = f"{short_repr(dict(data))} is nothing that a dimension can be"
        keys = ", ".join(kind.keys[0] for kind in VARIATIONS)
        raise InvalidInput(Problem(where, what, f"just one of these keys: {keys}"))
    _check_keys(where, fitting[0], data)
    return fitting[0].read(where, data)


def _check_keys(where: str, kind: type[Variation], data: Mapping[str, Any]) -> None:
    known, needed = (*kind.keys, *kind.optional), " and ".join(kind.keys)
    problems = [Problem(where, f"it has no {key!r}", f"say {needed}") for key in kind.keys if key not in data]
    problems += [
        Problem(f"{where}.{key}", "there is no such key", suggestion(key, known)) for key in data if key not in known
    ]
    if problems:
        raise InvalidInput(problems)


def check_kinds(variations: Mapping[str, Variation], dimensions: Iterable[FreeDimension]) -> None:
    """Raise InvalidInput for points instead of numbers, and the reverse."""
    problems = []
    for one in dimensions:
        if one.is_vector and not variations[one.name].is_point:
            remedy = "give points, as in ((x, y), (x, y)), or free one of its coordinates"
            problems.append(Problem(f"dimensions.{one.name}", "it is a point, and numbers are given", remedy))
        if not one.is_vector and variations[one.name].is_point:
            remedy = "give numbers, as in (40, 60)"
            problems.append(Problem(f"dimensions.{one.name}", "it is a number, and points are given", remedy))
    if problems:
        raise InvalidInput(problems)
