"""Parts of a study as Parquet: columns of numbers, courses as lists of fixed size, texts."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.parquet_library import parquet
from compoundkin.studies.runs.study_program import StudyColumn

# What every part says of the study that it belongs to.
STUDY = b"study"
# So many rows are read at once where one is asked for.
ROWS_TOGETHER = 8192


def part_content(columns: Iterable[StudyColumn], found: Mapping[str, Any], fingerprint: str) -> bytes:
    """Return the bytes of a part, with units, and the fingerprint of its study."""
    arrow, write = import_module("pyarrow"), parquet().write_table
    chosen = list(columns)
    arrays = [_array(arrow, found[column.name], column.width) for column in chosen]
    units = [{"unit": column.unit} if column.unit else None for column in chosen]
    fields = [
        arrow.field(one.name, array.type, metadata=unit) for one, array, unit in zip(chosen, arrays, units, strict=True)
    ]
    schema = arrow.schema(fields, metadata={STUDY: fingerprint, b"angles": b"radians"})
    texts = [field.name for field in fields if field.type == arrow.string()]
    content = io.BytesIO()
    table = arrow.Table.from_arrays(arrays, schema=schema)
    write(table, content, row_group_size=ROWS_TOGETHER, use_dictionary=texts, write_page_checksum=True)
    return content.getvalue()


def _array(arrow: Any, values: Number, width: int | None) -> Any:
    if width is None:
        return arrow.array(values, type=arrow.string() if values.dtype == object else None)
    return arrow.FixedSizeListArray.from_arrays(arrow.array(np.ravel(values)), width)


def rows_of_part(path: Path, fingerprint: str) -> range | None:
    """Return which rows a part has, by what it says of itself.

    None where it is damaged or belongs to another study.
    """
    try:
        found = parquet().read_metadata(path)
    except (OSError, ValueError):
        return None
    if (found.metadata or {}).get(STUDY) != fingerprint.encode() or not found.num_rows:
        return None
    first, last = (found.row_group(k).column(0).statistics for k in (0, found.num_row_groups - 1))
    return range(first.min, last.max + 1)


def part_column(path: Path, column: StudyColumn) -> Number:
    """Return a column of a part. Raises InvalidInput where it is damaged."""
    with _opened(path) as file:
        return _values(file.read([column.name]), column)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Yield a part whose pages are checked as they are read; what is wrong with it is told."""
    try:
        with parquet().ParquetFile(path, page_checksum_verification=True) as file:
            yield file
    except FileNotFoundError:
        raise InvalidInput(Problem(str(path), "the part is gone", "run the study into this folder again")) from None
    except (OSError, ValueError):
        remedy = "remove it, and run the study into this folder again"
        raise InvalidInput(Problem(str(path), "the part is damaged", remedy)) from None


def part_rows(path: Path, columns: Iterable[StudyColumn], places: Number) -> dict[str, Number]:
    """Return all columns of some rows of a part, by their places in it. Raises InvalidInput where it is damaged."""
    groups = np.unique(places // ROWS_TOGETHER)
    with _opened(path) as file:
        table = file.read_row_groups(groups.tolist())
    # the groups that are read follow each other
    near = np.searchsorted(groups, places // ROWS_TOGETHER) * ROWS_TOGETHER + places % ROWS_TOGETHER
    return {column.name: _values(table, column)[near] for column in columns}


def _values(table: Any, column: StudyColumn) -> Number:
    found = table.column(column.name).combine_chunks()
    if column.width is not None:
        return np.asarray(found.flatten()).reshape(-1, column.width)
    if str(found.type) == "string":
        return np.array(found.to_pylist(), dtype=object)
    return np.asarray(found.to_numpy(zero_copy_only=False))
