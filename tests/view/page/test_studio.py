"""The window of the studio in a browser: mechanisms drawn by gestures, moved, undone, saved, without a complaint."""

from __future__ import annotations

import asyncio
import random
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from compoundkin.studio.server import HOST, StudioServer

uvicorn = pytest.importorskip("uvicorn")
pytest.importorskip("starlette")
pytest.importorskip("websockets")

START = '# drawn by gestures\nformat = 1\ntitle = "Drawn"  # kept\n'
DESK = (1440, 900)
# What is told of a window that does not come to rest.
STATE = """[studio.edits, studio.text, studio.shown, studio.wire.socket.readyState, studio.wire.waiting.size,
  document.querySelector("#notice").textContent, document.querySelector("#problems").textContent]"""


@contextmanager
def served_studio() -> Iterator[StudioServer]:
    """A server in a thread, at a free port."""
    listener = socket.socket()
    listener.bind((HOST, 0))
    listener.listen()  # a window may come before the server runs
    served = StudioServer(Path("none.toml"), START, "token-of-tests", f"{HOST}:{listener.getsockname()[1]}")
    served.start()
    how = {"ws": "websockets-sansio", "lifespan": "off", "log_level": "critical", "timeout_graceful_shutdown": 1}
    running = uvicorn.Server(uvicorn.Config(served.application(), **how))
    thread = threading.Thread(target=lambda: asyncio.run(running.serve([listener])), daemon=True)
    thread.start()
    yield served
    running.should_exit = True
    thread.join(10)
    served.end()


@pytest.fixture(scope="module")
def server() -> Iterator[StudioServer]:
    """One server for all windows; each test gives it a file of its own."""
    with served_studio() as served:
        yield served


class Window:
    """A window of the studio, with what it complained of, driven by the pointer in pixels from the canvas's middle."""

    def __init__(self, view: Any, server: StudioServer) -> None:
        self.view, self.server, self.complaints = view, server, list[str]()
        view.on("console", lambda message: self.complaints.append(message.text))
        view.on("pageerror", lambda error: self.complaints.append(str(error)))
        view.on("dialog", lambda dialog: dialog.accept())
        view.goto(f"http://{server.host}/#{server.token}")
        self.settle()
        box = view.locator("#canvas").bounding_box()
        self.middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def value(self, script: str, *given: Any) -> Any:
        return self.view.evaluate(script, *given)

    def until(self, script: str, seconds: float = 60.0) -> None:
        """Wait until something holds: by asking, as the page's policy forbids scripts of texts."""
        end = time.monotonic() + seconds
        while not self.value(script):
            assert time.monotonic() < end, (script, self.complaints, self.value(STATE))
            self.view.wait_for_timeout(15)

    def settle(self) -> None:
        self.until("Boolean(window.studio?.isSettled)")

    @property
    def text(self) -> str:
        return str(self.value("studio.text"))

    def at(self, place: tuple[float, float]) -> tuple[float, float]:
        return self.middle[0] + place[0], self.middle[1] + place[1]

    def drag(self, start: tuple[float, float], end: tuple[float, float], key: str = "", free: bool = False) -> None:
        """Drag with a key held; `free` with Ctrl pressed on the way, so that nothing is snapped to."""
        self.hold(start, end, key, free)
        self.view.mouse.up()
        for one in filter(None, (key, "Control" if free else "")):
            self.view.keyboard.up(one)
        self.settle()

    def hold(self, start: tuple[float, float], end: tuple[float, float], key: str = "", free: bool = False) -> None:
        """Drag and do not let go."""
        (x, y), (u, v) = self.at(start), self.at(end)
        self.view.mouse.move(x, y)
        if key:
            self.view.keyboard.down(key)
        self.view.mouse.down()
        if free:
            self.view.keyboard.down("Control")
        self.view.mouse.move((x + u) / 2, (y + v) / 2)
        self.view.mouse.move(u, v)

    def where(self, letter: str) -> tuple[float, float]:
        """Where a point is, from the canvas's middle."""
        (x, y), (wide, high) = self.value(f"[studio.canvas.at('{letter}'), studio.canvas.size]")
        return x - wide / 2, y - high / 2

    def where_plane(self, place: tuple[float, float]) -> complex:
        """The place in the plane of the mechanism."""
        wide, high = self.value("studio.canvas.size")
        return complex(*self.value(f"studio.canvas.plane([{place[0] + wide / 2}, {place[1] + high / 2}])"))

    def menu(self, place: tuple[float, float]) -> Any:
        self.view.mouse.click(*self.at(place), button="right")
        found = self.view.locator(".menu")
        found.wait_for()
        return found

    def pick(self, place: tuple[float, float], words: str) -> None:
        """Do what a menu offers at a place."""
        self.menu(place).get_by_role("menuitem", name=words).click()
        self.settle()

    def press(self, place: tuple[float, float], key: str) -> None:
        self.view.mouse.move(*self.at(place))
        self.view.keyboard.press(key)
        self.settle()

    def save(self) -> ck.Mechanism:
        self.view.keyboard.press("Control+s")
        self.until("studio.text === studio.saved")
        return ck.load(str(self.server.path))


