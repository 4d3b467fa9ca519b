"""The command line: one file per verb, each loaded when it is called.

Results go to stdout, everything else to stderr. A verb imports NumPy and the rooms that it uses when it runs, so that
`--help` and completion stay fast.
"""

from __future__ import annotations

import atexit
import gc
import re
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import click

from compoundkin.cli.shell import guarded

# Each verb with its one-line help, so that neither `--help` nor completion has to load them.
VERBS = {
    "report": "Everything about a mechanism: structure, motion, checks.",
    "open": "The report in the browser: moving sketch, plots, tables.",
    "structure": "Take a mechanism apart: links, pairs, mobility, loops, groups.",
    "solve": "Positions, velocities, accelerations as a table.",
    "draw": "A picture: kinematic sketch, vectors, instant centres, structure.",
    "animate": "A motion as GIF, MP4 or SVG that moves.",
    "plot": "Draw quantities, phase plots, hodographs, coupler curves, centrodes.",
    "centres": "All instant centres at one pose, primary ones first.",
    "configurations": "Every way in which it can be assembled at one pose.",
    "circuits": "Circuits, branches and limit positions; whether the driver turns fully.",
    "singularities": "Limit positions, change points, dead points, and the branches that meet there.",
    "workspace": "The region that a point reaches by two or three drivers.",
    "characteristics": "Stroke, dead points, time ratio, transmission, advantage, dwells.",
    "forces": "Forces in all pairs, drivers' efforts, shaking force.",
    "size": "Which motor drives it, behind which gear.",
    "simulate": "How it moves under its masses and loads, in time.",
    "study": "Many designs: what dimensions do to figures, as a study file says.",
    "optimise": "Better dimensions: what shall be least, what may change, what must hold.",
    "tolerance": "What tolerances and loose pins do to outputs: worst case, deviation, shares.",
    "synthesise": "Mechanisms that do a task: poses, points, functions, swings, strokes.",
    "trace": "Linkages whose point follows a drawn curve: CSV, SVG, DXF.",
    "exercise": "Variants of an exercise: sheets, worked solutions, a table of answers.",
    "import": "A mechanism out of another program's file or link: PMKS+, Linkage, pyslvs and others.",
    "export": "A file for another program, or a function in C, Python, JavaScript or MATLAB.",
    "compare": "Two mechanisms side by side: structure, dimensions, how far apart they move.",
    "check": "Verify a motion: a table of all findings.",
    "catalog": "List, show or copy the shipped mechanisms.",
    "atlas": "All kinematic chains, trusses and Assur groups of a size.",
    "new": "Write a commented mechanism file to start from.",
    "studio": "Draw a mechanism in the browser; it moves at once.",
    "mcp": "A server for programs that talk (Model Context Protocol).",
    "set": "Change values in a mechanism file; its comments stay.",
    "schema": "The JSON Schema of mechanism files and of study files.",
    "completion": "The script that completes commands in your shell.",
}

# Verbs that are not `command` of the file of their name, as `import` is a word of Python.
_COMMANDS = {
    "centres": ("characteristics", "centres_command"),
    "configurations": ("circuits", "configurations_command"),
    "workspace": ("circuits", "workspace_command"),
    "completion": ("new", "completion_command"),
    "set": ("new", "set_command"),
    "schema": ("new", "schema_command"),
    "atlas": ("catalog", "atlas_command"),
    "import": ("export", "import_command"),
    "compare": ("check", "compare_command"),
    "open": ("report", "open_command"),
    "size": ("forces", "size_command"),
    "trace": ("synthesise", "trace_command"),
    "singularities": ("circuits", "singularities_command"),
}

# American spelling.
_SPELLED = {"synthesize": "synthesise", "optimize": "optimise", "centers": "centres"}

# Options by what others call them, each with ours; where a verb has none of the name, what is closest in meaning.
_OPTIONS = """
angle pose theta position: --at
rpm omega velocity: --speed
force payload: --load
trace curve point coupler: --path
width height resolution pixels: --size
duration length: --seconds
vary range dimension: --free --tolerance
samples number n: --count
percentiles quantile confidence: --percentile
steps working formulas derivation: --equations --sheet
out output-file save file export: --to-file --to-folder
unit: --units
transmission quantity plot: --output
"""

EPILOG = """\b
Examples:
  compoundkin report six-bar
  compoundkin open six-bar
  compoundkin report four-bar:60,20,50,40
  compoundkin new linkage.toml
  compoundkin structure linkage.toml
  compoundkin solve linkage.toml --from 0 --to 90 --step 1 -o linkage.csv

\b
Exit codes:
  0  all is well
  2  wrong input: a file, an option, a mechanism that cannot be solved
  3  some poses cannot be assembled
  4  a check failed, a published number was missed, or two mechanisms differ
"""


