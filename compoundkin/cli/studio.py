"""`compoundkin studio`: a window in the browser in which a mechanism is drawn, served on this machine alone."""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import secrets
import socket
import tempfile
import threading
import time
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem, missing_extra
from compoundkin.cli.file_options import complete_mechanism, is_foreign_file, load_mechanism
from compoundkin.cli.shell import deferred_signals, say

if TYPE_CHECKING:
    from compoundkin.studio.server import StudioServer

# Seconds for which the address of a server that was killed is kept, for its windows.
KEPT = 86_400.0
START = """\
# Drawn in the studio of compoundkin. See it with:  compoundkin report {name}
format = 1
title = {title}
"""


@click.command(
    epilog="""\b
Examples:
  compoundkin studio
  compoundkin studio linkage.toml
  compoundkin studio six-bar
  compoundkin studio four-bar:60,20,50,40
"""
)
@click.argument("file", metavar="[FILE]", required=False, default="mechanism.toml", shell_complete=complete_mechanism)
@click.option("--no-browser", is_flag=True, help="Print the address; open no browser.")
def command(file: str, no_browser: bool) -> int:
    """Draw a mechanism in the browser: its mobility, its groups and what is missing are seen at once, and it moves.

    Saving writes FILE with its comments, mechanism.toml if none is named; a shipped mechanism is saved as a copy. The
    server listens on this machine alone and ends with Ctrl-C. Needs the extra `studio`.
    """
    uvicorn = _server_library()
    from compoundkin.studio.server import HOST, StudioServer

    path, text = opened(file)
    # bound here, so that the port is known and nobody else has it
    listener, token = _address(HOST, record := _record(path))
    # who comes before the server has started waits
    listener.listen()
    _keep(record, listener.getsockname()[1], token)
    served = StudioServer(path, text, token, f"{HOST}:{listener.getsockname()[1]}")
    address = f"http://{served.host}/#{token}"
    say(f"The studio of {path}: {address}")
    say("Ctrl-C ends it.")
    served.start()
    if not no_browser:
        threading.Thread(target=_open_browser, args=(address,), daemon=True).start()
    try:
        asyncio.run(_serve(_server_of(uvicorn, served), listener, served))
    except KeyboardInterrupt:
        say("The studio has ended.")
    finally:
        served.end()
        listener.close()
        if record is not None:
            record.unlink(missing_ok=True)
    return 0


def _server_of(uvicorn: Any, served: StudioServer) -> Any:
    """Return a server of a studio; signals are those of the command line."""
    from compoundkin.studio.server import MOST_BYTES

    settings = {"http": "h11", "ws": "websockets-sansio", "lifespan": "off", "log_level": "critical"}
    limits = {"ws_max_size": MOST_BYTES, "ws_ping_interval": None, "limit_concurrency": 100, "timeout_keep_alive": 5}
    server = uvicorn.Server(
        uvicorn.Config(served.application(), access_log=False, server_header=False, **settings, **limits)
    )
    server.capture_signals = nullcontext
    return server


def _record(path: Path) -> Path | None:
    """Return where the address of a file's studio is kept while it runs; None where nobody else is kept from it.

    A server that was killed leaves it: the next one has the same address, so that its windows go on.
    """
    user = getattr(os, "getuid", lambda: "own")()
    folder = Path(tempfile.gettempdir()) / f"compoundkin-studio-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        known = folder.lstat()
    except OSError:
        return None
    is_own = not hasattr(os, "getuid") or (known.st_uid == os.getuid() and not known.st_mode & 0o077)
    if not is_own:
        return None
    record = folder / hashlib.sha256(os.fsencode(path.absolute())).hexdigest()[:32]
    _sweep(folder, record)
    return record