@pytest.fixture
def window(contexts: Callable[..., Any], server: StudioServer, tmp_path: Path) -> Iterator[Callable[..., Window]]:
    """Open the studio of a text in a new window; all are closed afterwards."""
    views: list[Any] = []

    def of(text: str = START, size: tuple[int, int] = DESK, **how: Any) -> Window:
        server.path, server.text = tmp_path / "drawn.toml", text
        views.append(contexts(size, "", **how).new_page())
        return Window(views[-1], server)

    yield of
    for view in views:
        view.close(run_before_unload=False)


def same_motion(drawn: ck.Mechanism, by_hand: ck.Mechanism, names: dict[str, str]) -> None:
    one, other = ck.solve(drawn), ck.solve(by_hand)
    for letter, own in names.items():
        np.testing.assert_allclose(one.points[letter].position, other.points[own].position, rtol=0, atol=1e-9)


A, B, C, D = (-200, 100), (-150, 0), (100, -120), (150, 100)


def middle_of(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


def four_bar(seen: Window) -> None:
    for start, end in ((A, B), (B, C), (C, D)):
        seen.drag(start, end)
    for place, key in ((A, "g"), (D, "g"), (A, "d")):
        seen.press(place, key)


def test_a_four_bar_is_drawn_moved_and_saved(window: Any) -> None:
    """Six gestures. Its file solves as the mechanism with the lengths that the drawing has, at four pixels a unit."""
    seen = window()
    four_bar(seen)
    assert seen.view.locator("#chip").inner_text() == "F = 3·3 − 2·4 = 1: moves"
    a, b, c, d = (complex(x, -y) / 4 for x, y in (A, B, C, D))
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", A=a, D=d),
        ck.link("crank", A=0, B=abs(b - a)),
        ck.link("coupler", B=0, C=abs(c - b)),
        ck.link("rocker", D=0, C=abs(c - d)),
        ck.drive("crank"),
        ck.drawn(B=b, C=c),
    )
    same_motion(seen.save(), by_hand, {letter: letter for letter in "ABCD"})
    # the driver is dragged by its handle, and the link follows
    seen.view.keyboard.press("v")
    seen.drag(B, (A[0] - 112, A[1]))
    assert seen.value("studio.canvas.pose") == pytest.approx(180, abs=1)
    shown = seen.value("studio.canvas.place('C')")
    solved = ck.solve(by_hand, {"crank": np.deg2rad([float(seen.value("studio.canvas.pose"))])})
    assert complex(*shown) == pytest.approx(solved.points["C"].position[0], abs=1e-3)
    assert seen.complaints == []


@pytest.mark.full
def test_a_slider_crank_is_drawn(window: Any) -> None:
    seen = window()
    seen.drag((-200, 0), (-150, -60))
    seen.drag((-150, -60), (100, 0))
    for place, key in (((-200, 0), "g"), ((100, 0), "s"), ((-200, 0), "d")):
        seen.press(place, key)
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", A=-50 + 0j, Q=25 + 0j),
        ck.link("crank", A=0, B=abs(12.5 + 15j)),
        ck.link("rod", B=0, C=abs(62.5 - 15j)),
        ck.link("piston", C=0),
        ck.slide("piston", on="frame", through="Q"),
        ck.drive("crank"),
        ck.drawn(B=-37.5 + 15j, C=25 + 0j),
    )
    same_motion(seen.save(), by_hand, {letter: letter for letter in "ABC"})
    assert seen.complaints == []


