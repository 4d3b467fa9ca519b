"""The file a verb starts from, of compoundkin or of another program, and where its results go in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable
from os.path import exists, isdir, isfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, alternatives, file_format, suffix_for, suffix_of
from compoundkin.cli.shell import has_colour, put, report_width, say

if TYPE_CHECKING:
    from compoundkin.files.exchange.exchanged import Imported
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


def load_mechanism(file: str) -> Mechanism:
    """Load the mechanism of a file or of a name. Raises what is wrong with it.

    Files of other programs, and links that hold a mechanism, are files too.
    """
    pass  # joined
    from compoundkin.files import load
    from compoundkin.files.shipped_mechanisms import resolve

    # unlike those of paths these answer for pasted texts, which are longer than names of files may be
    if isdir(file):
        raise InvalidInput(Problem(file, "this is a folder", "name a mechanism file in it"))
    if is_foreign_file(file):
        return import_with_notes(file).mechanism
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
    file = click.option("-o", "--to-file", "path", type=TO_FILE, metavar="PATH", callback=_checked_path, help=here)
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
    return click.option("--whole", is_flag=True, expose_value=False, callback=_store_whole, help=text)(command)


def _store_whole(context: click.Context, param: click.Parameter, value: bool) -> None:
    context.meta[WHOLE] = value


def _checked_path(context: click.Context, _: click.Parameter, path: str | None) -> str | None:
    """The path, once its suffix is known to tell a form; nothing is solved for one that does not."""
    if path is not None and context.params.get("form") is None:
        file_format("report", path)
    return path


def put_report(report: Report, form: str | None, path: str | None) -> None:
    """Print a report, or write it to a file whole or not at all."""
    if path is None:
        whole = click.get_current_context().meta.get(WHOLE, False)
        is_text = form is None or form == "text"
        put(report.text(report_width(), has_colour(sys.stdout), whole) if is_text else _report_text(report, form or ""))
        return
    from compoundkin.files.atomic import write_atomically

    content = _report_text(report, form or file_format("report", path)).encode("utf-8")
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


def draw_page(report: Report) -> Page:
    """Return the page of a report."""
    from compoundkin.cli.shell import working

    with working("drawing"):
        return report.page()


def _report_text(report: Report, form: str) -> str:
    if form == "html":
        return draw_page(report).html
    if form == "text":
        return report.text(whole=True)
    return {"markdown": report.markdown, "json": report.json}[form]()


# Of mechanisms with more pairs only the links are counted: finding out what holds what twice may take minutes.
_MOST_PAIRS = 100


def is_foreign_file(source: str) -> bool:
    """Tell whether a link or a file is to be read as another program's. Nothing is said of what is neither."""
    from compoundkin.files.exchange.content import content_of, is_itself

    if is_itself(source):
        return True
    if suffix_of(source) == suffix_for("mechanism", "toml") or not isfile(source):
        return False
    from compoundkin.base.errors import InvalidInput
    from compoundkin.files.exchange.known_formats import readable_formats
    from compoundkin.files.exchange.recognition import recognised

    try:
        recognised(content_of(Path(source)), readable_formats())
    except InvalidInput:
        # what is no file of ours either by its suffix is told what it is
        return suffix_of(source) not in SUFFIXES["mechanism"]
    return True


def import_with_notes(source: str, form: str = "") -> Imported:
    """Return what a file, a link or standard input holds. What does not come across is said."""
    from compoundkin.files.exchange.conversion import read

    found = read(_standard_input() if source == "-" else source, form)
    say(f"Read {found.mechanism.title!r} ({found.form}): {_summary(found)}.")
    for note in found.notes:
        say(f"Note: {note}")
    return found


def _summary(found: Imported) -> str:
    """What it is made of; where something keeps it from being solved, that."""
    from compoundkin.structure import decompose

    if len(found.mechanism.pins) + len(found.mechanism.written_pairs) > _MOST_PAIRS:
        return found.mechanism.in_numbers
    structure = decompose(found.mechanism)
    groups = ", ".join(group.name for group in structure.groups)
    faults = "; ".join(fault.text for fault in structure.faults)
    told = f"groups {groups}" if groups else "no groups"
    said = f"{found.mechanism.in_numbers}, mobility {structure.mobility.freedoms}, {told}"
    return f"{said}; it cannot be solved as it is: {faults}" if faults else said


def _standard_input() -> str:
    """Return what is piped in; a line end tells it from a path."""
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.files.exchange.content import MOST_BYTES, as_utf8

    raw = sys.stdin.buffer.read(MOST_BYTES + 1)
    try:
        return as_utf8(raw).decode("utf-8-sig") + "\n"
    except UnicodeDecodeError:
        raise InvalidInput(Problem("standard input", "it is not UTF-8 text", "name the file")) from None
