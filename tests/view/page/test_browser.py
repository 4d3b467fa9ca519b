"""Pages in a browser: what happens on clicks and keys, at a phone's and a desk's width, in print, when read aloud."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.view.report import page
from compoundkin.view.report.atlas_sections import atlas_report
from tests import catalog

from .conftest import DESK, PHONE, until

pytestmark = pytest.mark.filterwarnings("error")

Open = Callable[..., Any]
Made = Callable[[str], Path]

OUTPUTS = "#outputs-table-1"
SIX_BAR = "six-bar"


@pytest.fixture(scope="session")
def others(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Pages without a moving sketch: faults, and no mechanism at all."""
    folder = tmp_path_factory.mktemp("others")
    parts = ck.link("frame", A=0, D=4), ck.link("a", A=0, B=1), ck.link("b", B=0, C=3), ck.link("c", D=0, C=3)
    structure = ck.decompose(ck.Mechanism("Undriven four-bar", *parts))
    made = {"faults": page(structure), "atlas": atlas_report(6).page()}
    made["random"] = page(ck.decompose(ck.chains.random_mechanism(groups=19, seed=7)))
    for name, one in made.items():
        one.save(folder / f"{name}.html")
    return {name: folder / f"{name}.html" for name in made}


def wide(one: Any) -> tuple[int, int]:
    return tuple(one.value("[document.scrollingElement.scrollWidth, innerWidth]"))


def fits(one: Any) -> None:
    """It complains about nothing, asks for nothing, and is no wider than a desk's or a phone's window."""
    for width, height in (DESK, PHONE):
        one.set_viewport_size({"width": width, "height": height})
        one.wait_for_timeout(100)
        page_width, window = wide(one)
        assert page_width <= window, one.path
    assert one.complaints == []
    assert [url for url in one.requests if not url.startswith("data:")] == [one.path.as_uri()]


@pytest.mark.parametrize(
    "name",
    [SIX_BAR, "disc-cam-roller-program"]
    + [pytest.param(name, marks=pytest.mark.full) for name in ("jansen-leg", "stephenson-iii", "planetary-train")],
)
def test_it_is_quiet_asks_for_nothing_and_fits(made: Made, opened: Open, name: str) -> None:
    fits(opened(made(name)))


@pytest.mark.full
def test_pages_without_a_motion_are_quiet_and_fit_too(opened: Open, others: dict[str, Path]) -> None:
    for path in others.values():
        fits(opened(path))


def test_nothing_is_written_too_small_for_a_phone(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR), PHONE)
    small = one.value(
        """() => [...document.querySelectorAll("body *:not(svg *, script, style)")]
        .filter((e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()))
        .filter((e) => e.getClientRects().length && parseFloat(getComputedStyle(e).fontSize) < 13.99)
        .map((e) => e.outerHTML.slice(0, 80))"""
    )
    assert small == []


# Of formulas with matrices: how far parts of one stand below each other, and the least gap between entries of rows.
MATRICES = """() => {
  const shown = [...document.querySelectorAll(".maths:has(mtable)")].map((one) => {
    const boxes = [...one.querySelectorAll(":scope > math")].map((part) => part.getBoundingClientRect());
    return Math.max(...boxes.map((box) => box.top)) - Math.min(...boxes.map((box) => box.bottom));
  });
  const rows = [...document.querySelectorAll("mtable")].flatMap((one) => [...one.querySelectorAll("mtr")]
    .map((row) => [...row.querySelectorAll("mtd > *")].map((entry) => entry.getBoundingClientRect()))
    .map((boxes) => [Math.min(...boxes.map((b) => b.top)), Math.max(...boxes.map((b) => b.bottom))])
    .reduce(([gaps, last], [top, bottom]) => [last === null ? gaps : [...gaps, top - last], bottom], [[], null])[0]);
  return [shown.length, Math.max(...shown), Math.min(...rows)];
}"""