# The six-bar of Example 3-4 with its crank at zero, to tenths.
SIX_BAR = {
    "E": (0, 0), "D": (14, 0), "A": (41.2, -28), "C": (28.7, -2.8), "B": (41, 0), "F": (0, -34), "G": (37.3, 6.4),
}  # fmt: skip


def six_bar(seen: Window) -> None:
    """Draw it at ten pixels a unit, the slot last: the point of the plate slides along the bar."""
    seen.value("Object.assign(studio.canvas.view, { scale: 10, x: 20, y: -14 })")
    px = {k: ((x - 20) * 10, -(y + 14) * 10) for k, (x, y) in SIX_BAR.items()}

    for start, end in ("ED", "DA", "AB", "FG"):
        seen.drag(px[start], px[end], free=True)
    seen.view.mouse.click(*seen.at(middle_of(px["D"], px["A"])))
    seen.press(px["C"], "p")
    for letter in "EBF":
        seen.press(px[letter], "g")
    seen.view.mouse.click(*seen.at(px["C"]))
    seen.press(middle_of(px["F"], px["C"]), "s")
    seen.press(px["E"], "d")


# The least distance from the middle of a letter to a bar through its point, over all poses, in pixels.
BARS_FROM_LETTERS = """(() => {
  const { canvas } = studio, { links } = canvas.structure, count = canvas.motion.points.G[0].length;
  let least = Infinity;
  for (let pose = 0; pose < count; pose += 5) {
    canvas.pose = pose;
    canvas.draw();
    for (const text of canvas.letters.root.querySelectorAll("text")) {
      const letter = text.textContent, box = text.getBBox(), a = canvas.at(letter);
      const p = [box.x + box.width / 2 - a[0], box.y + box.height / 2 - a[1]];
      for (const { points } of links.filter((one) => one.name !== "frame" && one.points.includes(letter))) {
        for (const other of points.filter((one) => one !== letter)) {
          const b = canvas.at(other), u = [b[0] - a[0], b[1] - a[1]], long = u[0] ** 2 + u[1] ** 2;
          const t = Math.max(0, Math.min(1, (p[0] * u[0] + p[1] * u[1]) / long));
          least = Math.min(least, Math.hypot(p[0] - t * u[0], p[1] - t * u[1]));
        }
      }
    }
  }
  return least;
})()"""


@pytest.mark.full
def test_the_six_bar_of_the_textbook_is_drawn(window: Any) -> None:
    seen = window()
    six_bar(seen)
    assert seen.value(BARS_FROM_LETTERS) > 6
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", "E", "B", "F"),
        ck.link("crank", "E", "D"),
        ck.link("plate", "D", "A", "C"),
        ck.link("rocker", "A", "B"),
        ck.link("bar", "F", "G"),
        ck.link("block", "C"),
        ck.slide("block", on="bar", at="C", through="F", toward="G"),
        ck.drive("crank"),
        ck.drawn(**SIX_BAR),
    )
    same_motion(seen.save(), by_hand, dict(zip("ABCDEFG", "EDABFGC", strict=True)))
    assert seen.view.locator("#chip").inner_text() == "F = 3·5 − 2·7 = 1: moves"
    assert seen.complaints == []


# Of a shaper, in pixels at four a unit: crank, pivot and end of the slotted arm, end of the rod.
SHAPER = {"O": (0, 40), "A": (72, -10), "Q": (0, 200), "E": (120, -150), "C": (-120, -190)}


def quick_return(seen: Window) -> None:
    px = SHAPER
    for start, end in ("OA", "QE", "EC"):
        seen.drag(px[start], px[end], free=True)
    for letter in "OQ":
        seen.press(px[letter], "g")
    seen.press(px["C"], "s")
    seen.view.keyboard.press("Escape")
    on_arm = tuple(0.7 * a + 0.3 * b for a, b in zip(px["Q"], px["E"], strict=True))
    seen.view.mouse.click(*seen.at(px["A"]))
    seen.pick(on_arm, "Slot for B along bar2")
    seen.press(px["O"], "d")


