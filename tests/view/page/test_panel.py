"""The panel of dimensions in a browser: fields, bounds, ranges; what is copied, saved and kept in the address."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.kinematics.quantities import quantity
from compoundkin.programs.dimensions import StatedDimensions, mechanism_with
from compoundkin.view.page.live.panel_data import mechanism_template, template_data
from tests import catalog

from .conftest import DESK, PHONE

pytestmark = pytest.mark.filterwarnings("error")

# Bars, bars as drawn, cylinders, gears, wheels, slots, laws, loads, points that are led, class III.
KINDS = (
    "six-bar", "four-bar-meriam", "hydraulic-digger", "geared-coupler", "rolling-wheel", "geneva-wheel",
    "elliptic-trammel", "toggle-press-loaded", "five-bar-led", "class-iii-six-bar",
)  # fmt: skip
FILLED = """([toml, own, numbers]) => compoundkin.tomlOf({
  path: { data: { toml } }, own, numbers, isChanged: numbers.some((value, k) => value !== own[k]),
})"""

# The same of a page that stands at these places.
PLACED = """([toml, own, to, places]) => compoundkin.tomlOf({
  path: { data: { toml } }, own, numbers: to, isChanged: true,
  player: { data: { start: 0 }, assembled: [1], place: (letter) => places[letter] },
})"""

WRONG = """(field, texts) => texts.map((text) => {
  field.value = text;
  field.dispatchEvent(new Event("change"));
  return [document.getElementById(`${field.id}-more`).textContent, field.getAttribute("aria-invalid")];
})"""


@pytest.fixture(scope="module")
def whole(browser: Any, made: Callable[[str], Path]) -> Iterator[Any]:
    """The page of the six-bar, opened once, with all that it complained about."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, accept_downloads=True)
    view = context.new_page()
    view.complaints = []
    view.on("console", lambda message: view.complaints.append(message.text))
    view.on("pageerror", lambda error: view.complaints.append(str(error)))
    view.goto(made("six-bar").as_uri())
    yield view
    assert view.complaints == []
    context.close()


def field(view: Any, label: str) -> Any:
    return view.get_by_role("spinbutton", name=label)


def numbers(view: Any) -> dict[str, float]:
    """The dimensions that are changed, by name."""
    found = view.evaluate(
        "() => { const { names, numbers, own } = compoundkin.players[0].design;"
        "return names.map((name, k) => [name, numbers[k], own[k]]).filter(([, a, b]) => a !== b); }"
    )
    return {name: value for name, value, _ in found}


@pytest.mark.parametrize("name", KINDS)
def test_what_is_copied_is_the_changed_mechanism_to_the_last_digit(whole: Any, name: str) -> None:
    motion = catalog.motion(name)
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    free = [one for one in stated.known.values() if not one.is_vector and one.is_read]
    names = [one.name for one in free if not np.ndim(stated.own(one))]
    own = [float(stated.own(stated.known[one])) for one in names]
    pieces = mechanism_template(stated, names)
    assert whole.evaluate(FILLED, [pieces, own, own]) == dumps(motion.mechanism)
    random = np.random.default_rng(7)
    for count in (1, 2, len(names)):
        chosen = random.choice(len(names), count, replace=False)
        changed = list(own)
        for k in chosen:
            changed[k] = own[k] * (1 + 1e-4 * random.normal()) if own[k] else 1e-3 * random.normal()
        try:
            wanted = mechanism_with(stated, {stated.known[names[k]]: changed[k] for k in chosen})
        except ck.errors.InvalidMechanism:
            # wheels that do not fit their axes: a page leaves these out
            continue
        assert loads(whole.evaluate(FILLED, [pieces, own, changed])) == wanted


