"""The blocks of a report as plain HTML, its few styles inline: for notebooks, which have style sheets of their own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import singledispatch

from compoundkin.view.page.markup import element, lines, safe
from compoundkin.view.report.digits import written
from compoundkin.view.report.report_data import (
    Alert,
    Block,
    Column,
    FormulaBlock,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
)
from compoundkin.view.report.wording import counted

# A notebook shows so many rows of a table; reports and the objects themselves have all.
MOST_ROWS = 40
# Inline, for notebooks give tables styles of their own: numbers would not line up, texts be aligned right. Colours are
# the page's, so that they fit light and dark ones.
CELL = "vertical-align:top;padding:.3em .6em"
LEFT, RIGHT = f"text-align:left;{CELL}", f"text-align:right;{CELL}"
CAPTION = "text-align:left;caption-side:top;font-weight:bold;padding:.5em 0"


def sections_html(sections: Iterable[Section]) -> Iterator[str]:
    """Sections with their headings, block by block."""
    for section in sections:
        if section.title:
            yield element("h4", safe(section.title))
        yield from map(block_html, section.blocks)


def table_html(table: TableBlock, caption: str = "") -> str:
    """A table whose first column names its rows; in a box of its own that scrolls where it is wider than the page."""
    rows = table.shown_rows
    cells = [written(column, [row[k] for row in rows[:MOST_ROWS]]) for k, column in enumerate(table.columns)]
    sides = [RIGHT if column.is_number else LEFT for column in table.columns]
    heads = (element("th", _heading(c), scope="col", style=s) for c, s in zip(table.columns, sides, strict=True))
    found = [element("tr", "".join(_cells(row, sides))) for row in zip(*cells, strict=True)]
    more = len(table.rows) - min(len(rows), MOST_ROWS)
    if more > 0:
        text = f"... and {counted(more, 'more row')}"
        found.append(element("tr", element("td", text, colspan=str(len(sides)), style=LEFT)))
    parts = [
        element("caption", safe(caption), style=CAPTION) if caption else "",
        element("thead", element("tr", "".join(heads))),
        element("tbody", f"\n{lines(found)}\n"),
    ]
    return element("div", element("table", f"\n{lines(parts)}\n"), style="overflow-x:auto")


def _heading(column: Column) -> str:
    return safe(f"{column.name} [{column.unit}]" if column.unit else column.name)


def _cells(row: Iterable[str], sides: Iterable[str]) -> Iterator[str]:
    for k, (text, side) in enumerate(zip(row, sides, strict=True)):
        inside = safe(text).replace("\n", "<br>")
        yield element("td", inside, style=side) if k else element("th", inside, scope="row", style=side)


@singledispatch
def block_html(block: Block) -> str:
    """Any block of a report."""
    raise TypeError(f"{type(block).__name__} is not a part of a report")


@block_html.register
def _(block: Paragraph) -> str:
    return element("p", safe(block.text))


@block_html.register
def _(block: FormulaBlock) -> str:
    return element("pre", safe(block.text))


@block_html.register
def _(block: Alert) -> str:
    remedy = f" Remedy: {safe(block.remedy)}." if block.remedy else ""
    return element("p", element("strong", safe(block.text)) + remedy, role="note")


@block_html.register
def _(block: StepBlock) -> str:
    facts = "".join(element("dt", safe(term)) + element("dd", safe(text)) for term, text in block.facts)
    return element("h5", safe(block.title)) + element("dl", facts)


@block_html.register
def _(block: TableBlock) -> str:
    return table_html(block)
