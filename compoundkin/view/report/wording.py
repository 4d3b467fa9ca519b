"""Wording: numbers with as many digits as are significant, units, lists of names, kinds of links, objectives."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
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
# Powers of seconds, numbers that are multiplied, signs of numbers and between them; names may have anything else.
_TYPESET = re.compile(
    r"(?<=/s)\^[23]\b|(?<=\d) \* (?=\d)|(?<![\w.)\]-])-(?=\.?\d)|(?<=\de)-(?=\d)|(?<=[\d)] )-(?= [\d(])"
)
MINUS = "−"
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
    """Return a sentence, formula or number as pages and Markdown have it. Terminals and data have it plain.

    >>> typeset("3 (6 - 1) - 2 * 7 = 1"), typeset("9.81 m/s^2 at x^2"), typeset("-1.5e-07, a four-bar of 2-3 mm")
    ('3 (6 − 1) − 2·7 = 1', '9.81 m/s² at x^2', '−1.5e−07, a four-bar of 2-3 mm')
    """
    return _TYPESET.sub(lambda found: MINUS if found[0] == "-" else SUPERSCRIPTS.get(found[0], "·"), text)


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


# --- formulas in sentences ------------------------------------------------------------------------------------------


# Functions, whose names stand upright.
FUNCTIONS = {r"\sin": "sin", r"\cos": "cos", r"\tan": "tan", r"\cot": "cot"}
# Words, numbers, and what is between them in a sentence.
_SYMBOL = re.compile(r"(theta|phi|[^\W\d_])(\d+)")
_IN_SENTENCES = re.compile(r"(?:theta|phi|[^\W\d_])\d+|[^\W\d_]+(?:-[^\W\d_]+)*|\d+(?:\.\d+)?°?|\s+|.", re.DOTALL)
# What is between two terms, and what a formula has at least one of.
_BETWEEN, _TELLING = "=+-−/^·", "=^"
_MINUS = "-−"
_ROOT, _ARTICLES = "sqrt", ("a", "A", "I")
_GREEK = {"theta": r"\theta", "phi": r"\varphi"}
_NAMED = {name.removeprefix("\\"): name for name in FUNCTIONS}


def formulas_in(sentence: str, names: Collection[str] = ()) -> Iterator[tuple[str, bool]]:
    """Yield the parts of a sentence in order, and whether each is a formula, as of `with_formulas`.

    >>> [*formulas_in("It rises by sin(x), not more.")]
    [('It rises by ', False), ('sin(x)', True), (', not more.', False)]
    """
    plain = re.sub(r"(?<=\d) degrees(?= [-+−=/])", "°", re.sub(r"(?<=[-+−=/] )(\d[\d.]*) degrees\b", r"\1°", sentence))
    tokens, before = _IN_SENTENCES.findall(plain), ""
    k = 0
    while k < len(tokens):
        end = _end_of_formula(tokens, k, frozenset(names))
        found = "".join(tokens[k:end]).strip()
        if end > k and _is_formula(tokens[k:end]):
            if before:
                yield before, False
            yield found, True
            before = " " * tokens[end - 1].isspace()
            k = end
        else:
            # of a word of which a part would be a formula nothing is one
            step = max(end, k + 1) if end > k and not tokens[k].isalpha() else k + 1
            before += "".join(tokens[k:step])
            k = step
    if before:
        yield before, False


def _is_formula(tokens: Sequence[str]) -> bool:
    functions = any(one in (*_NAMED, _ROOT) for one in tokens)
    return functions or any(one in _TELLING for one in tokens if not one.isspace())


def _end_of_formula(tokens: Sequence[str], k: int, names: frozenset[str]) -> int:
    """Return where terms and signs between them end that begin at a token; its own place where no term begins."""
    end = _end_of_term(tokens, k, names)
    while end > k:
        after = _skipped(tokens, end)
        if after >= len(tokens) or tokens[after] not in _BETWEEN:
            break
        further = _end_of_term(tokens, _skipped(tokens, after + 1), names, signed=True)
        # a dash in a sentence, or an operator with nothing behind it
        if further <= _skipped(tokens, after + 1):
            break
        end = further
    return end


def _skipped(tokens: Sequence[str], k: int) -> int:
    while k < len(tokens) and tokens[k].isspace():
        k += 1
    return k


def _end_of_term(tokens: Sequence[str], k: int, names: frozenset[str], signed: bool = False) -> int:
    """Return where factors that stand beside each other end."""
    begin = k
    if signed and k < len(tokens) and tokens[k] in _MINUS:
        k = _skipped(tokens, k + 1)
    end = begin
    while k < len(tokens):
        one = tokens[k]
        if one == "(":
            closes = _end_of_formula(tokens, k + 1, names)
            if closes <= k + 1 or closes >= len(tokens) or tokens[closes] != ")":
                break
            k = closes + 1
        elif one in (*_NAMED, _ROOT):
            argument = _skipped(tokens, k + 1)
            k = _end_of_term(tokens, argument, names)
            if k <= argument:
                break
        elif one[0].isdigit() or one in names or _is_symbol(one) or (one[0].isalpha() and end == begin):
            k += 1
        else:
            break
        end, k = k, _skipped(tokens, k)
        if one.isalpha() and len(one) > 1 and one not in names and one not in (*_NAMED, _ROOT):
            break
    return end


def _is_symbol(token: str) -> bool:
    return bool(_SYMBOL.fullmatch(token)) or (len(token) == 1 and token.isalpha() and token not in _ARTICLES)


def formula_latex(formula: str) -> str:
    """Return a formula of a sentence as LaTeX."""
    found = re.sub(rf"\b{_ROOT}\(([^()]*)\)", r"\\sqrt{\1}", formula.replace("−", "-"))
    found = re.sub(r"\^(\w+)", r"^{\1}", found).replace("°", r"^\circ")
    found = _SYMBOL.sub(lambda one: rf"{_GREEK.get(one[1], one[1])}_{{{one[2]}}}", found)
    parts = re.split(r"(\\(?:sqrt|circ|theta|varphi)(?![a-z])|[^\W\d_]{2,}(?:-[^\W\d_]+)*)", found)
    words = (
        one if not one.strip("-").replace("-", "").isalpha() else _NAMED.get(one, rf"\text{{{one}}}") for one in parts
    )
    # factors that stand beside each other
    return re.sub(r"(?<=[\w)}]) (?=[\w(\\])", r"\:", "".join(words))