def test_a_quick_return_with_a_slot_is_drawn(window: Any) -> None:
    """The crank's pin slides along the arm: a block of one point, beside the line of the arm's two points."""
    seen = window()
    quick_return(seen)
    at = {k: complex(x, -y) / 4 for k, (x, y) in SHAPER.items()}
    line = (at["E"] - at["Q"]) / abs(at["E"] - at["Q"])
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", O=at["O"], Q=at["Q"], G=at["C"]),
        ck.link("crank", O=0, A=abs(at["A"] - at["O"])),
        ck.link("arm", Q=0, E=abs(at["E"] - at["Q"])),
        ck.link("rod", E=0, C=abs(at["C"] - at["E"])),
        ck.link("block", A=0),
        ck.link("ram", C=0),
        ck.slide("block", on="arm", through="Q", offset=((at["A"] - at["Q"]) * line.conjugate()).imag),
        ck.slide("ram", on="frame", through="G"),
        ck.drive("crank"),
        ck.drawn(A=at["A"], E=at["E"], C=at["C"]),
    )
    drawn = seen.save()
    names = dict(zip("ABCDE", "OAQEC", strict=True))
    one, other = ck.solve(drawn), ck.solve(by_hand)
    # the direction of the drawn crank is that of its points, as by hand; the slot of the drawing goes through its pin
    for letter, own in names.items():
        np.testing.assert_allclose(one.points[letter].position, other.points[own].position, rtol=0, atol=1e-9)
    assert seen.view.locator("#chip").inner_text() == "F = 3·5 − 2·7 = 1: moves"
    assert seen.complaints == []


# Of a digger, in pixels at four a unit: boom's pivot and end, where its cylinder pushes, that of the stick.
DIGGER = {
    "A": (-160, 120),
    "B": (60, -80),
    "C": (-50, 20),
    "D": (-60, 140),
    "E": (160, 60),
    "F": (0, -120),
    "G": (110, -10),
}


def digger_arm(seen: Window) -> None:
    px = DIGGER
    seen.drag(px["A"], px["B"], free=True)
    seen.press(px["A"], "g")
    seen.drag(px["B"], px["E"], free=True)
    seen.view.keyboard.press("c")
    seen.drag(px["D"], px["C"], free=True)
    seen.drag(tuple(0.2 * a + 0.8 * b for a, b in zip(px["A"], px["B"], strict=True)), px["G"], free=True)
    seen.view.keyboard.press("b")
    for name in ("cylinder1", "cylinder2"):
        a, b = seen.value(f"studio.canvas.cylinder('{name}').points.map((one) => studio.canvas.at(one))")
        wide, high = seen.value("studio.canvas.size")
        seen.press(((a[0] + b[0] - wide) / 2, (a[1] + b[1] - high) / 2), "d")


@pytest.mark.full
def test_a_digger_arm_with_cylinders_is_drawn(window: Any) -> None:
    """The ends of the cylinders become points of boom, stick and frame; each is driven by its length."""
    seen = window()
    digger_arm(seen)
    drawn = seen.save()
    at = drawn.sketch
    assert {name: link.letters for name, link in drawn.links.items() if " " not in name} == {
        "bar1": ("A", "B", "E", "F"), "bar2": ("B", "C", "G"), "frame": ("A", "D"),
    }  # fmt: skip
    a, b = at["A"], at["B"]
    along = (b - a) / abs(b - a)
    stick = (at["C"] - b) / abs(at["C"] - b)
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", A=a, D=at["D"]),
        ck.link("boom", A=0, B=abs(b - a), E=(at["E"] - a) / along, F=(at["F"] - a) / along),
        ck.link("stick", B=0, C=abs(at["C"] - b), G=(at["G"] - b) / stick),
        ck.cylinder("boom", "E", at="D", name="lift"),
        ck.cylinder("stick", "G", to="boom", at="F", name="curl"),
        ck.drive("lift"),
        ck.drive("curl"),
        ck.drawn(**{k: complex(p) for k, p in at.items() if k not in "AD"}),
    )
    long = abs(at["E"] - at["D"]), abs(at["G"] - at["F"])
    lengths = [part * np.linspace(0.95, 1.1, 7) for part in long]
    one = ck.solve(drawn, dict(zip(("cylinder1", "cylinder2"), lengths, strict=True)))
    other = ck.solve(by_hand, dict(zip(("lift", "curl"), lengths, strict=True)))
    assert one.assembled.all()
    for letter in "BCEFG":
        np.testing.assert_allclose(one.points[letter].position, other.points[letter].position, rtol=0, atol=1e-9)
    assert seen.complaints == []