def test_what_is_copied_keeps_its_configuration(whole: Any) -> None:
    # loops that are two triangles or a rhombus at the first pose: the least change makes another one the usual one
    bars = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=3), ck.link("arm", D=0, C=3)
    motion = ck.solve(ck.Mechanism("Tie", *bars, ck.drive("crank")))
    for name, to in [("frame.D.y", 0.1), ("frame.D.y", -0.1)]:
        stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
        pieces = template_data(stated, [name], motion)
        copied = loads(whole.evaluate(FILLED, [pieces, [0.0], [to]]))
        assert {mode.sign for mode in ck.solve(copied).modes.values()} == {m.sign for m in motion.modes.values()}
    # without signs the drawing chooses: it is that of the page, from which no link reads anything any more
    drawn = catalog.motion("stephenson-iii-floating-driver")
    stated = StatedDimensions(drawn.mechanism, drawn.inputs.ends)
    names = [name for name, one in stated.known.items() if one.is_of_link and not one.is_vector]
    own = [float(stated.own(stated.known[name])) for name in names]
    to = [value + 0.1 * (name == "AB.A.x") for name, value in zip(names, own, strict=True)]
    places = {letter: [point.x[7], point.y[7]] for letter, point in drawn.points.items()}
    copied = loads(whole.evaluate(PLACED, [template_data(stated, names, drawn), own, to, places]))
    assert copied.sketch == {letter: complex(*place) for letter, place in places.items()}
    assert all(None not in link.points.values() for link in copied.rigid_links.values())
    wanted = mechanism_with(stated, {stated.known["AB.A.x"]: to[names.index("AB.A.x")]})
    np.testing.assert_allclose(ck.solve(copied).points["F"].position, ck.solve(wanted).points["F"].position, rtol=1e-9)


def test_lengths_and_angles_are_changed_by_keyboard_and_wrong_ones_told(whole: Any) -> None:
    crank = field(whole, "length from E to D of crank")
    crank.press("ArrowUp")
    assert numbers(whole) == {"crank.D.x": 15.0}
    crank.press("Shift+ArrowDown")
    crank.fill("15,5 mm")
    crank.press("Enter")
    assert numbers(whole) == {"crank.D.x": 15.5}
    # what was taken is undone in the field too; what is being typed is not
    crank.press("Control+z")
    assert numbers(whole) == {"crank.D.x": 5.0}
    crank.press("Control+y")
    assert numbers(whole) == {"crank.D.x": 15.5}
    # each wrong text: what is told beside the field
    told = crank.evaluate(WRONG, ["abc", "", "-3", "0", "1e9", "NaN", "Infinity", "1 in"])
    assert [text.partition(" ")[0] for text, _ in told] == [
        "“abc”",
        "Write",
        "It",
        "It",
        "It",
        "“NaN”",
        "“Infinity”",
        "“1",
    ]
    assert {invalid for _, invalid in told} == {"true"}
    assert numbers(whole) == {"crank.D.x": 15.5}
    crank.press("Escape")
    assert (crank.input_value(), crank.get_attribute("aria-invalid")) == ("15.5", "false")
    angle = field(whole, "angle at D from A to C of plate")
    assert angle.input_value() == "35"
    angle.fill("-50")
    angle.press("Tab")
    found = numbers(whole)
    turned = complex(found["plate.C.x"], found["plate.C.y"])
    assert np.isclose(turned, 15 * np.exp(1j * np.deg2rad(-50)), rtol=1e-15, atol=0)
    assert "was 35" in whole.locator(".dimension.changed").all_text_contents()[-1]
    assert whole.locator(".original:visible").count() > 3
    whole.get_by_role("button", name="Reset angle at D from A to C of plate").click()
    whole.get_by_role("button", name="Reset length from E to D of crank").click()
    assert numbers(whole) == {}
    whole.wait_for_function("!document.querySelector('.dimension.changed')")
    assert whole.locator(".original:visible").count() == 0
    # undo goes back over what was typed and stepped
    assert [
        step["words"] for step in whole.evaluate("compoundkin.players[0].design.history.map(({words}) => ({words}))")
    ][1] != ""
    driver = field(whole, "value of crank")
    driver.fill("91")
    driver.press("Enter")
    assert (whole.evaluate("compoundkin.players[0].design.player.pose"), driver.input_value()) == (18, "90")
    driver.fill("400")
    driver.press("Enter")
    assert whole.evaluate("compoundkin.players[0].design.player.pose") == 18
    driver.press("Escape")


def test_the_range_in_which_it_assembles_is_that_of_the_four_bar(whole: Any) -> None:
    """The bar slides through a block: only the four-bar E D A B limits it, whose lengths are 14, 39, 28 and 41."""
    lengths = {
        "length from E to D of crank": (0, 39 + 28 - 41),
        "length from B to A of rocker": (41 + 14 - 39, 41 - 14 + 39),
    }
    for name, (low, high) in lengths.items():
        one = field(whole, name)
        one.focus()
        told = whole.locator(f"#{one.get_attribute('id')}-more")
        whole.wait_for_function(
            "(one) => one.textContent.startsWith('Assembles at all poses')", arg=told.element_handle()
        )
        ends = [float(text) for text in re.findall(r"\d+\.?\d*", told.text_content())]
        # inward, and by no more than the last digit
        for end, limit, way in zip(ends, [low, high][-len(ends) :], [1, -1][-len(ends) :], strict=True):
            assert 0 <= way * (end - limit) < 0.03
        assert len(ends) == (2 if low else 1)
    assert numbers(whole) == {}


