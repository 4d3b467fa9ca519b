"""How numbers are written: as many digits as say something, the same in a whole column."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import floor, isfinite, log10

from compoundkin.view.report.report_data import Cell, Column

SIGNIFICANT = 6
# Outside of these, numbers are written with exponents.
LARGEST, SMALLEST = 1e7, 1e-3
NOTHING = "-"


def written(column: Column, cells: Iterable[Cell], between: str = ", ") -> list[str]:
    """The cells of a column as text; `between` the numbers of a cell that holds several.

    >>> written(Column("x", style="fixed"), [1.0, 2.25, None])
    ['1.00', '2.25', '-']
    """
    cells = list(cells)
    write = _writer(column, cells)
    return [_cell(column, cell, write, between) for cell in cells]


def number(value: float) -> str:
    """A single number with six significant digits, without trailing zeros.

    >>> number(14.0), number(1 / 3), number(-0.0)
    ('14', '0.333333', '0')
    """
    return f"{value + 0.0:.{SIGNIFICANT}g}"


def brief(value: float) -> str:
    """A number of which only the magnitude matters.

    >>> brief(2.13e-14), brief(1e-9), brief(0.0)
    ('2.1e-14', '1e-09', '0')
    """
    return f"{value:.1e}".replace(".0e", "e") if value else "0"


def _cell(column: Column, cell: Cell, write: Callable[[float], str], between: str) -> str:
    if isinstance(cell, bool):
        return "pass" if cell else "FAIL"
    if isinstance(cell, str):
        return cell
    if isinstance(cell, tuple):
        return between.join(_one(column, value, write) for value in cell)
    return NOTHING if cell is None else _one(column, cell, write)


def _one(column: Column, value: float, write: Callable[[float], str]) -> str:
    if not isfinite(value):
        return NOTHING
    return write(0.0 if abs(value) <= column.floor else value)


def _writer(column: Column, cells: Iterable[Cell]) -> Callable[[float], str]:
    if column.style == "brief":
        return brief
    if column.style != "fixed":
        return number
    return _fixed([v for cell in cells for v in _numbers(cell) if isfinite(v) and abs(v) > column.floor])


def _numbers(cell: Cell) -> tuple[float, ...]:
    if isinstance(cell, tuple):
        return cell
    return (float(cell),) if isinstance(cell, int | float) and not isinstance(cell, bool) else ()


def _fixed(values: list[float]) -> Callable[[float], str]:
    """Six digits for the largest value, less the zeros that all of them end in."""
    largest = max(map(abs, values), default=0.0)
    if largest and not SMALLEST <= largest < LARGEST:
        return lambda value: f"{value:.{SIGNIFICANT - 1}e}" if value else "0"
    most = max(0, SIGNIFICANT - 1 - floor(log10(largest))) if largest else 0
    decimals = max((len(f"{v:.{most}f}".rstrip("0").partition(".")[2]) for v in values), default=0) if most else 0
    return lambda value: f"{round(value, decimals) + 0.0:.{decimals}f}"