def at_of(seen: Window) -> dict[str, complex]:
    """Where the text has its points drawn."""
    return {k: complex(p) for k, p in loads(seen.text).sketch.items()}


def test_what_is_drawn_snaps_and_takes_typed_lengths(window: Any) -> None:
    """A bar as long as another at a right angle to it, said before it is; one of a typed length and direction."""
    seen = window()
    four_bar(seen)
    turned = B[0] + 100 + 3, B[1] + 50 - 2
    seen.hold(B, turned)
    said = seen.view.locator("#hint").inner_text()
    assert "right angle to bar1" in said
    assert "as long as bar1" in said
    assert seen.value("document.querySelectorAll('#canvas .snap').length") == 2
    seen.view.mouse.up()
    seen.settle()
    at = at_of(seen)
    assert abs(at["E"] - at["B"]) == pytest.approx(abs(at["B"] - at["A"]), abs=1e-5)
    assert ((at["E"] - at["B"]) / (at["B"] - at["A"])).real == pytest.approx(0, abs=1e-6)
    seen.hold(C, (C[0] + 40, C[1] - 60))
    seen.view.keyboard.type("32.5<-30")
    seen.view.keyboard.press("Enter")
    seen.view.mouse.up()
    seen.settle()
    at = at_of(seen)
    assert at["F"] - at["C"] == pytest.approx(32.5 * np.exp(-1j * np.pi / 6), abs=1e-4)
    assert seen.complaints == []


@pytest.mark.full
def test_one_bar_grows_alone_locks_hold_and_several_move(window: Any) -> None:
    seen = window()
    four_bar(seen)

    def lengths() -> list[float]:
        at = at_of(seen)
        return [abs(at[a] - at[b]) for a, b in ("AB", "BC", "CD")]

    before = lengths()
    seen.drag(B, (B[0] + 8, B[1] - 16), "Control")
    after = lengths()
    assert after[0] == pytest.approx(before[0] + 20 / 4 * 0.894, abs=0.6)
    assert after[1:] == pytest.approx(before[1:], abs=1e-4)
    # a chosen bar takes a typed length
    seen.view.mouse.click(*seen.at(middle_of(seen.where("A"), seen.where("B"))))
    seen.view.keyboard.type("27")
    seen.view.keyboard.press("Enter")
    seen.settle()
    assert lengths() == pytest.approx([27, *before[1:]], abs=1e-4)
    # a locked length is held while its end is moved
    seen.pick(middle_of(seen.where("B"), seen.where("C")), "Lock its length")
    x, y = seen.where("C")
    seen.drag((x, y), (x + 20, y + 40), "Shift")
    assert lengths()[1] == pytest.approx(before[1], abs=1e-4)
    assert lengths()[2] != pytest.approx(before[2], abs=1)
    # a box chooses several, which move together; one undo takes all back
    text, at = seen.text, at_of(seen)
    seen.view.keyboard.press("v")
    seen.drag((-300, -200), (240, 60))
    assert set(seen.value("[...studio.canvas.picked]")) == {"B", "C"}
    x, y = seen.where("C")
    seen.drag((x, y), (x + 40, y + 40), free=True)
    assert {k for k, p in at_of(seen).items() if abs(p - at[k]) > 5} == {"B", "C"}
    seen.view.keyboard.press("Control+z")
    seen.settle()
    assert seen.text == text
    assert seen.complaints == []


