"""Options that say where results go and in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from compoundkin.cli.shell import has_colour, put, say, width

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.page import Page
    from compoundkin.view.report import Report

F = TypeVar("F", bound=Callable[..., Any])

FORMATS = ("text", "markdown", "json", "html")
BY_SUFFIX = {".md": "markdown", ".markdown": "markdown", ".json": "json", ".html": "html", ".htm": "html"}


@dataclass(frozen=True)
class About:
    """What a report is about, for the pictures of its page, and with which outputs of which design it was made.

    `closed` where every pose that was asked for is assembled.
    """

    structure: Structure | None = None
    motion: Motion | None = None
    outputs: Sequence[str] = ()
    design: int = 0
    closed: bool = True


NOTHING = About()


def report_options(command: F) -> F:
    """The options --format and -o of a command that prints a report."""
    file = click.option("-o", "--to-file", "path", metavar="PATH", help="Write the report here instead of printing it.")
    told = "Text unless PATH ends in .md, .json or .html."
    form = click.option("--format", "form", type=click.Choice(FORMATS), help=told)
    return form(file(command))


def put_report(report: Report, form: str | None, path: str | None, about: About = NOTHING) -> None:
    """Print a report, or write it to a file whole or not at all."""
    if path is None:
        put(_printed(report, form or "text", about))
        return
    from pathlib import Path

    from compoundkin.files.atomic import write_atomically

    content = _rendered(report, form or BY_SUFFIX.get(Path(path).suffix.lower(), "text"), about).encode("utf-8")
    write_atomically(path, lambda file: file.write(content))
    say(f"Wrote {path}.")


def made_page(report: Report, about: About) -> Page:
    """The page of a report."""
    from compoundkin.cli.progress import working
    from compoundkin.view.page import page_of

    with working("drawing"):
        return page_of(report, about.structure, about.motion, about.design, about.outputs)


def _rendered(report: Report, form: str, about: About) -> str:
    if form == "html":
        return made_page(report, about).html
    from compoundkin.view.report import rendered

    return rendered(report, form)


def _printed(report: Report, form: str, about: About) -> str:
    if form != "text":
        return _rendered(report, form, about)
    from compoundkin.view.report.terminal_text import text

    return text(report, width(), has_colour(sys.stdout))
