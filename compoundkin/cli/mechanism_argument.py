"""The argument that every verb starts from, a mechanism file or a name of the catalog; files that replace no others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

from compoundkin.base.errors import InvalidInput, Problem

if TYPE_CHECKING:
    from compoundkin.model.mechanism import Mechanism

F = TypeVar("F", bound=Callable[..., Any])


def complete_name(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the names of the catalog that begin so."""
    from compoundkin.files.shipped_mechanisms import names

    return [CompletionItem(name) for name in names() if name.startswith(incomplete)]


def _complete(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """The names that begin so, and files."""
    return [*complete_name(ctx, param, incomplete), CompletionItem(incomplete, type="file")]


def mechanism_argument(command: F) -> F:
    """Add the argument FILE to a command."""
    return click.argument("file", metavar="FILE", shell_complete=_complete)(command)


def loaded(file: str) -> Mechanism:
    """Load the mechanism of a file or of a name. Raises what is wrong with it."""
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.files import load
    from compoundkin.files.shipped_mechanisms import resolve

    if Path(file).is_dir():
        raise InvalidInput(Problem(file, "this is a folder", "name a mechanism file in it"))
    # what is there but is no regular file, such as a pipe, is for `load` to judge
    return load(file if Path(file).exists() else resolve(file))


def write_new(path: Path, content: bytes, force: bool) -> None:
    """Write a file. Raises InvalidInput where there is one already, unless forced, or it cannot be written."""
    from compoundkin.files.atomic import write_atomically

    if path.exists() and not force:
        raise InvalidInput(Problem(str(path), "the file is there already", "choose another name, or give --force"))
    write_atomically(path, lambda file: file.write(content))
