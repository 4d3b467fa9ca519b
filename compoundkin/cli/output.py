"""Options that say where results go and in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from compoundkin.cli.shell import has_colour, put, say, width

if TYPE_CHECKING:
    from compoundkin.reports import Report

F = TypeVar("F", bound=Callable[..., Any])

FORMATS = ("text", "markdown", "json")
BY_SUFFIX = {".md": "markdown", ".markdown": "markdown", ".json": "json"}


def report_options(command: F) -> F:
    """The options --format and -o of a command that prints a report."""
    file = click.option("-o", "--to-file", "path", metavar="PATH", help="Write the report here instead of printing it.")
    form = click.option("--format", "form", type=click.Choice(FORMATS), help="Text unless PATH ends in .md or .json.")
    return form(file(command))


def put_report(report: Report, form: str | None, path: str | None) -> None:
    """Print a report, or write it to a file whole or not at all."""
    if path is None:
        put(_printed(report, form or "text"))
        return
    from pathlib import Path

    from compoundkin.formats.atomic import write_atomically
    from compoundkin.reports import rendered

    content = rendered(report, form or BY_SUFFIX.get(Path(path).suffix.lower(), "text")).encode("utf-8")
    write_atomically(path, lambda file: file.write(content))
    say(f"Wrote {path}.")


def _printed(report: Report, form: str) -> str:
    if form != "text":
        from compoundkin.reports import rendered

        return rendered(report, form)
    from compoundkin.reports.text import text

    return text(report, width(), has_colour(sys.stdout))
