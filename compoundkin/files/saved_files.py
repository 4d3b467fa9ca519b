"""`save`: whatever can be saved, in the form that the file's suffix tells.

Tables are CSV and JSON for people, angles in degrees; NPZ and Parquet for programs, angles in radians. The library of
Parquet files is an extra of the package, imported when it is needed.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable, Mapping
from importlib import import_module
from math import isfinite
from types import MappingProxyType
from typing import Any, BinaryIO, ClassVar, Protocol, TypeAlias, runtime_checkable

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, missing_extra
from compoundkin.base.suffixes import Kind, all_suffixes, file_format
from compoundkin.files.atomic import write_atomically
from compoundkin.files.mechanism_files import encoded
from compoundkin.kinematics.quantities import ANGLES, Table
from compoundkin.model.mechanism import Mechanism

Write: TypeAlias = Callable[[BinaryIO], Any]


def csv_text(table: Table) -> str:
    """Return the table as CSV, with units in the heads; every digit is written."""
    text = io.StringIO()
    _write_csv(table, text)
    return text.getvalue()


def _write_csv(table: Table, text: Any) -> None:
    rows = csv.writer(text, lineterminator="\n")
    shown = table.shown.columns
    rows.writerow([f"{column.name} [{column.unit}]" if column.unit else column.name for column in shown])
    # lists of Python floats, which are written with as many digits as distinguish them
    rows.writerows(zip(*(column.values.tolist() for column in shown), strict=True))


def _csv(table: Table) -> Write:
    def write(file: BinaryIO) -> None:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        _write_csv(table, text)
        text.detach()

    return write


def _json(table: Table) -> Write:
    """{"columns": [{"name", "unit", "values"}]}, null where a pose is not assembled."""
    columns = [
        {"name": column.name, "unit": column.unit, "values": list(map(_plain, column.values.tolist()))}
        for column in table.shown.columns
    ]
    text = json.dumps({"columns": columns}, ensure_ascii=False, allow_nan=False) + "\n"
    return lambda file: file.write(text.encode("utf-8"))


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value


def _npz(table: Table) -> Write:
    """Return an array for each column.

    `units` is their units as JSON, `angles` how angles are counted, `title` the title.
    """
    arrays = {column.name: column.values for column in table.columns}
    told = {"title": table.title, "angles": ANGLES, "units": json.dumps(dict(table.units), ensure_ascii=False)}
    # NumPy 2 stubs take any keyword for `allow_pickle`
    save: Any = np.savez
    return lambda file: save(file, **arrays, **{name: np.array(text) for name, text in told.items()})


def _parquet(table: Table) -> Write:
    """Fields with their `unit` as metadata. The schema says what the table is of and how angles are counted."""
    write_table, pyarrow = parquet().write_table, import_module("pyarrow")
    arrays = [pyarrow.array(column.values) for column in table.columns]
    fields = [
        pyarrow.field(column.name, array.type, metadata={"unit": column.unit} if column.unit else None)
        for column, array in zip(table.columns, arrays, strict=True)
    ]
    schema = pyarrow.schema(fields, metadata={"title": table.title, "angles": ANGLES})
    whole = pyarrow.Table.from_arrays(arrays, schema=schema)
    return lambda file: write_table(whole, file)


# The writer of each form that the table of suffixes has for tables.
WRITERS: Mapping[str, Callable[[Table], Write]] = MappingProxyType(
    {"csv": _csv, "json": _json, "npz": _npz, "parquet": _parquet}
)


@runtime_checkable
class Tabulated(Protocol):
    """What has a table of its quantities: a motion, its forces."""

    def table(self, *names: str) -> Table:
        """Return the quantities of these names; everything without names."""


@runtime_checkable
class Contained(Protocol):
    """What has contents of files in the forms of its kind: a compiled path."""

    saved_as: ClassVar[Kind]

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in a form."""


class Savable:
    """What saves itself in forms of its own: pictures, plots, animations, pages, reports."""

    saved_as: ClassVar[Kind]

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in one of the forms of its kind. The same every time."""
        raise NotImplementedError

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save it to a file in the form that the suffix tells.

        Raises InvalidInput for another suffix, where the file cannot be written, or where a library is missing.
        """
        content = self.content(file_format(self.saved_as, path))
        write_atomically(path, lambda file: file.write(content))


@checked
def save(what: Any, path: str | os.PathLike[str]) -> None:
    """Save anything to a file in the form that its suffix tells.

    A mechanism is a .toml or .json file; a motion, its forces or a table .csv or .json (angles in degrees), .npz or
    .parquet (radians); a picture .svg, .png, .pdf, .tex; a plot .svg, .png, .pdf; an animation .gif, .mp4, .svg; a
    page .html; a report .txt, .md, .json, .html; a compiled path .c, .py, .js, .m. Raises InvalidInput for another
    suffix, for what cannot be saved, where the file cannot be written, or where a library is missing.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(solve(crank, {"crank": 0.0}, order=0), f"{folder}/crank.csv")
    ...     print(Path(f"{folder}/crank.csv").read_text().splitlines()[0].split(",")[:2])
    ['crank.value [deg]', 'A.position.x [length]']
    """
    if isinstance(what, Savable):
        what.save(path)
    elif isinstance(what, Contained):
        text = what.content(file_format(what.saved_as, path))
        write_atomically(path, lambda file: file.write(text))
    elif isinstance(what, Mechanism):
        content = encoded(what, file_format("mechanism", path), path)
        write_atomically(path, lambda file: file.write(content))
    elif isinstance(what, Table | Tabulated):
        write = WRITERS[file_format("table", path)]
        write_atomically(path, write(what if isinstance(what, Table) else what.table()))
    else:
        told = f"a {type(what).__name__} cannot be saved"
        raise InvalidInput(Problem(str(path), told, all_suffixes()))


def parquet(where: str = "") -> Any:
    """Return `pyarrow.parquet`. Raises InvalidInput, which names a place, where it is not installed."""
    try:
        import_module("pyarrow")
        return import_module("pyarrow.parquet")
    except ImportError:
        raise missing_extra(where, "this needs pyarrow", "parquet") from None
