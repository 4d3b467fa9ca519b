"""The window's server: who may come in, and the processes that reply.

The page sends documents and questions over a socket, and `compoundkin.studio.answer` replies, in processes of their own
that are ended and replaced when they take too long. Nobody else is let in: the server listens on 127.0.0.1, at a free
port, takes no other Host and Origin than its own, and the first message of a socket must be the token that stands in
the fragment of the address. The page names no files: the one that is written is that of the command line.

Source: The WebSocket Protocol, RFC 6455, 10.1 and 10.2; W3C, Content Security Policy Level 3.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import json
import os
import subprocess
import sys
import threading
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from compoundkin.base.errors import InvalidInput
from compoundkin.studio.drawn_curves import AT_ONCE

HOST = "127.0.0.1"
# A message may have so many bytes; a socket so many questions that wait; there may be so many windows.
MOST_BYTES, MOST_WAITING, MOST_WINDOWS = 500_000, 24, 8
# Seconds for a reply, for a process to begin, for the first message of a socket; memory of such a process, in bytes.
SECONDS, BEGINNING, GREETING, MEMORY = 10.0, 60.0, 15.0, 4 << 30
# Reports, plots and pages may take longer; what is no motion and not quick has a process of its own. So has the first
# answer to a curve, which keeps an atlas.
LONG = 60.0
REPORTS, CURVES, QUICK = "reports", "curves", ("structure", "edit", "offers")
# What a process says when it has begun.
READY = b"ready\n"
# Closed for a reason that is the other side's.
REFUSED = 1008
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
ASSETS = Path(__file__).parent / "assets"
TYPES = {"html": "text/html", "css": "text/css", "js": "text/javascript"}
PAGE = "studio.html"

Scope: TypeAlias = Mapping[str, Any]
Application: TypeAlias = Callable[[Any, Any, Any], Awaitable[None]]


# --- who replies --------------------------------------------------------------------------------------------


@dataclass
class AnsweringProcess:
    """A process that replies to questions, one after another; it is ended and replaced when it takes too long."""

    process: subprocess.Popen[bytes] | None = None
    has_ended: bool = False
    is_ready: bool = False
    lock: threading.Lock = field(default_factory=threading.Lock)

    def start(self) -> subprocess.Popen[bytes]:
        """Return a new process, which imports what it needs meanwhile."""
        package = str(Path(__file__).parents[2])
        paths = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
        # nothing is imported from the folder that it is started in
        words = [sys.executable, "-P", "-c", "from compoundkin.studio.server import reply_to_lines; reply_to_lines()"]
        self.is_ready = False
        self.process = subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": paths},
            start_new_session=os.name != "nt",  # Ctrl-C is for the server
        )
        return self.process

    def ask(self, document: str, question: Mapping[str, Any], seconds: float = SECONDS) -> dict[str, Any]:
        """Return the reply to a question; that it took too long, if it did."""
        with self.lock:
            process = self.process
            if process is None or process.poll() is not None:
                process = self.start()
            # what it imports does not count
            if not self.is_ready:
                self.is_ready = _line(process, BEGINNING) == READY
            line = _line(process, seconds, json.dumps([document, question]).encode() + b"\n") if self.is_ready else b""
            if line.endswith(b"\n"):
                reply: dict[str, Any] = json.loads(line)
                return reply
            process.kill()
            _closed(process)
            if not self.has_ended:
                self.start()
        what = f"it took longer than {seconds:g} s, or more memory than there may be, and was ended"
        problem = {"where": "", "what": what, "remedy": "fewer links or values"}
        return {"ask": question.get("ask"), "problems": [problem], "is_ended": True}

    def end(self) -> None:
        """End the process, whatever it does."""
        self.has_ended = True
        if self.process is not None:
            self.process.kill()
            # who waits for a reply closes it
            if self.lock.acquire(blocking=False):
                _closed(self.process)
                self.lock.release()


def _line(process: subprocess.Popen[bytes], seconds: float, question: bytes = b"") -> bytes:
    """Return the next line of a process, after a question if there is one; what there is of it when time is over."""
    assert process.stdin is not None
    assert process.stdout is not None
    timer = threading.Timer(seconds, process.kill)
    timer.start()
    line = b""
    with suppress(OSError, ValueError):
        process.stdin.write(question)
        process.stdin.flush()
        line = process.stdout.readline()
    timer.cancel()
    return line


def _closed(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process that has been ended, and close what led to it."""
    process.wait()
    for pipe in (process.stdin, process.stdout):
        with suppress(OSError):
            if pipe is not None:
                pipe.close()


