"""Which file a verb starts from, and where its results go and in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable
from os.path import exists, isdir
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, alternatives, form_of
from compoundkin.cli.shell import has_colour, put, say, width

if TYPE_CHECKING:
    from compoundkin.kinematics.table import Table
    from compoundkin.model.mechanism import Mechanism
    from compoundkin.view.page import Page
    from compoundkin.view.report import Report

# Under this name a command's context tells whether all of a report is to be printed.
WHOLE = "whole report"
F = TypeVar("F", bound=Callable[..., Any])

# What people and scripts call standard output where a file is wanted.
STDOUT = ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")


class Destination(click.ParamType[Any]):
    """A file to write, or None for standard output."""

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str | None:
        """Return the path, or None."""
        return None if value in STDOUT else str(value)


TO_FILE = Destination()


def to_file(text: str) -> Callable[[F], F]:
    """Return the option of where results go.

    Standard output by any of its names is as if it were left out.
    """
    return click.option("-o", "--to-file", "path", type=TO_FILE, metavar="PATH", help=text)


FORMATS = tuple(dict.fromkeys(SUFFIXES["report"].values()))


def complete_name(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the names of the catalog that begin so."""
    from compoundkin.files.shipped_mechanisms import names

    return [CompletionItem(name) for name in names() if name.startswith(incomplete)]


def complete_mechanism(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the names that begin so, and files."""
    return [*complete_name(ctx, param, incomplete), CompletionItem(incomplete, type="file")]


def mechanism_argument(command: F) -> F:
    """Add the argument FILE to a command."""
    return click.argument("file", metavar="FILE", shell_complete=complete_mechanism)(command)


def loaded(file: str) -> Mechanism:
    """Load the mechanism of a file or of a name. Raises what is wrong with it.

    Files of other programs, and links that hold a mechanism, are files too.
    """
    from compoundkin.cli.foreign_import import imported, is_foreign
    from compoundkin.files import load
    from compoundkin.files.shipped_mechanisms import resolve

    # unlike those of paths these answer for pasted texts, which are longer than names of files may be
    if isdir(file):
        raise InvalidInput(Problem(file, "this is a folder", "name a mechanism file in it"))
    if is_foreign(file):
        return imported(file).mechanism
    # what is there but is no regular file, such as a pipe, is for `load` to judge
    return load(file if exists(file) else resolve(file))


def write_new(path: Path, content: bytes, force: bool) -> None:
    """Write a file. Raises InvalidInput where there is one already, unless forced, or it cannot be written."""
    from compoundkin.files.atomic import write_atomically

    if path.exists() and not force:
        raise InvalidInput(Problem(str(path), "the file is there already", "choose another name, or give --force"))
    write_atomically(path, lambda file: file.write(content))


def report_options(command: F) -> F:
    """Add the options --format, -o and --whole to a command that prints a report."""
    here = "Write the report here instead of printing it."
    file = click.option("-o", "--to-file", "path", type=TO_FILE, metavar="PATH", callback=_checked, help=here)
    return _with_format(file(whole_option(command)))


def report_or_table_options(command: F) -> F:
    """Add the options of a report, or of a table instead.

    The command judges the suffix itself.
    """
    here = f"Write the report here, or a table: {alternatives('table')}."
    return _with_format(to_file(here)(whole_option(command)))


def _with_format(command: F) -> F:
    told = "Text unless PATH ends in .md, .json or .html."
    # it is read first: a form that is given rules, whatever the suffix
    return click.option("--format", "form", type=click.Choice(FORMATS), is_eager=True, help=told)(command)


def whole_option(command: F) -> F:
    """Add the option --whole. It is kept in the context until a report is put."""
    text = "Print all links and groups, where there are hundreds of them. Files have them all."
    return click.option("--whole", is_flag=True, expose_value=False, callback=_kept, help=text)(command)


def _kept(context: click.Context, param: click.Parameter, value: bool) -> None:
    context.meta[WHOLE] = value


def _checked(context: click.Context, _: click.Parameter, path: str | None) -> str | None:
    """The path, once its suffix is known to tell a form; nothing is solved for one that does not."""
    if path is not None and context.params.get("form") is None:
        form_of("report", path)
    return path


def put_report(report: Report, form: str | None, path: str | None) -> None:
    """Print a report, or write it to a file whole or not at all."""
    if path is None:
        whole = click.get_current_context().meta.get(WHOLE, False)
        is_text = form is None or form == "text"
        put(report.text(width(), has_colour(sys.stdout), whole) if is_text else _written(report, form or ""))
        return
    from compoundkin.files.atomic import write_atomically

    content = _written(report, form or form_of("report", path)).encode("utf-8")
    write_atomically(path, lambda file: file.write(content))
    say(f"Wrote {path}.")


def put_table(table: Table, path: str | None) -> None:
    """Print a table as CSV, or write it to a file."""
    from compoundkin.files import save
    from compoundkin.files.saved_files import csv_text

    if path is None:
        put(csv_text(table).encode("utf-8"))
        return
    save(table, path)
    rows = f"{len(table):,} {'row' if len(table) == 1 else 'rows'}"
    say(f"Wrote {rows} of {len(table.columns)} columns to {path}.")


def made_page(report: Report) -> Page:
    """Return the page of a report."""
    from compoundkin.cli.progress import working

    with working("drawing"):
        return report.page()


def _written(report: Report, form: str) -> str:
    if form == "html":
        return made_page(report).html
    if form == "text":
        return report.text(whole=True)
    return {"markdown": report.markdown, "json": report.json}[form]()