def test_a_cam_touches_its_roller_as_drawn_and_is_seen_whole(window: Any) -> None:
    """Its axis is away from the origin, and no drawing tells how it lies: it lies as where its motion begins."""
    seen = window()
    seen.drag((220, 40), (0, -60))
    seen.press((220, 40), "g")
    seen.pick((0, 100), "A fixed point here")
    seen.view.mouse.click(*seen.at((0, 100)))
    seen.pick((0, -60), "Cam at C that leads B")
    seen.view.locator("dialog").get_by_role("button", name="Do it").click()
    seen.settle()
    seen.press((0, 100), "d")
    outline = """(() => {
      const [cam, roller] = ["path.shape", "circle.shape"].map((one) => document.querySelector(`#canvas ${one}`));
      const places = cam.getAttribute("d").slice(1, -1).split("L");
      const points = places.map((one) => one.split(" ").map(Number));
      const [x, y, r] = ["cx", "cy", "r"].map((one) => Number(roller.getAttribute(one)));
      return [Math.min(...points.map(([u, v]) => Math.hypot(u - x, v - y))) - r, r, cam.getBBox().height];
    })()"""
    for pose in ("null", "75"):
        seen.value(f"() => {{ studio.canvas.pose = {pose}; studio.canvas.fit(); }}")
        gap, radius, high = seen.value(outline)
        assert abs(gap) < 0.05 * radius
        assert 0.3 * seen.value("studio.canvas.size[1]") < high < seen.value("studio.canvas.size[1]")
    assert seen.complaints == []


@pytest.mark.full
def test_the_menu_says_why_and_forms_make_gears(window: Any) -> None:
    """What cannot be done is grey, with its reason; Alt takes a bar off; a slide is turned by its grip."""
    seen = window()
    four_bar(seen)
    seen.view.keyboard.press("Escape")
    found = seen.menu(B)
    gears = found.get_by_role("menuitem", name="Gears or a belt at")
    assert gears.get_attribute("aria-disabled") == "true"
    assert "click the other point first" in gears.inner_text()
    assert found.get_by_role("menuitem", name="Weld bar1 and bar2").get_attribute("aria-disabled") is None
    seen.view.keyboard.press("Escape")
    again = seen.menu(middle_of(B, C)).get_by_role("menuitem", name="Slot for")
    assert "bar2 has the point B" in again.inner_text()  # for B, whose menu was open
    seen.view.keyboard.press("Escape")
    seen.view.mouse.click(*seen.at((300, 250)))
    seen.view.mouse.click(*seen.at(A))
    seen.pick(D, "Gears or a belt at A and D")
    form = seen.view.locator("dialog")
    form.get_by_label("On, at A").select_option("bar1")
    form.get_by_role("button", name="Do it").click()
    seen.settle()
    (pair,) = loads(seen.text).written_pairs
    assert (pair.code, pair.members[0]) == ("G", "bar1")
    assert seen.value("document.querySelectorAll('#canvas .gear').length") == 2
    # the rim of the greater one, around D; with the pair goes the wheel that it made
    rim = D[0], D[1] - 2 / 3 * (D[0] - A[0])
    seen.view.keyboard.press("Escape")
    seen.press(rim, "Delete")
    assert "gears" not in seen.text
    assert "wheel1" not in seen.text
    seen.view.keyboard.press("v")
    seen.drag(C, (C[0] + 60, C[1] - 40), "Alt")
    assert "E" in at_of(seen)
    x, y = seen.where("E")
    seen.press((x, y), "s")
    seen.view.mouse.click(*seen.at((x, y)))
    seen.drag((x + 70, y), (x + 50, y - 50))
    assert "angle = 45" in seen.text
    assert seen.complaints == []


LISTEN = """() => {
  const { socket } = studio.wire, send = socket.send.bind(socket);
  window.sent = [];
  socket.send = (message) => { window.sent.push(message); send(message); };
}"""
PHOTO = """async () => {
  const sheet = Object.assign(document.createElement("canvas"), { width: 200, height: 100 });
  sheet.getContext("2d").fillRect(20, 20, 160, 60);
  const blob = await new Promise((take) => sheet.toBlob(take));
  await studio.gestures.photograph(new File([blob], "photo.png", { type: "image/png" }));
}"""


