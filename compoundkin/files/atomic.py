"""Writing a file, or a folder of files, whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import time
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
        with atomic_file(Path(os.path.realpath(path))) as file:
            write(file)
    except IsADirectoryError:
        raise InvalidInput(Problem(str(path), "this is a folder", "name a file in it")) from None
    except (OSError, ValueError) as error:
        folder = os.path.dirname(path)
        if isinstance(error, FileNotFoundError) and not os.path.isdir(folder or "."):
            what = f"it cannot be written: there is no folder {os.fspath(folder)}"
            raise InvalidInput(Problem(str(path), what, "make it")) from None
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(path), f"it cannot be written: {what}")) from None


def check_folder_is_new(path: str | os.PathLike[str]) -> None:
    """Raise InvalidInput for the path of a file, or of a folder that holds files already."""
    target = Path(path)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise InvalidInput(Problem(str(path), "it is there already and not empty", "name a new folder"))


@contextmanager
def new_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a folder to fill, which is at `path` afterwards: whole, or not at all where something failed.

    Raises InvalidInput where `path` is a file or holds files already, and where it cannot be made.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     with new_folder(f"{place}/new") as folder:
    ...         _ = (folder / "a.txt").write_text("all")
    ...     sorted(one.name for one in Path(place, "new").iterdir())
    ['a.txt']
    """
    check_folder_is_new(path)
    target = Path(os.path.realpath(path))
    beside = _beside(target)
    try:
        beside.mkdir(parents=True)
        yield beside
        if target.exists():
            # somebody may work in it: it stays, and its files come
            for file in beside.iterdir():
                file.replace(target / file.name)
        else:
            beside.replace(target)
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(path), f"it cannot be made: {what}", "name another")) from None
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def begin_folder(head: Path, content: bytes) -> None:
    """Make a folder that several runs fill, or take an empty one, and write the file `head` that says what is in it.

    A head that is there stays: another run began the folder. Raises InvalidInput where it cannot be made, or holds
    other files.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     begin_folder(Path(place, "rows", "study.json"), b"first")
    ...     begin_folder(Path(place, "rows", "study.json"), b"second")
    ...     Path(place, "rows", "study.json").read_bytes()
    b'first'
    """
    folder = head.parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
        others = sorted(one.name for one in folder.iterdir() if not one.name.startswith("."))
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(folder), f"it cannot be made: {what}", "name another")) from None
    if os.path.exists(head):
        return
    if others:
        raise InvalidInput(Problem(str(folder), f"it has other files, such as {others[0]}", "name a new folder"))
    write_once(head, content)


def write_once(path: Path, content: bytes) -> None:
    """Write a file whole. Raises InvalidInput where that fails, unless another run has written it meanwhile."""
    try:
        write_atomically(path, lambda file: file.write(content))
    except InvalidInput:
        # it may have removed what was not yet in place at its end
        if not os.path.exists(path):
            raise


def _beside(target: Path) -> Path:
    """Return the path of a temporary file or folder, which takes the place of `target` in the end."""
    return target.with_name(f".{target.name[:40]}.{os.urandom(6).hex()}.tmp")


# Temporary files of killed writers; younger ones (seconds) may belong to another run.
_LEFT, _YOUNG = re.compile(r"\..*\.[0-9a-f]{12}\.tmp", re.DOTALL), 3600


def remove_leftovers(folder: Path, is_complete: bool) -> None:
    """Remove the temporary files that killed writers left in a folder; until it `is_complete`, only old ones."""
    for path in folder.iterdir():
        # another run may finish its file meanwhile
        with suppress(FileNotFoundError):
            if _LEFT.fullmatch(path.name) and (is_complete or time() - path.stat().st_mtime > _YOUNG):
                path.unlink()


@contextmanager
def atomic_file(target: Path) -> Iterator[BinaryIO]:
    """Yield a new file, which takes the place of `target` if nothing fails; raises OSError where it cannot."""
    beside = _beside(target)
    try:
        with beside.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, beside)
        beside.replace(target)
    finally:
        with suppress(FileNotFoundError):
            beside.unlink()
