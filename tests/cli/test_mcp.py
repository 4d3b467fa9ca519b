"""The server for programs that talk, asked by the client of the SDK itself."""

from __future__ import annotations

import base64
import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.cli import mcp as server_module
from compoundkin.files.mechanism_files import loads
from tests.support import FOUR_BAR, interrupts_heard

if find_spec("mcp") is None:
    pytest.skip("mcp is not installed", allow_module_level=True)


def in_client(target: Any = None) -> Any:
    """A client of a server. The SDK is loaded by the tests that use it: it takes as long as a tenth of all others."""
    import mcp

    return mcp.Client(target or server_module.server())


def asked(*calls: tuple[str, dict[str, Any]], target: Any = None) -> list[Any]:
    """The results of calls, one after another, through a client."""

    async def talk() -> list[Any]:
        async with in_client(target) as client:
            return [await client.call_tool(name, given) for name, given in calls]

    return list(in_thread(talk))


def in_thread(talk: Callable[[], Any]) -> Any:
    """What a coroutine returns, in a thread of its own: the browser of other tests keeps a loop in the main one."""
    import anyio

    with ThreadPoolExecutor(1) as pool:
        return pool.submit(anyio.run, talk).result()


def text(result: Any) -> str:
    return "\n".join(part.text for part in result.content if part.type == "text")


def test_a_client_sees_seven_tools_with_strict_schemas() -> None:
    from jsonschema import Draft202012Validator

    async def listed() -> Any:
        async with in_client() as client:
            return (await client.list_tools()).tools

    found = in_thread(listed)
    assert [tool.name for tool in found] == [
        *("describe", "solve", "report", "optimise", "forces", "draw", "synthesise")
    ]
    for tool in found:
        Draft202012Validator.check_schema(tool.input_schema)
        assert tool.input_schema["additionalProperties"] is False
        assert len(json.dumps(tool.input_schema)) < 12_000


def test_a_process_answers_over_its_streams_as_the_package_does() -> None:
    """The whole way, once: a mechanism as text, solved by the command, against `ck.solve`."""
    from mcp.client.stdio import StdioServerParameters

    root = str(Path(__file__).parents[2])
    process = StdioServerParameters(
        command=sys.executable, args=["-m", "compoundkin", "mcp"], env={**os.environ, "PYTHONPATH": root}
    )
    given = {"mechanism": FOUR_BAR, "drive": {"crank": "35"}, "outputs": ["rocker.angle"], "modes": {"rocker": -1}}
    (result,) = asked(("solve", given), target=process)
    assert not result.is_error
    (row,) = csv.DictReader(text(result).splitlines())
    motion = ck.solve(loads(FOUR_BAR), {"crank": ck.deg(35)}, modes={"rocker": -1})
    assert float(row["rocker.angle [deg]"]) == pytest.approx(np.degrees(float(motion.links["rocker"].angle)), abs=1e-9)


@pytest.mark.skipif(os.name != "posix", reason="no signals")
@pytest.mark.parametrize(("number", "told"), [(signal.SIGINT, b"Interrupted.\n"), (signal.SIGTERM, b"")])
def test_it_ends_by_a_signal_while_its_client_is_silent(number: signal.Signals, told: bytes) -> None:
    command = [sys.executable, "-m", "compoundkin", "mcp"]
    with interrupts_heard():
        served = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert served.stdin is not None
    assert served.stdout is not None
    try:
        served.stdin.write(b'{"jsonrpc": "2.0", "id": 1, "method": "ping"}\n')
        served.stdin.flush()
        assert json.loads(served.stdout.readline())["id"] == 1
        served.send_signal(number)
        served.wait(20)  # its input is still open
        assert (served.returncode, served.communicate()[1]) == (128 + number, told)
    finally:
        served.kill()
        served.communicate()


