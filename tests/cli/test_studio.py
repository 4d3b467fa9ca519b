"""`compoundkin studio`: who is let in, what is written, what takes too long, how it ends. By real sockets."""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from compoundkin.cli import cli, studio
from compoundkin.cli.studio import opened
from compoundkin.errors import InvalidInput
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.studio.server import MOST_BYTES, POLICY, REFUSED, AnsweringProcess
from tests.support import interrupts_heard

sync = pytest.importorskip("websockets.sync.client")
exceptions = pytest.importorskip("websockets.exceptions")
pytest.importorskip("starlette")
pytest.importorskip("uvicorn")

TEXT = '# mine\nformat = 1\ntitle = "Mine"\n'


class Served:
    """The command in a process of its own, and its address."""

    def __init__(self, path: Path) -> None:
        words = [sys.executable, "-m", "compoundkin", "studio", path.name, "--no-browser"]
        self.path, self.wires = path, ExitStack()
        with interrupts_heard():
            self.process = subprocess.Popen(words, cwd=path.parent, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        first = self.process.stderr.readline()
        found = re.search(r"http://(127\.0\.0\.1:\d+)/#(\S+)", first)
        assert found is not None, first
        self.host, self.token = found.groups()

    def get(self, path: str, **headers: str) -> tuple[int, dict[str, str], str]:
        talk = http.client.HTTPConnection(self.host, timeout=10)
        talk.putrequest("GET", path, skip_host=True)
        for key, value in {"Host": self.host, **headers}.items():
            talk.putheader(key, value)
        talk.endheaders()
        reply = talk.getresponse()
        found = reply.status, {k.lower(): v for k, v in reply.getheaders()}, reply.read().decode()
        talk.close()
        return found

    def wire(self, origin: str | None = "own", **headers: str) -> Any:
        own = f"http://{self.host}" if origin == "own" else origin
        return sync.connect(f"ws://{self.host}/talk", origin=own, additional_headers=headers, max_size=None)

    def entered(self) -> tuple[Any, dict[str, Any]]:
        wire = self.wires.enter_context(self.wire())
        wire.send(json.dumps({"token": self.token}))
        return wire, json.loads(wire.recv(10))

    def end(self) -> None:
        self.wires.close()
        self.process.kill()
        self.process.communicate()


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    path = tmp_path_factory.mktemp("studio") / "mine.toml"
    path.write_text(TEXT)
    one = Served(path)
    yield one
    one.end()


def ask(wire: Any, **message: Any) -> dict[str, Any]:
    wire.send(json.dumps({"id": 7, **message}))
    reply: dict[str, Any] = json.loads(wire.recv(20))
    assert reply["id"] == 7
    return reply


def test_the_page_is_its_own_alone(served: Served) -> None:
    """Nothing that it asks for is elsewhere, and its policy forbids it."""
    status, headers, page = served.get("/")
    assert (status, headers["content-security-policy"]) == (200, POLICY)
    assert "connect-src 'self'" in POLICY
    names = re.findall(r'(?:src|href)="([^"]+)"', page)
    for name in [one for one in names if one != "data:,"]:
        status, headers, content = served.get(f"/{name}")
        assert (status, headers["x-content-type-options"]) == (200, "nosniff")
        assert "http://" not in content.replace("http://www.w3.org/2000/svg", "")
        assert "https://" not in content
    assert served.get("/..%2f..%2fserver.py")[0] == served.get("/pyproject.toml")[0] == 404


@pytest.mark.parametrize("host", ["evil.example", "localhost", "127.0.0.1", "127.0.0.1:1"])
def test_another_host_is_refused(served: Served, host: str) -> None:
    assert served.get("/", Host=host)[0] == 403


def test_another_origin_is_refused(served: Served) -> None:
    assert served.get("/", Origin="http://evil.example")[0] == 403
    for origin in ("http://evil.example", "null", None, f"https://{served.host}", f"http://{served.host}.evil.example"):
        with pytest.raises(exceptions.InvalidStatus) as told:
            served.wires.enter_context(served.wire(origin))
        assert told.value.response.status_code == 403


@pytest.mark.parametrize("first", ['{"token": "wrong"}', '{"token": 3}', "[]", "{", '{"id": 1, "document": ""}'])
def test_a_wrong_token_is_refused_before_anything_is_told(served: Served, first: str) -> None:
    with served.wire() as wire:
        wire.send(first)
        with pytest.raises(exceptions.ConnectionClosedError) as told:
            wire.recv(10)
        assert told.value.rcvd is not None
        assert told.value.rcvd.code == REFUSED


def test_questions_are_replied_and_wrong_messages_end_the_socket(served: Served) -> None:
    wire, opening = served.entered()
    assert (opening["text"], opening["file"], opening["is_new"]) == (TEXT, "mine.toml", False)
    bar = {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [3, 4]}}
    reply = ask(wire, document=TEXT, question={"ask": "edit", "edit": bar})
    assert reply["made"] == {"link": "bar1", "points": ["A", "B"]}
    assert ask(wire, document=reply["text"], question={"ask": "structure"})["mobility"]["freedoms"] == 3
    for message in ("[1]", '{"id": 1}', '{"id": "x", "document": "", "question": {"ask": "motion"}}', "x" * MOST_BYTES):
        wire, _ = served.entered()
        wire.send(message + " " * (len(message) > 100))
        with pytest.raises(exceptions.ConnectionClosed):
            wire.recv(10)


