"""Dimensions dragged in the sketch: by pointer, touch and keyboard; the way back; what is shown is what is solved."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.programs.dimensions import StatedDimensions, mechanism_with
from compoundkin.view.page import player
from tests import catalog

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")

PLAYER = "compoundkin.players[0]"
VALUES = f"Object.fromEntries({PLAYER}.design.names.map((name, k) => [name, {PLAYER}.design.numbers[k]]))"
LINKS = f"{PLAYER}.links.map((link) => [link.name, [...link.x], [...link.y], [...link.angle]])"

# Random points dragged at random poses, each there and on again; of the quicker half of them how long one takes.
DRAGS = """([count, seed]) => {
  const player = compoundkin.players[0], { drag, design } = player;
  const random = () => (seed = (seed * 1664525 + 1013904223) % 4294967296) / 4294967296;
  let done = 0;
  for (let n = 0; n < count; n++) {
    player.show(Math.floor(random() * player.poses));
    const seen = drag.handles.all.filter((one) => one.kind === "point" && !one.button.hidden);
    if (player.assembled[player.pose] !== 1 || !seen.length) { design.undo(); continue; }
    const one = seen[Math.floor(random() * seen.length)], [x, y] = player.place(one.name), by = 12 * drag.handles.pixel;
    drag.take(one, "pointer");
    const away = () => by * (random() - 0.5);
    for (const part of [0.5, 1]) drag.held.move([x + part * away(), y + part * away()], random() < 0.5);
    drag.drop();
    done += 1;
  }
  return done;
}"""

# Every dimension goes out into gaps by itself, and back: how often a pose is then another one.
GAPS = """() => {
  const { design, links } = compoundkin.players[0], size = design.path.data.size;
  const shown = () => links.flatMap(({ x, y }) => [...x, ...y]), before = shown();
  design.commit("");
  return design.names.map((name) => {
    const own = design.value(name);
    for (const by of [0.3, 1, 3, -2, 0.6, 0]) design.change({ [name]: own + by * size });
    const isSame = (one, other) => Math.abs(one - other) < 1e-9 * size || [one, other].every(Number.isNaN);
    return shown().filter((one, k) => !isSame(one, before[k])).length;
  });
}"""


def changed(view: Any, motion: ck.results.Motion) -> ck.results.Motion:
    """The motion of the dimensions that a page has, solved anew at the page's poses."""
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    values = {stated.known[name]: value for name, value in view.value(VALUES).items()}
    values = {one: value for one, value in values.items() if value != np.ravel(stated.own(one))[0]}
    poses = np.array(view.value(f"[...{PLAYER}.indices]"), int)
    drives = {name: np.broadcast_to(v[0], motion.failed.shape)[0][poses] for name, v in motion.inputs.drives.items()}
    # the page keeps the assembly modes: those of a drawing of any of its poses
    pose = f"[...{PLAYER}.assembled].indexOf(1)"
    places = view.value(f"Object.keys({PLAYER}.points).map((name) => [name, {PLAYER}.place(name, {pose})])")
    drawing = ck.drawn(**dict(places))
    return ck.solve(mechanism_with(stated, values).replace(drawing), drives, speed=10)


def middle(view: Any, label: str) -> tuple[float, float]:
    box = view.locator(f".handle[aria-label='{label}']").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(view: Any, label: str, by: tuple[float, float]) -> None:
    x, y = middle(view, label)
    view.mouse.move(x, y)
    view.mouse.down()
    view.mouse.move(x + by[0] / 2, y + by[1] / 2)
    view.mouse.move(x + by[0], y + by[1])
    view.wait_for_timeout(40)


def is_changed(view: Any) -> bool:
    return bool(view.value(f"{PLAYER}.design.isChanged"))


@pytest.mark.parametrize(
    "name",
    [*(pytest.param(name, marks=pytest.mark.full) for name in ("geared-five-bar", "class-iii-six-bar")), "six-bar"],
)
def test_after_a_hundred_drags_all_links_are_where_the_solver_has_them(name: str, opened: Any, tmp_path: Path) -> None:
    motion = catalog.motion(name)
    (tmp_path / "alone.html").write_text(player(motion), encoding="utf-8")
    view = opened(tmp_path / "alone.html", (800, 900))
    assert view.value(DRAGS, [100, 7]) > 60
    solved = changed(view, motion)
    known = np.array(view.value(f"[...{PLAYER}.assembled]")) == 1
    np.testing.assert_array_equal(known, np.ravel(solved.assembled))
    assert known.any()
    for link, *shown in view.value(LINKS):
        x, y, angle = (np.array(part, float) for part in shown)
        off = x + 1j * y - np.ravel(solved.links[link].origin.position)
        turned = np.exp(1j * angle) - np.exp(1j * np.ravel(solved.links[link].angle))
        assert np.abs(off[known]).max() < 1e-9 * motion.size, link
        assert np.abs(turned[known]).max() < 1e-9, link
    # what is lost in gaps is there again when they are left
    assert not any(view.value(GAPS))
    assert view.complaints == []


