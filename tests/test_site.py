"""The documentation site: it is built without a warning, holds what it must, and loads nothing from elsewhere."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import compoundkin as ck
from tests.figures import FIGURES, FOLDER
from tests.view.test_notebooks import NOTEBOOKS, assert_it_ran

pytestmark = pytest.mark.full
ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(path.relative_to(DOCS) for path in (*DOCS.glob("*.md"), *DOCS.glob("notebooks/*.ipynb")))
# What a browser fetches by itself, by the tags and attributes that say so.
FETCHED = {
    ("script", "src"),
    ("img", "src"),
    ("iframe", "src"),
    ("source", "src"),
    ("video", "src"),
    ("object", "data"),
}
# The mechanisms of the gallery that is built here, of most kinds: pictures and pages of all take minutes.
SHOWN = (
    "crank-rocker", "slider-crank", "six-bar", "class-iii-six-bar", "planetary-train", "disc-cam-roller-program",
    "five-bar",
)  # fmt: skip
# Relations of <link> that fetch nothing.
TOLD = {"index", "search", "next", "prev", "canonical"}


@dataclass
class Page(HTMLParser):
    """What a page fetches, where it links to, which anchors it has, and its text."""

    path: Path
    text: str = ""
    fetched: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.path.read_text(encoding="utf-8"))

    def __hash__(self) -> int:
        return hash(self.path)

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {key: value or "" for key, value in attrs}
        self.anchors |= {given[key] for key in ("id", "name") if key in given}
        self.fetched += [value for key, value in given.items() if (tag, key) in FETCHED]
        if tag == "link" and given.get("rel", "") not in TOLD:
            self.fetched.append(given.get("href", ""))
        if tag == "a" and "href" in given:
            self.links.append(given["href"])


@dataclass(frozen=True)
class Site:
    """The built site."""

    root: Path

    @cached_property
    def pages(self) -> dict[Path, Page]:
        """All pages by their places."""
        return {path: Page(path) for path in sorted(self.root.rglob("*.html"))}


def build(folder: Path) -> Site:
    """Build it, from a copy, so that nothing is written beside the sources; notebooks with results are kept."""
    ignored = shutil.ignore_patterns("gallery", "__pycache__", ".ipynb_checkpoints")
    shutil.copytree(DOCS, folder / "docs", ignore=ignored)
    shutil.copytree(ROOT / "catalog", folder / "catalog")
    words = ("-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-d", "doctrees")
    keeping = ("-D", "nb_execution_mode=cache", "-D", f"nb_execution_cache_path={folder / 'ran'}")
    # nobody's settings of Jupyter or IPython are read or changed
    names = ("JUPYTER_DATA_DIR", "JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    own = {**os.environ, **{name: str(folder / name.lower()) for name in names}}
    few = ("-D", f"gallery_mechanisms={','.join(SHOWN)}")
    command = [sys.executable, *words, *keeping, *few, "docs", "site"]
    ran = subprocess.run(command, cwd=folder, env=own, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return Site(folder / "site")


def test_the_site(tmp_path: Path) -> None:
    """One build, and all that is asked of it: building twice would cost a minute more."""
    # lists the fonts, which the first notebook that draws would tell otherwise
    import_module("matplotlib.font_manager")
    site = build(tmp_path)
    every_page_is_there(site)
    every_public_name_is_described(site)
    the_gallery_is_whole(site)
    nothing_is_fetched_from_elsewhere(site)
    every_link_leads_somewhere(site)
    it_can_be_searched(site)
    every_notebook_ran(tmp_path)


def every_notebook_ran(folder: Path) -> None:
    ran = sorted((folder / "ran").rglob("*.ipynb"))
    assert len(ran) == len(NOTEBOOKS)
    for path in ran:
        assert_it_ran(path)
    left = {path.name for path in (folder / "docs" / "notebooks").iterdir()}
    assert left == {path.name for path in NOTEBOOKS}


def every_page_is_there(site: Site) -> None:
    listed = {site.root / page.with_suffix(".html") for page in PAGES}
    listed |= {site.root / "api" / f"{path.stem}.html" for path in (DOCS / "api").glob("*.rst")}
    assert not listed - set(site.pages)
    start = site.root / "index.html"
    sidebar = {site.root / href.split("#")[0] for href in site.pages[start].links}
    assert not listed - sidebar - {start}, "pages that docs/_ext/navigation.py does not name"
    assert not {site.root / "gallery" / f"{name}.html" for name in SHOWN} - set(site.pages)


def every_public_name_is_described(site: Site) -> None:
    # four lines of head; then, compressed, a line for each name: name, domain:kind, priority, place, title
    *_, packed = (site.root / "objects.inv").read_bytes().split(b"\n", 4)
    rows = [line.split() for line in zlib.decompress(packed).decode("utf-8").splitlines()]
    described = {row[0] for row in rows if row[1].startswith("py:")}
    missing = set(public_names()) - described
    assert not missing, f"docs/api/ does not describe {sorted(missing)}"


def public_names() -> Iterator[str]:
    """All of the package's, and those of its named modules."""
    yield from (f"compoundkin.{name}" for name in ck.__all__)
    for part in ck._MODULES:
        yield from (f"compoundkin.{part}.{name}" for name in getattr(ck, part).__all__)


