"""Exports to other programs: the format by its word or the suffix, its own options, the pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, suffix_for, suffix_of
from compoundkin.cli.shell import say

if TYPE_CHECKING:
    from compoundkin.structure import Structure

# What is asked of programs in other languages alone, and of poses alone, by the options.
OF_PROGRAMS = {"outputs": "--output", "free": "--free", "modes": "--mode", "name": "--name"}
OF_POSES = {"at": "--at", "options": "--option"}


def exported(structure: Structure, form: str, asked: Mapping[str, Any]) -> bytes:
    """Return the content of another program's file. What does not come across is said."""
    from compoundkin.files.exchange.conversion import write

    refuse(form, asked, OF_PROGRAMS)
    found = write(structure.mechanism, form, pose_of(structure, asked), **options_of(asked["options"]))
    for note in found.notes:
        say(f"Note: {note}")
    return found.content


def ended(content: bytes) -> bytes:
    """Return a text for standard output, with a line end. What is no text stays as it is.

    >>> ended(b"a"), ended(b"a\\n"), ended(b"PK\\0")
    (b'a\\n', b'a\\n', b'PK\\x00')
    """
    return content if content.endswith(b"\n") or b"\0" in content else content + b"\n"


def pictured(structure: Structure, form: str, asked: Mapping[str, Any]) -> bytes:
    """Return the kinematic sketch for LaTeX."""
    from compoundkin.view.sketch import draw

    refuse(form, asked, {**OF_PROGRAMS, "options": "--option"})
    return draw(structure, pose_of(structure, asked)).content(form)


def pose_of(structure: Structure, asked: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the driver values that are asked for. None is the pose nearest to the drawing."""
    from compoundkin.cli import typed_values

    return typed_values.of_pose(structure, asked["at"]) if asked["at"] else None


def refuse(form: str, asked: Mapping[str, Any], options: Mapping[str, str]) -> None:
    """Raise InvalidInput for options that do not go with a form."""
    for key, option in options.items():
        if asked[key]:
            raise InvalidInput(Problem(option, f"it does not go with --to {form}", "leave it out"))


def options_of(given: Sequence[str]) -> dict[str, str]:
    """Return options from texts NAME=VALUE. Formats know what kind of value each has.

    >>> options_of(["curves=no", "scale=2.5"])
    {'curves': 'no', 'scale': '2.5'}
    """
    found = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not (name and equals):
            raise InvalidInput(Problem(f"--option {text}", "this is no option", "write NAME=VALUE"))
        found[name] = value
    return found


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
