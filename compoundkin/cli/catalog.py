"""`compoundkin catalog`, `compoundkin atlas`: the shipped mechanisms; chains, trusses and Assur groups of a size."""

from __future__ import annotations

from pathlib import Path

import click

from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.cli.file_options import complete_name, put_report, report_options
from compoundkin.cli.shell import put, say, working


class Actions(click.Group):
    """What can be done with the catalog; another word is looked for in it."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the arguments name: `find` and `search` are `list`, as is a word of the catalog."""
        if args and args[0] not in self.commands and not args[0].startswith("-"):
            args = ["list", *args[1:]] if nearest(args[0], ["list"]) else ["list", *args]
        return super().resolve_command(ctx, args)


@click.group(
    cls=Actions,
    invoke_without_command=True,
    epilog="""\b
Examples:
  compoundkin catalog
  compoundkin catalog list crane
  compoundkin catalog show six-bar
  compoundkin catalog copy six-bar mine.toml
""",
)
@click.pass_context
def command(ctx: click.Context) -> int:
    """List, show or copy the shipped mechanisms; their names work wherever a file does."""
    return 0 if ctx.invoked_subcommand else print_catalog()


@command.command("list")
@click.argument("word", required=False, default="")
def list_(word: str) -> int:
    """List the names and titles (as `catalog` alone does), or those that have a WORD in name, title or description."""
    return print_catalog(word)


@command.command()
@click.argument("name", shell_complete=complete_name)
def show(name: str) -> int:
    """Print the file of a mechanism."""
    from compoundkin.files.shipped_mechanisms import path

    put(path(name).read_text(encoding="utf-8"))
    return 0


@command.command()
@click.argument("name", shell_complete=complete_name)
@click.argument("destination", required=False, type=click.Path())
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def copy(name: str, destination: str | None, force: bool) -> int:
    """Copy the file of a mechanism to DESTINATION, to change it. It is a file or a folder; here if left out.

    A name that ends in .json becomes a JSON file, without the comments.
    """
    from compoundkin.base.suffixes import file_format
    from compoundkin.cli.file_options import write_new
    from compoundkin.files.mechanism_files import encoded, load
    from compoundkin.files.shipped_mechanisms import path

    source = path(name)
    target = Path(destination or ".")
    target = target / source.name if target.is_dir() else target
    form = file_format("mechanism", target)
    content = source.read_bytes() if form == file_format("mechanism", source) else encoded(load(source), form, target)
    write_new(target, content, force)
    say(f"Wrote {target}; see it with: compoundkin report {target}")
    return 0


def print_catalog(word: str = "") -> int:
    """Print the names and titles, of all or of those with a word."""
    from compoundkin.files.shipped_mechanisms import titles

    found = titles(word)
    if not found:
        raise UnknownName(Problem(word, "no mechanism of the catalog has this word", "compoundkin catalog lists all"))
    wide = max(map(len, found), default=0)
    put("".join(f"{name:{wide}}  {title}\n" for name, title in found.items()))
    return 0


@click.command(
    epilog="""\b
Examples:
  compoundkin atlas --links 8
  compoundkin atlas --links 6 --inversions
  compoundkin atlas --links 7 --trusses
  compoundkin atlas --links 4 --groups --format json
"""
)
@click.option("--links", required=True, type=int, help="How many links: up to 10 at once, up to 12 with some patience.")
@click.option("--mobility", default=1, show_default=True, type=int, help="The mobility of the chains.")
@click.option("--inversions", is_flag=True, help="Also every mechanism that fixing a link gives.")
@click.option("--trusses", is_flag=True, help="The Baranov trusses with so many links instead.")
@click.option("--groups", is_flag=True, help="The Assur groups with so many links instead.")
@report_options
def atlas_command(
    links: int, mobility: int, inversions: bool, trusses: bool, groups: bool, form: str | None, path: str | None
) -> None:
    """List all kinematic chains of revolute pairs with a number of links, each once.

    Each has its number, name, links by their numbers of pairs, symmetries, inversions, graph6 and pairs.
    """
    from compoundkin.view.report.atlas_sections import atlas_report

    with working("listing chains"):
        made = atlas_report(links, mobility, inversions, trusses, groups)
    put_report(made, form, path)
