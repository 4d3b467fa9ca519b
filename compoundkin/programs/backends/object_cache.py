"""Compiled code on disk, from one process to the next: in a folder that is the user's own, signed with the user's key.

What is loaded from there is run, so that a file that somebody else has put there must never be taken. The folder must
belong to the user, and nobody else may write to it; each object is signed (HMAC, RFC 2104, with SHA-256) together with
the text that it was compiled from, by a random key that is kept beside the objects and that nobody else may read. What
is damaged, signed with another key or filed under another name is compiled again. Any fault of the cache is ignored.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import secrets
import stat
import sys
from contextlib import suppress
from pathlib import Path

# The environment variable that names the folder.
FOLDER = "COMPOUNDKIN_CACHE"
# The file of the key, and how long keys and signatures are, in bytes.
KEY, LENGTH = "key", 32
# Others may write, or do anything at all.
WRITTEN_BY_OTHERS, OPEN_TO_OTHERS = stat.S_IWGRP | stat.S_IWOTH, stat.S_IRWXG | stat.S_IRWXO


def cache_folder() -> Path:
    """Return the folder of compiled code: the one named, or the platform's own."""
    named = os.environ.get(FOLDER)
    if named:
        return _expand_home(Path(named))
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or "~/AppData/Local")
    elif sys.platform == "darwin":
        base = Path("~/Library/Caches")
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return _expand_home(base) / "compoundkin"


def _expand_home(folder: Path) -> Path:
    """Return a folder with "~" as the user's home."""
    with suppress(RuntimeError):  # of a user without one
        return folder.expanduser()
    return folder


def cached_object(source: str) -> bytes | None:
    """Return the object that was compiled from a source, if it is there and the user's own."""
    with suppress(OSError, ValueError):
        folder = cache_folder()
        if not _is_ones_own(folder.lstat(), WRITTEN_BY_OTHERS):
            return None
        key = _read(folder / KEY, OPEN_TO_OTHERS)
        content = _read(folder / _name(source), WRITTEN_BY_OTHERS)
        if len(key) == LENGTH and hmac.compare_digest(content[:LENGTH], _signature(key, source, content[LENGTH:])):
            return content[LENGTH:]
    return None


def store_object(source: str, content: bytes) -> None:
    """Write the object compiled from a source. Any other process finds it whole or not at all."""
    with suppress(OSError, ValueError):
        folder = cache_folder()
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        if not _is_ones_own(folder.lstat(), WRITTEN_BY_OTHERS):
            return
        _write(folder / _name(source), _signature(_own_key(folder), source, content) + content)


def _own_key(folder: Path) -> bytes:
    """Return the key of a folder, made when it is first needed or damaged; PermissionError for somebody else's."""
    path = folder / KEY
    with suppress(FileNotFoundError):
        key = _read(path, OPEN_TO_OTHERS)
        if len(key) == LENGTH:
            return key
        path.unlink()
    beside = _beside(path)
    try:
        _create(beside, secrets.token_bytes(LENGTH))
        try:  # of two processes, the first one's key holds
            os.link(beside, path)
        except FileExistsError:
            pass
        except OSError:  # a file system without links: the last one's key holds, and what the first one signed is lost
            os.replace(beside, path)
    finally:
        with suppress(OSError):
            beside.unlink()
    return _read(path, OPEN_TO_OTHERS)


def _is_ones_own(entry: os.stat_result, forbidden: int) -> bool:
    """Return whether a file or folder, and no link, belongs to this user, and grants others nothing forbidden."""
    if stat.S_ISLNK(entry.st_mode):
        return False
    if not hasattr(os, "geteuid"):  # Windows: folders of a user's profile are the user's
        return True
    return entry.st_uid == os.geteuid() and not entry.st_mode & forbidden


def _read(path: Path, forbidden: int) -> bytes:
    """Read a file that is the user's own; PermissionError for any other, links included."""
    with open(os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)), "rb") as file:
        entry = os.fstat(file.fileno())
        if not stat.S_ISREG(entry.st_mode) or not _is_ones_own(entry, forbidden):
            raise PermissionError(path)
        return file.read()


def _write(path: Path, content: bytes) -> None:
    """Write a file that takes the place of another one whole."""
    beside = _beside(path)
    try:
        _create(beside, content)
        os.replace(beside, path)
    finally:
        with suppress(OSError):
            beside.unlink()


def _create(path: Path, content: bytes) -> None:
    """Write a new file that nobody else may read."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    with open(os.open(path, flags, 0o600), "wb") as file:
        file.write(content)


def _beside(path: Path) -> Path:
    return path.with_name(f".{path.name}.{secrets.token_hex(6)}")


def _signature(key: bytes, source: str, content: bytes) -> bytes:
    return hmac.digest(key, hashlib.sha256(source.encode()).digest() + content, "sha256")


def _name(source: str) -> str:
    return f"{hashlib.sha256(source.encode()).hexdigest()}.o"
