"""A report as Markdown: headings, pipe tables, lists."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import singledispatch

from compoundkin.view.report.digits import written
from compoundkin.view.report.report_data import Alert, Column, FormulaBlock, Paragraph, Section, StepBlock, TableBlock


def markdown(title: str, sections: Sequence[Section]) -> str:
    """The report as Markdown, for GitHub and the like.

    >>> print(markdown("Crank", [Section("about", "", (Paragraph("a | b"),))]))
    # Crank
    <BLANKLINE>
    a \\| b
    <BLANKLINE>
    """
    parts = [f"# {_plain(title)}", *(part for section in sections for part in _section(section))]
    return "\n\n".join(parts) + "\n"


def _section(section: Section) -> Iterator[str]:
    if section.title:
        yield f"## {_plain(section.title)}"
    for block in section.blocks:
        yield _block(block)


@singledispatch
def _block(block: object) -> str:
    raise TypeError(f"{type(block).__name__} is not a part of a report")


@_block.register
def _(block: Paragraph) -> str:
    return _plain(block.text)


@_block.register
def _(block: FormulaBlock) -> str:
    return f"$$\n{block.latex}\n$$" if block.latex else f"```text\n{block.text}\n```"


@_block.register
def _(block: Alert) -> str:
    remedy = f" *Remedy:* {_plain(block.remedy)}." if block.remedy else ""
    return f"> **{_plain(block.text)}**{remedy}"


@_block.register
def _(block: StepBlock) -> str:
    facts = "\n".join(f"- *{_plain(term)}*: {_plain(text)}" for term, text in block.facts)
    return f"### {_plain(block.title)}\n\n{facts}"


@_block.register
def _(block: TableBlock) -> str:
    rows = block.shown_rows
    cells = [written(column, [row[k] for row in rows]) for k, column in enumerate(block.columns)]
    lines = [map(_heading, block.columns), ("---:" if column.is_number else "---" for column in block.columns)]
    return "\n".join(map(_line, [*lines, *(map(_plain, row) for row in zip(*cells, strict=True))]))


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _heading(column: Column) -> str:
    return _plain(f"{column.name} [{column.unit}]" if column.unit else column.name)


def _plain(text: str) -> str:
    """Text in which nothing is taken for markup."""
    for mark in "\\`*_|<>":
        text = text.replace(mark, "\\" + mark)
    return " ".join(text.split())
