"""The suffixes of files: what can be saved as what, in one table that all writers and the command line read."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Literal, TypeAlias

from compoundkin.base.errors import InvalidInput, Problem

Kind: TypeAlias = Literal[
    "mechanism", "table", "picture", "plot", "animation", "page", "report", "program", "study", "task", "curve"
]
# Of each kind its suffixes and the format that each means; messages name the first suffix of a format.
SUFFIXES: Mapping[Kind, Mapping[str, str]] = MappingProxyType(
    {
        "mechanism": {".toml": "toml", ".json": "json"},
        "table": {".csv": "csv", ".json": "json", ".npz": "npz", ".parquet": "parquet"},
        "picture": {".svg": "svg", ".png": "png", ".pdf": "pdf", ".tex": "tikz"},
        "plot": {".png": "png", ".svg": "svg", ".pdf": "pdf"},
        "animation": {".gif": "gif", ".mp4": "mp4", ".svg": "svg"},
        "page": {".html": "html", ".htm": "html"},
        "report": {
            ".txt": "text",
            ".md": "markdown",
            ".markdown": "markdown",
            ".json": "json",
            ".html": "html",
            ".htm": "html",
        },
        "program": {".c": "c", ".py": "python", ".js": "javascript", ".m": "matlab"},
        "study": {".toml": "toml", ".json": "json"},
        "task": {".toml": "toml", ".json": "json"},
        "curve": {".csv": "csv", ".svg": "svg", ".dxf": "dxf"},
    }
)
# Kinds that messages call "mechanism files", not "mechanisms".
_OF_FILES: tuple[Kind, ...] = ("mechanism", "study", "task")
# Kinds that are written by hand and read, and not saved: messages of what can be saved leave them out.
READ_ALONE: tuple[Kind, ...] = ("task", "curve")
# What a name without a suffix means, where there is one form that everybody expects.
WITHOUT: Mapping[Kind, str] = MappingProxyType({"page": "html", "report": "text"})


_PRINTED = "; an .html page is printed as PDF by any browser, a sheet on A4"
_PLAYED = "; .mp4 and .gif are what slides and players take"
_OPENED = "; an .html page opens there too"
# What helps where a suffix is wanted that is not written.
_INSTEAD: Mapping[tuple[Kind, str], str] = MappingProxyType(
    {
        ("report", ".pdf"): _PRINTED,
        ("page", ".pdf"): _PRINTED,
        ("report", ".tex"): "; compoundkin exercise writes sheets and solutions in LaTeX",
        **{("report", suffix): _OPENED for suffix in (".doc", ".docx", ".odt", ".pptx")},
        **{("animation", suffix): _PLAYED for suffix in (".avi", ".mov", ".mkv", ".webm", ".wmv", ".ppt", ".pptx")},
    }
)


def file_format(kind: Kind, path: str | os.PathLike[str]) -> str:
    """Return the format that a file's suffix means. Raises InvalidInput for a suffix of another kind.

    >>> file_format("animation", "six-bar.GIF"), file_format("page", "six-bar")
    ('gif', 'html')
    >>> file_format("plot", "a.gif")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: a.gif: a plot is not saved as '.gif', \
an animation is; plots end in .png, .svg, .pdf
    """
    suffix = suffix_of(path)
    form = SUFFIXES[kind].get(suffix) if suffix else WITHOUT.get(kind)
    if form is None:
        what = (
            f"{_with_article(kind)} is not saved as {suffix!r}{_other_kinds(suffix)}"
            if suffix
            else "the file has no suffix"
        )
        helps = _INSTEAD.get((kind, suffix), "")
        raise InvalidInput(Problem(str(path), what, f"{_suffix_phrase(kind)}{helps}"))
    return form


def all_suffixes() -> str:
    """Return what can be saved as what, in words."""
    return "; ".join(_suffix_phrase(kind) for kind in SUFFIXES if kind not in READ_ALONE)


def suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file's name in small letters, or nothing."""
    return Path(path).suffix.lower()


def suffix_for(kind: Kind, form: str) -> str:
    """Return the preferred suffix of a format.

    >>> suffix_for("report", "markdown")
    '.md'
    """
    return next(suffix for suffix, meant in SUFFIXES[kind].items() if meant == form)


def alternatives(kind: Kind) -> str:
    """Return the suffixes of a kind in words, for help texts.

    >>> alternatives("animation")
    '.gif, .mp4 or .svg'
    """
    *most, last = _preferred_suffixes(kind)
    return f"{', '.join(most)} or {last}"


def _preferred_suffixes(kind: Kind) -> list[str]:
    """The first suffix of each form."""
    return [suffix_for(kind, form) for form in dict.fromkeys(SUFFIXES[kind].values())]


def _suffix_phrase(kind: Kind) -> str:
    plural = f"{kind} files" if kind in _OF_FILES else f"{kind}s"
    return f"{plural} end in {', '.join(_preferred_suffixes(kind))}"


def _other_kinds(suffix: str) -> str:
    """What else is saved with a suffix."""
    *most, last = [
        _with_article(kind) for kind, own in SUFFIXES.items() if suffix in own and kind not in READ_ALONE
    ] or [""]
    if most:
        return f", {', '.join(most)} and {last} are"
    return f", {last} is" if last else ""


def _with_article(kind: Kind) -> str:
    return f"{'an' if kind.startswith('a') else 'a'} {kind}"
