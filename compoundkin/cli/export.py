"""`compoundkin export` and `import`: files of other programs, functions in other languages, TikZ pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem, nearest, suggestion
from compoundkin.base.suffixes import SUFFIXES, alternatives, file_format, suffix_for, suffix_of
from compoundkin.cli.drive_options import MODE, names_option, read_assembly_modes
from compoundkin.cli.file_options import import_with_notes, load_mechanism, mechanism_argument, to_file, write_new
from compoundkin.cli.shell import put, say, working
from compoundkin.files.exchange import MODULES, READ_ONLY
from compoundkin.files.exchange.content import is_itself

if TYPE_CHECKING:
    Choice = click.Choice[str]
    from compoundkin.structure import Structure
else:  # before click 8.2 it takes no type
    Choice = click.Choice


PROGRAMS = tuple(dict.fromkeys(SUFFIXES["program"].values()))
TIKZ = "tikz"
TARGETS = (*PROGRAMS, *(name for name in MODULES if name not in READ_ONLY), TIKZ)
# Options of programs in other languages alone, and of poses alone, by the names of their values.
OF_PROGRAMS = {"outputs": "--output", "free": "--free", "modes": "--mode", "name": "--name"}
OF_POSES = {"at": "--at", "options": "--option"}


class Target(Choice):
    """A format, also by what others call it."""

    def get_invalid_choice_message(self, value: Any, ctx: click.Context | None) -> str:
        """Return the message with the formats, and that which is meant."""
        said = super().get_invalid_choice_message(value, ctx)
        return f"{said} {suggestion(value, TARGETS)}" if nearest(value, TARGETS) else said


class WithTargets(click.Command):
    """A command that lists what can be exported in its help."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the formats of other programs with their options, then the examples."""
        from compoundkin.files.exchange.known_formats import writable_formats

        rows = []
        for one in writable_formats().values():
            suffix = f" ({one.suffix})" if one.suffix and one.suffix not in one.title else ""
            rows.append((one.name, f"{one.title}{suffix}"))
            rows += [(f"  --option {name}=...", text) for name, text in one.options.items()]
        rows.append((TIKZ, f"the kinematic sketch for LaTeX ({suffix_for('picture', TIKZ)})"))
        with formatter.section("Formats of other programs"):
            formatter.write_dl(rows)
        super().format_epilog(ctx, formatter)


@click.command(
    cls=WithTargets,
    epilog="""\b
Examples:
  compoundkin export six-bar -o six_bar.linkage2
  compoundkin export six-bar --to pmks+ --at 35
  compoundkin export six-bar -o six_bar.c
  compoundkin export six-bar --to python --output G.position,bar.angle
  compoundkin export six-bar --free crank.D --free plate.C -o six_bar.js
""",
)
@mechanism_argument
@click.option("--to", "form", type=Target(tuple(TARGETS), case_sensitive=False), metavar="FORM",
              help="As what: c, python, javascript, matlab, or a format of another program (see below); the suffix "
              "of PATH tells too.")  # fmt: skip
@click.option("--at", "at", multiple=True, metavar="[NAME=]VALUE",
              help="For other programs: the pose, a driver's value, degrees or length; as drawn if left "
              "out.")  # fmt: skip
@click.option("--option", "options", multiple=True, metavar="NAME=VALUE", help="An option of the format.")
@names_option("--output", "outputs", "QUANTITY",
              "What a function returns, such as G.velocity, bar.angle, slot.rate; repeat it, or write commas. "
              "The outputs of the file if left out, else all points.")  # fmt: skip
@names_option("--free", "free", "DIMENSION",
              "A dimension that it takes as an argument, such as crank.D; repeat it, or write commas.")  # fmt: skip
