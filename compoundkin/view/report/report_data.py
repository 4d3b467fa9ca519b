"""A report as data: sections of paragraphs, formulas, steps and tables; renderers only write it out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from compoundkin.base.display import ShortRepr
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure

# What a report is about, for the pictures of its page.
Subject: TypeAlias = Structure | Motion
Cell: TypeAlias = str | int | float | bool | tuple[float, ...] | None

# The section whose sentences people have written of a mechanism: they have formulas.
ABOUT = "about"

# How the cells of a column are written.
#   text    words, aligned left
#   fixed   numbers, all with the same decimals: six digits for the largest
#   each    numbers, each with six significant digits
#   brief   numbers of which only the magnitude matters: 2.1e-14
#   passed  True, False, or None where it is unknown
Style: TypeAlias = Literal["text", "fixed", "each", "brief", "passed"]


@dataclass(frozen=True)
class Paragraph:
    """One or several sentences. `badged` are the last ones if badges of a page repeat them."""

    text: str
    badged: str = ""


@dataclass(frozen=True)
class FormulaBlock:
    """A line of mathematics, to be written as it is. `latex` where there is such, without dollar signs."""

    text: str
    latex: str = ""


@dataclass(frozen=True)
class Column:
    """A column of a table. Numbers not above `floor` in size are rounding and are written as zero.

    `follows` keeps it beside the column before it where a table is split.
    """

    name: str
    unit: str = ""
    style: Style = "text"
    floor: float = 0.0
    follows: bool = False

    @property
    def is_number(self) -> bool:
        """Whether it is aligned right."""
        return self.style in ("fixed", "each", "brief")


@dataclass(frozen=True)
class TableBlock:
    """Rows of cells. The first `keys` columns are repeated where a wide table is split.

    `shown` are the indices of the rows that a text or page shows, where not all; the JSON report has all. `figures` are
    keys of figures of the motion in each row, by which a live page computes the row again.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    keys: int = 0
    shown: tuple[int, ...] | None = None
    figures: tuple[tuple[str, ...], ...] = ()

    @property
    def selected_rows(self) -> tuple[tuple[Cell, ...], ...]:
        """The rows that a reader needs.

        >>> TableBlock((Column("a"),), (("x",), ("y",)), shown=(1,)).selected_rows
        (('y',),)
        """
        return self.rows if self.shown is None else tuple(self.rows[k] for k in self.shown)


@dataclass(frozen=True)
class StepBlock:
    """One step of several: a title, and facts by keyword."""

    title: str
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Alert:
    """What is wrong, and how to mend it."""

    text: str
    remedy: str = ""


# Of more than MANY rows of a table or parts of a section, a text shows the first ones.
MANY, SHOWN = 300, 100
# No text of a cell or fact is longer (characters) there.
LONGEST = 2000
_MORE = "... and {:,} {} more, in the whole report."

Block: TypeAlias = Paragraph | FormulaBlock | TableBlock | StepBlock | Alert


def not_a_block(what: object) -> TypeError:
    """Return the error of a renderer for anything but a block."""
    return TypeError(f"{type(what).__name__} is not a part of a report")


@dataclass(frozen=True, repr=False)
class Section(ShortRepr):
    """A part of a report; `key` is its name in the JSON report."""

    key: str
    title: str
    blocks: tuple[Block, ...]


def summarised(section: Section) -> Section:
    """Return a section with the first of its very many rows and parts.

    >>> rows = tuple((k,) for k in range(1000))
    >>> summarised(Section("links", "Links", (TableBlock((Column("link"),), rows),))).blocks[-1].text
    '... and 900 rows more, in the whole report.'
    """
    blocks = section.blocks[:SHOWN] if len(section.blocks) > MANY else section.blocks
    more = [Paragraph(_MORE.format(len(section.blocks) - SHOWN, "parts"))] if len(blocks) < len(section.blocks) else []
    return replace(section, blocks=(*(part for block in blocks for part in _shortened(block)), *more))


def _shortened(block: Block) -> Iterator[Block]:
    if isinstance(block, TableBlock):
        rows = block.selected_rows
        shown = rows[:SHOWN] if len(rows) > MANY else rows
        yield replace(block, rows=tuple(tuple(map(_cell, row)) for row in shown), shown=None)
        if len(shown) < len(rows):
            yield Paragraph(_MORE.format(len(rows) - len(shown), "rows"))
    elif isinstance(block, StepBlock):
        yield StepBlock(_cut(block.title), tuple((term, _cut(fact)) for term, fact in block.facts))
    elif isinstance(block, Paragraph):
        yield replace(block, text=_cut(block.text))
    elif isinstance(block, Alert):
        yield Alert(_cut(block.text), _cut(block.remedy))
    else:
        yield block


def _cut(text: str) -> str:
    """Return a text that is not too long to be read."""
    end = max(text.rfind(",", 0, LONGEST), LONGEST // 2)
    return text if len(text) <= LONGEST else f"{text[:end]} ..."


def _cell(cell: Cell) -> Cell:
    return _cut(cell) if isinstance(cell, str) else cell


@dataclass(frozen=True)
class Outcome:
    """The outcome of a report in numbers. `passed` covers checks, published numbers and interference.

    `verified` is whether `verify` passed, None where nothing was verified, and `verdict` its text. `touching` is how
    many pairs of links touch, None where no outlines were compared, and `compared` its text.
    """

    solvable: bool
    poses: int = 0
    assembled: int = 0
    checks: int = 0
    checks_passed: int = 0
    published: int = 0
    published_passed: int = 0
    verified: bool | None = None
    verdict: str = ""
    touching: int | None = None
    compared: str = ""

    @property
    def passed(self) -> bool:
        """Whether what was verified passed, published numbers were reproduced, no links touch."""
        return self.verified is not False and self.published == self.published_passed and not self.touching


# The outcome of a report that solves nothing.
NOT_SOLVED = Outcome(True)