def test_matrices_stand_on_one_line_and_their_rows_apart(opened: Open, tmp_path: Path) -> None:
    path = tmp_path / "equations.html"
    options = "--equations", "--order", "2", "-o", str(path)
    assert CliRunner().invoke(cli, ["structure", "jansen-leg", *options]).exit_code == 0
    one = opened(path)
    fits(one)
    count, below, gap = one.value(MATRICES)
    assert count == 3
    assert below < 0
    assert gap > 2


def column(one: Any, table: str, k: int) -> list[float]:
    """The numbers of a column, with every digit, as they stand below each other."""
    cells = one.value(
        """([table, k]) => [...document.querySelector(table).tBodies[0].rows]
        .filter((r) => r.getClientRects().length).map((r) => r.cells[k].dataset.sort ?? r.cells[k].textContent)""",
        [table, k],
    )
    return [float(cell) for cell in cells]


def test_a_column_is_sorted_by_its_numbers_with_a_click_and_by_keyboard(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    head = one.locator(f"{OUTPUTS} thead th").nth(3)
    before = column(one, OUTPUTS, 3)
    assert before != sorted(before)
    head.get_by_role("button").click()
    one.wait_for_timeout(50)
    assert head.get_attribute("aria-sort") == "ascending"
    assert column(one, OUTPUTS, 3) == sorted(before)
    head.get_by_role("button").focus()
    one.keyboard.press("Enter")
    one.wait_for_timeout(100)
    assert head.get_attribute("aria-sort") == "descending"
    assert column(one, OUTPUTS, 3) == sorted(before, reverse=True)
    assert "descending" in one.locator("#said").text_content()
    other = one.locator(f"{OUTPUTS} thead th").nth(0)
    other.get_by_role("button").focus()
    one.keyboard.press("Space")
    one.wait_for_timeout(50)
    assert other.get_attribute("aria-sort") == "ascending"
    assert head.get_attribute("aria-sort") is None


def test_all_rows_are_shown_on_demand(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.value("document.dispatchEvent(new CustomEvent('compoundkin:pose', { detail: { pose: 9 } }))")
    assert one.locator(f"{OUTPUTS} tr.here").get_attribute("data-pose") == "9"
    button = one.get_by_role("button", name="Show all 73 rows")
    assert len(column(one, OUTPUTS, 0)) == 25
    button.click()
    assert column(one, OUTPUTS, 0) == [5.0 * k for k in range(73)]
    fewer = one.get_by_role("button", name="Show fewer rows")
    assert fewer.get_attribute("aria-expanded") == "true"
    fewer.click()
    assert len(column(one, OUTPUTS, 0)) == 25


# The clipboard as a page from a file may find it: there or not.
WATCHED = "addEventListener('copy', () => { window.taken = document.activeElement.value; });"
LACKING = f"Object.defineProperty(navigator, 'clipboard', {{ value: undefined }}); {WATCHED}"


@pytest.mark.parametrize("script", ["", pytest.param(LACKING, marks=pytest.mark.full)], ids=["clipboard", "none"])
def test_a_table_is_copied_with_every_digit(made: Made, opened: Open, script: str) -> None:
    permitted = {} if script else {"permissions": ["clipboard-read", "clipboard-write"]}
    one = opened(made(SIX_BAR), script=script, **permitted)
    button = one.locator("#outputs .copy").first
    button.click()
    one.wait_for_timeout(150)
    text = one.value("window.taken") if script else one.value("navigator.clipboard.readText()")
    rows = [line.split("\t") for line in text.splitlines()]
    assert rows[0][:3] == ["crank [°]", "G.position.x [mm]", "G.position.y [mm]"]
    assert len(rows) == 26
    motion = catalog.motion(SIX_BAR)
    places = motion.points["G"].position
    for row in rows[1:]:
        pose = round(float(row[0]) / 5.0)
        assert complex(float(row[1]), float(row[2])) == complex(places[pose])
    assert "25 rows copied" in one.locator("#said").text_content()
    assert one.value("document.activeElement.className") == button.get_attribute("class").replace(" done", "") + " done"


def colour(one: Any) -> str:
    return str(one.value("getComputedStyle(document.documentElement).backgroundColor"))


@pytest.mark.full
def test_light_and_dark_follow_the_system_or_the_switch_and_stay(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR), color_scheme="light")
    light = colour(one)
    one.emulate_media(color_scheme="dark")
    dark = colour(one)
    assert light != dark
    one.locator(".theme").get_by_text("Light").click()
    assert colour(one) == light
    one.locator(".theme").get_by_text("Dark").click()
    one.emulate_media(color_scheme="light")
    assert colour(one) == dark
    one.reload()
    assert colour(one) == dark
    assert one.locator(".theme input:checked").get_attribute("value") == "dark"
    bar = one.value("getComputedStyle(document.querySelector('#groups svg .ck-bar2, #groups svg .ck-line2')).stroke")
    one.locator(".theme").get_by_text("Auto").click()
    assert colour(one) == light
    now = one.value("getComputedStyle(document.querySelector('#groups svg .ck-bar2, #groups svg .ck-line2')).stroke")
    assert now != bar


@pytest.mark.full
def test_paper_is_light_has_no_controls_and_all_that_is_shown(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR), color_scheme="dark")
    one.locator(".theme").get_by_text("Dark").click()
    one.emulate_media(media="print")
    for control in (".theme", ".tools", ".contents", ".skip"):
        assert not one.locator(control).first.is_visible()
    ink = one.value("getComputedStyle(document.body).color")
    red, green, blue = map(int, re.findall(r"\d+", ink)[:3])
    assert max(red, green, blue) < 60
    assert one.locator("#published").is_visible()
    assert len(one.pdf(format="A4")) > 20_000
    assert len(one.pdf(format="Letter")) > 20_000


