"""Options that say where results go and in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from compoundkin.base.suffixes import SUFFIXES, form_of
from compoundkin.cli.shell import has_colour, put, say, width

if TYPE_CHECKING:
    from compoundkin.view.page import Page
    from compoundkin.view.report import Report

F = TypeVar("F", bound=Callable[..., Any])

FORMATS = tuple(dict.fromkeys(SUFFIXES["report"].values()))


def report_options(command: F) -> F:
    """Add the options --format and -o to a command that prints a report."""
    here = "Write the report here instead of printing it."
    file = click.option("-o", "--to-file", "path", metavar="PATH", callback=_checked, help=here)
    told = "Text unless PATH ends in .md, .json or .html."
    # it is read first: a form that is given rules, whatever the suffix
    form = click.option("--format", "form", type=click.Choice(FORMATS), is_eager=True, help=told)
    return form(file(command))


def _checked(context: click.Context, _: click.Parameter, path: str | None) -> str | None:
    """The path, once its suffix is known to tell a form; nothing is solved for one that does not."""
    if path is not None and context.params.get("form") is None:
        form_of("report", path)
    return path


def put_report(report: Report, form: str | None, path: str | None) -> None:
    """Print a report, or write it to a file whole or not at all."""
    if path is None:
        put(report.text(width(), has_colour(sys.stdout)) if form is None or form == "text" else _written(report, form))
        return
    from compoundkin.files.atomic import write_atomically

    content = _written(report, form or form_of("report", path)).encode("utf-8")
    write_atomically(path, lambda file: file.write(content))
    say(f"Wrote {path}.")


def made_page(report: Report) -> Page:
    """Return the page of a report."""
    from compoundkin.cli.progress import working

    with working("drawing"):
        return report.page()


def _written(report: Report, form: str) -> str:
    if form == "html":
        return made_page(report).html
    return {"text": report.text, "markdown": report.markdown, "json": report.json}[form]()
