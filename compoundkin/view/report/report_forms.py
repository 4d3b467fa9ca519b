"""A report, and the forms in which it is written: text, Markdown, JSON, a page."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar

from compoundkin.base.display import DisplaysHtml
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.report.report_data import (
    Alert,
    Cell,
    FormulaBlock,
    Outcome,
    Paragraph,
    Section,
    StepBlock,
    Subject,
    TableBlock,
    not_a_block,
    summarised,
)
from compoundkin.view.report.wording import column_texts, title_with_unit, typeset

if TYPE_CHECKING:
    from compoundkin.view.page import Page

_ESCAPED = str.maketrans({mark: f"\\{mark}" for mark in "\\`*_|<>"})


def json_text(title: str, sections: Sequence[Section], outcome: Outcome) -> str:
    """Return the report as a JSON text. `title`, `outcome`, and `sections` by their keys in reading order.

    A table has `columns` (name and unit) and `rows`; what is not assembled is null, a vector is [x, y].

    >>> sections = [Section("about", "", (Paragraph("Watch B."),))]
    >>> json.loads(json_text("Crank", sections, Outcome(True)))["sections"]["about"]["blocks"]
    [{'kind': 'paragraph', 'text': 'Watch B.'}]
    """
    parts = {s.key: {"title": s.title, "blocks": [_as_data(block) for block in s.blocks]} for s in sections}
    result = {**asdict(outcome), "passed": outcome.passed}
    whole = {"format": 1, "title": title, "outcome": result, "sections": parts}
    return json.dumps(whole, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _as_data(block: object) -> dict[str, Any]:
    match block:
        case Paragraph():
            return {"kind": "paragraph", "text": block.text}
        case FormulaBlock():
            return {"kind": "formula", "text": block.text, **({"latex": block.latex} if block.latex else {})}
        case Alert():
            return {"kind": "alert", "text": block.text, "remedy": block.remedy}
        case StepBlock():
            return {"kind": "step", "title": block.title, "facts": [list(fact) for fact in block.facts]}
        case TableBlock():
            columns = [{"name": column.name, "unit": column.unit} for column in block.columns]
            return {
                "kind": "table",
                "columns": columns,
                "rows": [[_cell_as_data(cell) for cell in r] for r in block.rows],
            }
    raise not_a_block(block)


def _cell_as_data(cell: Cell) -> Any:
    if isinstance(cell, tuple):
        return [_cell_as_data(value) for value in cell]
    if isinstance(cell, str):
        return cell.replace("\n", " ")
    return None if isinstance(cell, float) and not isfinite(cell) else cell


def markdown(title: str, sections: Sequence[Section]) -> str:
    """Return the report as Markdown, for GitHub and the like.

    >>> print(markdown("Crank", [Section("about", "", (Paragraph("a | b"),))]))
    # Crank
    <BLANKLINE>
    a \\| b
    <BLANKLINE>
    """
    parts = [f"# {_plain(title)}", *(part for section in sections for part in _section_as_markdown(section))]
    return "\n\n".join(parts) + "\n"


def _section_as_markdown(section: Section) -> Iterator[str]:
    if section.title:
        yield f"## {_plain(section.title)}"
    for block in section.blocks:
        yield _as_markdown(block)


def _as_markdown(block: object) -> str:
    match block:
        case Paragraph():
            return _plain(block.text)
        case FormulaBlock():
            return f"$$\n{block.latex}\n$$" if block.latex else f"```text\n{typeset(block.text)}\n```"
        case Alert():
            remedy = f" *Remedy:* {_plain(block.remedy)}." if block.remedy else ""
            return f"> **{_plain(block.text)}**{remedy}"
        case StepBlock():
            facts = "\n".join(f"- *{_plain(term)}*: {_plain(text)}" for term, text in block.facts)
            return f"### {_plain(block.title)}\n\n{facts}"
        case TableBlock():
            rows = block.selected_rows
            cells = [column_texts(column, [row[k] for row in rows]) for k, column in enumerate(block.columns)]
            heads = [_plain(title_with_unit(column)) for column in block.columns]
            rules = ["---:" if column.is_number else "---" for column in block.columns]
            lines = [heads, rules, *(map(_plain, row) for row in zip(*cells, strict=True))]
            return "\n".join(f"| {' | '.join(line)} |" for line in lines)
    raise not_a_block(block)


def _plain(text: str) -> str:
    """Return text without markup."""
    return " ".join(typeset(text).translate(_ESCAPED).split())


@dataclass(frozen=True)
class Report(DisplaysHtml, Savable):
    """The report of a mechanism, in the order in which it is read.

    `subject` is what it is about, for the pictures of its page, and `outputs` and `design` are those it was made with.
    `studied` is the study, tolerance analysis or search that it reports.
    """

    saved_as: ClassVar[Kind] = "report"

    title: str
    sections: tuple[Section, ...]
    outcome: Outcome
    subject: Subject | None = field(default=None, repr=False, compare=False)
    outputs: Sequence[str] = field(default=(), repr=False, compare=False)
    design: int = field(default=0, repr=False, compare=False)
    studied: object = field(default=None, repr=False, compare=False)

    def section(self, key: str) -> Section | None:
        """Return the section of a key; None where the report has none."""
        return next((section for section in self.sections if section.key == key), None)

    def text(self, width: int = 80, colour: bool = False, whole: bool = False) -> str:
        """Write it as text, no line longer than `width`; in colour for a terminal.

        Of hundreds of links or groups the first ones are written, all if it is to be `whole`.
        """
        # rich costs as much to load as all of compoundkin, and only the text needs it
        from compoundkin.view.report.terminal_text import terminal_text

        return terminal_text(
            self.title, self.sections if whole else tuple(map(summarised, self.sections)), width, colour
        )

    def markdown(self) -> str:
        """Write it as Markdown, for GitHub and the like."""
        return markdown(self.title, self.sections)

    def json(self) -> str:
        """Write it as JSON: the same sections, with every row and every digit."""
        return json_text(self.title, self.sections, self.outcome)

    def html(self) -> str:
        """Write it as one HTML file with its pictures, which needs no other file."""
        return self.page().html

    def page(self) -> Page:
        """Return it as a page, which can be saved and opened in the browser."""
        from compoundkin.view.page.report_page import page_of

        figures: dict[str, str] = {}
        if self.studied is not None:
            # what studies and their plots take is not loaded for other pages
            from compoundkin.view.page.study_figures import study_figures

            figures = study_figures(self.studied)
        subject = self.subject, self.outputs, self.design
        return page_of(self.title, self.sections, self.outcome, *subject, figures)

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "text", "markdown", "json" or "html"."""
        if form == "text":
            return self.text(whole=True).encode("utf-8")
        return {"markdown": self.markdown, "json": self.json, "html": self.html}[form]().encode("utf-8")

    def __repr__(self) -> str:
        return f"Report({self.title!r}: {', '.join(section.key for section in self.sections)})"