def test_a_point_is_dragged_and_there_is_a_way_back(made: Any, opened: Any) -> None:
    view, motion = opened(made("six-bar")), catalog.motion("six-bar")
    view.click(".play")
    drag(view, "Point F", (5.0, 5.0))
    # the motion stands still while a point is held
    assert view.get_attribute(".play", "aria-pressed") == "false"
    view.keyboard.press("Escape")
    view.mouse.up()
    assert not is_changed(view)
    view.value(f"{PLAYER}.show(9)")
    drag(view, "Point D", (33.0, -31.0))
    # beside it stand its place and the lengths on its links
    told = view.text_content(".numbers")
    assert all(length in told for length in ("crank ED", "plate AD", "plate CD"))
    at = view.value(f"{PLAYER}.drag.held.now")
    view.mouse.up()
    assert not view.locator(".numbers").is_visible()
    k, solved = 9, changed(view, motion)
    # the point is where it was put, the pins of the sketch too, and all other points are where they were
    for letter in "ABCDEFG":
        place = motion.points[letter].position[k] if letter != "D" else complex(*at)
        assert abs(view.drawn(letter)[letter] - place) < 1e-4, letter
        assert abs(view.drawn(letter)[letter] - solved.points[letter].position[k]) < 1e-9
    # the original stands behind, where it was
    ghost = view.value("document.querySelector('.sketch .former').childElementCount")
    assert ghost == view.locator(".parts > g:not(.name)").count()
    # rates are the new ones, and so are instant centres
    np.testing.assert_allclose(
        np.array(view.value(f"{PLAYER}.rate('G', 1)")) @ [1, 1j], solved.points["G"].velocity[k], rtol=1e-9
    )
    centres = ck.instant_centres(solved)
    for links in [("plate", "rocker"), ("crank", "rocker"), ("bar", "block"), ("bar", "plate")]:
        own = "centres.find((one) => links.every((name) => one.links.includes(name)))"
        x, y, w = view.value(f"links => {PLAYER}.overlays.centres.pole({PLAYER}.{own})", list(links))
        centre = centres[links]
        if centre.at_infinity[k]:
            assert w == 0
        else:
            assert abs(complex(x, y) / w - centre.point[k]) < 1e-6
    # a crank is turned by its bar; pressed without that, it lights up its link for good
    x, y = (sum(pair) / 2 for pair in zip(middle(view, "Point E"), middle(view, "Point D"), strict=True))
    view.mouse.click(x + 3, y)
    assert view.locator(".pinned").is_visible()
    view.keyboard.press("Escape")
    view.mouse.down()
    view.mouse.move(x - 20, y - 20)
    view.mouse.move(x - 40, y - 20)
    view.mouse.up()
    assert view.value(f"{PLAYER}.pose") > 9
    assert not view.locator(".pinned").is_visible()
    view.value(f"{PLAYER}.show(9)")
    first = view.value(VALUES)
    drag(view, "Point B", (4.0, 20.0))
    view.keyboard.press("Escape")
    view.mouse.up()
    assert view.value(VALUES) == first
    drag(view, "Point F", (-12.0, 9.0))
    view.mouse.up()
    second = view.value(VALUES)
    assert {name for name in first if first[name] != second[name]} == {"frame.F.x", "frame.F.y", "bar.F.x"}
    assert second["bar.F.y"] == 0  # it was near the line of the bar, and is drawn to it
    view.keyboard.press("Control+z")
    assert view.value(VALUES) == first
    view.keyboard.press("Control+z")
    assert not is_changed(view)
    assert view.locator(".sketch .former").count() == 0
    view.keyboard.press("Control+y")
    view.keyboard.press("Control+Shift+z")
    assert view.value(VALUES) == second
    view.get_by_role("button", name="Original").click()
    assert not is_changed(view)
    assert view.value(f"{PLAYER}.outputs[0].parts.x[9]") == pytest.approx(motion.points["G"].x[9], rel=1e-7)
    view.get_by_role("button", name="Undo").click()
    assert view.value(VALUES) == second
    assert view.complaints == []