def test_only_its_file_is_written_and_what_changed_there_is_offered(served: Served) -> None:
    wire, opening = served.entered()
    new = TEXT + "# more\n"
    reply = ask(wire, document=new, save=True, mark=opening["mark"], path="/tmp/other.toml")
    assert reply["is_saved"]
    assert served.path.read_text() == new
    served.path.write_text(TEXT + "# by an editor\n")
    told = ask(wire, document=TEXT, save=True, mark=reply["mark"])
    assert (told["is_saved"], told["disk"]) == (False, TEXT + "# by an editor\n")
    assert ask(wire, document=TEXT, save=True, mark=told["mark"])["is_saved"]
    assert served.path.read_text() == TEXT
    assert [one.name for one in served.path.parent.iterdir()] == ["mine.toml"]


def test_late_questions_are_dropped(served: Served) -> None:
    wire, _ = served.entered()
    for number in range(8):
        wire.send(json.dumps({"id": number, "document": TEXT, "question": {"ask": "structure"}}))
    replies = {reply["id"]: reply for reply in (json.loads(wire.recv(20)) for _ in range(8))}
    assert not replies[7].get("is_dropped")
    assert sum(bool(reply.get("is_dropped")) for reply in replies.values()) >= 4


def test_what_takes_too_long_is_ended_and_the_next_question_is_answered() -> None:
    one = AnsweringProcess()
    try:
        first = one.start()
        reply = one.ask(resolve("v8-engine").read_text(encoding="utf-8"), {"ask": "motion"}, seconds=0.005)
        assert reply["is_ended"]
        assert "took longer" in reply["problems"][0]["what"]
        assert first.poll() is not None
        assert one.ask(TEXT, {"ask": "structure"}, seconds=30)["mobility"]["freedoms"] == 0
    finally:
        one.end()


def test_it_ends_at_once_by_an_interrupt_and_leaves_nothing(tmp_path: Path) -> None:
    served = Served(tmp_path / "new.toml")
    try:
        wire, opening = served.entered()
        assert opening["is_new"]
        start = time.monotonic()
        served.process.send_signal(signal.SIGINT)
        _, told = served.process.communicate(timeout=20)
        assert time.monotonic() - start < 5
        assert (served.process.returncode, told.splitlines()[-1]) == (0, "The studio has ended.")
        assert "Traceback" not in told
        assert list(tmp_path.iterdir()) == []
        with pytest.raises(exceptions.ConnectionClosed):
            wire.recv(5)
    finally:
        served.end()


def test_one_that_was_killed_comes_back_at_its_address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that windows go on, as they know it. One that runs beside it has another; one that ends leaves nothing."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    path = tmp_path / "mine.toml"
    path.write_text(TEXT)
    first = Served(path)
    first.entered()
    (record,) = tmp_path.glob("compoundkin-studio-*/*")
    assert record.stat().st_mode & 0o077 == record.parent.stat().st_mode & 0o077 == 0
    beside = Served(path)
    assert beside.host != first.host
    assert beside.token != first.token
    beside.end()
    again = Served(path)
    try:
        assert (again.host, again.token) == (beside.host, beside.token)
        assert again.entered()[1]["text"] == TEXT
        again.process.send_signal(signal.SIGINT)
        again.process.communicate(timeout=20)
        assert not record.exists()
    finally:
        again.end()
        first.end()


def test_addresses_of_servers_that_were_killed_long_ago_are_swept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not those of today, for whose windows they are kept, nor of who runs, nor what is no address."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    own = studio._record(tmp_path / "mine.toml")
    assert own is not None
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    others = {"old": (gone.pid, 2), "today": (gone.pid, 0), "runs": (os.getpid(), 2), own.name: (gone.pid, 2)}
    for name, (process, days) in others.items():
        record = own.parent / name
        record.write_text(json.dumps({"port": 1, "token": "t", "process": process}))
        os.utime(record, (time.time() - 86_500 * days,) * 2)
    (own.parent / "broken").write_text("{")
    os.utime(own.parent / "broken", (0, 0))
    assert studio._record(tmp_path / "mine.toml") == own
    assert {one.name for one in own.parent.iterdir()} == {"today", "runs", "broken", own.name}


def test_what_it_begins_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert opened("drawn.toml")[1].endswith('title = "Drawn"\n')
    assert json.loads(opened("drawn.json")[1]) == {"format": 1, "title": "Drawn"}
    path, text = opened("six-bar")
    assert (str(path), "Example 3-4" in text) == ("six-bar.toml", True)
    assert str(opened("four-bar:60,20,50,40")[0]) == "four-bar.toml"
    path.write_text(text)
    with pytest.raises(InvalidInput, match=r"compoundkin studio six-bar\.toml"):
        opened("six-bar")
    with pytest.raises(InvalidInput, match="no such folder"):
        opened("nowhere/drawn.toml")
    assert CliRunner().invoke(cli, ["studio", "sixbar"]).exit_code != 0


def test_without_the_extra_it_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[studio\]'"):
        cli.main(["studio"], standalone_mode=False)
