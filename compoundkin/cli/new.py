"""`compoundkin new`, `schema`, `completion`: a file to start from, the JSON Schema of files, completion in shells."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import click

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.cli.shell import put, say

TEMPLATE = """\
# A mechanism for compoundkin. See it with:  compoundkin report @FILE@
format = 1
title = @TITLE@
unit = "mm"                     # the unit of all lengths; any word
source = ""                     # where the dimensions come from
description = ""                # what to look at
outputs = ["P.position", "P.velocity", "rocker.angle"]     # what a report tabulates

# A point is written in its own link's frame, [x, y] or { polar = [radius, degrees] }.
# Two links that have a point of the same name are pinned there.
# The link called "frame" stands still.

[links.frame]
points = { A = [0, 0], D = [80, 0] }

[links.crank]
points = { A = [0, 0], B = [25, 0] }

[links.coupler]
points = { B = [0, 0], C = [70, 0], P = [35, 30] }         # P is on no other link: it is traced

[links.rocker]
points = { D = [0, 0], C = [50, 0] }

# A driver turns a link about its pin, in degrees; speed in rad/s, or { rpm = 60 }.
[[drives]]
link = "crank"
values = { from = 0, to = 360, step = 5 }
speed = 1

# Points roughly as drawn, in one pose: they choose between the ways to assemble the links.
[drawn]
B = [25, 0]
C = [78, 46]

# A block that slides would be a link with one point, and a slide:
#
#   [links.block]
#   points = { Q = [0, 0] }
#
#   [[slides]]
#   link = "block"
#   on = "rocker"             # the link with the guide
#   through = "D"             # a point of that link on the guide
#   angle = 0                 # the guide's direction, from that link's x axis
#
# Published numbers are checked by every report:
#
#   [[expected]]
#   at = { crank = 0 }
#   quantity = "rocker.angle"
#   value = 92.0
#   tolerance = 0.5
"""


STUDY = """\
# A study: many designs of a mechanism. Compute it with:  compoundkin study @FILE@
format = 1
mechanism = "crank-rocker"      # a shipped one, or the path of a file, seen from this one
outputs = ["rocker.angle.stroke", "rocker.transmission_angle.least"]      # what is found of each design
count = 1024                    # how many designs; 1_000_000 take some seconds
seed = 1

[dimensions]                    # what varies: names in quotes, lengths and degrees
"crank.B.x" = { low = 1.8, high = 2.2 }
"rocker.C.x" = { distribution = "norm", loc = 4, scale = 0.05 }
"""
TASK = """\
# A task of synthesis. Find the mechanisms that do it with:  compoundkin synthesise @FILE@ --save found
format = 1
task = "poses"                  # or points, curve, mixed, function, swing, stroke, dwell
link = "plate"                  # what the body is called that is guided through them
poses = [[2.9, 0.1, -35], [2.5, 0.4, 12], [1.9, 0.5, 40]]      # x, y, degrees; three to five, more approximately

# A coupler point goes through points instead, two to nine:
#
#   task = "points"
#   points = [[10, 20], [15, 30], [25, 35], [35, 33], [45, 25], [50, 15]]
#
# Or it traces a drawn curve, eight points or more along it (of a file: compoundkin trace curve.svg):
#
#   task = "curve"
#   points = [[0, 0], [20, -2], [40, -2], [60, 0], [55, 12], [40, 20], [20, 20], [5, 12]]
#   closed = true
#   links = 6
#   at = [0, 30, 60, 90, 150, 210, 270, 330]    # the driver's angle at each, degrees; or times = [...]; or any
#
# Or an output follows a function, of which there are eight pairs or more (so does a body along eight poses or more):
#
#   task = "function"
#   pairs = [[0, 0], [30, 5], [60, 15], [90, 25], [120, 30], [180, 30], [240, 15], [300, 2]]    # degrees
#   links = 6

[conditions]                    # may be left out
transmission = 10               # degrees, at least
"""
# What `compoundkin new WORD` writes beside linkages: the text, and the verb that takes the file.
DOCUMENTS = {"study": (STUDY, "study"), "task": (TASK, "synthesise")}


class WithNumbers(click.Command):
    """A command whose words may be negative numbers, where others have options: slider-crank 20 60 -5."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the words; a blank before a number says that it is no option."""
        return super().parse_args(ctx, [f" {one}" if re.fullmatch(r"-[\d.][\d.,e+-]*", one) else one for one in args])


