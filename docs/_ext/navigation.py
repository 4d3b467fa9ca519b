"""The order of the pages. It stands here so that the first page is plain Markdown wherever it is read."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import filter as matching
from typing import Any

from sphinx.application import Sphinx

# Headings and the pages below them; a pattern stands for the pages that are there.
CONTENTS: dict[str, tuple[str, ...]] = {
    "Start": (
        *("Quickstart <self>", "notebooks/first*", "notebooks/*"),
        *("press-drive", "outlines", "loads", "machine", "simulation"),
    ),
    "Use it": (
        *("pairs", "cams", "laws", "circuits", "composing", "pictures", "animation", "plots", "page"),
        *("studies", "clusters", "tolerances", "optimisation", "compiled"),
        *("cli", "file-format", "exchange/index", "study-files", "programs_in_other_languages"),
    ),
    "Understand it": ("theory", "friction", "notation"),
    "Examples": ("gallery/index", "catalog"),
    "Refer to it": ("api/index",),
    "Add to it": ("adding", "architecture", "modules"),
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


def setup(app: Sphinx) -> dict[str, Any]:
    """Read the first page with the tables of contents."""
    app.connect("source-read", append)
    return {"parallel_read_safe": True}
