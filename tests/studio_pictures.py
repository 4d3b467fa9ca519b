"""The pictures of the page about the studio, and the film at the head of the README, made by the tests' own browser.

Run `python -m tests.studio_pictures` to write them all, or with names of some.
"""

from __future__ import annotations

import io
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

from tests.studio.test_answers import shipped_text
from tests.view.page.conftest import BROWSERS, FLAGS
from tests.view.page.test_studio import (
    A,
    B,
    C,
    D,
    Window,
    digger_arm,
    middle_of,
    quick_return,
    served_studio,
    six_bar,
)
from tests.view.page.test_studio_pen import egg, sketched

FOLDER = Path(__file__).parents[1] / "docs" / "figures"
SIZE = {"width": 1400, "height": 800}
# The film: its width in pixels, milliseconds of a frame, of a rest.
WIDTH, FRAME, REST = 860, 90, 1100
UNCHOSEN = (
    "() => { studio.canvas.chosen = studio.canvas.over = null; studio.canvas.picked.clear(); studio.canvas.draw(); }"
)
# A machine in grey on a bench, three arms between four pins, at the pixels of its picture.
PHOTOGRAPHED = """async () => {
  const [wide, high] = studio.canvas.size, scale = 0.8 * Math.min(wide / 900, high / 540);
  const sheet = Object.assign(document.createElement("canvas"), { width: 900, height: 540 });
  const to = sheet.getContext("2d");
  const bench = to.createLinearGradient(0, 0, 900, 540);
  bench.addColorStop(0, "#c9b391"); bench.addColorStop(1, "#8f7757");
  to.fillStyle = bench; to.fillRect(0, 0, 900, 540);
  const pins = [[-150, 60], [-60, -60], [110, -20], [150, 85]].map(([x, y]) => [450 + x / scale, 270 + y / scale]);
  to.lineCap = "round";
  to.shadowColor = "rgba(0,0,0,.5)"; to.shadowBlur = 16; to.shadowOffsetY = 8;
  for (const [color, k] of [["#596066", 0], ["#7c858c", 1], ["#4b5156", 2]]) {
    to.strokeStyle = color; to.lineWidth = 46;
    to.beginPath(); to.moveTo(...pins[k]); to.lineTo(...pins[k + 1]); to.stroke();
  }
  to.fillStyle = "#d9dde0";
  for (const [x, y] of pins) { to.beginPath(); to.arc(x, y, 13, 0, 7); to.fill(); }
  const blob = await new Promise((take) => sheet.toBlob(take));
  await studio.gestures.photograph(new File([blob], "machine.png", { type: "image/png" }));
}"""
# A pointer and a caption, as a film has none of its own.
ACTORS = """() => {
  const add = (text, style) => {
    const node = document.createElement("div");
    node.textContent = text;
    Object.assign(node.style, { position: "fixed", zIndex: 9, pointerEvents: "none", ...style });
    document.body.append(node);
    return node;
  };
  const round = { width: "18px", height: "18px", margin: "-9px", borderRadius: "50%", left: "-99px", top: "0" };
  window.cursor = add("", { ...round, background: "rgba(220,80,0,.55)" });
  const dark = { padding: "6px 14px", borderRadius: "10px", background: "rgba(20,24,32,.88)", color: "white" };
  window.caption = add("", { ...dark, left: "24px", bottom: "120px", font: "600 19px system-ui, sans-serif" });
}"""


@contextmanager
def window(title: str) -> Iterator[Window]:
    """An empty studio in a browser of its own."""
    found = next(where for name in BROWSERS if (where := shutil.which(name)))
    with sync_playwright() as driver, served_studio() as served:
        browser = driver.chromium.launch(executable_path=found, args=list(FLAGS))
        served.text = f'format = 1\ntitle = "{title}"\n'
        served.path = Path(f"{title.lower().replace(' ', '-')}.toml")
        yield Window(browser.new_page(viewport=SIZE), served)
        browser.close()


def written(name: str, seen: Window) -> None:
    """Write what the window shows, in few colours; its panels have come by then."""
    seen.until("document.querySelector('#dimensions-box').hidden || document.querySelector('#dimensions').innerText")
    picture = Image.open(io.BytesIO(seen.view.screenshot())).convert("RGB")
    picture.quantize(64, dither=Image.Dither.NONE).save(FOLDER / f"{name}.png", optimize=True)


def rested(seen: Window) -> None:
    """Choose nothing, and take the pointer away."""
    seen.view.mouse.move(1, 1)
    seen.value(UNCHOSEN)


