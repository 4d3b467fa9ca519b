"""`compoundkin export`: a mechanism as something that other programs take."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import SUFFIXES, alternatives, form_of
from compoundkin.cli.drive_options import MODE, assembly_modes, names
from compoundkin.cli.file_options import loaded, mechanism_argument, to_file, write_new
from compoundkin.cli.shell import put, say
from compoundkin.model.attributes import OF_POINTS

if TYPE_CHECKING:
    from compoundkin.structure import Structure


def _program(structure: Structure, form: str, asked: Mapping[str, Any]) -> str:
    """A function in another language."""
    from compoundkin.cli.progress import working
    from compoundkin.programs.compilation import compile

    modes = assembly_modes(structure, asked["modes"]) or None
    outputs = asked["outputs"] or _own_outputs(structure)
    with working("solving"):
        return compile(structure, outputs, free=asked["free"], modes=modes).source(form, asked["name"])


# What can be exported, by the form: each form of a kind of files, and what makes its text.
TARGETS: Mapping[str, Callable[[Structure, str, Mapping[str, Any]], str]] = {
    **dict.fromkeys(SUFFIXES["program"].values(), _program),
}


@click.command(
    epilog="""\b
Examples:
  compoundkin export six-bar -o six_bar.c
  compoundkin export six-bar --to python --output G.position,bar.angle
  compoundkin export six-bar --free crank.D --free plate.C -o six_bar.js
  compoundkin export linkage.toml --output P.acceleration -o linkage.m
"""
)
@mechanism_argument
@click.option("--to", "form", type=click.Choice(tuple(TARGETS)), help="As what; the suffix of PATH tells too.")
@click.option("--output", "outputs", multiple=True, metavar="QUANTITY", callback=lambda _c, _p, given: names(given),
              help="What it answers, such as G.velocity, bar.angle, slot.rate; repeat it, or write commas. "
              "The outputs of the file if left out, else all points.")  # fmt: skip
@click.option("--free", "free", multiple=True, metavar="DIMENSION", callback=lambda _c, _p, given: names(given),
              help="A dimension that it is given, such as crank.D; repeat it, or write commas.")  # fmt: skip
@MODE
@click.option(
    "--name", "name", metavar="NAME", default="", help="What the function is called; as the file if left out."
)
@to_file(f"Write it here: {alternatives('program')}; else to stdout.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(file: str, path: str | None, form: str | None, force: bool, **asked: Any) -> None:
    """Write a mechanism as a function in C, Python, JavaScript or MATLAB.

    It needs nothing else. It is given drivers' values (radians or lengths), their rates and free dimensions, and
    answers the outputs.
    """
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.structure import decompose

    if form is None and path is None:
        raise InvalidInput(Problem("--to", "it is not said as what", f"give one of {', '.join(TARGETS)}"))
    form = form or form_of("program", path or "")
    asked["name"] = asked["name"] or Path(path or file).stem
    text = TARGETS[form](decompose(loaded(file)), form, asked)
    if path is None:
        put(text.encode("utf-8"))
    else:
        write_new(Path(path), text.encode("utf-8"), force)
        say(f"Wrote {path}.")


def _own_outputs(structure: Structure) -> list[str]:
    """The outputs of the file that a program can have, else the places of all points."""
    from compoundkin.base.errors import InvalidInput, UnknownName
    from compoundkin.kinematics import solve
    from compoundkin.programs.recording.recorded_outputs import output_of

    found: list[str] = []
    motion = solve(structure, order=0)
    for name in structure.mechanism.outputs:
        try:
            found.append(output_of(motion, name).name)
        except (UnknownName, InvalidInput) as error:
            say(f"Left out: {error}")
    return found or [f"{point}.{OF_POINTS[0]}" for point in structure.mechanism.carriers]