@pytest.mark.full
def test_a_photograph_beneath_is_scaled_kept_and_sent_nowhere(window: Any) -> None:
    seen = window()
    sent: list[str] = []
    seen.view.on("request", lambda request: sent.append(request.url))
    seen.value(LISTEN)
    seen.value(PHOTO)
    for place in ((-100, 0), (100, 0)):
        seen.view.mouse.click(*seen.at(place))
    form = seen.view.locator("dialog")
    form.get_by_label("drawing's unit").fill("10")
    form.get_by_role("button", name="Do it").click()
    seen.until("studio.gestures.tool === 'draw'")
    x, y = seen.where_plane((-100, 0)), seen.where_plane((100, 0))
    assert abs(x - y) == pytest.approx(10, abs=1e-6)
    before = seen.value("[studio.canvas.photo.scale, studio.canvas.photo.x]")
    assert all(one.startswith("data:") for one in sent)
    assert "data:image" not in str(seen.value("window.sent"))
    seen.view.wait_for_timeout(150)
    seen.view.reload()
    seen.settle()
    seen.until("Boolean(studio.canvas.photo)")
    assert seen.value("[studio.canvas.photo.scale, studio.canvas.photo.x]") == pytest.approx(before)
    seen.pick((300, 200), "Take the photograph away")
    assert seen.complaints == []


def test_bars_start_and_end_on_bars_and_points_join(window: Any) -> None:
    seen = window()
    four_bar(seen)
    on_bar = (B[0] + C[0]) / 2, (B[1] + C[1]) / 2
    seen.drag(on_bar, (0, -250))
    mechanism = loads(seen.text)
    assert (mechanism.links["bar2"].letters, mechanism.links["bar4"].letters) == (("B", "C", "E"), ("E", "F"))
    seen.drag((300, -250), (200, -200))
    seen.view.keyboard.press("v")
    seen.drag((200, -200), (0, -250))
    assert loads(seen.text).pins["F"] == ("bar4", "bar5")
    assert seen.complaints == []


def test_text_and_drawing_are_two_sides_of_one_document(window: Any) -> None:
    seen = window()
    four_bar(seen)
    before = seen.text
    seen.view.locator("#text").fill(before.replace("B = [-37.5, 0]", "B = [-40, 0]"))
    seen.until("studio.canvas.structure.points.B[0] === -40")
    seen.view.locator("#text").fill(before + "[[drives]\n")
    seen.until("document.querySelector('#problems').textContent.includes('line')")
    assert seen.value("studio.canvas.structure.points.B[0]") == -40
    while seen.view.locator("#undo").is_enabled():
        seen.view.locator("#undo").click()
        seen.settle()
    assert seen.text == START
    assert seen.complaints == []


def test_a_reload_and_a_changed_file_lose_nothing(window: Any) -> None:
    seen = window()
    four_bar(seen)
    drawn = seen.text
    assert "#" not in seen.view.url
    seen.view.reload()
    seen.settle()
    assert seen.text == drawn
    seen.view.locator("#undo").click()
    seen.settle()
    seen.server.path.write_text(START)
    seen.view.keyboard.press("Control+s")
    notice = seen.view.locator("#notice")
    notice.get_by_text("has changed on disk").wait_for()
    assert seen.server.path.read_text() == START
    notice.get_by_role("button", name="Replace it").click()
    seen.until("studio.text === studio.saved")
    assert seen.server.path.read_text() == seen.text
    assert seen.complaints == []


def test_without_its_token_a_window_is_told_so(window: Any, server: StudioServer, contexts: Any) -> None:
    view = contexts(DESK, "").new_page()
    view.goto(f"http://{server.host}/#wrong")
    view.locator("#notice").get_by_text("did not let this window in").wait_for()
    view.close()


def test_by_the_keyboard_alone(window: Any) -> None:
    """A bar from nothing and one from its end, a point moved by arrows, grounded, driven; all names are there."""
    seen = window()
    keys = seen.view.keyboard
    seen.view.locator("#canvas").focus()
    for key in ("n", "n", "ArrowUp", "ArrowUp"):
        keys.press(key)
        seen.settle()
    seen.view.get_by_role("button", name="A", exact=True).press("Enter")
    for key in ("g", "d"):
        keys.press(key)
        seen.settle()
    mechanism = loads(seen.text)
    assert mechanism.links["frame"].letters == ("A",)
    assert [drive.link for drive in mechanism.drives] == ["bar1"]
    assert seen.view.get_by_role("button", name="Drive bar2 on bar1 at B").is_visible()
    assert seen.complaints == []


