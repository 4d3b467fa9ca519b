"""`compoundkin export`: a mechanism as a file of another program, a function in another language, or a TikZ picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, file_format, suffix_for, suffix_of
from compoundkin.cli.drive_options import MODE, read_assembly_modes, split_names
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, to_file, write_new
from compoundkin.cli.shell import put, say
from compoundkin.files.exchange import MODULES, READ_ONLY
from compoundkin.files.exchange.content import is_itself
from compoundkin.model.attributes import OF_POINTS

if TYPE_CHECKING:
    from compoundkin.structure import Structure


def _program(structure: Structure, form: str, asked: Mapping[str, Any]) -> bytes:
    """A function in another language."""
    from compoundkin.cli.shell import working
    from compoundkin.programs.compiled_path import compile

    refuse_options(form, asked, OF_POSES)
    modes = read_assembly_modes(structure, asked["modes"]) or None
    outputs = asked["outputs"] or _own_outputs(structure)
    with working("solving"):
        text = compile(structure, outputs, free=asked["free"], modes=modes).source(form, asked["called"])
    return text.encode("utf-8")


TIKZ = "tikz"


def _own_outputs(structure: Structure) -> list[str]:
    """The outputs of the file that a program can have, else the places of all points."""
    from compoundkin.base.errors import InvalidInput, UnknownName
    from compoundkin.kinematics import solve
    from compoundkin.programs.recording.recorded_motion import output_of

    found: list[str] = []
    motion = solve(structure, order=0)
    for name in structure.mechanism.outputs:
        try:
            found.append(output_of(motion, name).name)
        except (UnknownName, InvalidInput) as error:
            say(f"Left out: {error}")
    return found or [f"{point}.{OF_POINTS[0]}" for point in structure.mechanism.carriers]


# What is asked of programs in other languages alone, and of poses alone, by the options.
OF_PROGRAMS = {"outputs": "--output", "free": "--free", "modes": "--mode", "name": "--name"}


OF_POSES = {"at": "--at", "options": "--option"}


def foreign_file(structure: Structure, form: str, asked: Mapping[str, Any]) -> bytes:
    """Return the content of another program's file. What does not come across is said."""
    from compoundkin.files.exchange.conversion import write

    refuse_options(form, asked, OF_PROGRAMS)
    found = write(structure.mechanism, form, export_pose(structure, asked), **format_options(asked["options"]))
    for note in found.notes:
        say(f"Note: {note}")
    return found.content


def tikz_picture(structure: Structure, form: str, asked: Mapping[str, Any]) -> bytes:
    """Return the kinematic sketch for LaTeX."""
    from compoundkin.view.sketch import draw

    refuse_options(form, asked, {**OF_PROGRAMS, "options": "--option"})
    return draw(structure, export_pose(structure, asked)).content(form)