class Verbs(click.Group):
    """The commands by name, imported one at a time."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the verbs, in the order of a newcomer's interest."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of a verb."""
        cmd_name = _SPELLED.get(cmd_name, cmd_name)
        if cmd_name not in VERBS:
            return None
        file, name = _COMMANDS.get(cmd_name, (cmd_name, "command"))
        command: click.Command = getattr(import_module(f"compoundkin.cli.{file}"), name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the arguments name. Raises UsageError with the nearest one for an unknown name."""
        if args and _SPELLED.get(args[0], args[0]) not in VERBS and not args[0].startswith("-"):
            from compoundkin.base.errors import suggestion

            raise click.UsageError(f"there is no command {args[0]!r}; {suggestion(args[0], list(VERBS))}", ctx)
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of verbs without loading them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(VERBS.items()))

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run, and turn errors into a message and an exit code."""
        if extra.get("standalone_mode") is False:
            return super().main(*args, **extra)
        given = _with_units(args[0] if args else extra.pop("args", None) or sys.argv[1:])
        return guarded(lambda: self._run(given, *args[1:], **{**extra, "standalone_mode": False}))

    def _run(self, *args: Any, **extra: Any) -> Any:
        """Run, and add to an error of the words of a command what is meant."""
        try:
            return super().main(*args, **extra)
        except click.NoSuchOption as error:
            raise click.UsageError(_unknown_option(self, error), error.ctx) from None
        except click.UsageError as error:
            if said := _file_meant(error):
                raise click.UsageError(f"{error.format_message().rstrip('.')}. {said}", error.ctx) from None
            raise


def _unknown_option(verbs: Verbs, error: click.NoSuchOption) -> str:
    """Return what to say of an option that a command has not: the one that is meant, or the verbs that have it."""
    has = {option for one in error.ctx.command.params for option in one.opts} if error.ctx is not None else set()
    rows = (line.partition(": ") for line in _OPTIONS.splitlines())
    ours = [one for others, _, own in rows if error.option_name.lstrip("-") in others.split() for one in own.split()]
    meant = [one for one in ours if one in has]
    if meant:
        return f"No such option {error.option_name!r}. Did you mean {meant[0]!r}?"
    if error.ctx is None or error.ctx.parent is None:
        return error.format_message()
    others = [name for name in VERBS if _has_option(verbs.get_command(error.ctx.parent, name), error.option_name)]
    where = ", ".join(others[:4])
    return f"{error.format_message()}{f' It is an option of {where}.' if others else ''}"


def _has_option(command: click.Command | None, name: str) -> bool:
    return command is not None and any(name in one.opts for one in command.params)


def _file_meant(error: click.UsageError) -> str:
    """Return which option a file to write needs, where one is written as it stands."""
    words = re.findall(r"\(([^()]*)\)$", error.message.rstrip("."))
    last = words[0].split()[-1] if words and words[0].split() else ""
    names_file = "." in last and error.ctx is not None and _has_option(error.ctx.command, "-o")
    return f"A file to write is named by -o {last}" if names_file else ""


def _with_units(args: Sequence[str]) -> list[str]:
    """Join rates and units that a shell separated: ``--speed 300 rpm``."""
    joined: list[str] = []
    for word in args:
        if word in ("rpm", "deg", "deg/s", "rad/s", "1/min") and joined[-2:-1] in (["--speed"], ["--acceleration"]):
            joined[-1] += word
        else:
            joined.append(word)
    return joined


def _version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        from compoundkin.base.version import VERSION

        click.echo(f"compoundkin {VERSION}")
        ctx.exit()


SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


@click.group(cls=Verbs, epilog=EPILOG, context_settings=SETTINGS)
@click.option("--version", is_flag=True, expose_value=False, is_eager=True, callback=_version, help="Show the version.")
def cli() -> None:
    """Take compound planar mechanisms apart into Assur groups and solve them group by group.

    Wherever a FILE is expected, the name of a shipped mechanism does too (`compoundkin catalog` lists them), and a
    linkage by its lengths, such as four-bar:60,20,50,40 (`compoundkin new --list`).
    """


# Objects that Python makes before it looks for cycles among them: a command makes many, few cycles, and ends soon.
COLLECTED_AFTER = 200_000


def main() -> None:
    """Run the command `compoundkin`."""
    gc.set_threshold(COLLECTED_AFTER)
    # what is left goes with the process: at its end Python would look through all of it once more
    atexit.register(gc.freeze)
    cli.main(prog_name="compoundkin")