@click.command(
    cls=WithNumbers,
    epilog="""\b
Examples:
  compoundkin new
  compoundkin new linkage.toml
  compoundkin new four-bar ground=60 crank=20 coupler=50 rocker=40
  compoundkin new slider-crank 20 60 offset=5 -o mine.toml
  compoundkin new --list
  compoundkin new study -o variants.toml
  compoundkin new task -o points.toml
  compoundkin new crane.toml --from hydraulic-crane
""",
)
@click.argument("words", nargs=-1, metavar="[PATH | LINKAGE NAME=VALUE ...]")
@click.option("-o", "--to-file", "path", type=click.Path(), metavar="PATH", help="Where to write it.")
@click.option("--list", "listed", is_flag=True, help="List the linkages with what they take.")
@click.option("--from", "source", metavar="NAME", help="Start from a shipped mechanism: its file, comments and all.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(words: tuple[str, ...], path: str | None, listed: bool, source: str | None, force: bool) -> int:
    """Write a commented mechanism file, to be changed into your own.

    Without a linkage it has a four-bar to start from. With one it is that linkage by its lengths, angles in degrees.
    The same words do wherever a FILE is expected: compoundkin report four-bar:60,20,50,40. `study` and `task` are files
    of many designs, and of what a mechanism shall do.
    """
    from compoundkin.base.suffixes import suffix_for, suffix_of
    from compoundkin.cli.file_options import write_new
    from compoundkin.files.shipped_mechanisms import path as shipped_path

    if listed:
        put(linkage_list())
        return 0
    if path is None and len(words) > 1 and suffix_of(Path(words[-1])) == suffix_for("mechanism", "toml"):
        # new task mine.toml: the last word is where, as after -o
        words, path = words[:-1], words[-1]
    name, given = words[0] if words else "", words[1:]
    is_linkage = bool(given) or (name != "" and suffix_of(Path(name)) == "" and not Path(name).is_dir())
    if not is_linkage and path is not None and name:
        raise InvalidInput(Problem(name, "the file is named twice", f"compoundkin new {name}"))
    document, verb = DOCUMENTS.get(name, ("", "report")) if not given else ("", "report")
    own = f"{name}{suffix_for('study', 'toml')}" if document else "mechanism.toml"
    target = Path(path or (own if is_linkage else name or own))
    target = target / own if target.is_dir() else target
    if suffix_of(target) != suffix_for("mechanism", "toml"):
        raise InvalidInput(Problem(str(target), "only TOML files have comments", "choose a name that ends in .toml"))
    text = linkage_file(name, given, target) if is_linkage and not document else starting_file(target)
    text = document.replace("@FILE@", target.name) or text
    text = shipped_path(source).read_text(encoding="utf-8") if source else text
    write_new(target, text.encode("utf-8"), force)
    how = "compute" if document else "see"
    say(f"Wrote {target}; {how} it with: compoundkin {verb} {shlex.quote(str(target))}")
    return 0


def linkage_list() -> str:
    """Return the linkages with their parameters and an example of each."""
    from compoundkin.synthesis.linkages import KINDS

    lines = []
    for kind in KINDS.values():
        lines += [kind.name, f"  {kind.summary}", f"  compoundkin new {kind.name} {kind.example}"]
        wide = max(len(one.name) for one in kind.parameters)
        for one in kind.parameters:
            default = "" if one.is_required or one.default in (None, "") else f" [{one.shown_default}]"
            left_out = "" if one.is_required else " May be left out."
            lines.append(f"    {one.name:<{wide}}  {one.meaning}{default}{left_out}")
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def linkage_file(name: str, given: tuple[str, ...], target: Path) -> str:
    """Return the text of the file of a linkage, with what its numbers mean. Raises InvalidInput, UnknownName."""
    from compoundkin.files import dumps
    from compoundkin.files.shipped_mechanisms import titles
    from compoundkin.synthesis.linkages import KINDS, kind_named

    if not nearest(name, list(KINDS)) and (found := titles(name)):
        remedy = f"the catalog has {', '.join([*found][:6])}: compoundkin new mine.toml --from {next(iter(found))}"
        raise UnknownName(Problem(name, "there is no such linkage", remedy))
    kind = kind_named(name)
    mechanism = kind.written(given)
    typed = " ".join(" ".join(given).split())
    meanings = (f"{one.name}: {one.meaning}" for one in kind.parameters if one.name != "unit")
    comments = (
        f"{mechanism.title}: compoundkin new {name} {typed}",
        f"See it with: compoundkin report {target.name}",
        "",
        *meanings,
        "",
        "A point is written in its own link's frame. Two links that have a point of the same name are pinned there.",
        "[drawn] has points of one pose: they choose between the ways to assemble the links.",
    )
    return "".join(f"# {line}".rstrip() + "\n" for line in comments) + "\n" + dumps(mechanism)


def starting_file(target: Path) -> str:
    """Return the text of the file, its title the file's name.

    >>> "title = \\"My linkage\\"" in starting_file(Path("my-linkage.toml"))
    True
    """
    words = target.stem.replace("-", " ").replace("_", " ").strip()
    title = json.dumps(words[:1].upper() + words[1:] or "Mechanism", ensure_ascii=False)
    return TEMPLATE.replace("@FILE@", target.name).replace("@TITLE@", title)


@click.command(
    epilog="""\b
Examples:
  compoundkin set mine.toml crank.B.x=22
  compoundkin set mine.toml crank.B.x=22 rocker.C.x=45 title="My linkage"
  compoundkin set mine.toml coupler.P.radius=30 crank.speed=10
"""
)
@click.argument("file", metavar="FILE", type=click.Path())
@click.argument("changes", metavar="NAME=VALUE ...", nargs=-1, required=True)
def set_command(file: str, changes: tuple[str, ...]) -> int:
    """Change values in a mechanism file; its comments and its layout stay.

    Angles are in degrees, as in the file. The changed file is read again before it is written, and written whole or
    not at all: a mistake leaves it as it was.
    """
    from compoundkin.files.atomic import write_atomically
    from compoundkin.files.mechanism_files import changed_text
    from compoundkin.files.parsed_document import text_of

    pairs: dict[str, str] = {}
    for change in changes:
        name, is_there, value = change.partition("=")
        if not is_there or not name.strip() or not value.strip():
            raise InvalidInput(Problem(change, "this is no change of a value", "write crank.B.x=22"))
        if name.strip() in pairs:
            raise InvalidInput(Problem(name.strip(), "it is changed twice", "name it once"))
        pairs[name.strip()] = value
    text, syntax = text_of(file, "mechanism")
    mark = b"\xef\xbb\xbf" if Path(file).read_bytes().startswith(b"\xef\xbb\xbf") else b""
    content = mark + changed_text(text, pairs, syntax, file).encode("utf-8")
    write_atomically(file, lambda to: to.write(content))
    say(f"Changed {', '.join(pairs)} in {file}.")
    return 0


KINDS = ("mechanism", "study")


@click.command(
    epilog="""\b
Examples:
  compoundkin schema > mechanism.schema.json
  compoundkin schema study > study.schema.json
"""
)
@click.argument("kind", type=click.Choice(KINDS), default=KINDS[0])
def schema_command(kind: str) -> int:
    """Print the JSON Schema of mechanism or study files. Editors check and complete TOML and JSON with it."""
    import json

    from compoundkin.files.json_schema import schema
    from compoundkin.studies.study_document import study_schema

    result = {"mechanism": schema, "study": study_schema}[kind]()
    put(json.dumps(result, indent=2, ensure_ascii=False) + "\n")
    return 0


SHELLS = ("bash", "zsh", "fish")


@click.command(
    epilog="""\b
Examples:
  eval "$(compoundkin completion bash)"      in ~/.bashrc
  eval "$(compoundkin completion zsh)"       in ~/.zshrc
  compoundkin completion fish > ~/.config/fish/completions/compoundkin.fish
"""
)
@click.argument("shell", type=click.Choice(SHELLS))
def completion_command(shell: str) -> int:
    """Print the script that completes commands, options, files and catalog names in your shell."""
    from click.shell_completion import get_completion_class

    from compoundkin.cli import cli

    kind = get_completion_class(shell)
    if kind is None:  # pragma: no cover - click knows all three
        raise click.UsageError(f"{shell} is not supported")
    put(kind(cli, {}, "compoundkin", "_COMPOUNDKIN_COMPLETE").source() + "\n")
    return 0
