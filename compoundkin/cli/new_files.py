"""Writing files that must not replace others."""

from __future__ import annotations

from pathlib import Path

from compoundkin.base.errors import InvalidInput, Problem


def write_new(path: Path, content: bytes, force: bool) -> None:
    """Write a file; raises InvalidInput where there is one already, unless forced, or it cannot be written."""
    from compoundkin.files.atomic import write_atomically

    if path.exists() and not force:
        raise InvalidInput(Problem(str(path), "the file is there already", "choose another name, or give --force"))
    write_atomically(path, lambda file: file.write(content))