def reply_to_lines() -> None:
    """Reply to questions on standard input, each a line [document, question] in JSON, until it is closed."""
    from compoundkin.studio import answer

    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    sys.stdout.buffer.write(READY)
    sys.stdout.buffer.flush()
    for line in sys.stdin.buffer:
        document, question = json.loads(line)
        try:
            reply = answer(document, question)
        except Exception as error:
            # a window stays alive whatever happens; what happened is named there
            what = f"this cannot be answered: {type(error).__name__}: {error}"
            reply = {
                "ask": question.get("ask"),
                "problems": [{"where": "", "what": what, "remedy": "undo, and report it"}],
            }
        sys.stdout.buffer.write(json.dumps(reply, allow_nan=False).encode() + b"\n")
        sys.stdout.buffer.flush()


# --- who is let in ------------------------------------------------------------------------------------------


@dataclass
class StudioServer:
    """The one file that is served, who may come in, and the processes that reply."""

    path: Path
    text: str
    token: str
    host: str
    # what changes the text or says what follows from it never waits for a motion, and neither of them for a report
    answerers: Mapping[str, AnsweringProcess] = field(
        default_factory=lambda: {name: AnsweringProcess() for name in ("motion", "", REPORTS, CURVES)}
    )
    windows: int = 0

    def start(self) -> None:
        """Start the processes that each window needs; those of reports and curves start when they are first asked."""
        for name, one in self.answerers.items():
            if name not in (REPORTS, CURVES):
                one.start()

    def end(self) -> None:
        """End the processes."""
        for one in self.answerers.values():
            one.end()

    def application(self) -> Application:
        """Return the application that lets nobody in but the page of this address."""
        from starlette.applications import Starlette
        from starlette.routing import Route, WebSocketRoute

        routes = [Route("/", self._asset), Route("/{name}", self._asset), WebSocketRoute("/talk", self.talk)]
        return self.guarded(Starlette(routes=routes))

    def guarded(self, inner: Application) -> Application:
        """Return an application that refuses any other Host and Origin than this one's."""
        host, origin = self.host.encode(), f"http://{self.host}".encode()

        async def outer(scope: Scope, receive: Any, send: Any) -> None:
            hosts, origins = ([v for k, v in scope["headers"] if k == name] for name in (b"host", b"origin"))
            is_socket = scope["type"] == "websocket"
            if hosts == [host] and (origins == [origin] or (not origins and not is_socket)):
                await inner(scope, receive, send)
            elif is_socket:
                await send({"type": "websocket.close", "code": REFUSED})
            else:
                await send({"type": "http.response.start", "status": 403, "headers": []})
                await send({"type": "http.response.body", "body": b"This is not the address of the studio.\n"})

        return outer

    async def _asset(self, request: Any) -> Any:
        """Reply a file of the page, by its name in the list of them."""
        from starlette.responses import PlainTextResponse, Response

        name = request.path_params.get("name", PAGE)
        content = (await asyncio.to_thread(_assets)).get(name)
        if content is None:
            return PlainTextResponse("There is no such file.\n", 404, HEADERS)
        return Response(content, headers=HEADERS, media_type=f"{TYPES[name.rpartition('.')[2]]}; charset=utf-8")

    async def talk(self, wire: Any) -> None:
        """Talk with a window: its token first, then questions and saving, each with a number that the reply has."""
        from starlette.websockets import WebSocketDisconnect

        await wire.accept()
        if not await self._lets_in(wire):
            with suppress(RuntimeError):
                await wire.close(REFUSED)
            return
        self.windows += 1
        waiting: set[asyncio.Task[None]] = set()
        try:
            await wire.send_json(await asyncio.to_thread(self._opening))
            newest: dict[str, int] = {}
            locks = {name: asyncio.Lock() for name in self.answerers}
            while True:
                message = message_in(await wire.receive_text())
                if message is None or len(waiting) >= MOST_WAITING:
                    await wire.close(REFUSED)
                    return
                newest[message.sort] = message.number
                task = asyncio.create_task(self._reply(wire, message, newest, locks))
                waiting.add(task)
                task.add_done_callback(waiting.discard)
        except (WebSocketDisconnect, KeyError):
            pass
        finally:
            self.windows -= 1
            for task in waiting:
                task.cancel()

    async def _lets_in(self, wire: Any) -> bool:
        """Return whether a window's first message is the token, in time, and there is room for it."""
        from starlette.websockets import WebSocketDisconnect

        try:
            first = await asyncio.wait_for(wire.receive_text(), GREETING)
        except (TimeoutError, WebSocketDisconnect, KeyError):
            return False
        return self._knows(first) and self.windows < MOST_WINDOWS

    def _knows(self, first: str) -> bool:
        """Return whether a first message is the token."""
        try:
            given = json.loads(first)
            return hmac.compare_digest(given["token"].encode(), self.token.encode())
        except (ValueError, TypeError, KeyError, AttributeError):
            return False

    def _opening(self) -> dict[str, Any]:
        """Return what a window begins with: the document as it is on disk, else the one to start from."""
        text, mark = self._on_disk()
        about = {"file": self.path.name, "folder": str(self.path.absolute().parent)}
        return {"text": self.text if text is None else text, "mark": mark, "is_new": text is None, **about}

    def _on_disk(self) -> tuple[str | None, str]:
        """Return the text of the file and its mark, by which it is known whether it has changed."""
        try:
            content = self.path.read_bytes()
        except FileNotFoundError:
            return None, ""
        return content.decode("utf-8-sig", "replace"), hashlib.sha256(content).hexdigest()

    async def _reply(self, wire: Any, message: Message, newest: Mapping[str, int], locks: Mapping[str, Any]) -> None:
        """Reply to one message; to a question that a newer one has overtaken, that it was dropped."""
        if message.sort == "save":
            reply = await asyncio.to_thread(self._save, message.document, message.mark)
        else:
            name = self._process(message.sort)
            async with locks[name]:
                if message.sort != "edit" and newest[message.sort] != message.number:
                    reply = {"is_dropped": True}
                else:
                    seconds = LONG if name in (REPORTS, CURVES) else SECONDS
                    ask = self.answerers[name].ask
                    reply = await asyncio.to_thread(ask, message.document, message.question, seconds)
        with suppress(RuntimeError):  # the window has gone
            await wire.send_json({**reply, "id": message.number})

    def _process(self, sort: str) -> str:
        """Return which process replies to a sort of question."""
        if sort in self.answerers or sort in QUICK:
            return sort if sort in self.answerers else ""
        return CURVES if sort in AT_ONCE else REPORTS

    def _save(self, document: str, mark: str) -> dict[str, Any]:
        """Write the file, unless it is another than the window last saw: both are then offered."""
        from compoundkin.files.atomic import write_atomically

        try:
            there, now = self._on_disk()
            if now != mark:
                return {"is_saved": False, "disk": there or "", "mark": now}
            content = document.encode("utf-8")
            write_atomically(self.path, lambda file: file.write(content))
        except (InvalidInput, OSError, UnicodeEncodeError) as error:
            return {"is_saved": False, "why": str(error)}
        return {"is_saved": True, "mark": hashlib.sha256(content).hexdigest()}


