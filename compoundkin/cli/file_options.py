"""The file a verb starts from, of compoundkin or of another program, and where its results go in which form."""

from __future__ import annotations

import sys
from collections.abc import Callable
from os.path import dirname, exists, isdir, isfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotDetermined, Problem, UnknownName
from compoundkin.base.suffixes import SUFFIXES, alternatives, file_format, suffix_for, suffix_of
from compoundkin.cli.shell import NOT_ASSEMBLED, has_colour, put, report_width, say, working

if TYPE_CHECKING:
    from compoundkin.files.exchange.contract import Imported
    from compoundkin.kinematics.quantities import Table
    from compoundkin.model.mechanism import Mechanism
    from compoundkin.structure import Structure
    from compoundkin.view.page import Page
    from compoundkin.view.plot import Plot
    from compoundkin.view.report import Report
    from compoundkin.view.sketch import Picture

    Parameter = click.ParamType[Any]
else:  # before click 8.4 it takes no type
    Parameter = click.ParamType

F = TypeVar("F", bound=Callable[..., Any])
FORMATS = tuple(dict.fromkeys(SUFFIXES["report"].values()))
# The key of a command's context under which --whole is stored.
WHOLE = "whole report"
# What an editor does about wrong files, while they are written.
SCHEMA_HINT = (
    'Editors check and complete such files: compoundkin schema > mechanism.schema.json, and "#:schema '
    "mechanism.schema.json\" as the file's first line."
)
# Names of standard output where a file is expected.
STDOUT = ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")
# Mechanisms with more pairs are not decomposed for a summary: finding redundant constraints may take minutes.
_MOST_PAIRS = 100


class Destination(Parameter):
    """A file to write, or None for standard output."""

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str | None:
        """Return the path, or None. Raises InvalidInput where its folder does not exist, before anything is solved."""
        if value in STDOUT:
            return None
        check_place(value)
        return str(value)


def check_place(path: str) -> None:
    """Raise InvalidInput for a file in a folder that does not exist."""
    if not isdir(dirname(path) or "."):
        raise InvalidInput(Problem(str(path), f"it cannot be written: there is no folder {dirname(path)}", "make it"))


def to_file(text: str) -> Callable[[F], F]:
    """Return the option for the file of results; any name of standard output means no file."""
    return click.option("-o", "--to-file", "path", type=Destination(), metavar="PATH", help=text)


