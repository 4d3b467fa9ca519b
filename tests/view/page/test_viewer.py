"""The moving sketch and the plots in a real browser: where the solver is, and what the switches do."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.page import player
from compoundkin.view.report import page
from tests import catalog

from .conftest import DESK, PHONE, Opened, until

PLAYER = "compoundkin.players[0]"


def set_slider(view: Any, k: int) -> None:
    """Move the slider as a hand would: the input event tells."""
    view.value(
        "k => { const s = document.querySelector('.slider'); s.value = k; s.dispatchEvent(new Event('input')); }", k
    )


@pytest.mark.parametrize(
    "name",
    [
        "six-bar",
        "planetary-train",
        *(pytest.param(name, marks=pytest.mark.full) for name in ("jansen-leg", "class-iii-six-bar")),
    ],
)
def test_the_slider_takes_every_point_where_the_solver_has_it(name: str, made: Any, opened: Any) -> None:
    motion = catalog.motion(name)
    view = opened(made(name))
    letters = view.value(f"Object.keys({PLAYER}.points)")
    assert letters
    for k in np.linspace(0, motion.inputs.poses - 1, 9).round().astype(int):
        set_slider(view, int(k))
        for letter, place in view.drawn(*letters).items():
            assert abs(place - motion.points[letter].position[k]) < 1e-6
    assert view.complaints == []


def test_bars_turn_with_their_links(made: Any, opened: Any) -> None:
    """What the browser paints: the bar of a link ends in the circles of its pins, to a tenth of a unit as written."""
    view = opened(made("six-bar"))
    set_slider(view, 40)
    off = view.value(f"""() => {{
        const player = {PLAYER}, inverse = player.svg.getScreenCTM().inverse();
        const rocker = player.parts.find((part) => part.dataset.links === "rocker" && part.querySelector(".ck-bar1"));
        const bar = rocker.querySelector("path");
        const through = (length) => bar.getPointAtLength(length)
            .matrixTransform(bar.getScreenCTM()).matrixTransform(inverse);
        const ends = [through(0), through(bar.getTotalLength())];
        const pins = ["A", "B"].map((letter) => player.paper(player.place(letter)));
        const gaps = pins.map(([x, y]) => Math.min(...ends.map((end) => Math.hypot(end.x - x, end.y - y))));
        return Math.max(...gaps);
    }}""")
    assert off < 0.2


def test_keys_and_buttons_move_it(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    view.focus(".slider")
    start = view.value(f"{PLAYER}.pose")
    view.keyboard.press("ArrowRight")
    assert view.value(f"{PLAYER}.pose") == start + 1
    view.keyboard.press("End")
    assert view.value(f"{PLAYER}.pose") == 72
    view.click(".forth")
    assert view.value(f"{PLAYER}.pose") == 0
    view.click(".back")
    assert view.value(f"{PLAYER}.pose") == 72
    assert view.get_attribute(".slider", "aria-valuetext") == "crank 360°"
    assert view.text_content(".where") == "crank 360°"


def test_it_plays_and_stops(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    play = view.locator(".play")
    play.click()
    assert play.get_attribute("aria-pressed") == "true"
    assert play.text_content() == "Pause"
    until(view, f"{PLAYER}.pose > 3")
    part = "document.querySelector('.parts > g:last-child').getAttribute('transform')"
    view.value(f"window.before = {part}")
    until(view, f"{part} !== window.before")
    play.click()
    at = view.value(f"{PLAYER}.pose")
    view.wait_for_timeout(150)
    assert view.value(f"{PLAYER}.pose") == at
    assert play.get_attribute("aria-pressed") == "false"


@pytest.mark.full
def test_a_motion_that_does_not_close_goes_there_and_back(opened: Any, tmp_path: Path) -> None:
    motion = ck.solve(load("six-bar"), {"crank": ck.deg(range(0, 91, 10))})
    page(motion).save(tmp_path / "part.html")
    view = opened(tmp_path / "part.html")
    view.value("""() => {
        window.seen = [];
        compoundkin.players[0].data.seconds = 0.3;
        compoundkin.players[0].listeners.push((k) => window.seen.push(k));
    }""")
    view.click(".play")
    until(view, "seen.includes(9) && seen.indexOf(9) < seen.length - 1")
    seen = view.value("seen")
    peak = seen.index(9)
    after = seen[peak + 1]
    assert after < 9, "from the last pose it goes back"
    assert after > 0, "not to the first one at once"


def test_velocities_and_accelerations_are_those_of_the_solver(made: Any, opened: Any) -> None:
    motion = catalog.motion("six-bar")
    view = opened(made("six-bar"))
    set_slider(view, 17)
    for order, kind in ((1, "velocity"), (2, "acceleration")):
        for letter in ("G", "D", "A", "C"):
            x, y = view.value(f"([letter, order]) => {PLAYER}.rate(letter, order)", [letter, order])
            solved = complex(motion.points[letter].derivative(order)[17])
            assert abs(x + 1j * y - solved) < 2e-6 * abs(solved), (letter, kind)


def test_switches_show_and_hide(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    for key, selector in (
        ("velocity", ".velocities .ck-velocity-head"),
        ("acceleration", ".accelerations .ck-acceleration-head"),
        ("centres", ".dots .ck-centre"),
        ("path G", ".traces .ck-path"),
    ):
        assert view.locator(selector).count() == 0
        view.value("() => document.querySelector('.switches details').open = true")
        view.check(f"[data-show='{key}']")
        assert view.locator(selector).count() > 0, key
        view.uncheck(f"[data-show='{key}']")
        assert view.locator(selector).count() == 0, key
    assert view.locator(".name").first.is_visible()
    view.uncheck("[data-show=names]")
    assert not view.locator(".name").first.is_visible()
    assert view.complaints == []


def test_centres_are_drawn_where_they_are(made: Any, opened: Any) -> None:
    motion = catalog.motion("six-bar")
    view = opened(made("six-bar"))
    set_slider(view, 7)
    view.check("[data-show=centres]")
    dots = view.value(f"""() => [...document.querySelectorAll(".dots .ck-centre")].map((dot) => {{
        const window = {PLAYER}.data.window;
        return [dot.cx.baseVal.value / window.scale + window.x, window.y - dot.cy.baseVal.value / window.scale];
    }})""")
    centres = ck.instant_centres(motion)
    known = np.array([complex(centres[couple].point[7]) for couple in centres])
    assert len(dots) > 5
    for x, y in dots:
        assert np.abs(known[np.isfinite(known)] - (x + 1j * y)).min() < 1e-3


def test_the_path_of_a_point_is_its_coupler_curve(made: Any, opened: Any) -> None:
    motion = catalog.motion("jansen-leg")
    view = opened(made("jansen-leg"))
    view.value("() => document.querySelector('.switches details').open = true")
    view.check("[data-show='path foot']")
    d = view.get_attribute(".traces .ck-path", "d")
    window = view.value(f"{PLAYER}.data.window")
    places = [complex(*map(float, part.split())) for part in d[1:].split("L")]
    foot = np.asarray(motion.points["foot"].position)
    paper = np.conjugate((foot - (window["x"] + 1j * window["y"])) * window["scale"])
    np.testing.assert_allclose(places, paper, atol=0.01)


def test_plots_have_a_cursor_that_follows_and_leads(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    set_slider(view, 36)
    place = "[...document.querySelectorAll('.plot .cursor')].map(c => c.getBoundingClientRect().x)"
    at = view.value(place)
    assert len(at) >= 3
    over = view.locator(".plot .u-over").first
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    # crank 180 is in the middle of 0 to 360
    assert view.value(place)[0] == pytest.approx(box["x"] + box["width"] / 2, abs=2)
    view.mouse.move(box["x"] + box["width"] * 0.25, box["y"] + 40)
    view.mouse.down()
    assert view.value(f"{PLAYER}.pose") == 18
    view.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + 40)
    view.mouse.up()
    assert view.value(f"{PLAYER}.pose") == 54
    assert view.input_value(".slider") == "54"
    assert "crank 270°" in view.text_content(".where")


def test_plots_show_the_outputs(made: Any, opened: Any) -> None:
    motion = catalog.motion("six-bar")
    view = opened(made("six-bar"))
    data = view.value("compoundkin.players[0].plots.panels.map((panel) => panel.plot.data)")
    velocity = np.asarray(motion.points["G"].velocity)
    np.testing.assert_allclose(data[1][1], velocity.real, rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(data[1][2], velocity.imag, rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(data[1][3], np.abs(velocity), rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(data[0][0], np.arange(0, 361, 5), atol=1e-9)


def test_any_other_quantity_can_be_plotted(made: Any, opened: Any) -> None:
    motion = catalog.motion("six-bar")
    view = opened(made("six-bar"))
    before = view.locator(".plot").count()
    view.select_option(".quantity", "rocker.angular_acceleration")
    view.click(".add")
    assert view.locator(".plot").count() == before + 1
    data = view.value("compoundkin.players[0].plots.panels.at(-1).plot.data[1]")
    np.testing.assert_allclose(data, motion.links["rocker"].angular_acceleration, rtol=1e-6, atol=1e-5)
    view.select_option(".quantity", "A.position")
    view.click(".add")
    data = view.value("compoundkin.players[0].plots.panels.at(-1).plot.data[2]")
    np.testing.assert_allclose(data, motion.points["A"].y, atol=1e-9)
    view.locator(".remove").last.click()
    view.locator(".remove").last.click()
    assert view.locator(".plot").count() == before
    assert view.complaints == []


def test_every_choice_of_a_quantity_draws_a_plot(made: Any, opened: Any) -> None:
    view = opened(made("planetary-train"))
    names = view.value("[...document.querySelector('.quantity').options].map((option) => option.value)")
    assert len(names) > 10
    for name in names:
        drawn = view.value("name => compoundkin.players[0].plots.add(name).plot.data.slice(1)", name)
        assert all(value is None or np.isfinite(value) for row in drawn for value in row), name
        assert any(value is not None for row in drawn for value in row), name
    assert view.complaints == []


def test_poses_that_cannot_be_assembled_are_said(opened: Callable[..., Any], tmp_path: Path) -> None:
    rocker = ck.with_driver(load("crank-rocker"), "rocker")
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(rocker, {rocker.drives[0].name: ck.deg(range(0, 360, 5))})
    page(motion).save(tmp_path / "rocker.html")
    view = opened(tmp_path / "rocker.html")
    missing = int(np.flatnonzero(~motion.assembled)[0])
    set_slider(view, missing)
    assert "cannot be assembled" in view.text_content(".said")
    assert "unassembled" in view.get_attribute(".sketch", "class")
    assert "cannot be assembled" in view.get_attribute(".slider", "aria-valuetext")
    set_slider(view, int(np.flatnonzero(motion.assembled)[0]))
    assert view.text_content(".said") == ""
    gaps = view.value("compoundkin.players[0].plots.panels[0].plot.data[1].filter((value) => value === null).length")
    assert gaps == int((~motion.assembled).sum())
    assert view.complaints == []


@pytest.mark.full
def test_names_grow_on_a_small_screen(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"), size=(360, 740))
    tall = view.value("document.querySelector('.name text').getBoundingClientRect().height")
    assert tall >= 10
    assert view.value("document.scrollingElement.scrollWidth") <= 360


@pytest.mark.full
def test_a_driver_that_goes_back_and_forth_is_plotted_over_poses(opened: Callable[..., Any], tmp_path: Path) -> None:
    there = np.concatenate([np.arange(0, 91, 10), np.arange(80, -1, -10)])
    page(ck.solve(load("six-bar"), {"crank": ck.deg(there)})).save(tmp_path / "back.html")
    view = opened(tmp_path / "back.html")
    assert view.value("compoundkin.players[0].plots.panels[0].plot.data[0]") == list(range(19))
    page(ck.solve(load("six-bar"), {"crank": ck.deg(range(90, -1, -10))})).save(tmp_path / "down.html")
    view = opened(tmp_path / "down.html")
    np.testing.assert_allclose(
        view.value("compoundkin.players[0].plots.panels[0].plot.data[0]"), range(0, 91, 10), atol=1e-9
    )
    set_slider(view, 2)
    assert "crank 70°" in view.text_content(".where")


def test_the_player_of_a_notebook_plays(opened: Callable[..., Any], tmp_path: Path) -> None:
    motion = catalog.motion("six-bar")
    (tmp_path / "alone.html").write_text(player(motion), encoding="utf-8")
    view = opened(tmp_path / "alone.html")
    set_slider(view, 30)
    assert abs(view.drawn("G")["G"] - motion.points["G"].position[30]) < 1e-6
    framed = motion._repr_html_()
    assert framed is not None
    (tmp_path / "notebook.html").write_text(f"<!DOCTYPE html><title>n</title>{framed}", encoding="utf-8")
    view = opened(tmp_path / "notebook.html")
    inside = view.frame_locator("iframe")
    inside.locator(".play").click()
    view.wait_for_timeout(300)
    assert inside.locator(".play").text_content() == "Pause"
    assert inside.locator(".where").text_content() != "crank 0°"
    assert view.complaints == []


NEARER = """() => {
  const player = compoundkin.players[0], found = new Set(), pixels = player.svg.getScreenCTM().a;
  let told = 0;
  for (let k = 0; k < player.poses; k++) {
    if (player.assembled[k] !== 1) continue;
    player.show(k);
    const points = Object.keys(player.points).map((letter) => [letter, player.paper(player.place(letter))]);
    for (const [index, part] of player.parts.entries()) {
      const letter = part.classList.contains("name") && part.dataset.letter;
      if (!letter) continue;
      told += 1;
      // from the picture: the group is at the point, the text beside it
      const [x, y, by] = [...part.getAttribute("transform").matchAll(/-?[\\d.]+(?:e-?\\d+)?/g)].map(Number).concat(1);
      const text = part.querySelector("text"), off = ["x", "y"].map((name) => Number(text.getAttribute(name)) * by);
      const own = Math.hypot(...off), led = [...player.svg.querySelectorAll(".leaders line")].some((line) =>
        Math.hypot(line.x2.baseVal.value - x, line.y2.baseVal.value - y) < 0.1);
      if (own * pixels > 24 && !led) found.add(`${letter} is ${Math.round(own * pixels)} px from its point at ${k}`);
      for (const [other, at] of points) {
        if (other === letter || Math.hypot(at[0] - x, at[1] - y) <= 1 || led) continue;
        const away = Math.hypot(at[0] - x - off[0], at[1] - y - off[1]);
        if (away < own) found.add(`${letter} is nearer to ${other} at ${k}`);
      }
    }
  }
  return [told, [...found]];
}"""


SIZED = """([width, height]) => {
  const player = compoundkin.players[0];
  Object.assign(player.svg.style, { width: `${width}px`, maxHeight: `${height}px` });
  player.fit();
}"""
SKETCH = f"(() => {{ const box = {PLAYER}.svg.getBoundingClientRect(); return [box.width, box.height]; }})()"
# Room for the sketch on a page: as wide and at most as high, in pixels.
ROOM = {DESK: (887, 604), PHONE: (310, 444)}


def assert_letters_are_near(view: Any) -> None:
    """At every pose; a letter farther than 24 pixels has a line to its point."""
    told, wrong = view.value(NEARER)
    assert told
    assert wrong == []


@pytest.mark.parametrize("name", ["jaw-crusher", pytest.param("hydraulic-digger", marks=pytest.mark.full)])
def test_no_letter_is_nearer_to_another_point_than_to_its_own(name: str, made: Any, opened: Any) -> None:
    """On a desk and a phone."""
    for size in (DESK, PHONE):
        view = opened(made(name), size)
        assert_letters_are_near(view)
        width, height = view.value(SKETCH)
        assert width == pytest.approx(ROOM[size][0], abs=1)
        assert height <= ROOM[size][1] + 1


@pytest.fixture(scope="module")
def window(contexts: Callable[..., Any]) -> Iterator[Any]:
    """One window for many players: a new one costs more than what is asked of each."""
    opened = contexts(DESK, "").new_page()
    yield opened
    opened.close()


@pytest.mark.full
@catalog.each(name for name in catalog.NAMES[::3] if name not in {"jaw-crusher", "hydraulic-digger"})
def test_no_letter_of_many_mechanisms_is_nearer_to_another_point(name: str, window: Any, tmp_path: Path) -> None:
    """In the sketch alone, as large as on a page: a page with all its tables takes three times as long."""
    path = tmp_path / f"{name}.html"
    path.write_text(player(catalog.motion(name)), encoding="utf-8")
    window.goto(path.as_uri())
    for room in ROOM.values():
        window.evaluate(SIZED, room)
        told, wrong = window.evaluate(NEARER)
        assert told
        assert wrong == []


# Counts what listens to the document and the window, what is observed, and what waits for a time or a picture.
COUNTED = """
(() => {
  const counts = window.counts = { heard: new Set(), observed: new Set(), waits: new Set() };
  const { addEventListener: add, removeEventListener: remove } = EventTarget.prototype;
  EventTarget.prototype.addEventListener = function (kind, run, how) {
    const one = { target: this, kind, run };
    if (!how?.once && !how?.signal?.aborted && !(this instanceof AbortSignal)) counts.heard.add(one);
    how?.signal?.addEventListener("abort", () => counts.heard.delete(one));
    return add.call(this, kind, run, how);
  };
  EventTarget.prototype.removeEventListener = function (kind, run, how) {
    const isIt = (one) => one.target === this && one.kind === kind && one.run === run;
    for (const one of counts.heard) if (isIt(one)) counts.heard.delete(one);
    return remove.call(this, kind, run, how);
  };
  for (const name of ["ResizeObserver", "MutationObserver", "IntersectionObserver"]) {
    const { observe, disconnect } = window[name].prototype;
    window[name].prototype.observe = function (...given) {
      counts.observed.add(this);
      return observe.apply(this, given);
    };
    window[name].prototype.disconnect = function () { counts.observed.delete(this); return disconnect.call(this); };
  }
  for (const [begin, end] of [["setTimeout", "clearTimeout"], ["requestAnimationFrame", "cancelAnimationFrame"]]) {
    const [own, stop] = [window[begin], window[end]];
    window[begin] = (run, ...more) => {
      const id = own((...given) => { counts.waits.delete(key); run(...given); }, ...more), key = `${begin} ${id}`;
      counts.waits.add(key);
      return id;
    };
    window[end] = (id) => { counts.waits.delete(`${begin} ${id}`); stop(id); };
  }
  window.counted = () => {
    // what listens inside the markup of a player that has gone goes with it
    const outside = [...counts.heard].filter(({ target }) => !(target instanceof Node) || document.contains(target));
    return [outside.length, counts.observed.size, counts.waits.size];
  };
})();
"""


def test_players_are_mounted_and_unmounted_and_leave_nothing_behind(
    made: Callable[[str], Path], opened: Callable[..., Opened]
) -> None:
    """Two pages' players in one document: each has its own design, and one that has gone listens to nothing more."""
    view = opened(made("six-bar"), script=COUNTED)
    until(view, "compoundkin.players.length === 1 && counts.waits.size === 0")
    before, other = view.value("counted()"), made("crank-rocker").read_text(encoding="utf-8")
    view.value(
        """html => {
          const whole = new DOMParser().parseFromString(html, "text/html"), root = whole.querySelector(".player");
          document.querySelector(".player").after(document.adoptNode(root));
          window.other = compoundkin.mount(root, JSON.parse(whole.getElementById("ck-motion").textContent));
        }""",
        other,
    )
    one, two = "compoundkin.players[0]", "compoundkin.players[1]"
    assert view.value("counted()[0]") > before[0]
    assert view.value("counted()[1]") > before[1]
    # each moves and changes by itself; a key of one is no key of the other
    view.value(f"() => {{ {two}.design.change({{ 'crank.B.x': 22 }}); {two}.design.commit(''); {two}.show(3); }}")
    assert view.value(f"[{one}.design.isChanged, {two}.design.isChanged, {one}.pose === 3]") == [False, True, False]
    # while it plays, is dragged and is about to draw what it was told
    view.value(
        f"() => {{ {one}.transport.start(); {two}.transport.start(); {two}.design.soon({{ 'crank.B.x': 23 }}); }}"
    )
    handle = view.locator(".handle.point").last
    handle.focus()
    handle.press("Enter")
    view.value("() => { const { root } = other; other.unmount(); root.remove(); }")
    assert view.value("[compoundkin.players.length, other.transport.playing]") == [1, False]
    assert view.value(f"{one}.transport.playing")
    view.value(f"{one}.transport.stop()")
    until(view, "counts.waits.size === 0")
    assert view.value("counted()") == before
    # the one that stays goes on, alone
    pose = view.value("other.pose")
    view.keyboard.press("Control+z")
    view.value(f"() => {{ {one}.design.change({{ 'crank.D.x': 15 }}); {one}.design.commit(''); {one}.show(5); }}")
    assert view.value(f"[{one}.design.isChanged, {one}.pose, other.pose]") == [True, 5, pose]
    assert view.complaints == []
