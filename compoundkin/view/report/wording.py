"""Wording: numbers with as many digits as are significant, units, lists of names, kinds of links, objectives."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from math import floor, isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import SUPERSCRIPTS, plain_unit, typeset_unit, with_unit
from compoundkin.view.report.report_data import Cell, Column

if TYPE_CHECKING:
    from compoundkin.studies.optimisation.optimum import Optimum

SIGNIFICANT = 6
# Outside of these, numbers are written with exponents.
LARGEST, SMALLEST = 1e7, 1e-3
MISSING = "-"
# Powers of seconds, and numbers that are multiplied; names may have anything else.
_TYPESET = re.compile(r"(?<=/s)\^[23]\b|(?<=\d) \* (?=\d)")
# The heads of columns that have a unit in each row.
UNIT_HEADS = ("unit", "speed in")
_KINDS = ("free", "singular", "binary", "ternary", "quaternary", "quinary", "senary")


def column_texts(column: Column, cells: Iterable[Cell], between: str = ", ") -> list[str]:
    """Return the cells of a column as text. `between` the numbers of a cell that holds several.

    >>> column_texts(Column("x", style="fixed"), [1.0, 2.25, None])
    ['1.00', '2.25', '-']
    """
    cells = list(cells)
    write = _writer(column, cells)
    return [_cell_text(column, cell, write, between) for cell in cells]


def title_with_unit(column: Column) -> str:
    """Return the title of a column with its unit.

    >>> title_with_unit(Column("speed", "mm/s^2"))
    'speed [mm/s²]'
    """
    return f"{column.name} [{typeset_unit(column.unit)}]" if column.unit else column.name


def number_text(value: float) -> str:
    """Return a single number with six significant digits, without trailing zeros.

    >>> number_text(14.0), number_text(1 / 3), number_text(-0.0)
    ('14', '0.333333', '0')
    """
    return f"{value + 0.0:.{SIGNIFICANT}g}"


def typeset(text: str) -> str:
    """Return a sentence or formula as pages and Markdown have it. Terminals and data have it plain.

    >>> typeset("3 (6 - 1) - 2 * 7 = 1"), typeset("9.81 m/s^2 at x^2")
    ('3 (6 - 1) - 2·7 = 1', '9.81 m/s² at x^2')
    """
    return _TYPESET.sub(lambda found: SUPERSCRIPTS.get(found[0], "·"), text)


def brief(value: float) -> str:
    """Return a number of which only the magnitude matters.

    >>> brief(2.13e-14), brief(1e-9), brief(0.0)
    ('2.1e-14', '1e-09', '0')
    """
    return f"{value:.1e}".replace(".0e", "e") if value else "0"


def _cell_text(column: Column, cell: Cell, write: Callable[[float], str], between: str) -> str:
    if isinstance(cell, bool):
        return "pass" if cell else "FAIL"
    if isinstance(cell, str):
        return plain_unit(cell) if column.name in UNIT_HEADS else cell
    if isinstance(cell, tuple):
        return between.join(_finite_text(column, value, write) for value in cell)
    return MISSING if cell is None else _finite_text(column, cell, write)


def _finite_text(column: Column, value: float, write: Callable[[float], str]) -> str:
    if not isfinite(value):
        return MISSING
    return write(0.0 if abs(value) <= column.floor else value)


def _writer(column: Column, cells: Iterable[Cell]) -> Callable[[float], str]:
    if column.style == "brief":
        return brief
    if column.style != "fixed":
        return number_text
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


def range_text(values: Any) -> str:
    """Return a number, or of an array the least and the greatest.

    >>> range_text(2.0), range_text([1.0, 2.5])
    ('2', '1 to 2.5')
    """
    low, high = float(np.min(values)), float(np.max(values))
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


def point_text(at: complex) -> str:
    """Return a point by its coordinates.

    >>> point_text(1 - 0.5j)
    '(1, -0.5)'
    """
    return f"({number_text(at.real)}, {number_text(at.imag)})"


def sentence(text: str) -> str:
    """Return a clause as a sentence.

    >>> sentence("it turns")
    'It turns.'
    """
    return f"{text[:1].upper()}{text[1:]}."


def listed(names: Iterable[str]) -> str:
    """Return names in a row, the last two joined by "and".

    >>> listed(["crank"]), listed(["crank", "rod", "frame"])
    ('crank', 'crank, rod and frame')
    """
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def counted(number: int, word: str) -> str:
    """Return a number of things.

    >>> counted(1, "pair"), counted(1200, "pose")
    ('1 pair', '1,200 poses')
    """
    return f"{number:,} {word}{'' if number == 1 else 's'}"


def kind_of_link(pairs: int) -> str:
    """Return the name of a link with a number of pairs.

    >>> kind_of_link(3), kind_of_link(9)
    ('ternary', 'with 9 pairs')
    """
    return _KINDS[pairs] if pairs < len(_KINDS) else f"with {pairs} pairs"


def ordinal_text(number: int) -> str:
    """Return "2nd" of 2.

    >>> [ordinal_text(k) for k in (2, 3, 4, 11, 12, 21)]
    ['2nd', '3rd', '4th', '11th', '12th', '21st']
    """
    ending = "th" if 10 <= number % 100 <= 20 else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def joined_links(links: Sequence[str]) -> str:
    """Return the links that a pair joins.

    >>> joined_links(["crank", "rod"])
    'crank - rod'
    """
    return " - ".join(links)


def objective_quantity(found: Optimum, values: Number | float) -> Quantity:
    """Return objectives as a quantity in display units.

    The objective of a single figure has its unit, a sum of squares or of several goals none.
    """
    return Quantity("objective", _objective_unit(found), np.asarray(values, dtype=float)).shown


def _objective_unit(found: Optimum) -> str:
    goal, *others = found.goals
    names = goal.outputs(found.before)
    if others or goal.is_squares or len(names) != 1:
        return ""
    return goal.unit or quantity(found.motion, names[0]).unit


def objective_text(found: Optimum, value: float) -> str:
    """Write an objective with its unit."""
    shown = objective_quantity(found, value)
    return with_unit(number_text(float(shown.values)), shown.unit)