def complete_name(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the names of the catalog that complete a word."""
    from compoundkin.files.shipped_mechanisms import shipped

    return [CompletionItem(name) for name in shipped() if name.startswith(incomplete)]


def complete_mechanism(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the names of the catalog that complete a word, and files."""
    return [*complete_name(ctx, param, incomplete), CompletionItem(incomplete, type="file")]


def mechanism_argument(command: F) -> F:
    """Add the argument FILE to a command."""
    return click.argument("file", metavar="FILE", shell_complete=complete_mechanism)(command)


def load_mechanism(file: str) -> Mechanism:
    """Return the mechanism of a file, of a name of the catalog, of another program's file, or of a link that holds one.

    A text such as "four-bar:60,20,50,40" is a linkage by its lengths. Raises InvalidInput and its kinds for what cannot
    be read.
    """
    from compoundkin.files import load
    from compoundkin.files.shipped_mechanisms import resolve

    # functions of os.path accept a pasted text longer than a file name may be
    if isdir(file):
        raise InvalidInput(Problem(file, "this is a folder", "name a mechanism file in it"))
    if ":" in file and not exists(file) and (made := _linkage(file)) is not None:
        return made
    if not exists(file) and (lacking := _needs_lengths(file)) is not None:
        raise lacking
    if is_foreign_file(file):
        return import_with_notes(file).mechanism
    # `load` judges what is no regular file, such as a pipe
    try:
        return load(file if exists(file) else resolve(file))
    except InvalidMechanism as error:
        error.add_note(SCHEMA_HINT)
        raise


def _linkage(text: str) -> Mechanism | None:
    from compoundkin.synthesis.linkages import linkage_of

    return linkage_of(text)


def _needs_lengths(text: str) -> UnknownName | None:
    """Return the error of a linkage without its lengths; None for any other name."""
    from compoundkin.files.shipped_mechanisms import shipped

    if text in shipped():
        return None
    from compoundkin.synthesis.linkages import is_linkage, kind_named

    if not is_linkage(f"{text}:"):
        return None
    kind = kind_named(text)
    such = f'"{kind.name}:{kind.example}", what they are lists compoundkin new --list'
    return UnknownName(Problem(text, "a linkage takes its lengths", f"such as {such}"))


def write_new(path: Path, content: bytes, force: bool) -> None:
    """Write a file. Raises InvalidInput where it exists, unless forced, or cannot be written."""
    from compoundkin.files.atomic import write_atomically

    if path.exists() and not force:
        raise InvalidInput(Problem(str(path), "the file is there already", "choose another name, or give --force"))
    write_atomically(path, lambda file: file.write(content))


def report_options(command: F) -> F:
    """Add the options --format, -o and --whole to a command that prints a report."""
    here = "Write the report here instead of printing it."
    file = click.option(
        "-o", "--to-file", "path", type=Destination(), metavar="PATH", callback=_checked_path, help=here
    )
    return _with_format(file(_with_whole(command)))


def report_or_table_options(command: F) -> F:
    """Add the options of a report or a table; the command decides by the suffix."""
    here = f"Write the report here, or a table: {alternatives('table')}."
    return _with_format(to_file(here)(_with_whole(command)))


def report_or_mechanism_options(command: F) -> F:
    """Add the options of a report or a changed mechanism; the command decides by the suffix."""
    here = "Write the report here, or the mechanism with its new dimensions: .toml."
    return _with_format(to_file(here)(_with_whole(command)))


def _with_format(command: F) -> F:
    text = "Text unless PATH ends in .md, .json or .html."
    # read first, as it overrules the suffix
    return click.option("--format", "form", type=click.Choice(FORMATS), is_eager=True, help=text)(command)


def _with_whole(command: F) -> F:
    """Add the option --whole, which the context holds until a report is printed."""

    def store(context: click.Context, _: click.Parameter, value: bool) -> None:
        context.meta[WHOLE] = value

    text = "Print all links and groups, where there are hundreds of them. Files have them all."
    return click.option("--whole", is_flag=True, expose_value=False, callback=store, help=text)(command)


def _checked_path(context: click.Context, _: click.Parameter, path: str | None) -> str | None:
    """Check that the suffix of a path determines a form before anything is solved."""
    if path is not None and context.params.get("form") is None:
        file_format("report", path)
    return path


def solvable_structure(
    file: str, form: str | None, path: str | None, change: Callable[[Mechanism], Mechanism] | None = None
) -> Structure:
    """Return the structure of a file, its mechanism changed first.

    One with faults is reported, and the command exits.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.report import report

    mechanism = load_mechanism(file)
    structure = decompose(mechanism if change is None else change(mechanism))
    if structure.faults:
        put_report(report(structure), form, path)
        raise click.exceptions.Exit(report_unsolvable(len(structure.faults)))
    return structure


def report_unsolvable(faults: int) -> int:
    """Write to stderr that a structure cannot be solved, and return the exit code."""
    say(f"The mechanism cannot be solved: {faults:,} fault{'' if faults == 1 else 's'}, explained in the report.")
    return NotDetermined.exit_code


def exit_code(report: Report) -> int:
    """Return the exit code of a report: not zero where poses cannot be assembled."""
    return NOT_ASSEMBLED if report.outcome.assembled < report.outcome.poses else 0


def is_table(path: str | None, form: str | None, table: str = "", report: str = "") -> bool:
    """Return whether a table is asked for instead of a report: by an option, or by a suffix that only tables have.

    `table` and `report` name the given options that ask for either. Raises InvalidInput for options that exclude each
    other and for unknown suffixes.
    """
    report = f"--format {form}" if form else report
    only_table = path is not None and suffix_of(path) in SUFFIXES["table"].keys() - SUFFIXES["report"].keys()
    tabulated = bool(table) or (only_table and not report)
    if table and report:
        raise InvalidInput(Problem(report, f"it does not go with {table}, which is a table", "leave one of them out"))
    if path is not None and (tabulated or form is None):
        file_format("table" if tabulated else "report", path)
    return tabulated


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
    from compoundkin.files.saved_files import csv_text, save

    if path is None:
        put(csv_text(table).encode("utf-8"))
        return
    save(table, path)
    rows = f"{len(table):,} {'row' if len(table) == 1 else 'rows'}"
    say(f"Wrote {rows} of {len(table.columns)} columns to {path}.")


def put_picture(picture: Picture | Plot, path: str | None) -> None:
    """Print a picture as SVG, or write it to a file."""
    if path is None:
        put(picture.content("svg"))
    else:
        picture.save(path)
        say(f"Wrote {path}.")


def draw_page(report: Report) -> Page:
    """Return the page of a report."""
    with working("drawing"):
        return report.page()


def _report_text(report: Report, form: str) -> str:
    if form == "html":
        return draw_page(report).html
    if form == "text":
        return report.text(whole=True)
    return {"markdown": report.markdown, "json": report.json}[form]()


def is_foreign_file(source: str) -> bool:
    """Return whether a source is a link that holds a mechanism, or a file of another program."""
    from compoundkin.files.exchange.content import content_of, is_itself

    if is_itself(source):
        return True
    if suffix_of(source) == suffix_for("mechanism", "toml") or not isfile(source):
        return False
    from compoundkin.files.exchange.known_formats import readable_formats, recognised

    try:
        recognised(content_of(Path(source)), readable_formats())
    except InvalidInput:
        # a suffix that is not ours either: the reader's error explains it
        return suffix_of(source) not in SUFFIXES["mechanism"]
    return True


def import_with_notes(source: str, form: str = "") -> Imported:
    """Return the mechanism of a file, a link or standard input; what is not converted is noted on stderr."""
    from compoundkin.files.exchange.known_formats import read

    found = read(_standard_input() if source == "-" else source, form)
    say(f"Read {found.mechanism.title!r} ({found.form}): {_summary(found)}.")
    for note in found.notes:
        say(f"Note: {note}")
    return found


def _summary(found: Imported) -> str:
    """Links, pairs, mobility and groups in a line, and what keeps the mechanism from being solved."""
    from compoundkin.structure import decompose

    if len(found.mechanism.pins) + len(found.mechanism.written_pairs) > _MOST_PAIRS:
        return found.mechanism.in_numbers
    structure = decompose(found.mechanism)
    groups = ", ".join(group.name for group in structure.groups)
    faults = "; ".join(fault.text for fault in structure.faults)
    parts = f"groups {groups}" if groups else "no groups"
    text = f"{found.mechanism.in_numbers}, mobility {structure.mobility.freedoms}, {parts}"
    return f"{text}; it cannot be solved as it is: {faults}" if faults else text


def _standard_input() -> str:
    """Return the text of standard input; a line end distinguishes it from a path."""
    from compoundkin.files.exchange.content import MOST_BYTES, as_utf8

    raw = sys.stdin.buffer.read(MOST_BYTES + 1)
    try:
        return as_utf8(raw).decode("utf-8-sig") + "\n"
    except UnicodeDecodeError:
        raise InvalidInput(Problem("standard input", "it is not UTF-8 text", "name the file")) from None