@MODE
@click.option(
    "--name", "name", metavar="NAME", default="", help="What the function is called; as the file if left out."
)
@to_file("Write it here; else to stdout.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(file: str, path: str | None, form: str | None, force: bool, **options: Any) -> None:
    """Write a mechanism for another program, or as a function in another language.

    Those are C, Python, JavaScript and MATLAB: a function takes drivers' values (radians or lengths), their rates and
    free dimensions, and returns the outputs. Files of other programs hold one pose; what their format lacks is an
    error, what is not converted is noted on stderr.
    """
    from compoundkin.structure import decompose

    if form is None and path is None:
        raise InvalidInput(Problem("--to", "the form is missing", f"give one of {', '.join(TARGETS)}"))
    form = form or _form_of(path or "")
    mechanism = load_mechanism(file)
    structure = decompose(mechanism)
    if form in PROGRAMS:
        # a link is no name
        name = options["name"] or Path(path or (mechanism.title if is_itself(file) else file)).stem
        content = _program(structure, form, name, options)
    else:
        content = _picture(structure, options) if form == TIKZ else _foreign_file(structure, form, options)
    if path is None:
        # text ends with a line end on the terminal
        put(content if content.endswith(b"\n") or b"\0" in content else content + b"\n")
    else:
        write_new(Path(path), content, force)
        say(f"Wrote {path}.")


def _form_of(path: str) -> str:
    """Return the form of a suffix: a language, TikZ, or the format of another program."""
    suffix = suffix_of(path)
    if suffix == suffix_for("picture", TIKZ):
        return TIKZ
    return file_format("program", path) if suffix in SUFFIXES["program"] else _format_of(path, suffix)


def _format_of(path: str, suffix: str) -> str:
    """Return the format whose files have a suffix. Raises InvalidInput where there is none, or several."""
    from compoundkin.files.exchange.known_formats import writable_formats

    known = writable_formats()
    found = [name for name, one in known.items() if one.suffix and one.suffix == suffix]
    if len(found) > 1:
        raise InvalidInput(Problem(path, f"files of {len(found)} programs end so", f"give --to {' or '.join(found)}"))
    if not found:
        what = f"nothing is exported as {suffix!r}" if suffix else "the file has no suffix"
        formats = (one.suffix for one in known.values() if one.suffix)
        ends = ", ".join(dict.fromkeys((*SUFFIXES["program"], *formats, suffix_for("picture", TIKZ))))
        named = nearest(suffix.removeprefix("."), TARGETS)
        to = f"--to {' or '.join(named)}" if named else "--to"
        raise InvalidInput(Problem(path, what, f"give {to}, or end it in {ends}"))
    return found[0]


def _program(structure: Structure, form: str, name: str, options: Mapping[str, Any]) -> bytes:
    """Return a function in another language."""
    from compoundkin.programs.compiled_path import compile, recorded_outputs

    _refuse(form, options, OF_POSES)
    modes = read_assembly_modes(structure, options["modes"]) or None
    outputs = list(options["outputs"])
    if not outputs:
        outputs, left_out = recorded_outputs(structure)
        for why in left_out:
            say(f"Left out: {why}")
    with working("solving"):
        text = compile(structure, outputs, free=options["free"], modes=modes).source(form, name)
    return text.encode("utf-8")


def _foreign_file(structure: Structure, form: str, options: Mapping[str, Any]) -> bytes:
    """Return the content of another program's file; what is not converted is noted on stderr."""
    from compoundkin.files.exchange.known_formats import write

    _refuse(form, options, OF_PROGRAMS)
    found = write(structure.mechanism, form, _pose(structure, options), **format_options(options["options"]))
    for note in found.notes:
        say(f"Note: {note}")
    return found.content


def _picture(structure: Structure, options: Mapping[str, Any]) -> bytes:
    """Return the kinematic sketch for LaTeX."""
    from compoundkin.view.sketch import draw

    _refuse(TIKZ, options, {**OF_PROGRAMS, "options": "--option"})
    return draw(structure, _pose(structure, options)).content(TIKZ)


def _pose(structure: Structure, options: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the drivers' values that the options set. None is the pose nearest to the drawing."""
    from compoundkin.cli import typed_values

    return typed_values.read_pose(structure, options["at"]) if options["at"] else None


def _refuse(form: str, options: Mapping[str, Any], names: Mapping[str, str]) -> None:
    """Raise InvalidInput for options that do not go with a form."""
    for key, option in names.items():
        if options[key]:
            raise InvalidInput(Problem(option, f"it does not go with --to {form}", "leave it out"))


def format_options(given: Sequence[str]) -> dict[str, str]:
    """Return options of a format from texts NAME=VALUE.

    >>> format_options(["curves=no", "scale=2.5"])
    {'curves': 'no', 'scale': '2.5'}
    """
    found = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not (name and equals):
            raise InvalidInput(Problem(f"--option {text}", "this is no option", "write NAME=VALUE"))
        found[name] = value
    return found


class WithFormats(click.Command):
    """A command that lists the formats of other programs in its help."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the formats that are read, then the examples."""
        from compoundkin.files.exchange.known_formats import readable_formats

        rows = [(one.name, one.title) for one in readable_formats().values()]
        with formatter.section("Formats that are read"):
            formatter.write_dl(rows)
        super().format_epilog(ctx, formatter)


@click.command(
    cls=WithFormats,
    epilog="""\b
Examples:
  compoundkin import crane.linkage2 -o crane.toml
  compoundkin import 'https://app.pmksplus.com/?...' -o mine.toml
  compoundkin import joints.csv --form joints
  xclip -o | compoundkin import - -o pasted.toml
""",
)
@click.argument("source", metavar="FILE|LINK")
@click.option("--form", "form", default="", metavar="FORMAT", help="Its format; it is recognised if left out.")
@to_file(f"Write a mechanism file here: {alternatives('mechanism')}; else TOML to stdout.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def import_command(source: str, form: str, path: str | None, force: bool) -> int:
    """Read a mechanism from another program's file, or from a link that holds it. Nothing is fetched.

    What is not converted is noted on stderr. - reads standard input.
    """
    from compoundkin.files.mechanism_files import encoded

    syntax = "toml" if path is None else file_format("mechanism", path)
    found = import_with_notes(source, form)
    content = encoded(found.mechanism, syntax, path or source)
    if path is None:
        put(content)
    else:
        write_new(Path(path), content, force)
        say(f"Wrote {path}; see it with: compoundkin report {path}")
    return 0