@pytest.mark.parametrize("scheme", ["light", pytest.param("dark", marks=pytest.mark.full)])
def test_it_is_narrow_enough_and_accessible(window: Any, scheme: str) -> None:
    """A finger draws a bar, opens the menu and moves the view; the lines of a text from Windows keep their ends."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    seen = window(START.replace("\n", "\r\n"), size=(390, 800), color_scheme=scheme, has_touch=True)
    wire = seen.view.context.new_cdp_session(seen.view)

    def touch(kind: str, *places: tuple[float, float]) -> None:
        points = [dict(zip("xy", seen.at(place), strict=True), id=k) for k, place in enumerate(places)]
        wire.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    for kind, places in (
        ("touchStart", [(-80, 20)]),
        ("touchMove", [(0, 0)]),
        ("touchMove", [(60, -40)]),
        ("touchEnd", []),
    ):
        touch(kind, *places)
    seen.until("studio.text.includes('bar1')")
    seen.settle()
    assert seen.text.count("\n") == seen.text.count("\r\n") > 5
    before = seen.value("studio.canvas.view.scale")
    touch("touchStart", (-60, 90))
    touch("touchStart", (-60, 90), (60, 90))
    touch("touchMove", (-120, 90), (120, 90))
    touch("touchEnd")
    assert seen.value("studio.canvas.view.scale") == pytest.approx(2 * before, rel=0.1)
    touch("touchStart", seen.where("B"))
    seen.view.locator(".menu").wait_for()
    touch("touchEnd")
    assert seen.value("document.documentElement.scrollWidth") <= 390
    found = axe.Axe().run(seen.view)
    assert found.violations_count == 0, found.generate_report()
    assert seen.complaints == []


def gestures(seen: Window, count: int, dice: random.Random) -> None:
    for _ in range(count):
        points = [
            tuple(one) for one in seen.value("Object.keys(studio.structure.points).map((k) => studio.canvas.at(k))")
        ]
        wide, high = seen.value("studio.canvas.size")

        def somewhere(points: Any = points, wide: float = wide, high: float = high) -> tuple[float, float]:
            if points and dice.random() < 0.6:
                x, y = dice.choice(points)
                return min(max(x, 2), wide - 2) - wide / 2, min(max(y, 2), high - 2) - high / 2
            return dice.uniform(-wide, wide) / 2.2, dice.uniform(-high, high) / 2.2

        what = dice.random()
        if what < 0.5:
            seen.drag(
                somewhere(), somewhere(), dice.choice(["", "", "", "Shift", "Alt", "Control"]), dice.random() < 0.2
            )
        elif what < 0.6:
            seen.hold(somewhere(), somewhere())
            seen.view.keyboard.type(dice.choice(["25", "40<60", "0", "<"]))
            seen.view.keyboard.press(dice.choice(["Enter", "Escape"]))
            seen.view.mouse.up()
        elif what < 0.75:
            offered = seen.menu(somewhere()).get_by_role("menuitem").all()
            some = dice.choice(offered)
            if "photograph" not in some.inner_text().lower():
                some.evaluate("one => one.click()")
        else:
            seen.press(somewhere(), dice.choice(KEYS))
        form = seen.view.locator("dialog")
        if form.count():
            form.get_by_role("button", name=dice.choice(["Do it", "Do it", "Cancel"])).click()
        if dice.random() < 0.2:
            seen.view.keyboard.press("Escape")
        seen.settle()


KEYS = (
    *("g", "g", "d", "s", "Delete", "v", "b", "c", "p", "n", "w", "t", "l", "r", "k", " ", "f", "7", "Enter"),
    *("Control+z", "Control+y", "Control+a", "ArrowUp", "Escape", "ContextMenu"),
)


def undone(seen: Window) -> str:
    seen.value("() => { while (studio.place) studio.step(-1); }")
    seen.settle()
    return seen.text


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.full) for seed in range(40, 42)])
def test_random_gestures_never_raise_and_are_undone_byte_for_byte(window: Any, seed: int) -> None:
    """Forty in a window; what many more make holds so many groups that each is solved for seconds."""
    seen = window()
    gestures(seen, 40, random.Random(seed))
    assert "# kept" in seen.text
    assert undone(seen) == START
    assert seen.complaints == []