@pytest.mark.full
def test_the_keyboard_alone_changes_a_dimension(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    view.focus(".handles [tabindex='0']")
    view.keyboard.press("ArrowRight")
    view.keyboard.press("ArrowRight")
    view.keyboard.press("ArrowRight")
    assert view.value("document.activeElement.getAttribute('aria-label')") == "Point D"
    # one stop of the tab key for all of them
    assert view.locator(".handles [tabindex='0']").count() == 1
    step = view.value(f"compoundkin.gridStep({PLAYER}.drag.handles.pixel)")
    view.keyboard.press("Enter")
    assert view.value("document.activeElement.getAttribute('aria-pressed')") == "true"
    for key in ("ArrowRight", "Shift+ArrowUp", "Alt+ArrowLeft"):
        view.keyboard.press(key)
    view.keyboard.press("Enter")
    x, y = (view.value(f"{PLAYER}.design.value('crank.D.{part}')") for part in "xy")
    assert (x, y) == pytest.approx((14 + 0.9 * step, 10 * step))
    view.keyboard.press("Space")
    view.keyboard.press("ArrowUp")
    for _ in range(40):
        view.wait_for_timeout(50)
        if view.text_content(".spoken").startswith("D "):
            break
    assert "crank ED" in view.text_content(".spoken")
    view.keyboard.press("Escape")
    assert view.value(f"{PLAYER}.design.value('crank.D.y')") == y
    view.keyboard.press("Control+z")
    assert not is_changed(view)
    # a gap has its reason beside the sketch
    view.value(f"{PLAYER}.design.change({{ 'rocker.A.x': 5 }})")
    view.value(f"{PLAYER}.show([...{PLAYER}.assembled].indexOf(0))")
    assert "cannot be assembled" in view.text_content(".said")
    assert view.text_content(".reason").startswith("RRR")
    view.get_by_role("button", name="Undo").click()
    assert view.text_content(".reason") == ""
    assert view.complaints == []


@pytest.mark.full
def test_a_finger_drags_points_and_a_crank(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"), (360, 740), has_touch=True, is_mobile=True)
    view.locator(".handles").scroll_into_view_if_needed()
    touch = view.context.new_cdp_session(view.view)

    def swipe(x: float, y: float, dx: float, dy: float) -> None:
        for kind, part in (("touchStart", 0.0), ("touchMove", 0.5), ("touchMove", 1.0), ("touchEnd", None)):
            points = [] if part is None else [{"x": x + part * dx, "y": y + part * dy}]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
            view.wait_for_timeout(30)

    assert min(view.locator(".handle").first.bounding_box()[side] for side in ("width", "height")) >= 24
    before = view.value("scrollY")
    swipe(*middle(view, "Point A"), -20.0, -30.0)
    assert is_changed(view)
    assert view.value("scrollY") == before
    values, pose = view.value(VALUES), view.value(f"{PLAYER}.pose")
    swipe(*middle(view, "Driver crank"), -10.0, -40.0)
    assert view.value(f"{PLAYER}.pose") != pose
    assert view.value(VALUES) == values
    assert view.value("document.scrollingElement.scrollWidth") <= 360


def test_of_two_drivers_each_is_dragged_on_its_own(opened: Any, tmp_path: Path) -> None:
    motion = ck.solve(load("five-bar"))
    (tmp_path / "two.html").write_text(player(motion), encoding="utf-8")
    view = opened(tmp_path / "two.html", (800, 900))
    k = view.value(f"{PLAYER}.pose")
    left, right = (view.value(f"{PLAYER}.drivers[{which}].parts[''][{k}]") for which in (0, 1))
    drag(view, "Driver left", (-30.0, 0.0))
    view.mouse.up()
    moved = view.value(f"{PLAYER}.drivers[0].parts[''][{k}]")
    assert abs(moved - left) > 2
    assert view.value(f"{PLAYER}.drivers[1].parts[''][{k}]") == right
    alone = ck.solve(motion.mechanism, {"left": ck.deg(moved), "right": ck.deg(right)})
    for letter in "BPD":
        assert abs(view.drawn(letter)[letter] - complex(alone.points[letter].position)) < 1e-9
    view.click(".forth")
    view.click(".back")
    assert view.value(f"{PLAYER}.drivers[0].parts[''][{k}]") == left
    assert abs(view.drawn("P")["P"] - motion.points["P"].position[k]) < 1e-9
    assert view.complaints == []


def test_with_shift_one_length_alone_changes_and_what_is_locked_stays(made: Any, opened: Any) -> None:
    """Of the two links at D, Shift lengthens the crank; a locked length is kept while its point goes where it may."""
    view = opened(made("six-bar"))
    own = view.value(VALUES)

    def dragged(by: tuple[float, float], shift: bool = False) -> dict[str, float]:
        if shift:
            view.keyboard.down("Shift")
        drag(view, "Point D", by)
        view.mouse.up()
        if shift:
            view.keyboard.up("Shift")
        view.wait_for_timeout(100)
        found = {name: value for name, value in view.value(VALUES).items() if value != own[name]}
        view.value(f"() => {PLAYER}.design.reset()")
        return found

    lengthened = dragged((40, 3), shift=True)
    assert lengthened.keys() == {"crank.D.x"}
    assert lengthened["crank.D.x"] > own["crank.D.x"]
    assert dragged((40, 25)).keys() == {"crank.D.x", "crank.D.y", "plate.D.x", "plate.D.y"}
    view.get_by_role("button", name="Lock length from E to D of crank").click()
    view.value("() => scrollTo(0, 0)")
    held = dragged((40, 25))
    assert np.hypot(held["crank.D.x"], held["crank.D.y"]) == pytest.approx(own["crank.D.x"], rel=1e-12)
    assert "plate.D.x" in held
    assert view.complaints == []
