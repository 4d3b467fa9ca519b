"""`compoundkin catalog`: the shipped mechanisms."""

from __future__ import annotations

import tomllib
from pathlib import Path

import click

from compoundkin.cli.file_options import complete_name
from compoundkin.cli.shell import put, say


@click.group(
    invoke_without_command=True,
    epilog="""\b
Examples:
  compoundkin catalog
  compoundkin catalog show six-bar
  compoundkin catalog copy six-bar mine.toml
""",
)
@click.pass_context
def command(ctx: click.Context) -> int:
    """List, show or copy the shipped mechanisms; their names work wherever a file does."""
    return 0 if ctx.invoked_subcommand else print_catalog()


@command.command("list")
def list_() -> int:
    """List the names and titles (as `catalog` alone does)."""
    return print_catalog()


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


def print_catalog() -> int:
    """Print the names and titles."""
    from compoundkin.files.shipped_mechanisms import path, shipped

    titles = {name: tomllib.loads(path(name).read_text(encoding="utf-8"))["title"] for name in shipped()}
    wide = max(map(len, titles), default=0)
    put("".join(f"{name:{wide}}  {title}\n" for name, title in titles.items()))
    return 0
