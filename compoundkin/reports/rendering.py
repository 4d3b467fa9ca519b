"""The ways a report is written out: one file each, and this registry."""

from __future__ import annotations

from collections.abc import Callable

from compoundkin.reports import json_, markdown
from compoundkin.reports.model import Report


def _text(report: Report) -> str:
    # rich costs as much to load as all of compoundkin, and only the text needs it
    from compoundkin.reports.text import text

    return text(report)


FORMATS: dict[str, Callable[[Report], str]] = {"text": _text, "markdown": markdown.markdown, "json": json_.json_text}


def rendered(report: Report, format: str = "text") -> str:
    """A report as text for 80 columns, Markdown or JSON, ending in a new line.

    >>> from compoundkin.mechanism import Mechanism
    >>> from compoundkin.words import link
    >>> from compoundkin.reports import report
    >>> from compoundkin.structure import decompose
    >>> rendered(report(decompose(Mechanism("Pin", link("frame", A=0)))), "markdown").splitlines()[0]
    '# Pin'
    """
    return FORMATS[format](report)
