"""The comment at the head of a text: what it computes, of what, in which units, and when it cannot."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from compoundkin.base.version import VERSION
from compoundkin.programs.sources.contract import WrittenProgram

WIDTH = 96


def explanation(program: WrittenProgram, use: str) -> list[str]:
    """Return the lines of the comment, without the signs of one. `use` tells how the function is called."""
    whether = "always true" if program.always else "whether it can be assembled; all others are NaN where it cannot"
    inputs = [(one.name, one.unit, _with_own(one.meaning, one.own)) for one in program.arguments]
    outputs = [(one.name, one.unit, one.meaning) for one in program.results]
    lines = [program.title, "", f"{program.name}: one pose of this mechanism, of the numbers given. {use}"]
    lines += ["", "Inputs", *_table(inputs), "", "Outputs"]
    lines += _table([("assembled", "", whether), *outputs])
    for note in program.notes:
        lines += ["", note]
    lines += ["", f"Made by compoundkin {VERSION}."]
    return [_plain(part) for line in lines for part in _wrapped(line)]


def _with_own(meaning: str, own: float | None) -> str:
    return meaning if own is None else f"{meaning}; {own!r} in the mechanism"


def _table(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Rows with their columns below each other."""
    names, units = (max(len(row[k]) for row in rows) if rows else 0 for k in (0, 1))
    return [f"  {name:<{names}}  {unit:<{units}}  {told}" for name, unit, told in rows]


def _wrapped(line: str) -> list[str]:
    indent = "    " if line.startswith("  ") else ""
    return textwrap.wrap(line, WIDTH, subsequent_indent=indent, break_long_words=False) or [""]


def _plain(line: str) -> str:
    """A line that ends no comment in any language, whatever a title says."""
    line = " ".join(line.splitlines()).replace("\\", "/").replace('"""', "'''").replace("??", "? ?")
    return line.replace("*/", "* /").replace("/*", "/ *").rstrip()