def _sweep(folder: Path, own: Path) -> None:
    """Take away addresses of servers that were killed long ago, for whose windows nobody waits any more."""
    for record in folder.iterdir():
        with suppress(OSError, ValueError, TypeError, KeyError, OverflowError):
            is_old = time.time() - record.stat().st_mtime > KEPT
            if record != own and is_old and not _is_running(json.loads(record.read_text(encoding="utf-8"))["process"]):
                record.unlink()


def _is_running(process: int) -> bool:
    """Return whether there is a process of a number; true where nobody can tell without ending it."""
    if os.name == "nt":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True


def _address(host: str, record: Path | None) -> tuple[socket.socket, str]:
    """Return a bound socket and a token: those of a server of the file that was killed, else a free port."""
    listener = socket.socket()
    if os.name != "nt":  # there it would take the port of another
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    with suppress(OSError, ValueError, TypeError, KeyError, OverflowError):
        known = json.loads(record.read_text(encoding="utf-8")) if record is not None else {}
        token = str(known["token"])
        listener.bind((host, int(known["port"])))
        return listener, token
    listener.bind((host, 0))
    return listener, secrets.token_urlsafe(32)


def _keep(record: Path | None, port: int, token: str) -> None:
    """Write the address, for this user alone."""
    if record is not None:
        with suppress(OSError):
            record.unlink(missing_ok=True)
            handle = os.open(record, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                json.dump({"port": port, "token": token, "process": os.getpid()}, file)


async def _serve(server: Any, listener: socket.socket, served: StudioServer) -> None:
    """Serve until a signal comes; nothing that runs is waited for."""
    serving = asyncio.ensure_future(server.serve([listener]))
    loop = asyncio.get_running_loop()
    try:
        with deferred_signals(lambda: loop.call_soon_threadsafe(serving.cancel)), suppress(asyncio.CancelledError):
            await serving
    finally:
        served.end()


def _server_library() -> Any:
    """Return uvicorn. Raises InvalidInput where the extra is not installed."""
    try:
        import starlette
        import uvicorn
        import websockets
    except ImportError:
        what = "the studio needs Starlette, Uvicorn and websockets"
        raise missing_extra("studio", what, "studio", "draw in a text: compoundkin new") from None
    del starlette, websockets
    return uvicorn


def _open_browser(address: str) -> None:
    import webbrowser

    try:
        is_open = webbrowser.open(address)
    except (OSError, webbrowser.Error):
        is_open = False
    if not is_open:
        say("No browser can be opened here; open the address in one.")


def opened(file: str) -> tuple[Path, str]:
    """Return the file that is written and the text to begin with, which need not be there yet.

    Raises InvalidInput for what cannot be read, and where the copy of a shipped mechanism or of another program's file
    would replace a file.
    """
    from compoundkin.base.suffixes import SUFFIXES, suffix_for, suffix_of
    from compoundkin.files.mechanism_files import dumps
    from compoundkin.files.parsed_document import text_of
    from compoundkin.files.shipped_mechanisms import resolve, shipped

    path = Path(file)
    is_own = suffix_of(path) in SUFFIXES["mechanism"] and not is_foreign_file(file)
    if is_own and path.exists():
        return path, text_of(path, "mechanism")[0]
    if is_own:
        if not path.absolute().parent.is_dir():
            raise InvalidInput(Problem(file, "there is no such folder", "make it first"))
        title = path.stem.replace("-", " ").replace("_", " ").strip().capitalize() or "Mechanism"
        if suffix_of(path) == suffix_for("mechanism", "json"):
            return path, json.dumps({"format": 1, "title": title}, indent=2, ensure_ascii=False) + "\n"
        return path, START.format(name=path.name, title=json.dumps(title, ensure_ascii=False))
    if file in shipped():
        text = text_of(resolve(file), "mechanism")[0]
    else:
        text = dumps(load_mechanism(file))
    copy = Path(Path(file.partition(":")[0]).stem + suffix_for("mechanism", "toml"))
    if copy.exists():
        raise InvalidInput(Problem(str(copy), "the file is there already", f"compoundkin studio {copy}"))
    return copy, text