def drawing() -> None:
    """Five gestures to a four-bar: the first bars, what snaps, and how it moves."""
    with window("Four-bar") as seen:
        seen.drag(A, B)
        seen.hold(B, (B[0] + 103, B[1] + 48))
        written("studio-snap", seen)
        seen.view.keyboard.press("Escape")
        seen.view.mouse.up()
        seen.drag(B, C)
        seen.drag(C, D)
        rested(seen)
        written("studio-bars", seen)
        for place, key in ((A, "g"), (D, "g"), (A, "d")):
            seen.press(place, key)
        rested(seen)
        seen.value("() => studio.pose(60)")
        written("studio-moves", seen)
        seen.value("() => { studio.canvas.pose = null; studio.canvas.draw(); }")
        seen.menu(C)
        written("studio-menu", seen)
        seen.view.keyboard.press("Escape")
        rested(seen)
        seen.hold(B, (B[0] + 12, B[1] - 24), "Control")
        seen.view.wait_for_timeout(400)
        written("studio-lengthen", seen)
        seen.view.mouse.up()
        seen.view.keyboard.up("Control")
        seen.settle()


def shaper() -> None:
    with window("Quick return") as seen:
        quick_return(seen)
        rested(seen)
        seen.value("() => studio.pose(40)")
        written("studio-slot", seen)


def digger() -> None:
    with window("Digger arm") as seen:
        digger_arm(seen)
        rested(seen)
        seen.value("() => studio.pose(200)")
        written("studio-cylinders", seen)


def gears() -> None:
    with window("Gears") as seen:
        seen.drag((-160, 60), (-160, 0))
        seen.drag((80, 60), (80, -20))
        seen.press((-160, 60), "g")
        seen.press((80, 60), "g")
        seen.view.mouse.click(*seen.at((-160, 60)))
        seen.menu((80, 60)).get_by_role("menuitem", name="Gears or a belt at A and C").click()
        form = seen.view.locator("dialog")
        form.get_by_label("On, at A").select_option("bar1")
        form.get_by_label("On, at C").select_option("bar2")
        written("studio-form", seen)
        form.get_by_role("button", name="Do it").click()
        seen.settle()
        seen.press((-160, 60), "d")
        rested(seen)
        seen.value("() => { studio.pose(30); studio.canvas.fit(); }")
        written("studio-gears", seen)


def cam() -> None:
    """A bar that swings about a fixed point, led by a cam at another."""
    with window("Cam") as seen:
        seen.drag((220, 40), (0, -60))
        seen.press((220, 40), "g")
        seen.pick((0, 100), "A fixed point here")
        seen.view.mouse.click(*seen.at((0, 100)))
        seen.pick((0, -60), "Cam at C that leads B")
        form = seen.view.locator("dialog")
        form.get_by_role("button", name="Do it").click()
        seen.settle()
        seen.press((0, 100), "d")
        rested(seen)
        seen.value("() => { studio.pose(75); studio.canvas.fit(); }")
        written("studio-cam", seen)


def locks() -> None:
    """The crank's length and the right pivot are locked while the coupler's end is dragged."""
    with window("Locks") as seen:
        for start, end in ((A, B), (B, C), (C, D)):
            seen.drag(start, end)
        for place, key in ((A, "g"), (D, "g"), (A, "d"), (D, "l"), (middle_of(A, B), "l")):
            seen.press(place, key)
        rested(seen)
        seen.hold(B, (B[0] + 60, B[1] - 10), "Shift")
        seen.view.wait_for_timeout(500)
        written("studio-locks", seen)
        seen.view.mouse.up()
        seen.view.keyboard.up("Shift")
        seen.settle()


def forces() -> None:
    """A press of the catalog with its load."""
    with window("Press") as seen:
        seen.value(
            "t => { studio.isFitted = false; studio.isOpened = true; studio.put(t); }",
            shipped_text("toggle-press-loaded"),
        )
        seen.until("studio.isSettled && studio.motion?.poses > 0")
        seen.view.locator("#show-forces").click()
        for ask in ("circuits", "forces"):
            seen.view.locator(f"#results-{ask} > summary").click()
        seen.until("[...document.querySelectorAll('#results-circuits .branch, #results-forces img')].length > 5")
        seen.value("() => { studio.pose(60); document.querySelector('#results-circuits').scrollIntoView(); }")
        seen.view.wait_for_timeout(800)
        rested(seen)
        written("studio-forces", seen)


def photograph() -> None:
    """A pair of pliers that locks, as if photographed: its handles' pins are brought to scale and drawn over."""
    with window("Traced") as seen:
        seen.value(PHOTOGRAPHED)
        pins = (-150, 60), (-60, -60), (110, -20), (150, 85)
        for place in (pins[0], pins[3]):
            seen.view.mouse.click(*seen.at(place))
        form = seen.view.locator("dialog")
        form.get_by_label("drawing's unit").fill("120")
        form.get_by_role("button", name="Do it").click()
        seen.until("studio.gestures.tool === 'draw'")
        for start, end in pairwise(pins):
            seen.drag(start, end, free=True)
        for place, key in ((pins[0], "g"), (pins[3], "g"), (pins[0], "d")):
            seen.press(place, key)
        rested(seen)
        written("studio-photograph", seen)


