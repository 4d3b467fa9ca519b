"""The view of the sketch: enlarged and moved by buttons, keys, wheel and pointer; its text legible at any width."""

from __future__ import annotations

from typing import Any

import pytest

BOX = """() => document.querySelector("svg.sketch").getAttribute("viewBox").split(" ").map(Number)"""
SMALLEST = """() => Math.min(...[...document.querySelectorAll("svg.sketch .parts text")].map((text) =>
    parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a))"""


def test_the_view_is_enlarged_moved_and_fitted_again(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    x, _, width, _ = whole = view.value(BOX)
    view.get_by_role("button", name="Larger").click()
    assert view.value(BOX)[2] == pytest.approx(width / 1.4)
    view.focus("svg.sketch")
    view.keyboard.press("+")
    view.keyboard.press("ArrowRight")
    moved = view.value(BOX)
    assert moved[2] == pytest.approx(width / 1.96)
    assert moved[0] > x + (width - moved[2]) / 2
    assert view.value(SMALLEST) >= 11.99
    view.keyboard.press("0")
    assert view.value(BOX) == pytest.approx(whole)
    # the wheel alone scrolls the page; with Ctrl the place below the pointer stays where it is
    box = view.locator("svg.sketch").bounding_box()
    at = round(box["x"] + box["width"] / 4), round(box["y"] + box["height"] / 4)
    view.mouse.move(*at)
    place = "at => { const p = compoundkin.players[0].viewBox.place(at); return [p.x, p.y]; }"
    before = view.value(place, at)
    view.keyboard.down("Control")
    view.mouse.wheel(0, -300)
    view.keyboard.up("Control")
    view.wait_for_function(f"() => ({BOX})()[2] < {width * 0.9}")
    assert view.value(place, at) == pytest.approx(before, abs=0.01)
    # empty ground is dragged, and the picture goes with it
    start = view.value(BOX)
    view.mouse.down()
    view.mouse.move(at[0] - 30, at[1])
    view.mouse.up()
    assert view.value(BOX)[0] > start[0]
    assert view.value(place, (at[0] - 30, at[1])) == pytest.approx(before, abs=0.01)
    view.get_by_role("button", name="The whole sketch").click()
    assert view.value(BOX) == pytest.approx(whole)
    assert view.complaints == []


@pytest.mark.full
def test_text_in_the_sketch_is_legible_at_any_width(made: Any, opened: Any) -> None:
    view, player = opened(made("six-bar"), size=(360, 740)), "compoundkin.players[0]"
    for width in (360, 768, 1440):
        view.set_viewport_size({"width": width, "height": 740})
        view.wait_for_timeout(100)
        assert view.value(SMALLEST) >= 11.99
        assert view.value(f"{player}.svg.clientWidth / {player}.root.clientWidth") > 0.99


MEASURED = """() => {
  const [player] = compoundkin.players, own = SVGGraphicsElement.prototype.getScreenCTM;
  let asked = 0;
  SVGGraphicsElement.prototype.getScreenCTM = function () { asked++; return own.call(this); };
  const known = () => [asked, player.letters.pixels / own.call(player.svg).a];
  const found = [];
  for (const change of [() => {}, () => player.viewBox.by(2), () => player.viewBox.fit()]) {
    change();
    player.show((player.pose + 1) % player.poses);
    asked = 0;
    for (let k = 0; k < 10; k++) player.show((player.pose + 1) % player.poses);
    found.push(known());
  }
  SVGGraphicsElement.prototype.getScreenCTM = own;
  return found;
}"""


def test_the_view_is_measured_where_it_changes_and_not_at_each_pose(made: Any, opened: Any) -> None:
    """To ask at each pose how large a picture unit is makes the browser lay the page out anew each time."""
    view = opened(made("six-bar"))
    for asked, ratio in view.value(MEASURED):
        assert asked == 0
        assert ratio == pytest.approx(1.0, rel=1e-6)
