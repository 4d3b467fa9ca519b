"""The cells of a table as HTML: sorted and copied with all their digits."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np

from compoundkin.model.attributes import readable
from compoundkin.view.page.markup import safe
from compoundkin.view.report.report_data import Cell, Column

RESULTS = {True: ("good", "✓", "pass"), False: ("bad", "✗", "FAIL")}
# Cells with more letters than this are broken into lines, and get room for them.
LONG = 24
# The column that tells the units of others.
UNIT = "unit"


def cell_html(column: Column, cell: Cell, text: str) -> str:
    """Return a cell of a table that is read as some text."""
    if isinstance(cell, bool):
        result, mark, word = RESULTS[cell]
        inside = f'<span class="{result}"><span aria-hidden="true">{mark}</span> {word}</span>'
        return f'<td data-sort="{int(cell)}" data-copy="{word}">{inside}</td>'
    kind = "number" if column.is_number else "long" if len(text) > LONG else None
    inside = "<br>".join(map(safe, (readable(text) if column.name == UNIT else text).split("\n")))
    return f"<td{of_kind(kind)}{''.join(_exact(column, cell, text))}>{inside}</td>"


def _exact(column: Column, cell: Cell, text: str) -> Iterator[str]:
    """What a number is sorted by and copied as, where that is not what is shown: every digit of it."""
    if not column.is_number and not isinstance(cell, tuple):
        return
    digits = [_digits(column, value) for value in (cell if isinstance(cell, tuple) else (cell,))]
    if digits[0] != text:
        yield f' data-sort="{digits[0]}"'
    if len(digits) > 1:
        yield f' data-copy="{", ".join(digits)}"'


def packed_cells(columns: Sequence[Column], row: Sequence[Cell], texts: Sequence[str]) -> tuple[str, str] | None:
    """Return the attribute of a row of numbers, and its cells.

    The attribute has all digits. A script gives each cell what `cell_html` writes. None for a row of anything else.
    """
    numbers = [_number(column, cell) for column, cell in zip(columns, row, strict=True)]
    known = [number for number in numbers if number is not None]
    if len(known) < len(numbers):
        return None
    packed = b64encode(np.array(known, "<f8").tobytes()).decode("ascii")
    return f' data-n="{packed}"', "".join(f"<td>{safe(text)}</td>" for text in texts)


def _number(column: Column, cell: Cell) -> float | None:
    """A cell as a number, NaN where it is not known; None where it is something else."""
    if not column.is_number or isinstance(cell, bool | str | tuple):
        return None
    if cell is None or not isfinite(cell):
        return float("nan")
    return float(cell) if abs(cell) > column.floor else 0.0


def _digits(column: Column, value: Cell) -> str:
    if isinstance(value, str):
        return safe(value)
    if value is None or isinstance(value, tuple) or not isfinite(value):
        return ""
    return repr(value) if abs(value) > column.floor else "0"


def of_kind(kind: str | None) -> str:
    """Return the class of an element as it is written, if it has one."""
    return f' class="{kind}"' if kind else ""