@pytest.mark.full
def test_reports_forces_and_better_dimensions() -> None:
    document = tomllib.loads(FOUR_BAR)
    hold = {"mechanism": document, "torques": ["rocker=-120"], "units": "mm,kg,N", "statics": True}
    search = {"mechanism": FOUR_BAR, "free": {"crank.B.x": [0.5, 1.4]}, "target": {"rocker.angle.stroke": 50}}
    described, forces, better = asked(
        ("describe", {"mechanism": document}),
        ("forces", {**hold, "drive": {"crank": "35"}}),
        ("optimise", {**search, "full_turn": True}),
    )
    assert not any(result.is_error for result in (described, forces, better))
    assert "mobility 1" in text(described)
    assert "crank" in text(forces)
    crank = tomllib.loads(better.content[-1].text)["links"]["crank"]["points"]["B"][0]
    ends = [np.arccos((9 + 16 - (3 + side * crank) ** 2) / 24) for side in (1, -1)]
    assert np.degrees(ends[0] - ends[1]) == pytest.approx(50, abs=1e-6)


def test_a_picture_is_an_image() -> None:
    image = pytest.importorskip("PIL.Image")
    (result,) = asked(("draw", {"mechanism": "six-bar", "at": ["35"]}))
    (part,) = (part for part in result.content if part.type == "image")
    picture = image.open(io.BytesIO(base64.b64decode(part.data)))
    assert (picture.format, part.mime_type) == ("PNG", "image/png")
    assert min(picture.size) > 300


def test_mechanisms_for_a_task_are_found_drawn_and_sent() -> None:
    """Each of the mechanisms that are sent has the body at the places of the poses, apart as they are."""
    poses = [[2.0, 2.5, 53.1], [1.82, 4.1, 24.8], [-0.47, 3.42, 26.1], [-1.33, 1.34, 45.9], [-0.22, 0.46, 71.4]]
    document = {"format": 1, "task": "poses", "link": "plate", "poses": poses}
    found, explained = asked(("synthesise", {"task": document, "picture": True, "best": 2}), ("synthesise", {}))
    assert not found.is_error
    assert [part.type for part in found.content] == ["text", "text", "image", "text", "text"]
    for part in found.content[-2:]:
        mechanism = loads(part.text)
        motion = ck.solve(mechanism)
        link, places = motion.links["plate"], np.array([complex(x, y) for x, y, _ in poses])
        far = np.abs(link.origin.position[:, None] - places) + np.abs(
            np.exp(1j * link.angle)[:, None] - np.exp(1j * np.deg2rad([angle for *_, angle in poses]))
        )
        assert far.min(axis=0).max() < 0.2  # its own range passes near each pose
    assert 'task = "poses"' in text(explained)


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        ("describe", {"mechanism": "/etc/passwd"}, "neither a file nor in the catalog"),
        ("describe", {"mechanism": "../../pyproject.toml"}, "neither a file nor in the catalog"),
        ("describe", {"mechanism": "format = 1\n["}, "mechanism.toml"),
        ("describe", {"mechanism": {"format": 1, "title": "x", "links": {}, "q": 1}}, "'q' was unexpected"),
        ("solve", {}, "'mechanism' is a required property"),
        ("solve", {"mechanism": "six-bar", "drive": {"crank": "35 -o x"}}, "arguments.drive.crank"),
        ("solve", {"mechanism": "six-bar", "outputs": ["--help"]}, "--help"),
        ("solve", {"mechanism": "x" * 300_000}, "it does not fit"),
        ("optimise", {"mechanism": "six-bar", "free": {"crank.D.x": [1]}}, "arguments.free"),
        ("solve", {"mechanism": "six-bar", "outputs": ["bar\0"]}, "cannot be passed on"),
        ("solved", {}, "did you mean 'solve'?"),
        ("synthesise", {"task": "/etc/passwd"}, "this is not TOML"),
        ("synthesise", {"task": {"format": 1, "task": "path", "points": [[0, 0]]}}, "arguments.task"),
        ("synthesise", {"task": 'format = 1\ntask = "path"'}, "did you mean 'points'?"),
    ],
)
def test_what_is_wrong_is_told_and_no_file_is_read(name: str, given: dict[str, Any], said: str) -> None:
    (result,) = asked((name, given))
    assert result.is_error
    assert said in text(result)


def test_a_call_that_takes_too_long_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "SECONDS", 0.05)
    begun = time.monotonic()
    (result,) = asked(("report", {"mechanism": "six-bar"}))
    assert result.is_error
    assert "took longer" in text(result)
    assert time.monotonic() - begun < 5


def test_long_replies_are_cut_and_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "MOST_TEXT", 500)
    (result,) = asked(("describe", {"mechanism": "six-bar"}))
    assert "characters are left out" in text(result)