def lit(one: Any, where: str) -> set[str]:
    """The links that are lit in some part of the page."""
    found = one.value("(w) => [...document.querySelectorAll(w + ' .lit')].map((e) => e.dataset.links)", where)
    return set(found)


def test_a_group_lights_up_everywhere_under_the_pointer(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.locator("#groups .step").nth(2).hover()
    for where in ("#chain svg", "#groups svg"):
        assert {"bar", "block"} <= lit(one, where), where
        assert "crank" not in lit(one, where)
    assert lit(one, "#links") == {"bar", "block"}
    opacity = "getComputedStyle(document.querySelector('#chain svg [data-links=crank]')).opacity"
    until(one, f"{opacity} < 1")
    one.mouse.move(1, 1)
    assert lit(one, "body") == set()
    until(one, f"{opacity} === '1'")


def test_a_link_in_a_picture_lights_up_its_group_and_a_row_its_link(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.locator("#chain svg [data-links=plate]").first.hover()
    assert lit(one, "#links") == {"plate", "rocker"}
    assert lit(one, "#groups .text, #groups") >= {"plate,rocker"}
    one.locator("#links tr[data-links=plate] th").hover()
    assert lit(one, "#links") == {"plate"}
    assert "rocker" not in lit(one, "#groups svg")


def test_by_keyboard_links_light_up_are_pinned_and_freed(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.mouse.move(1, 1)
    one.locator("#links .who").first.focus()
    assert lit(one, "#links") == {"frame"}
    one.keyboard.press("ArrowDown")
    one.keyboard.press("ArrowDown")
    assert one.value("document.activeElement.textContent") == "plate"
    assert lit(one, "#links") == {"plate"}
    assert "plate" in lit(one, "#chain svg")
    one.keyboard.press("Enter")
    button = one.locator("#links .who").nth(2)
    assert button.get_attribute("aria-pressed") == "true"
    assert one.locator(".pinned").is_visible()
    one.locator("h1").click()
    assert lit(one, "#links") == {"plate"}
    one.keyboard.press("Escape")
    assert lit(one, "body") == set()
    assert button.get_attribute("aria-pressed") == "false"
    assert not one.locator(".pinned").is_visible()


def test_names_below_the_sketch_light_up_by_keyboard_too(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.mouse.move(1, 1)
    name = one.locator("#stage [data-links=rocker][tabindex]").first
    name.focus()
    assert lit(one, "#links") == {"rocker"}
    one.keyboard.press("Enter")
    one.keyboard.press("Shift+Tab")
    assert lit(one, "#links") != set()
    one.keyboard.press("Escape")
    one.value("document.activeElement.blur()")
    assert lit(one, "#links") == set()


def test_the_keyboard_comes_to_the_report_first_and_headings_go_down_by_one(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR))
    one.keyboard.press("Tab")
    assert one.value("document.activeElement.className") == "skip"
    assert one.value("document.activeElement.getBoundingClientRect().top") >= 0
    one.keyboard.press("Enter")
    assert one.value("document.activeElement.id") == "content"
    order = one.value(
        """() => [...document.querySelectorAll("a, button, input, select, summary, [tabindex='0']")]
        .filter((e) => e.tabIndex >= 0).every((e) => e.tabIndex === 0)"""
    )
    assert order, "positive tab indices change the order of the page"
    stops = one.value("[...document.querySelectorAll('#links .who')].filter((b) => b.tabIndex === 0).length")
    assert stops == 1, "names in a table are one stop of the tab key"
    levels = one.value("[...document.querySelectorAll('h1,h2,h3,h4')].map((h) => +h.tagName[1])")
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))


# what is wide is the same in both schemes, and so are colours at both widths
@pytest.mark.parametrize(
    ("size", "scheme"),
    [pytest.param(PHONE, "dark", id="phone-dark"), pytest.param(DESK, "light", id="desk", marks=pytest.mark.full)],
)
def test_axe_finds_nothing_against_it(made: Made, opened: Open, size: tuple[int, int], scheme: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    one = opened(made(SIX_BAR), size, color_scheme=scheme)
    one.wait_for_timeout(300)
    found = axe.run(one.view).response["violations"]
    told = [(v["id"], v["impact"], [node["html"][:120] for node in v["nodes"]][:3]) for v in found]
    assert [v for v in told if v[1] in ("serious", "critical", "moderate")] == []


def test_names_that_are_markup_run_no_script(opened: Open, hostile: ck.Mechanism, tmp_path: Path) -> None:
    page(ck.solve(hostile)).save(tmp_path / "hostile.html")
    one = opened(tmp_path / "hostile.html")
    one.wait_for_timeout(200)
    assert one.value("typeof hacked") == "undefined"
    assert one.complaints == []
    assert one.locator("h1").text_content() == hostile.title
    assert one.locator("img").count() == 0
    button = one.locator("#links .who").nth(1)
    assert button.text_content() == list(hostile.links)[1]
    button.click()
    assert "<script>" in one.locator(".pinned").text_content()
    width, window = wide(one)
    assert width <= window


def test_scripts_leave_one_name_behind(made: Made, opened: Open, tmp_path: Path) -> None:
    (tmp_path / "blank.html").write_text("<!DOCTYPE html><title>Blank</title>", encoding="utf-8")
    known = set(opened(tmp_path / "blank.html").value("Object.getOwnPropertyNames(window)"))
    one = opened(made(SIX_BAR))
    found = set(one.value("Object.getOwnPropertyNames(window)")) - known
    named = set(one.value("[...document.querySelectorAll('[id]')].map((e) => e.id)"))
    assert found - named - {"compoundkin"} == set()


def test_without_scripts_all_is_there_to_read_but_the_plots(made: Made, opened: Open) -> None:
    one = opened(made(SIX_BAR), java_script_enabled=False)
    for visible in ("#published", "#links"):
        assert one.locator(visible).is_visible()
    for scripted in (".theme", ".tools", "#motion", ".contents a[href='#motion']"):
        assert not one.locator(scripted).first.is_visible()


def test_a_report_of_faults_says_so_in_words(opened: Open, others: dict[str, Path]) -> None:
    one = opened(others["faults"], PHONE)
    assert "cannot be solved" in one.locator(".badges").text_content()
    assert one.locator(".alert").first.is_visible()