def export_pose(structure: Structure, asked: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the driver values that are asked for. None is the pose nearest to the drawing."""
    from compoundkin.cli import typed_values

    return typed_values.read_pose(structure, asked["at"]) if asked["at"] else None


def refuse_options(form: str, asked: Mapping[str, Any], options: Mapping[str, str]) -> None:
    """Raise InvalidInput for options that do not go with a form."""
    for key, option in options.items():
        if asked[key]:
            raise InvalidInput(Problem(option, f"it does not go with --to {form}", "leave it out"))


def format_options(given: Sequence[str]) -> dict[str, str]:
    """Return options from texts NAME=VALUE. Formats know what kind of value each has.

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


# What can be exported, by the form: each language of programs and each format of other programs, and what makes it.
TARGETS: Mapping[str, Callable[[Structure, str, Mapping[str, Any]], bytes]] = {
    **dict.fromkeys(SUFFIXES["program"].values(), _program),
    **dict.fromkeys((name for name in MODULES if name not in READ_ONLY), foreign_file),
    TIKZ: tikz_picture,
}


class WithTargets(click.Command):
    """A command that lists what can be exported in its help."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the formats of other programs with their options, then the examples."""
        from compoundkin.files.exchange.known_formats import writable_formats

        rows = []
        for one in writable_formats().values():
            told = f" ({one.suffix})" if one.suffix and one.suffix not in one.title else ""
            rows.append((one.name, f"{one.title}{told}"))
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
@click.option("--to", "form", type=click.Choice(tuple(TARGETS)), metavar="FORM",
              help="As what: c, python, javascript, matlab, or a format of another program (see below); the suffix "
              "of PATH tells too.")  # fmt: skip
@click.option("--at", "at", multiple=True, metavar="[NAME=]VALUE",
              help="For other programs: the pose, a driver's value, degrees or length; as drawn if left "
              "out.")  # fmt: skip
@click.option("--option", "options", multiple=True, metavar="NAME=VALUE", help="An option of the format.")
@click.option("--output", "outputs", multiple=True, metavar="QUANTITY", callback=lambda _c, _p, given: split_names(given),
              help="What a function answers, such as G.velocity, bar.angle, slot.rate; repeat it, or write commas. "
              "The outputs of the file if left out, else all points.")  # fmt: skip
@click.option("--free", "free", multiple=True, metavar="DIMENSION", callback=lambda _c, _p, given: split_names(given),
              help="A dimension that it is given, such as crank.D; repeat it, or write commas.")  # fmt: skip
@MODE
@click.option(
    "--name", "name", metavar="NAME", default="", help="What the function is called; as the file if left out."
)
@to_file("Write it here; else to stdout.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(file: str, path: str | None, form: str | None, force: bool, **asked: Any) -> None:
    """Write a mechanism for another program, or as a function in another language.

    Those are C, Python, JavaScript and MATLAB: a function is given drivers' values (radians or lengths), their rates
    and free dimensions, and answers the outputs. Files of other programs hold one pose; what they cannot say is
    refused, what does not come across is said.
    """
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.structure import decompose

    if form is None and path is None:
        raise InvalidInput(Problem("--to", "it is not said as what", f"give one of {', '.join(TARGETS)}"))
    form = form or _form_of(path or "")
    mechanism = load_mechanism(file)
    # a link is no name
    asked["called"] = asked["name"] or Path(path or (mechanism.title if is_itself(file) else file)).stem
    content = TARGETS[form](decompose(mechanism), form, asked)
    if path is None:
        put(with_line_end(content))
    else:
        write_new(Path(path), content, force)
        say(f"Wrote {path}.")


def _form_of(path: str) -> str:
    """The form that a suffix tells: of programs in other languages, else of other programs' files."""
    suffix = suffix_of(path)
    if suffix == suffix_for("picture", TIKZ):
        return TIKZ
    return file_format("program", path) if suffix in SUFFIXES["program"] else form_by_suffix(path)


def with_line_end(content: bytes) -> bytes:
    """Return a text for standard output, with a line end. What is no text stays as it is.

    >>> with_line_end(b"a"), with_line_end(b"a\\n"), with_line_end(b"PK\\0")
    (b'a\\n', b'a\\n', b'PK\\x00')
    """
    return content if content.endswith(b"\n") or b"\0" in content else content + b"\n"


def form_by_suffix(path: str) -> str:
    """Return the format whose files end so. Raises InvalidInput where there is none, or several."""
    from compoundkin.files.exchange.known_formats import writable_formats

    suffix, known = suffix_of(path), writable_formats()
    found = [name for name, one in known.items() if one.suffix and one.suffix == suffix]
    if len(found) > 1:
        raise InvalidInput(Problem(path, f"files of {len(found)} programs end so", f"give --to {' or '.join(found)}"))
    if not found:
        what = f"nothing is exported as {suffix!r}" if suffix else "the file has no suffix"
        ends = (
            *SUFFIXES["program"],
            *(one.suffix for one in known.values() if one.suffix),
            suffix_for("picture", "tikz"),
        )
        raise InvalidInput(Problem(path, what, f"give --to, or end it in {', '.join(ends)}"))
    return found[0]
