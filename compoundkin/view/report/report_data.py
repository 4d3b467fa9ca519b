"""A report as data: sections of paragraphs, formulas, steps and tables; renderers only write it out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from compoundkin.base.display import ShortRepr

Cell: TypeAlias = str | int | float | bool | tuple[float, ...] | None

# How the cells of a column are written.
#   text    words, aligned left
#   fixed   numbers, all with the same decimals: six digits for the largest
#   each    numbers, each with six significant digits
#   brief   numbers of which only the magnitude matters: 2.1e-14
#   passed  True, False, or None where it cannot be said
Style: TypeAlias = Literal["text", "fixed", "each", "brief", "passed"]


@dataclass(frozen=True)
class Paragraph:
    """A sentence or several. `badged` are the last ones where a page has badges that say the same."""

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
    """Rows of cells. The first `keys` columns are repeated where a table is split for its width.

    `shown` are the indices of the rows that a reader needs, where those are not all: the JSON report has all.
    `figures` tell for each row which figure of the motion it has, where that is known: a live page tells it anew.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    keys: int = 0
    shown: tuple[int, ...] | None = None
    figures: tuple[tuple[str, ...], ...] = ()

    @property
    def selected_rows(self) -> tuple[tuple[Cell, ...], ...]:
        """The rows that a reader needs.

        >>> TableBlock((Column("a"),), (("x",), ("y",)), shown=(1,)).shown_rows
        (('y',),)
        """
        return self.rows if self.shown is None else tuple(self.rows[k] for k in self.shown)


@dataclass(frozen=True)
class StepBlock:
    """One step of several. A title, and what is to be said of it by keyword."""

    title: str
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Alert:
    """What is wrong, and how to mend it."""

    text: str
    remedy: str = ""


# Of more rows of a table or parts of a section than these, so many are shown where a report is read.
MANY, SHOWN = 300, 100
# No text of a cell or fact is longer (characters) there.
LONGEST = 2000
_MORE = "... and {:,} {} more, in the whole report."

Block: TypeAlias = Paragraph | FormulaBlock | TableBlock | StepBlock | Alert


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
    """What a report comes to, for those who only ask that. `passed` covers checks and published numbers.

    `verified` is whether `verify` passed, None where nothing was to be verified, and `verdict` its words.
    `touching` is how many pairs of links touch, None where no outlines were compared, and `compared` that in words.
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


# What a report comes to that solves nothing.
NOT_SOLVED = Outcome(True)
