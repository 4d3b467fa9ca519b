"""A document as TOML that is pleasant to read. Short tables and lists on one line, one order of keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

WIDTH = 100


def dumps(document: Mapping[str, Any]) -> str:
    """Return the text of a document of tables, lists, texts and numbers.

    >>> print(dumps({"a": 1, "t": {"x": [1, 2.5]}, "s": [{"y": "z"}]}))
    a = 1
    <BLANKLINE>
    [t]
    x = [1, 2.5]
    <BLANKLINE>
    [[s]]
    y = "z"
    <BLANKLINE>
    """
    return "\n".join(_table(document, "")) + "\n"


def _table(table: Mapping[str, Any], path: str) -> Iterator[str]:
    """Yield the lines of a table. Its entries first, as TOML wants it, then the tables in it."""
    inner = {}
    for key, value in table.items():
        if _has_own_heading(key, value, nested=bool(path)):
            inner[key] = value
        else:
            yield f"{_key(key)} = {_wrapped(value, WIDTH - len(_key(key)) - 3)}"
    for key, value in inner.items():
        yield from _section(f"{path}.{_key(key)}" if path else _key(key), value)


def _section(path: str, value: Any) -> Iterator[str]:
    if isinstance(value, list):
        for entry in value:
            yield from ("", f"[[{path}]]", *_table(entry, path))
    elif value and all(_is_table(entry) for entry in value.values()):
        for key, entry in value.items():
            yield from _section_of(f"{path}.{_key(key)}", entry)
    else:
        yield from _section_of(path, value)


def _section_of(path: str, table: Mapping[str, Any]) -> Iterator[str]:
    lines = list(_table(table, path))
    # the heading of a table that holds nothing but tables may be left out
    heading = [] if lines and not lines[0] else ["", f"[{path}]"]
    yield from (*heading, *lines)


def _has_own_heading(key: str, value: Any, nested: bool) -> bool:
    if isinstance(value, dict):
        return not nested or len(f"{_key(key)} = {_inline(value)}") > WIDTH
    # tables listed in a table are short: the segments of a program
    return not nested and _lists_tables(value)


def _lists_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(_is_table(entry) for entry in value)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


def _wrapped(value: Any, room: int, indent: str = "") -> str:
    """Return a value on one line, or a list on several. `room` is left on the first."""
    line = _text(value) if isinstance(value, str) else _inline(value)
    if len(line) <= room or not isinstance(value, list):
        return line
    inner = f"{indent}    "
    lines: list[str] = []
    for entry in (_wrapped(entry, WIDTH - len(inner) - 1, inner) for entry in value):
        fits = lines and len(lines[-1]) + len(entry) + 2 <= WIDTH and "\n" not in lines[-1] + entry
        if fits and not _lists_tables(value):
            lines[-1] += f" {entry},"
        else:
            lines.append(f"{inner}{entry},")
    return "\n".join(["[", *lines, f"{indent}]"])


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        entries = ", ".join(f"{_key(key)} = {_inline(entry)}" for key, entry in value.items())
        return f"{{ {entries} }}" if entries else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return _literal(value) if isinstance(value, str) else repr(value)


def _literal(value: str, lines: bool = False) -> str:
    import tomli_w

    return tomli_w.dumps({"a": value}, multiline_strings=lines)[len("a = ") : -1]


def _text(value: str) -> str:
    # a multi-line text would not keep \r
    return _literal(value, lines="\n" in value and "\r" not in value)


def _key(key: str) -> str:
    import tomli_w

    return tomli_w.dumps({key: 0})[: -len(" = 0\n")]
