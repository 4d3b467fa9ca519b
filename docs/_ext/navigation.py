"""The order of the pages. It stands here so that the first page is plain Markdown wherever it is read."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import filter as matching
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

# Headings and the pages below them; a pattern stands for the pages that are there.
CONTENTS: dict[str, tuple[str, ...]] = {
    "Start": (
        *("Quickstart <self>", "first-tasks", "for-students", "for-engineers", "for-programmers"),
        *("notebooks/first*", "notebooks/*"),
        *("linkages", "press-drive", "outlines", "loads", "machine", "simulation", "exercises"),
    ),
    "Use it": (
        *(
            "pairs",
            "cams",
            "laws",
            "circuits",
            "composing",
            "synthesis",
            "from-a-sketch",
            "letters",
            "pictures",
            "animation",
            "plots",
            "page",
        ),
        "studio",
        *("studies", "clusters", "data-sets", "tolerances", "optimisation", "compiled"),
        *("cli", "file-format", "exchange/index", "study-files", "programs_in_other_languages"),
    ),
    "Understand it": ("theory", "friction", "notation", "words"),
    "Examples": ("gallery/index", "catalog"),
    "Refer to it": ("api/index",),
    "Add to it": ("adding", "architecture", "benchmarks"),
}


def contents(documents: Iterable[str]) -> str:
    """The tables of contents, in MyST."""
    known, lines = sorted(documents), []
    for caption, patterns in CONTENTS.items():
        found = (page for pattern in patterns for page in (matching(known, pattern) or single(pattern)))
        lines += ["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *dict.fromkeys(found), "```", ""]
    return "\n".join(lines)


def single(pattern: str) -> list[str]:
    """An entry that is no pattern as it is; nothing for a pattern without pages."""
    return [] if "*" in pattern else [pattern]


def append(app: Sphinx, docname: str, source: list[str]) -> None:
    """Put them at the end of the first page."""
    if docname == app.config.root_doc:
        source[0] += contents(app.env.found_docs)


def title_alone(contents_of_page: nodes.Element) -> nodes.Element:
    """A page's entry in the sidebar: its title and the pages below it, as the theme leaves them."""
    found = contents_of_page.deepcopy()
    for entry in found.children:
        below = list(entry.findall(addnodes.toctree))
        if below:
            entry[1][:] = below
        elif len(entry) > 1:
            entry.pop(1)
    return found


def titles_alone(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: nodes.document | None) -> None:
    """Make the sidebar of titles from the start.

    The theme has all headings of all pages copied for every page and drops them again: a quarter of the whole build.
    """
    whole, env = context["toctree"], app.env

    def sidebar(**words: Any) -> str:
        kept, env.tocs = env.tocs, short_tables(app)
        try:
            return str(whole(**words))
        finally:
            env.tocs = kept

    context["toctree"] = sidebar


def short_tables(app: Sphinx) -> dict[str, Any]:
    """The tables of contents without headings, made once."""
    found: dict[str, Any] = getattr(app, "short_tables", {})
    if not found:
        found = {name: title_alone(table) for name, table in app.env.tocs.items()}
        app.short_tables = found  # type: ignore[attr-defined]
    return found


def setup(app: Sphinx) -> dict[str, Any]:
    """Read the first page with the tables of contents; titles alone are there before the theme asks for them."""
    app.connect("source-read", append)
    app.connect("html-page-context", titles_alone, priority=400)
    return {"parallel_read_safe": True}