def pen() -> None:
    """An egg drawn by hand, and the linkages that trace it; the first of four links is the document."""
    with window("Curve") as seen:
        seen.view.keyboard.press("i")
        sketched(seen, [(1.15 * x - 40, -1.15 * y - 60) for x, y in egg(70)])
        seen.until("studio.pen.words.textContent.startsWith('Searched')", 120.0)
        seen.view.locator("#pen-list [data-links='4']").first.click()
        rested(seen)
        seen.until("studio.structure.moves && studio.motion?.poses === 361")
        seen.value("() => { studio.pose(40); studio.canvas.fit(); }")
        written("studio-pen", seen)


def textbook() -> None:
    with window("Six-bar") as seen:
        six_bar(seen)
        rested(seen)
        seen.value("() => { studio.pose(35); studio.canvas.fit(); }")
        written("studio", seen)


class Film:
    """Frames of a window, each with its milliseconds."""

    def __init__(self, seen: Window) -> None:
        self.seen, self.frames, self.times = seen, list[Any](), list[int]()
        seen.value(ACTORS)

    def frame(self, time: int = FRAME) -> None:
        picture = Image.open(io.BytesIO(self.seen.view.screenshot())).convert("RGB")
        high = round(picture.height * WIDTH / picture.width)
        self.frames.append(picture.resize((WIDTH, high), Image.Resampling.LANCZOS))
        self.times.append(time)

    def say(self, text: str, time: int = REST) -> None:
        self.seen.value("text => { window.caption.textContent = text; }", text)
        self.frame(time)

    def point(self, place: tuple[float, float]) -> None:
        x, y = self.seen.at(place)
        self.seen.view.mouse.move(x, y)
        self.seen.value("([x, y]) => Object.assign(window.cursor.style, { left: `${x}px`, top: `${y}px` })", [x, y])

    def drag(self, start: tuple[float, float], end: tuple[float, float], steps: int = 6) -> None:
        self.point(start)
        self.frame()
        self.seen.view.mouse.down()
        for k in range(1, steps + 1):
            self.point((start[0] + (end[0] - start[0]) * k / steps, start[1] + (end[1] - start[1]) * k / steps))
            self.seen.view.wait_for_timeout(60)
            self.frame()
        self.seen.view.mouse.up()
        self.seen.settle()
        self.frame(350)

    def press(self, place: tuple[float, float], key: str) -> None:
        self.point(place)
        self.frame(250)
        self.seen.view.keyboard.press(key)
        self.seen.settle()
        self.frame(450)

    def turn(self, poses: range) -> None:
        for k in poses:
            self.seen.value("k => studio.pose(k % 360)", k)
            self.frame()
        self.seen.value("() => { studio.canvas.pose = null; studio.canvas.draw(); }")

    def save(self, path: Path) -> None:
        first, *others = self.frames
        how = {"quality": 62, "method": 4, "minimize_size": True}
        first.save(path, save_all=True, append_images=others, duration=self.times, loop=0, **how)


def film() -> None:
    """A four-bar from nothing, its coupler's path, one bar lengthened alone: some twenty seconds."""
    with window("Four-bar") as seen:
        shot = Film(seen)
        shot.say("Drag: a bar, and another from its end")
        a, b, c, d = (-200, 110), (-165, 45), (40, -70), (100, 110)
        for start, end in ((a, b), (b, c), (c, d)):
            shot.drag(start, end)
        shot.say("G: grounded", 500)
        shot.press(a, "g")
        shot.press(d, "g")
        shot.say("D: driven. It moves", 500)
        shot.press(a, "d")
        rested(seen)
        shot.turn(range(60, 420, 14))
        shot.say("P: a point of the coupler, with its path", 600)
        seen.view.mouse.click(*seen.at(middle_of(b, c)))
        shot.press((-40, -130), "p")
        rested(seen)
        shot.turn(range(60, 420, 14))
        shot.say("Ctrl: the crank alone grows, all others keep their lengths", 600)
        seen.view.keyboard.down("Control")
        shot.drag(b, (b[0] + 14, b[1] - 26))
        seen.view.keyboard.up("Control")
        rested(seen)
        shot.turn(range(60, 420, 14))
        shot.say("It is a file: solved, checked, exported like any other", 1800)
        shot.save(FOLDER / "studio.webp")


PICTURES: dict[str, Callable[[], None]] = {
    one.__name__: one for one in (drawing, shaper, digger, gears, cam, locks, forces, photograph, pen, textbook, film)
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        PICTURES[name]()
