"""The ways a report is written out: one file each, and this registry."""

from __future__ import annotations

from collections.abc import Callable

from compoundkin.view.report import json_text, markdown_text
from compoundkin.view.report.report_data import Report


def _text(report: Report) -> str:
    # rich costs as much to load as all of compoundkin, and only the text needs it
    from compoundkin.view.report.terminal_text import text

    return text(report)


FORMATS: dict[str, Callable[[Report], str]] = {
    "text": _text,
    "markdown": markdown_text.markdown,
    "json": json_text.json_text,
}


def rendered(report: Report, format: str = "text") -> str:
    """A report as text for 80 columns, Markdown or JSON, ending in a new line.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.view.report import report
    >>> from compoundkin.structure import decompose
    >>> rendered(report(decompose(Mechanism("Pin", link("frame", A=0)))), "markdown").splitlines()[0]
    '# Pin'
    """
    return FORMATS[format](report)
