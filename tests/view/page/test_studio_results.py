"""The studio's results in a browser: panels, configurations to click, files; a server that goes and comes back."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from tests.studio.test_answers import shipped_text
from tests.studio.test_notebook import opened, told
from tests.view.page.test_studio import DESK, START, Window, server, window

__all__ = ["server", "window"]


def test_results_are_one_click_away(window: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    seen = window(shipped_text("six-bar"))
    view = seen.view
    for ask, what in (("plots", "img"), ("configurations", ".thumbnail"), ("results", "[data-section=checks]")):
        view.locator(f"#results-{ask} > summary").click()
        view.locator(f"#results-{ask} {what}").first.wait_for()
    for name in ("velocities", "centres"):
        view.locator(f"#show-{name}").click()
    seen.until("document.querySelectorAll('.velocity:not(.under)').length === 4")
    seen.until("document.querySelectorAll('.centre').length > 9")
    # another configuration, by a click: the drawing chooses it, one entry in the history
    before = seen.text
    view.locator(".thumbnail[aria-pressed=false]").first.click()
    seen.until("studio.isSettled && document.querySelector('.thumbnail:nth-child(2)').ariaPressed === 'true'")
    signs = [{k: mode.sign for k, mode in ck.solve(loads(text), order=0).modes.items()} for text in (before, seen.text)]
    assert signs[0] != signs[1]
    found = axe.Axe().run(view)
    assert found.violations_count == 0, [(one["id"], one["nodes"][0]["html"]) for one in found.response["violations"]]
    view.locator("#undo").click()
    seen.settle()
    assert seen.text == before
    assert seen.complaints == []


@pytest.mark.full
def test_files_are_opened_and_exported(window: Any, tmp_path: Path) -> None:
    seen = window()
    view = seen.view
    view.locator("#open").click()
    view.locator("#open-name").fill("/etc/passwd")
    view.keyboard.press("Enter")
    view.locator("dialog").get_by_text("no name of the catalog").wait_for()
    view.locator("#open-name").fill("slider-crank")
    view.keyboard.press("Enter")
    seen.until("studio.isSettled && studio.text.includes('[[slides]]')")
    view.locator("#export").click()
    view.locator("#export-form").select_option("linkage")
    with view.expect_download() as download:
        view.get_by_role("button", name="Download").click()
    assert download.value.suggested_filename == "drawn.linkage2"
    view.get_by_role("button", name="Close").click()
    saved = tmp_path / "other.linkage2"
    download.value.save_as(saved)
    view.locator("#undo").click()
    seen.settle()
    view.locator("#open").click()
    view.locator("#open-file").set_input_files(saved)
    seen.until("studio.isSettled && studio.structure?.moves")
    assert ck.decompose(loads(seen.text)).mobility.freedoms == 1
    assert seen.complaints == []


@pytest.mark.full
def test_a_drawing_gets_its_unit(window: Any) -> None:
    seen = window(shipped_text("six-bar").replace('unit = "mm"\n', "", 1))
    view = seen.view
    if not view.locator("#unit").is_visible():
        view.locator("#more").click()
    view.locator("#unit").click()
    view.locator("dialog select").select_option("in")
    view.get_by_role("button", name="Do it").click()
    seen.until("studio.isSettled && studio.unit === 'in'")
    assert loads(seen.text).unit == "in"
    view.locator("#undo").click()
    seen.settle()
    assert seen.value("studio.unit") == ""
    assert seen.complaints == []


def test_dimensions_change_in_the_browser_alone(window: Any) -> None:
    """What is typed is seen before anything is sent, and is what Python then solves; dragged points take paths."""
    seen = window(shipped_text("six-bar"))
    field = seen.view.locator("#dimensions input[aria-label='length from E to D of crank']")
    field.wait_for()
    sent = seen.value("studio.wire.count")
    field.fill("15.5")
    assert seen.value("studio.wire.count") == sent
    here = seen.value("studio.canvas.motion.points")
    field.press("Enter")
    seen.until("studio.isSettled && studio.text.includes('15.5') && studio.dimensions.path !== null")
    solved = ck.solve(loads(seen.text), {"crank": np.deg2rad(np.arange(361.0))}, order=0)
    for letter, (x, y) in here.items():
        told = np.array(x, float) + 1j * np.array(y, float)
        np.testing.assert_allclose(told, np.broadcast_to(solved.points[letter].position, 361), atol=1e-9)
    # a point that is dragged: the path of G is another one while it is held
    sent, before = seen.value("studio.wire.count"), seen.value("studio.canvas.motion.points.G[0][200]")
    x, y = seen.value("studio.canvas.at('A')")
    box = seen.view.locator("#canvas").bounding_box()
    seen.view.mouse.move(box["x"] + x, box["y"] + y)
    seen.view.mouse.down()
    seen.view.mouse.move(box["x"] + x + 30, box["y"] + y + 20)
    assert seen.value("studio.canvas.motion.points.G[0][200]") != pytest.approx(before, abs=1e-3)
    assert seen.value("studio.wire.count") == sent
    held = seen.value("studio.canvas.motion.points.G[0][200]")
    seen.view.mouse.up()
    seen.until(f"studio.isSettled && studio.wire.count > {sent} && studio.canvas.motion !== null")
    assert seen.value("studio.canvas.motion.points.G[0][200]") == pytest.approx(held, abs=0.2)
    assert seen.complaints == []


def test_pairs_circuits_and_forces_are_one_click_away(window: Any) -> None:
    """A number of a pair is typed and seen at once; a branch takes drawing and driver along; forces are drawn."""
    seen = window(shipped_text("toggle-press-loaded"))
    view = seen.view
    field = view.locator("#dimensions input[aria-label='angle of press']")
    field.fill("5")
    here = seen.value("studio.canvas.motion.points.D.map((one) => one[90])")
    field.press("Enter")
    seen.until("studio.isSettled && studio.text.includes('angle = 5') && studio.dimensions.path !== null")
    crank = np.deg2rad(seen.value("studio.canvas.motion.drives.crank.values[90]"))
    solved = ck.solve(loads(seen.text), {"crank": [crank]}, order=0).points["D"].position
    assert complex(*here) == pytest.approx(complex(np.ravel(solved)[0]), abs=1e-6)
    view.locator("#show-forces").click()
    seen.until("document.querySelectorAll('.force:not(.under)').length > 5")
    assert seen.value("document.querySelectorAll('.force-name').length") > 5
    before = seen.value("studio.canvas.at('B')")
    view.locator("#results-circuits > summary").click()
    view.locator(".branch[aria-pressed=false]").first.click()
    seen.until("studio.isSettled && document.querySelector('.branch').ariaPressed === 'true'")
    assert seen.value("studio.canvas.at('B')") != pytest.approx(before, abs=5)
    assert seen.complaints == []


def test_a_server_that_comes_back_goes_on(window: Any) -> None:
    """The window says that it has gone, keeps what is drawn, and asks again what was not replied."""
    seen = window(shipped_text("crank-rocker"))
    seen.value("studio.wire.socket.close()")
    seen.view.locator("#notice").get_by_text("has ended").wait_for()
    seen.value("void studio.edit({ do: 'bar', from: { at: [0, 90] }, to: { at: [50, 90] } })")
    seen.until("studio.isSettled && studio.text.includes('bar1') && document.querySelector('#notice').hidden")
    assert seen.view.locator("#save").is_enabled()


@pytest.mark.full
def test_two_windows_of_one_file_lose_nothing(window: Any, contexts: Any) -> None:
    one = window(START)
    other = Window(contexts(DESK, "").new_page(), one.server)
    for seen, y in ((one, 0), (other, 120)):
        seen.drag((-100, y), (60, y - 50))
    mine = other.text
    one.view.keyboard.press("Control+s")
    one.until("studio.text === studio.saved")
    other.view.keyboard.press("Control+s")
    other.view.locator("#notice").get_by_text("has changed on disk").wait_for()
    assert one.server.path.read_text() == one.text
    other.view.locator("#notice").get_by_role("button", name="Take the file").click()
    other.until("studio.isSettled && studio.text === studio.saved")
    assert other.text == one.text
    # the other version is one step back
    other.view.locator("#undo").click()
    other.settle()
    assert other.text == mine
    other.view.close(run_before_unload=False)


# A page that mounts the widget's module with a model whose messages go to Python.
MOUNTED = """async ([module, name]) => {
  const heard = new Set();
  const model = {
    on: (kind, run) => heard.add(run), off: (kind, run) => heard.delete(run), get: () => null,
    send: async (content) => {
      for (const one of JSON.parse(await toPython(content.text))) for (const run of heard) run(one);
    },
  };
  const { default: widget } = await import(URL.createObjectURL(new Blob([module], { type: "text/javascript" })));
  const el = document.createElement("div");
  el.id = name;
  document.body.append(el);
  window.mounted = { ...(window.mounted ?? {}), [name]: { heard, el, unmount: await widget.render({ model, el }) } };
}"""


def test_the_widget_is_drawn_in_and_leaves_nothing_behind(contexts: Callable[..., Any]) -> None:
    """Two windows in one page; one is unmounted, and the other one goes on."""
    widget, comm = opened(ck.load("crank-rocker"))
    view, complaints = contexts((1000, 900), "").new_page(), list[str]()
    view.on("console", lambda message: complaints.append(message.text))
    view.on("pageerror", lambda error: complaints.append(str(error)))

    def to_python(text: str) -> str:
        before = len(comm.sent)
        told(widget, comm, json.loads(text))
        return json.dumps([{"text": json.dumps(one)} for one in comm.sent[before:]])

    view.expose_function("toPython", to_python)
    view.goto("about:blank")
    for name in ("one", "other"):
        view.evaluate(MOUNTED, [widget._esm, name])
        view.wait_for_function(f"mounted.{name}.el.firstChild.studio.isSettled")
    studio = "mounted.other.el.firstChild.studio"
    view.evaluate(f"{studio}.edit({{ do: 'bar', from: {{ point: 'C' }}, to: {{ at: [9, 9] }} }})")
    view.wait_for_function(f"{studio}.isSettled && {studio}.text.includes('bar1')")
    assert list(widget.mechanism.links)[-1] == "bar1"
    # keys stay inside: one that would ground a point in a notebook's other cell does nothing there
    view.evaluate("() => { window.keys = 0; document.addEventListener('keydown', () => { window.keys += 1; }); }")
    view.locator("#other #canvas").press("Control+z")
    view.wait_for_function(f"{studio}.isSettled && !{studio}.text.includes('bar1')")
    assert view.evaluate("window.keys") == 0
    view.evaluate("mounted.one.unmount()")
    assert view.evaluate("[mounted.one.heard.size, mounted.one.el.childElementCount, mounted.other.heard.size]") == [
        0,
        0,
        1,
    ]
    assert complaints == []
    view.close()
