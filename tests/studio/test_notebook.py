"""The studio as a widget: its messages by the widget's own protocol, and its front end in a browser."""

from __future__ import annotations

import json
from typing import Any

import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from compoundkin.studio import answer
from tests.studio.test_answers import FOUR_BAR

pytest.importorskip("anywidget")


class Comm:
    """What stands for a notebook: it keeps what the widget sends."""

    comm_id = "one"

    def __init__(self) -> None:
        self.sent: list[dict[str, Any]] = []

    def send(self, data: Any = None, metadata: Any = None, buffers: Any = None) -> None:
        if data["method"] == "custom":
            self.sent.append(json.loads(data["content"]["text"]))

    def on_msg(self, heard: Any) -> None:
        self.heard = heard

    def close(self, *given: Any, **named: Any) -> None:
        pass


def opened(mechanism: ck.Mechanism | None = None) -> tuple[Any, Comm]:
    window, comm = ck.studio(mechanism), Comm()
    window.comm = comm
    return window, comm


def told(window: Any, comm: Comm, message: dict[str, Any]) -> dict[str, Any]:
    """Send a message as a notebook does, and return the newest reply."""
    content = {"text": json.dumps(message)}
    window._handle_msg({"content": {"data": {"method": "custom", "content": content}}, "buffers": []})
    return comm.sent[-1]


def test_messages_are_replied_by_the_same_function() -> None:
    window, comm = opened(ck.load("crank-rocker"))
    first = told(window, comm, {"hello": True})
    assert loads(first["text"]).title == window.mechanism.title == ck.load("crank-rocker").title
    text = first["text"]
    for number, ask in enumerate(("structure", "motion", "overlays"), 1):
        reply = told(window, comm, {"id": number, "document": text, "question": {"ask": ask}})
        assert reply == {**json.loads(json.dumps(answer(text, {"ask": ask}))), "id": number}


def test_what_is_drawn_is_in_python_at_each_step_and_the_other_way() -> None:
    window, comm = opened()
    text = told(window, comm, {"hello": True})["text"]
    for number, edit in enumerate(FOUR_BAR):
        text = told(window, comm, {"id": number, "document": text, "question": {"ask": "edit", "edit": edit}})["text"]
        told(window, comm, {"id": 99, "document": text, "question": {"ask": "structure"}})
        assert window.document == text
    assert ck.decompose(window.mechanism).mobility.freedoms == 1
    before = len(comm.sent)
    window.document = "format = 1\ntitle = 'Other'\n"
    (given,) = comm.sent[before:]
    assert (given["is_given"], given["text"]) == (True, window.document)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"id": 1}', '{"id": 1, "document": 3, "question": {"ask": "motion"}}']
)
def test_what_is_no_message_has_no_reply(text: str) -> None:
    window, comm = opened()
    window._handle_msg({"content": {"data": {"method": "custom", "content": {"text": text}}}, "buffers": []})
    window._handle_msg({"content": {"data": {"method": "custom", "content": text}}, "buffers": []})
    assert comm.sent == []


def test_without_the_extra_it_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    from compoundkin.studio import notebook

    monkeypatch.setitem(sys.modules, "anywidget", None)
    notebook.widget_class.cache_clear()
    with pytest.raises(ck.errors.InvalidInput, match="notebook"):
        ck.studio()
    notebook.widget_class.cache_clear()
