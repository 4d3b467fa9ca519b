"""The pen in a browser: a curve drawn by hand brings linkages, one that is chosen is the document, undo leads back."""

from __future__ import annotations

import cmath
import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from compoundkin.studio import server as servers
from tests.studio.test_notebook import opened, told
from tests.view.page.test_studio import Window, served_studio, window

__all__ = ["window"]


@pytest.fixture(scope="module")
def server() -> Iterator[Any]:
    """One that answers in this process, with a small atlas: the processes of a server are tested by its own tests."""
    patch = pytest.MonkeyPatch()
    from compoundkin.dimensional.coupler_atlas import coupler_atlas
    from compoundkin.studio import answer, drawn_curves

    class Here(servers.AnsweringProcess):
        def ask(self, document: str, question: Any, seconds: float = 0.0) -> dict[str, Any]:
            # the search that takes seconds finds what is found at once
            asked = {**question, "ask": "near"} if question["ask"] == "traced" else question
            return {**answer(document, asked), "ask": question["ask"]}

        def start(self) -> Any:
            return None

    patch.setattr(drawn_curves, "GIVEN", 4)
    patch.setattr(drawn_curves, "_atlas", lambda: coupler_atlas(4, 3_000))
    patch.setattr(servers, "AnsweringProcess", Here)
    with served_studio() as served:
        yield served
    patch.undo()


def egg(count: int = 40, turn: float = 2 * np.pi) -> list[tuple[float, float]]:
    places = [cmath.exp(1j * one) for one in np.linspace(0, turn, count)]
    return [(z.real, z.imag) for z in (100 * p + 30 / p + 12 * p * p for p in places)]


def sketched(seen: Window, places: list[tuple[float, float]]) -> None:
    seen.view.mouse.move(*seen.at(places[0]))
    seen.view.mouse.down()
    for place in places[1:]:
        seen.view.mouse.move(*seen.at(place))
    seen.view.mouse.up()


def test_a_curve_brings_linkages_and_one_of_them_is_the_document(window: Any) -> None:
    seen = window()
    before = seen.text
    seen.view.keyboard.press("i")
    sketched(seen, egg())
    seen.until("studio.pen.words.textContent.startsWith('Searched')")
    assert seen.value("studio.pen.isClosed")
    curve = np.array([seen.where_plane(place) for place in egg()])
    errors = [
        float(one)
        for one in seen.value("[...document.querySelectorAll('#pen-list button')].map((one) => one.dataset.error)")
    ]
    assert errors == sorted(errors)
    assert errors[0] < 0.05 * np.ptp(curve.real)
    # each picture has the curve, the path and the bars
    assert seen.value("document.querySelectorAll('#pen-list .sketched').length") == len(errors)
    seen.view.locator("#pen-list button").first.click()
    seen.until("studio.isSettled && studio.structure?.moves && studio.motion?.poses === 361")
    motion = ck.solve(loads(seen.text), order=0)
    path = np.ravel(motion.points["P"].position)
    assert np.abs(curve[:, None] - path).min(axis=1).mean() < 2 * errors[0] + 0.01 * np.ptp(curve.real)
    assert seen.view.locator(".layer-pen path").count() == 1  # what was drawn stays
    seen.view.locator("#undo").click()
    seen.settle()
    assert seen.text == before
    # a stroke is another question; four links are a condition
    seen.view.keyboard.press("i")
    sketched(seen, egg(25, np.pi))
    seen.view.locator("#pen-links").select_option("4")
    seen.until("studio.pen.words.textContent.startsWith('Searched')")
    assert not seen.value("studio.pen.isClosed")
    links = seen.value("[...document.querySelectorAll('#pen-list button')].map((one) => one.dataset.links)")
    assert set(links) == {"4"}
    seen.view.locator("#pen-clear").click()
    assert seen.view.locator("#pen-list button").count() == 0
    sketched(seen, [(0, 0), (10, 0), (12, 4)])
    seen.until("studio.pen.words.textContent.includes('too short')")
    assert seen.complaints == []


@pytest.mark.full
def test_a_finger_draws_and_a_second_one_does_not(window: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    seen = window(size=(390, 844), has_touch=True)
    touches = seen.view.context.new_cdp_session(seen.view)

    def touch(kind: str, *places: tuple[float, float]) -> None:
        points = [dict(zip("xy", seen.at(place), strict=True)) for place in places]
        touches.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points})

    seen.view.locator("#tool-pen").click()
    touch("Start", (0, 0))
    touch("Move", (40, 40))
    touch("Start", (40, 40), (0, 40))  # two fingers move the view
    touch("End")
    assert seen.value("studio.pen.places.length") == 0
    small = [(0.6 * x, 0.6 * y) for x, y in egg()]
    touch("Start", small[0])
    for place in small[1:]:
        touch("Move", place)
    touch("End")
    seen.until("studio.pen.words.textContent.startsWith('Searched')")
    assert seen.view.locator("#pen-list button").count() > 0
    assert seen.value("document.documentElement.scrollWidth") <= 390
    found = axe.Axe().run(seen.view)
    assert found.violations_count == 0, [(one["id"], one["nodes"][0]["html"]) for one in found.response["violations"]]


def test_a_notebook_is_told_the_same() -> None:
    from compoundkin.studio import answer

    pytest.importorskip("anywidget")
    widget, comm = opened()
    question = {"ask": "near", "points": [list(one) for one in egg()[:-1]], "closed": True, "links": 4}
    reply = told(widget, comm, {"id": 1, "document": "", "question": question})
    assert reply == {**json.loads(json.dumps(answer("", question))), "id": 1}
    assert len(reply["suggestions"]) > 1
    assert widget.document  # a question of no document changes none
