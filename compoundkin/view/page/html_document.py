"""The whole document: assets, colours, head, the moving sketch, sections, scripts."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from compoundkin.view.page.markup import element, lines, safe, screen_reader_text
from compoundkin.view.report.report_data import Outcome
from compoundkin.view.sketch import sketch_style
from compoundkin.view.sketch.sketch_style import page_css

ASSETS = Path(__file__).parent / "assets"
# Those that pictures do not have. Words in `good`, `bad` and `link` keep a contrast of 4.5 : 1 with every ground they
# stand on (WCAG 2.2, 1.4.3).
PAGE_COLOURS: dict[str, tuple[str, str]] = {
    "ground": ("#f5f6f8", "#0d0f13"),
    "soft": ("#eef1f4", "#1d2129"),
    "rule": ("#d9dde3", "#2e343d"),
    "quiet": ("#545d69", "#a3adba"),
    "link": ("#00579a", "#7cc0f7"),
    "lit": ("#fff0bd", "#3d3512"),
    "good": ("#006b4f", "#52d1a8"),
    "bad": ("#b3261e", "#ff8a80"),
    "bad-ground": ("#fdf0ee", "#2e1817"),
}
# The page loads nothing from elsewhere. Source: W3C, Content Security Policy Level 3.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)
ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E"
    "%3Cpath d='M3 12L6 4L13 7' fill='none' stroke='%230067b1' stroke-width='2'/%3E"
    "%3Ccircle cx='3' cy='12' r='2'/%3E%3Ccircle cx='6' cy='4' r='2'/%3E%3Ccircle cx='13' cy='7' r='2'/%3E%3C/svg%3E"
)
# Lines with patterns or templates stay as they are; a stroke between spaces divides. Elsewhere spaces matter only
# beside signs, as in "a - -b".
PLAIN, TEXT = re.compile(r"['`\\]|(?<! )/|/(?! )"), re.compile('("[^"]*")')
SPACES = re.compile(r" (?=[=,:;?*{}()\[\]&|])|(?<=[=,:;?*{}()\[\]&|]) |(?<==>) ")
STOPS = re.compile(r"(?<=[:;,{}]) | (?=[{}])")
# A line of comment.
REMARK = re.compile(r"//.*|/\*[^*]*\*/")
# A comment at the end of a line without texts.
END_REMARK = re.compile(r" +// [^\"'`]*$")
SCRIPTS = ("tables.js", "light.js")
THEMES = {"auto": "Auto", "light": "Light", "dark": "Dark"}


@cache
def asset(name: str) -> str:
    """Return the text of an asset; our own without indents and comments, a sixth smaller.

    >>> "sortable" in asset("vendor/sortable.min.js"), "//" in asset("theme.js")
    (True, False)
    """
    text = (ASSETS / name).read_text(encoding="utf-8").strip()
    if name.startswith("vendor/"):
        return text
    lines_without_remarks = (END_REMARK.sub("", line.strip()) for line in text.splitlines())
    code = (line for line in lines_without_remarks if line and not REMARK.fullmatch(line))
    return "\n".join(map(_minified_script if name.endswith("js") else _minified_style, code))


def _minified_script(line: str) -> str:
    """Return a line of a script without needless spaces; texts and patterns stay as they are."""
    if PLAIN.search(line):
        return line
    parts = TEXT.split(line)
    return "".join(part if k % 2 else SPACES.sub("", part) for k, part in enumerate(parts))


def _minified_style(line: str) -> str:
    """Return a line of a style sheet without needless spaces."""
    return line if PLAIN.search(line) or '"' in line else STOPS.sub("", line)


def vendored_library(name: str, licence: str, gives: str = "") -> str:
    """Return a library as part of a page, with its licence, in a function so that its names stay private.

    What it `gives` is then `compoundkin.uPlot`, or whatever its name is.

    >>> vendored_library("uPlot.iife.min.js", "uPlot.LICENSE.txt", "uPlot").splitlines()[-2:]
    ['(window.compoundkin ??= {}).uPlot = uPlot;', '})();']
    """
    given = f"\n(window.compoundkin ??= {{}}).{gives} = {gives};" if gives else ""
    return f"/*\n{asset(f'vendor/{licence}')}\n*/\n(() => {{\n{asset(f'vendor/{name}')}{given}\n}})();"


def page_palette() -> str:
    """Return the style rules that name all colours. Paper that is printed on is light."""
    colours = {"paper": sketch_style.PAPER, "ink": sketch_style.INK, **PAGE_COLOURS}
    colours |= {f"g{k}": pair for k, pair in enumerate(sketch_style.COLOURS)}
    light, dark = ("".join(f"--{name}:{pair[k]};" for name, pair in colours.items()) for k in (0, 1))
    swatches = "\n".join(f".g{k}{{background:var(--g{k})}}" for k in range(len(sketch_style.COLOURS)))
    return "\n".join(
        (
            f":root{{color-scheme:light;{light}}}",
            f"@media screen{{:root[data-theme=dark]{{color-scheme:dark;{dark}}}}}",
            "@media screen and (prefers-color-scheme:dark)"
            f"{{:root:not([data-theme=light]){{color-scheme:dark;{dark}}}}}",
            swatches,
        )
    )


@dataclass(frozen=True)
class Document:
    """The parts of a page as markup, but for its title.

    `contents` are the keys and titles of sections. `viewer` stands beside the text: the moving sketch and its plots.
    `styles` and `scripts` are those beyond every page's own, and `data` elements with data for scripts.
    """

    title: str
    outcome: Outcome
    contents: tuple[tuple[str, str], ...]
    about: str
    sections: tuple[str, ...]
    version: str
    viewer: str = ""
    styles: tuple[str, ...] = ()
    scripts: tuple[str, ...] = ()
    data: tuple[str, ...] = ()
    before: tuple[tuple[str, str], ...] = ()

    @property
    def html(self) -> str:
        """The document as one text, the same every time."""
        body = lines(("<body>", *self._body(), *self.data, *map(_script, self._scripts()), "</body>"))
        head = element("head", f"\n{lines(self._head())}\n")
        return f'<!DOCTYPE html>\n<html lang="en">\n{head}\n{body}\n</html>\n'

    def _head(self) -> Iterator[str]:
        yield '<meta charset="utf-8">'
        yield f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        yield '<meta name="viewport" content="width=device-width, initial-scale=1">'
        yield '<meta name="color-scheme" content="light dark">'
        yield f'<meta name="generator" content="compoundkin {safe(self.version)}">'
        yield element("title", safe(self.title))
        yield f'<link rel="icon" href="{ICON}">'
        yield from (
            f"<style>\n{text}\n</style>" for text in (page_palette(), asset("page.css"), page_css(), *self.styles)
        )
        # before anything is painted, so that no page flashes in the other theme
        yield _script(asset("theme.js"))

    def _scripts(self) -> Iterator[str]:
        yield asset("page.js")
        yield vendored_library("sortable.min.js", "sortable.LICENSE.txt")
        yield from map(asset, SCRIPTS)
        yield from self.scripts

    def _body(self) -> Iterator[str]:
        yield '<a class="skip" href="#content">Skip to the report</a>'
        yield element("header", f"\n{lines(self._header())}\n", class_="top")
        yield _contents([*self.before, *self.contents])
        kind = "columns" if self.viewer else "single"
        viewer = element("div", f"\n{self.viewer}\n", class_="stage", id="stage") if self.viewer else ""
        about = element("section", f"\n{self.about}\n", id="about", aria_label="About") if self.about else ""
        text = element("div", f"\n{lines([about, *self.sections])}\n", class_="text")
        yield element("main", lines([viewer, text]), id="content", class_=kind, tabindex="-1")
        yield element("footer", f"<p>Made by compoundkin {safe(self.version)}.</p>")
        yield '<div id="said" class="unseen" role="status" aria-live="polite"></div>'

    def _header(self) -> Iterator[str]:
        badges = lines(element("li", badge, data_badge=key) for key, badge in _badges(self.outcome))
        outcome = element("ul", badges, class_="badges", aria_label="Outcome") if badges else ""
        yield f'<div class="title"><h1>{safe(self.title)}</h1>{outcome}{_theme()}</div>'


def _script(text: str) -> str:
    return f"<script>\n{text}\n</script>"


def _theme() -> str:
    """Return the switch between light and dark, which scripts reveal."""
    options = lines(
        f'<label><input type="radio" name="theme" value="{key}"{" checked" if key == "auto" else ""}>'
        f"<span>{text}</span></label>"
        for key, text in THEMES.items()
    )
    return element("fieldset", f'<legend class="unseen">Colours</legend>\n{options}', class_="theme")


def _contents(sections: Iterable[tuple[str, str]]) -> str:
    """Links to all sections that have a title."""
    items = lines(f'<li><a href="#{safe(key)}">{safe(title)}</a></li>' for key, title in sections if title)
    return element("nav", element("ul", f"\n{items}\n"), aria_label="Sections", class_="contents") if items else ""


def _badges(outcome: Outcome) -> Iterator[tuple[str, str]]:
    """Yield the outcome of a report as badges, each with its key: a mark and a text."""
    if not outcome.solvable:
        yield "solvable", _badge(False, "cannot be solved")
    if outcome.poses:
        of = "poses" if outcome.poses != 1 else "pose"
        text = f"{outcome.assembled:,} of {outcome.poses:,} {of} assembled"
        yield "assembled", _badge(outcome.assembled == outcome.poses, text)
    if outcome.verified is not None:
        yield "verified", _badge(outcome.verified, outcome.verdict)
    if outcome.touching is not None:
        yield "touching", _badge(not outcome.touching, outcome.compared)
    if outcome.published:
        done, total = outcome.published_passed, outcome.published
        yield "published", _badge(done == total, f"{done:,} of {total:,} published numbers reproduced")


def _badge(good: bool, text: str) -> str:
    mark = f'<span aria-hidden="true">{"✓" if good else "✗"}</span>'
    missing = "" if good else screen_reader_text("Attention:")
    return element("span", f"{mark} {missing}{safe(text)}", class_=f"badge {'good' if good else 'bad'}")
