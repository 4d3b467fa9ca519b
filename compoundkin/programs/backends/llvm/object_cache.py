"""Compiled code kept on disk from one process to the next; whatever is wrong with it is ignored."""

from __future__ import annotations

import hashlib
import os
import secrets
import sys
from contextlib import suppress
from pathlib import Path

# The environment variable that names the folder.
FOLDER = "COMPOUNDKIN_CACHE"
DIGEST = 32  # bytes in front, of what follows them


def cache_folder() -> Path:
    """Return the folder of compiled code: the one named, or the platform's own."""
    named = os.environ.get(FOLDER)
    if named:
        return _expanded(Path(named))
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or "~/AppData/Local")
    elif sys.platform == "darwin":
        base = Path("~/Library/Caches")
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return _expanded(base) / "compoundkin"


def _expanded(folder: Path) -> Path:
    """Return a folder with "~" as the user's home."""
    with suppress(RuntimeError):  # of a user without one
        return folder.expanduser()
    return folder


def cached_object(key: str) -> bytes | None:
    """Return the object kept by a key, unless it is damaged."""
    try:
        content = _file(key).read_bytes()
    except (OSError, ValueError):
        return None
    digest, found = content[:DIGEST], content[DIGEST:]
    return found if found and hashlib.sha256(found).digest() == digest else None


def keep_object(key: str, content: bytes) -> None:
    """Write an object. Any other process finds it whole or not at all."""
    target = _file(key)
    beside = target.with_name(f".{target.name}.{secrets.token_hex(6)}")
    with suppress(OSError, ValueError):
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        try:
            beside.write_bytes(hashlib.sha256(content).digest() + content)
            os.replace(beside, target)
        finally:
            with suppress(OSError):
                beside.unlink()


def _file(key: str) -> Path:
    return cache_folder() / f"{hashlib.sha256(key.encode()).hexdigest()}.o"
