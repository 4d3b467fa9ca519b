"""The studio's results in a browser: panels, configurations to click, files; a server that goes and comes back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from tests.studio.test_answers import shipped_text
from tests.view.page.test_studio import server, window

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
    seen.until("document.querySelectorAll('.velocity').length === 4 && document.querySelectorAll('.centre').length > 9")
    # another configuration, by a click: the drawing chooses it, one entry in the history
    before = seen.text
    view.locator(".thumbnail[aria-pressed=false]").first.click()
    seen.until("studio.isSettled && document.querySelector('.thumbnail:nth-child(2)').ariaPressed === 'true'")
    signs = [{k: mode.sign for k, mode in ck.solve(loads(text), order=0).modes.items()} for text in (before, seen.text)]
    assert signs[0] != signs[1]
    found = axe.Axe().run(view)
    assert found.violations_count == 0, found.generate_report()
    view.locator("#undo").click()
    seen.settle()
    assert seen.text == before
    assert seen.complaints == []


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
