"""Writing a file whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from compoundkin.base.errors import InvalidInput, Problem


def write_atomically(path: str | os.PathLike[str], write: Callable[[BinaryIO], Any]) -> None:
    """Let `write` fill a new file, then put it in place of `path`.

    Raises InvalidInput where the file cannot be written; what was there before is then untouched.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_atomically(f"{folder}/a.txt", lambda file: file.write(b"all"))
    ...     Path(f"{folder}/a.txt").read_bytes()
    b'all'
    """
    if str(path).endswith(os.sep):
        raise InvalidInput(Problem(str(path), "this is the name of a folder", "name a file"))
    try:
        given = Path(path)
        if given.exists() and not given.is_file() and not given.is_dir():
            # a pipe or /dev/stdout is written to, not replaced; where it leads may be no path
            with given.open("wb") as file:
                write(file)
            return
        # a link is followed, so that it stays one
        _replace(Path(os.path.realpath(path)), write)
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(path), f"it cannot be written: {what}")) from None


def _replace(target: Path, write: Callable[[BinaryIO], Any]) -> None:
    beside = target.with_name(f".{target.name[:40]}.{os.urandom(6).hex()}.tmp")
    try:
        with beside.open("xb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, beside)
        beside.replace(target)
    finally:
        with suppress(FileNotFoundError):
            beside.unlink()