def the_gallery_is_whole(site: Site) -> None:
    index = site.pages[site.root / "gallery" / "index.html"]
    assert {f"{name}.html" for name in SHOWN} <= set(index.links)
    for suffix in ("", "-small"):
        pictures = [site.root / "_images" / f"{name}{suffix}.svg" for name in SHOWN]
        sources = [path.read_text(encoding="utf-8") for path in pictures]
        # what follows the title differs: links at other places
        drawn = {source[source.index("</style>") :] for source in sources}
        assert len(drawn) == len(sources)
        assert all(source.count("<path") + source.count("<circle") > 4 for source in sources)
    for name in SHOWN:
        text = site.pages[site.root / "gallery" / f"{name}.html"].text
        live = site.root / "gallery" / f"{name}-live.html"
        assert f"{name}-live.html" in site.pages[site.root / "gallery" / f"{name}.html"].links
        assert "ck-motion" in live.read_text(encoding="utf-8")
        assert all(words in text for words in ("Structure:", "Source:", f"compoundkin report {name}", "Assur group"))


def nothing_is_fetched_from_elsewhere(site: Site) -> None:
    for page in site.pages.values():
        assert not [address for address in page.fetched if urlsplit(address).scheme not in ("", "data")], page.path
    for style in (*site.root.rglob("*.css"), *site.root.rglob("*.svg")):
        text = style.read_text(encoding="utf-8")
        assert not re.search(r"url\(\s*['\"]?(https?:)?//|@import", text), style
        assert not re.search(r"(href|src)=['\"](https?:)?//", text), style


def every_link_leads_somewhere(site: Site) -> None:
    for page in site.pages.values():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or not link:
                continue
            target = (page.path.parent / unquote(parts.path)).resolve() if parts.path else page.path
            assert target.is_file(), f"{page.path.name} links to {link}"
            if parts.fragment and target in site.pages:
                assert unquote(parts.fragment) in site.pages[target].anchors, f"{page.path.name} links to {link}"


def it_can_be_searched(site: Site) -> None:
    index = (site.root / "searchindex.js").read_text(encoding="utf-8")
    assert "planetary" in index
    assert (site.root / "search.html") in site.pages


# --- the pages as they are read without a site ---------------------------------------------------------------------


def markdown(path: Path) -> str:
    """The Markdown of a page or a notebook, without code."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    return re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)


def anchors(path: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    titles = re.findall(r"^#+ +(.*?) *$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


READ_ALONE = (Path("README.md"), Path("CONTRIBUTING.md"))


@pytest.mark.parametrize("page", [*(Path("docs") / page for page in PAGES), *READ_ALONE], ids=str)
def test_links_between_pages(page: Path) -> None:
    path = ROOT / page
    for link in re.findall(r"\]\(([^)\s]+)\)", markdown(path)):
        parts = urlsplit(link)
        if parts.scheme:
            continue
        target = path.parent / unquote(parts.path) if parts.path else path
        assert target.is_file(), f"{page} links to {link}"
        if parts.fragment and target.suffix == ".md":
            assert parts.fragment in anchors(target), f"{page} links to {link}"


@pytest.mark.parametrize("name", FIGURES)
def test_figures_are_up_to_date(name: str) -> None:
    """If not: look at what `python -m tests.figures` writes."""
    assert FIGURES[name]().svg == (FOLDER / f"{name}.svg").read_text(encoding="utf-8")


def test_every_figure_is_shown() -> None:
    shown = {name for page in DOCS.glob("*.md") for name in re.findall(r"\(figures/([\w-]+)\.svg\)", page.read_text())}
    assert shown == set(FIGURES) == {path.stem for path in FOLDER.glob("*.svg")}


def test_the_first_page_prints_what_it_shows(tmp_path: Path) -> None:
    text = (DOCS / "index.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (shown,) = re.findall(r"```text\n(.*?)```", text, re.DOTALL)
    ran = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ran.stdout == shown
    figure = (DOCS / "figures" / "crank-rocker.svg").read_text(encoding="utf-8")
    assert (tmp_path / "crank-rocker.svg").read_text(encoding="utf-8") == figure
