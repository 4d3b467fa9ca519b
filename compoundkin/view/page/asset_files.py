"""The files that pages are made with: style sheets, scripts, and libraries of others."""

from __future__ import annotations

from functools import cache
from pathlib import Path

ASSETS = Path(__file__).parent / "assets"


@cache
def asset(name: str) -> str:
    """The text of a file.

    >>> "sortable" in asset("vendor/sortable.min.js")
    True
    """
    return (ASSETS / name).read_text(encoding="utf-8").strip()


def vendored(name: str, licence: str, gives: str = "") -> str:
    """A library as part of a page: with its licence, and in a function, so that its names stay its own.

    What it `gives` is then `compoundkin.uPlot`, or whatever its name is.

    >>> vendored("uPlot.iife.min.js", "uPlot.LICENSE.txt", "uPlot").splitlines()[-2:]
    ['(window.compoundkin ??= {}).uPlot = uPlot;', '})();']
    """
    given = f"\n(window.compoundkin ??= {{}}).{gives} = {gives};" if gives else ""
    return f"/*\n{asset(f'vendor/{licence}')}\n*/\n(() => {{\n{asset(f'vendor/{name}')}{given}\n}})();"
