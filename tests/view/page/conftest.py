"""A browser for the tests of pages, and pages to look at."""

from __future__ import annotations

import os
import shutil
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck
from compoundkin.view.report import page
from tests import catalog

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
# No sandbox where tests run as root in a container; nothing that reaches for the network of its own accord.
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
DESK, PHONE = (1440, 900), (360, 740)

# A name that would run a script wherever it is not written as text.
HOSTILE = "<script>hacked=1</script>\"'&</p><img src=x onerror=hacked=2>"


def _missing(why: str) -> None:
    """Skip what needs a browser, or fail where one is required."""
    if os.environ.get("COMPOUNDKIN_BROWSER") == "required":
        pytest.fail(f"{why}, and COMPOUNDKIN_BROWSER=required")
    pytest.skip(f"{why}: apt-get install chromium")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium as the system has it; none is ever downloaded."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        _missing("there is no Chromium on this machine")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=found, args=list(FLAGS))
        yield started
        started.close()


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The pages of mechanisms by name, each made once."""
    folder, known = tmp_path_factory.mktemp("pages"), {}

    def of(name: str) -> Path:
        if name not in known:
            known[name] = folder / f"{name}.html"
            page(catalog.motion(name)).save(known[name])
        return known[name]

    return of


class Opened:
    """A page in the browser, with all that it asked for and complained about."""

    def __init__(self, view: Any, path: Path) -> None:
        self.view, self.path = view, path
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.heard: dict[str, Callable[[Any], None]] = {
            "request": lambda request: self.requests.append(request.url),
            "console": lambda message: self.complaints.append(message.text),
            "pageerror": lambda error: self.complaints.append(str(error)),
        }
        for kind, run in self.heard.items():
            view.on(kind, run)
        view.bring_to_front()  # what is behind others is not painted
        view.goto(path.as_uri())

    def leave(self, size: tuple[int, int], scheme: str) -> Any:
        """The window as it was before, empty, with nothing that is remembered of the page."""
        for kind, run in self.heard.items():
            self.view.remove_listener(kind, run)
        self.value("localStorage.clear(), sessionStorage.clear()")
        self.view.goto("about:blank")
        self.view.mouse.move(0, 0)
        self.view.set_viewport_size({"width": size[0], "height": size[1]})
        self.view.emulate_media(media="null", color_scheme=scheme)
        return self.view

    def value(self, script: str, *arguments: Any) -> Any:
        """What a script in the page gives."""
        return self.view.evaluate(script, *arguments)

    def drawn(self, *letters: str) -> dict[str, complex]:
        """Where the sketch shows points, read back from the picture."""
        found = self.value(
            """letters => {
              const player = compoundkin.players[0], { scale, x, y } = player.data.window;
              return letters.map((letter) => {
                const part = player.parts.find((one) => one.dataset.letter === letter);
                const at = part.getAttribute("transform").match(/-?[\\d.]+(e[+-]?\\d+)?/g).map(Number);
                return [at[0] / scale + x, y - at[1] / scale];
              });
            }""",
            list(letters),
        )
        return {letter: complex(*place) for letter, place in zip(letters, found, strict=True)}

    def __getattr__(self, name: str) -> Any:
        return getattr(self.view, name)


def until(view: Any, script: str) -> None:
    """Wait until a script is true; the page's policy lets the browser's driver evaluate no text of its own."""
    for _ in range(200):
        if view.value(script):
            return
        view.wait_for_timeout(50)
    pytest.fail(f"never true: {script}")


@pytest.fixture(scope="session")
def contexts(browser: Any) -> Callable[..., Any]:
    """Contexts by their size and settings, each made once.

    Each has an empty window that stays open: pages then share what a context begins anew with its first window.
    """
    made: dict[str, Any] = {}

    def of(size: tuple[int, int], script: str, **how: Any) -> Any:
        key = repr((size, script, sorted(how.items())))
        if key not in made:
            made[key] = browser.new_context(viewport={"width": size[0], "height": size[1]}, **how)
            if script:
                made[key].add_init_script(script)
            made[key].new_page()
        return made[key]

    return of


@pytest.fixture(scope="session")
def idle() -> dict[Any, list[Any]]:
    """The windows of each context that nobody looks at: a page opens in one at half the cost of a new window."""
    return defaultdict(list)


@pytest.fixture
def opened(contexts: Callable[..., Any], idle: dict[Any, list[Any]]) -> Iterator[Callable[..., Opened]]:
    """Open a file in a window of its own; all are emptied afterwards, and nothing is remembered of them."""
    shown: list[tuple[Any, Opened, tuple[int, int], str]] = []

    def of(path: Path, size: tuple[int, int] = DESK, script: str = "", **how: Any) -> Opened:
        context = contexts(size, script, **how)
        view = idle[context].pop() if idle[context] else context.new_page()
        shown.append((context, Opened(view, path), size, how.get("color_scheme", "light")))
        return shown[-1][1]

    yield of
    for context, window, size, scheme in shown:
        idle[context].append(window.leave(size, scheme))


@pytest.fixture(scope="session")
def hostile() -> ck.Mechanism:
    """A four-bar whose title, description and names try to be markup."""
    return ck.Mechanism(
        f"Title {HOSTILE}",
        ck.link("frame", A=0, D=4),
        ck.link(f"crank {HOSTILE}", A=0, B=1),
        ck.link("rod", B=0, C=3),
        ck.link("arm", D=0, C=3),
        ck.drive(f"crank {HOSTILE}"),
        description=f"Description {HOSTILE}",
        source=f"Source {HOSTILE}",
    )