@dataclass(frozen=True)
class Message:
    """What a window sends: a question of a document, or the document to be saved."""

    number: int
    sort: str
    document: str
    question: Mapping[str, Any]
    mark: str


def message_in(text: str) -> Message | None:
    """Return the message of a text; None for what is none."""
    try:
        given = json.loads(text)
        number, document, question = given["id"], given["document"], given.get("question", {})
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
    sort = "save" if given.get("save") is True else question.get("ask") if isinstance(question, dict) else None
    mark = given.get("mark", "")
    if isinstance(number, int) and isinstance(document, str) and isinstance(sort, str) and isinstance(mark, str):
        return Message(number, sort, document, question, mark)
    return None


def solving_script() -> str:
    """Return the scripts of live pages that solve a mechanism again, and that tell its dimensions."""
    from compoundkin.view.page.html_document import asset
    from compoundkin.view.page.live.live_assets import FIRST_SCRIPTS, PATH_SCRIPTS, ROW_SCRIPT

    return "\n".join(map(asset, (*FIRST_SCRIPTS, *PATH_SCRIPTS, ROW_SCRIPT)))


def _assets() -> Mapping[str, str]:
    """Return the files of the page by name: its own, and the colours that all pages have."""
    from compoundkin.view.page.html_document import asset, page_palette

    own = {path.name: path.read_text(encoding="utf-8") for path in sorted(ASSETS.iterdir()) if path.is_file()}
    return {**own, "palette.css": page_palette(), "theme.js": asset("theme.js"), "solving.js": solving_script()}
