"""A report as text for a terminal of 80 columns or more; colour only where it is asked for."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Sequence
from typing import Literal

from rich.box import Box
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table as Grid
from rich.text import Text

from compoundkin.model.attributes import plain_unit
from compoundkin.view.report.report_data import (
    Alert,
    Column,
    FormulaBlock,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
    not_a_block,
)
from compoundkin.view.report.wording import column_texts

# Between two columns of a table.
GAP = 2
# A rule under the heads and nothing else, in ASCII so that it survives any terminal and pipe.
RULE = Box("    \n    \n -- \n" + "    \n" * 5, ascii=True)
STYLES = {"pass": "green", "FAIL": "bold red"}


def terminal_text(title: str, sections: Sequence[Section], width: int = 80, colour: bool = False) -> str:
    """Return the report as text, no line longer than `width`.

    >>> print(terminal_text("Crank", [Section("about", "", (Paragraph("Watch B."),))]))
    Crank
    =====
    <BLANKLINE>
    Watch B.
    <BLANKLINE>
    """
    out = io.StringIO()
    console = Console(file=out, width=width, force_terminal=colour, color_system="standard" if colour else None,
                      highlight=False, emoji=False, markup=False, legacy_windows=False)  # fmt: skip
    console.print(Text(title, "bold"), Text("=" * min(len(title), width), "bold"), sep="\n")
    for section in sections:
        _print(console, section, width)
    return "\n".join(line.rstrip() for line in out.getvalue().split("\n"))


def _print(console: Console, section: Section, width: int) -> None:
    if section.title:
        console.print(Text(f"\n{section.title}\n{'-' * len(section.title)}", "bold"))
    for block in section.blocks:
        console.print()
        for part in _block(block, width):
            console.print(part)


def _block(block: object, width: int) -> Iterator[RenderableType]:
    match block:
        case Paragraph():
            yield Text(block.text)
        case FormulaBlock():
            yield Padding(Text(block.text), (0, 0, 0, 2))
        case Alert():
            remedy = Text(f"\nRemedy: {block.remedy}.") if block.remedy else Text("")
            yield Padding(Text(block.text, "bold red").append_text(remedy), (0, 0, 0, 2))
        case StepBlock():
            yield Text(block.title, "bold")
            grid = Grid.grid(padding=(0, GAP, 0, 0))
            grid.add_column(style="dim", no_wrap=True)
            grid.add_column()
            for term, fact in block.facts:
                grid.add_row(Text(term), Text(fact))
            yield Padding(grid, (0, 0, 0, 3))
        case TableBlock():
            yield from _table(block, width)
        case _:
            raise not_a_block(block)


def _table(block: TableBlock, width: int) -> Iterator[RenderableType]:
    rows = block.selected_rows
    cells = [column_texts(column, [row[k] for row in rows], between="\n") for k, column in enumerate(block.columns)]
    heads = [_heading(column) for column in block.columns]
    for number, panel in enumerate(_panels(block, heads, cells, width)):
        if number:
            yield Text("")
        parts = [block.columns[k] for k in panel], [heads[k] for k in panel], [cells[k] for k in panel]
        yield _lines(*parts) if _is_plain(*parts[1:], width) else _grid(*parts)


def _panels(block: TableBlock, heads: Sequence[str], cells: Sequence[Sequence[str]], width: int) -> list[list[int]]:
    """Return the columns of each panel: a table of numbers too wide is split, its first columns repeated."""
    keys = list(range(block.keys))
    wide = [_width((head, *column)) + GAP for head, column in zip(heads, cells, strict=True)]
    panels: list[list[int]] = [[*keys]]
    for part in _inseparable(block):
        if keys and len(panels[-1]) > len(keys) and sum(wide[j] for j in [*panels[-1], *part]) > width:
            panels.append([*keys])
        panels[-1] += part
    return panels


def _inseparable(block: TableBlock) -> list[list[int]]:
    """Return the columns after the first ones, with those that follow one another together."""
    parts: list[list[int]] = []
    for k, column in enumerate(block.columns[block.keys :], block.keys):
        if column.follows and parts:
            parts[-1].append(k)
        else:
            parts.append([k])
    return parts


def _width(texts: Iterable[str]) -> int:
    return max(len(line) for text in texts for line in text.split("\n"))


def _is_plain(heads: Sequence[str], cells: Sequence[Sequence[str]], width: int) -> bool:
    """Return whether no cell is to be wrapped or coloured, so that cells need not be measured one by one."""
    wide = sum(_width((head, *column)) + GAP for head, column in zip(heads, cells, strict=True)) - GAP
    texts = [cell for column in cells for cell in column]
    plain = all(cell.isascii() and "\n" not in cell and cell not in STYLES for cell in texts)
    return wide <= width and plain and all(head.isascii() for head in heads)


def _lines(columns: Sequence[Column], heads: Sequence[str], cells: Sequence[Sequence[str]]) -> Text:
    """Return a table as lines that are written as they are: many times faster than a grid, and the same."""
    wide = [_width((head, *column)) for head, column in zip(heads, cells, strict=True)]
    sides = [str.rjust if column.is_number else str.ljust for column in columns]
    tall = max(head.count("\n") for head in heads)
    above = ["\n" * (tall - head.count("\n")) + head for head in heads]
    titles = zip(*(head.split("\n") for head in above), strict=True)
    rows = [*titles, ("-" * (sum(wide) + GAP * (len(wide) - 1)),), *zip(*cells, strict=True)]
    gap = " " * GAP
    lines = [gap.join(side(cell, w) for side, cell, w in zip(sides, row, wide, strict=False)) for row in rows]
    found = Text("\n".join(lines), no_wrap=True, overflow="ignore")
    found.stylize("bold", 0, len("\n".join(lines[: tall + 1])))
    return found


def _grid(columns: Sequence[Column], heads: Sequence[str], cells: Sequence[Sequence[str]]) -> Grid:
    grid = Grid(box=RULE, padding=(0, GAP - 1, 0, 0), pad_edge=False, show_edge=False, header_style="bold")
    for column, head in zip(columns, heads, strict=True):
        side: Literal["left", "right"] = "right" if column.is_number else "left"
        grid.add_column(Text(head), justify=side, no_wrap=column.is_number, overflow="fold")
    for row in zip(*cells, strict=True):
        grid.add_row(*(Text(cell, STYLES.get(cell, "")) for cell in row))
    return grid


def _heading(column: Column) -> str:
    """A number's name over several short lines, its unit under it."""
    name = column.name
    if column.is_number:
        name = name.replace(".", "\n").replace("_", "\n").replace(" ", "\n")
    return f"{name}\n[{plain_unit(column.unit)}]" if column.unit else name