def test_on_a_narrow_screen_the_sketch_comes_along(whole: Any) -> None:
    whole.set_viewport_size({"width": 360, "height": 740})
    field(whole, "length from D to C of plate").press("ArrowUp")
    small = whole.locator(".miniature")
    whole.wait_for_function("(one) => one.querySelectorAll('.parts > g.lit').length > 1", arg=small.element_handle())
    assert small.bounding_box()["y"] == 0
    assert field(whole, "length from D to C of plate").bounding_box()["y"] > small.bounding_box()["height"]
    assert whole.evaluate("document.scrollingElement.scrollWidth") == 360
    whole.get_by_role("button", name="Reset length from D to C of plate").click()
    whole.set_viewport_size({"width": 1440, "height": 900})
    whole.evaluate("document.activeElement.blur()")
    assert small.is_hidden()
    assert numbers(whole) == {}


def test_the_address_restores_what_was_changed(whole: Any) -> None:
    values = {"crank.D.x": 15.25, "plate.C.y": 8.7, "slot.angle": float(np.deg2rad(5.0)), "frame.F.x": -0.1}
    whole.evaluate("(values) => compoundkin.players[0].design.load(values, 'test')", values)
    taken = "() => { compoundkin.copied = async (text) => { window.taken = text; return true; }; }"
    whole.evaluate(taken)
    whole.click("[data-share=link]")
    address = whole.evaluate("window.taken")
    assert address.endswith("#dimensions=slot.angle:5deg,frame.F.x:-0.1,crank.D.x:15.25,plate.C.y:8.7")
    whole.evaluate("compoundkin.players[0].design.reset()")
    whole.evaluate("(hash) => { location.hash = hash; }", address.partition("#")[2])
    whole.wait_for_function("compoundkin.players[0].design.isChanged")
    assert numbers(whole) == values
    # back to the address before it, and on again
    whole.go_back()
    whole.wait_for_function("!compoundkin.players[0].design.isChanged")
    whole.go_forward()
    whole.wait_for_function("compoundkin.players[0].design.isChanged")
    assert numbers(whole) == values
    # an ordinary anchor goes where it always went, and changes nothing
    whole.evaluate("() => { location.hash = 'outputs'; }")
    assert numbers(whole) == values
    whole.click("[data-share=toml]")
    changed = loads(whole.evaluate("window.taken"))
    assert changed.links["crank"].points["D"] == 15.25
    # where copying is not allowed, the text stands there selected
    whole.evaluate("() => { compoundkin.copied = async () => false; }")
    whole.click("[data-share=toml]")
    whole.wait_for_selector("textarea.taken:focus")
    area = whole.evaluate(
        "(({ value, selectionStart, selectionEnd }) => [value, selectionEnd - selectionStart])(document.activeElement)"
    )
    assert (loads(area[0]), area[1]) == (changed, len(area[0]))
    saved_numbers(whole, changed)
    saved_picture(whole)
    whole.evaluate("compoundkin.players[0].design.reset()")


def saved_numbers(whole: Any, changed: ck.Mechanism) -> None:
    """The CSV has the numbers that solving the changed mechanism gives."""
    with whole.expect_download() as saved:
        whole.click("[data-share=csv]")
    assert saved.value.suggested_filename == "six-bar-of-example-3-4.csv"
    rows = list(csv.reader(io.StringIO(Path(saved.value.path()).read_text())))
    found = {head: np.array(column, float) for head, column in zip(rows[0], zip(*rows[1:], strict=True), strict=True)}
    motion = ck.solve(changed)
    assert np.allclose(found["crank [deg]"], np.arange(0, 361, 5), rtol=0, atol=1e-12)
    for head in ("G.position.x [mm]", "G.velocity.y [mm/s]", "bar.angular_acceleration [rad/s^2]", "A.position.y [mm]"):
        name = head.partition(" ")[0]
        assert np.allclose(found[head], quantity(motion, name).values, rtol=1e-9, atol=1e-9), head


def saved_picture(whole: Any) -> None:
    """The SVG needs no style sheet: colours and widths are its own."""
    with whole.expect_download() as saved:
        whole.click("[data-share=svg]")
    text = Path(saved.value.path()).read_text()
    whole_picture = ET.fromstring(text)
    assert whole_picture.tag == "{http://www.w3.org/2000/svg}svg"
    assert "var(" not in text
    assert "class=" not in text
    letters = [one.text for one in whole_picture.iter("{http://www.w3.org/2000/svg}text")]
    assert {*"ABCDEFG"} <= set(letters)
    # a bar of the second group
    assert re.search(r'<path[^>]* stroke="rgb\(192, 74, 0\)"', text)


