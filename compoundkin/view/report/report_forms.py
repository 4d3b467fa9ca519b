"""A report, and the forms in which it is written: text, Markdown, JSON, a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, TypeAlias

from compoundkin.base.display import Shows
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.report.json_text import json_text
from compoundkin.view.report.markdown_text import markdown
from compoundkin.view.report.report_data import Outcome, Section

if TYPE_CHECKING:
    from compoundkin.view.page import Page

Subject: TypeAlias = Structure | Motion


@dataclass(frozen=True)
class Report(Shows, Savable):
    """What there is to say about a mechanism, in the order in which it is read.

    `subject` is what it is about, for the pictures of its page, and `outputs` and `design` are those it was made with.
    """

    saved_as: ClassVar[Kind] = "report"

    title: str
    sections: tuple[Section, ...]
    outcome: Outcome
    subject: Subject | None = field(default=None, repr=False, compare=False)
    outputs: Sequence[str] = field(default=(), repr=False, compare=False)
    design: int = field(default=0, repr=False, compare=False)

    def section(self, key: str) -> Section | None:
        """Return the section of a key; None where the report has none."""
        return next((section for section in self.sections if section.key == key), None)

    def text(self, width: int = 80, colour: bool = False) -> str:
        """Write it as text, no line longer than `width`; in colour for a terminal."""
        # rich costs as much to load as all of compoundkin, and only the text needs it
        from compoundkin.view.report.terminal_text import text

        return text(self.title, self.sections, width, colour)

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

        return page_of(self.title, self.sections, self.outcome, self.subject, self.outputs, self.design)

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "text", "markdown", "json" or "html"."""
        write = {"text": self.text, "markdown": self.markdown, "json": self.json, "html": self.html}[form]
        return write().encode("utf-8")

    def __repr__(self) -> str:
        return f"Report({self.title!r}: {', '.join(section.key for section in self.sections)})"
