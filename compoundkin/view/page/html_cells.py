"""The cells of a table as HTML: sorted and copied with all their digits."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

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


def _digits(column: Column, value: Cell) -> str:
    if isinstance(value, str):
        return safe(value)
    if value is None or isinstance(value, tuple) or not isfinite(value):
        return ""
    return repr(value) if abs(value) > column.floor else "0"


def of_kind(kind: str | None) -> str:
    """Return the class of an element as it is written, if it has one."""
    return f' class="{kind}"' if kind else ""