MALFORMED = """([names, texts, wholes]) => {
  let seed = 1;
  const random = (n) => { seed = (seed * 48271) % 2147483647; return seed % n; };
  const pick = (list) => list[random(list.length)];
  const [{ design }] = compoundkin.players, before = JSON.stringify([...design.numbers]), wrong = [];
  const good = (k) => `${design.names[k % design.names.length]}:${1 + random(9)}`;
  const mixed = (k) => {
    const bad = random(2) ? `${pick(names)}:${pick(["1", ...texts])}` : `crank.D.x:${pick(texts)}`;
    return [...Array(random(3)).keys()].map((j) => good(k + j)).concat(bad).sort(() => random(3) - 1).join(",");
  };
  for (let k = 0; k < 1000; k++) {
    const text = `#dimensions=${random(9) ? mixed(k) : pick(wholes)}`;
    let found = null;
    try { found = compoundkin.readFragment(text, design); } catch (error) { found = String(error); }
    if (!found || !/^[a-z ]+[A-Z:]*[a-z 0]*$/.test(found.problem)) wrong.push([text.slice(0, 200), found]);
  }
  return [wrong.slice(0, 5), before === JSON.stringify([...design.numbers])];
}"""
NAMES = (
    *("crank.D", "crank.D.z", "__proto__", "constructor", "toString", "__proto__.x", "", "%", "%E0%A4%A"),
    *("crank.D.x%00", "ähm", "x" * 999, "CRANK.D.X", "<img src=x>"),
)
TEXTS = (
    *("", "NaN", "1e999", "-Infinity", "0x10", "1,5", "1e", "--1", "1 2", "1e300", "12deg", "alert(1)", "%F0%9F"),
    *("null", "[]", "9" * 400),
)
WHOLES = "", ":", ",", "crank.D.x", "%%%", "a" * 1_000_000, "crank.D.x:1," * 90_000, "crank.D.x:1,crank.D.x:2"


def test_a_thousand_malformed_addresses_change_nothing(whole: Any) -> None:
    assert whole.evaluate(MALFORMED, [NAMES, TEXTS, WHOLES]) == [[], True]
    whole.evaluate("() => { location.hash = 'dimensions=__proto__.x:1e999,%'; }")
    told = whole.locator("#dimensions .told")
    whole.wait_for_function("(one) => one.textContent.endsWith('nothing was changed.')", arg=told.element_handle())
    assert numbers(whole) == {}


@pytest.mark.full
def test_an_address_that_does_not_fit_is_told_above_the_sketch(made: Any, opened: Any) -> None:
    """Whoever opens a link sees why nothing was changed, on a desk and on a phone, without scrolling."""
    for size in (DESK, PHONE):
        view = opened(made("six-bar"), size)
        view.goto(f"{view.path.as_uri()}#dimensions=crank.D.x:oops")
        view.reload()
        told = view.locator("[role=alert]:visible")
        assert "nothing was changed" in told.text_content()
        box = told.bounding_box()
        assert 0 <= box["y"] < view.locator("svg.sketch").bounding_box()["y"]
        assert box["y"] + box["height"] < size[1]


def test_at_a_gap_stands_what_is_known_and_the_circles_that_miss(made: Any, opened: Any) -> None:
    """A crank of 27 is too long for plate and rocker at 180 degrees: about D and B lie circles of 39 and 28 apart."""
    view = opened(made("six-bar"))
    found = view.value("""() => {
      const [player] = compoundkin.players, { design } = player, { window } = player.data;
      design.change({ "crank.D.x": 27 });
      player.show(36);
      const known = player.parts.filter((part) => !part.classList.contains("missing"));
      const circles = [...document.querySelectorAll(".misses circle")].map((one) => {
        const [x, y, r] = ["cx", "cy", "r"].map((name) => Number(one.getAttribute(name)));
        return [x / window.scale + window.x, window.y - y / window.scale, r / window.scale];
      });
      return { shown: [...new Set(known.map((part) => part.dataset.links))], circles };
    }""")
    assert sorted(found["shown"]) == ["crank", "frame"]
    assert np.allclose(sorted(found["circles"]), [[-27, 0, 39], [41, 0, 28]], atol=1e-9)
    view.value("() => compoundkin.players[0].design.reset()")
    assert view.locator(".misses, .missing").count() == 0
    assert view.complaints == []
