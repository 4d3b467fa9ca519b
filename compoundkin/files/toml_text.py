"""A document as TOML that is pleasant to read, and a text changed only where another document wants it.

Short tables and lists stand on one line, in one order of keys. A text that is changed keeps its comments, its layout
and its line ends: what is another value, more or gone is replaced, inserted or cut out at its place, and the text is
read again. A text of JSON is changed so too: it is one inline table whose keys have another sign behind them.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from types import MappingProxyType
from typing import Any, TypeAlias

from compoundkin.base.errors import InvalidInput, Problem

WIDTH = 100
# The keys, and the places in arrays, that lead to a value.
Way: TypeAlias = tuple[str | int, ...]
NOTHING: Mapping[Way, str] = MappingProxyType({})


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


def changed(
    text: str,
    wanted: Mapping[str, Any],
    syntax: str = "toml",
    written: Mapping[Way, str] = NOTHING,
    read: Callable[[str], Any] | None = None,
) -> str:
    """Return a text of TOML or JSON changed so that it says what is wanted; comments, layout and line ends stay.

    `written` are values as they shall stand in the text, by the keys and places in arrays that lead to them; `read`
    reads a text where somebody has read it already. Raises InvalidInput where the text alone cannot be changed so, such
    as a table written in several places.

    >>> print(changed("a = 1  # one\\nb = [1, 2]\\n", {"a": 2, "b": [1, 2, 3]}))
    a = 2  # one
    b = [1, 2, 3]
    <BLANKLINE>
    >>> changed('{"a": 1, "b":  [1]}', {"a": 2, "b": [1]}, "json", {("a",): "2.0"})
    '{"a": 2.0, "b":  [1]}'
    """
    read = read or (tomllib.loads if syntax == "toml" else json.loads)
    old = read(text)
    if old == wanted:
        return text
    # a last line without an end would take in what is written after it
    more = "" if not text or text.endswith("\n") else "\n"
    try:
        edits = _Edits(text + more, _Layout(text + more, _SIGNS[syntax]), written)
        edits.table((), old, wanted)
        new = edits.applied()
        if more and all(stop <= len(text) for _, stop, _ in edits.splices):
            new = new[:-1]
        if read(new) == wanted:
            return new
    except (_NoPlace, ValueError):
        pass
    raise InvalidInput(Problem("", "this cannot be written into the text at its place", "change it in the text"))


# The sign between a key and its value.
_SIGNS = {"toml": "=", "json": ":"}


class _NoPlace(Exception):
    """What shall change has no place in the text that is known."""


@dataclass
class _LaidSection:
    """A heading with its lines: from the heading to the end of its last line that holds something."""

    way: Way
    start: int
    end: int


_BLANK = re.compile(r"(?:[ \t\r\n]+|\#[^\n]*)*")
_SPACES = re.compile(r"[ \t]*")
_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'""")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}' + r"|'{3}[\s\S]*?'{3,5}" + r'|"(?:[^"\\\n]|\\.)*"' + r"|'[^'\n]*'", re.DOTALL
)
_BARE = re.compile(r"[^\s,\]}#]+(?: \d[^\s,\]}#]*)?")
_HEAD = re.compile(r"\[\[?")
_APART = re.compile(r"\n(\r?\n)\Z")


@dataclass
class _Layout:
    """Where the sections, entries and values of a text stand: by their ways, from where to where."""

    text: str
    sign: str
    sections: list[_LaidSection] = field(default_factory=list)
    entries: dict[Way, tuple[int, int]] = field(default_factory=dict)
    values: dict[Way, tuple[int, int]] = field(default_factory=dict)
    own: dict[Way, Way] = field(default_factory=dict)  # of an entry in lines: the way of its section

    def __post_init__(self) -> None:
        if self.sign == ":":
            self._value(self.skip_blank(0), ())
        else:
            self._note_lines()

    def _note_lines(self) -> None:
        """Note the sections of TOML, and the entries in their lines."""
        at, section, counts = 0, _LaidSection((), 0, 0), dict[Way, int]()
        self.sections.append(section)
        while (at := self._skip(_BLANK, at)) < len(self.text):
            head = _HEAD.match(self.text, at)
            if head:
                keys, stop = self._keys(self._skip(_SPACES, head.end()))
                way = self._resolved(keys, counts)
                if len(head[0]) == 2:
                    counts[way] = counts.get(way, -1) + 1
                    way = (*way, counts[way])
                section = _LaidSection(way, self.line_start(at), self.line_end(stop))
                self.sections.append(section)
            else:
                stop = self._entry(at, section.way, section.way)
                section.end = self.line_end(stop)
            at = self.line_end(stop)

    def _resolved(self, keys: Way, counts: Mapping[Way, int]) -> Way:
        """Return the way of a heading, in the last of the tables of arrays that it leads through."""
        way: Way = ()
        for k, key in enumerate(keys):
            way = (*way, key)
            if way in counts and k < len(keys) - 1:
                way = (*way, counts[way])
        return way

    def _skip(self, what: re.Pattern[str], at: int) -> int:
        found = what.match(self.text, at)
        return found.end() if found else at

    def skip_blank(self, at: int) -> int:
        """Return where the next thing after a place stands that is neither blank nor a comment."""
        return self._skip(_BLANK, at)

    def line_start(self, at: int) -> int:
        """Return where the line of a place begins."""
        return self.text.rfind("\n", 0, at) + 1

    def line_end(self, at: int) -> int:
        """Return where the line of a place ends, its sign of the end included."""
        end = self.text.find("\n", at)
        return len(self.text) if end < 0 else end + 1

    def _keys(self, at: int) -> tuple[Way, int]:
        found: list[str] = []
        while True:
            key = _KEY.match(self.text, at)
            if key is None:
                raise _NoPlace
            written = key[0]
            found.append(json.loads(written) if written[0] == '"' else written.strip("'"))
            at = self._skip(_SPACES, key.end())
            if self.text[at : at + 1] != ".":
                return tuple(found), at
            at = self._skip(_SPACES, at + 1)

    def _entry(self, at: int, way: Way, section: Way | None) -> int:
        """Note a key with its value; return where it ends."""
        keys, stop = self._keys(at)
        if self.text[stop : stop + 1] != self.sign:
            raise _NoPlace
        whole = (*way, *keys)
        end = self._value(self._skip(_SPACES, stop + 1), whole)
        self.entries[whole] = at, end
        if section is not None:
            self.own[whole] = section
        return end

    def _value(self, at: int, way: Way) -> int:
        sign = self.text[at : at + 1]
        if sign in ("[", "{"):
            end = self._several(at + 1, way, "]" if sign == "[" else "}")
        else:
            found = (_STRING if sign in ("'", '"') else _BARE).match(self.text, at)
            if found is None:
                raise _NoPlace
            end = found.end()
        self.values[way] = at, end
        return end

    def _several(self, at: int, way: Way, closing: str) -> int:
        """Note the items of an array or the entries of an inline table; return where it ends."""
        count = 0
        while True:
            at = self._skip(_BLANK, at)
            if self.text[at : at + 1] == closing:
                return at + 1
            if closing == "}":
                at = self._entry(at, way, None)
            else:
                start = at
                at = self._value(at, (*way, count))
                self.entries[*way, count] = start, at
                count += 1
            at = self._skip(_BLANK, at)
            if self.text[at : at + 1] == ",":
                at += 1
            elif self.text[at : at + 1] != closing:
                raise _NoPlace


@dataclass
class _Edits:
    """What of a text is replaced: from where, to where, by what."""

    text: str
    layout: _Layout
    written: Mapping[Way, str]
    splices: list[tuple[int, int, str]] = field(default_factory=list)

    def applied(self) -> str:
        """Return the text with all replacements; of several at one place those noted first stand first."""
        new, last = [], 0
        is_crlf = 2 * self.text.count("\r\n") > self.text.count("\n")
        for start, end, by in sorted(self.splices, key=lambda one: one[:2]):
            if start < last:
                # cut out already, with what held it
                if by:
                    raise _NoPlace
                last = max(last, end)
                continue
            new += [self.text[last:start], by.replace("\n", "\r\n") if is_crlf else by]
            last = end
        return "".join([*new, self.text[last:]])

    def table(self, way: Way, old: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
        """Change a table: keys that are gone, those that have other values, new ones."""
        gone = [key for key in old if key not in wanted]
        new = {key: value for key, value in wanted.items() if key not in old}
        for key, value in wanted.items():
            if key in old and old[key] != value:
                self._change((*way, key), old[key], value)
        if way in self.layout.values:
            if gone or new:
                ways = [(*way, key) for key in gone]
                self._inside(way, ways, [self._entry(k, v) for k, v in new.items()])
            return
        for key in gone:
            self._cut((*way, key))
        for key, value in new.items():
            self._insert(way, key, value)

    def _change(self, way: Way, old: Any, new: Any) -> None:
        if isinstance(old, dict) and isinstance(new, dict):
            self.table(way, old, new)
        elif isinstance(old, list) and isinstance(new, list) and (way in self.layout.values or _lists_tables(old)):
            self._list(way, old, new)
        elif way in self.layout.values:
            self.splices.append((*self.layout.values[way], self.written.get(way) or self._value(new)))
        else:
            raise _NoPlace

    def _value(self, value: Any) -> str:
        """Return a value as it is written."""
        if self.layout.sign == ":":
            return json.dumps(value, ensure_ascii=False)
        return _text(value) if isinstance(value, str) else _inline(value)

    def _entry(self, key: str, value: Any) -> str:
        """Return an entry of an inline table."""
        if self.layout.sign == ":":
            return f"{json.dumps(key, ensure_ascii=False)}: {self._value(value)}"
        return f"{_key(key)} = {_inline(value)}"

    def _list(self, way: Way, old: list[Any], new: list[Any]) -> None:
        """Change an array: what is equal in both stays, items between are changed, cut out or inserted."""
        before, after = ([json.dumps(one, sort_keys=True, default=str) for one in items] for items in (old, new))
        ways = SequenceMatcher(None, before, after, autojunk=False).get_opcodes()
        in_line = way in self.layout.values
        is_other = len(old) != len(new) and not any(what == "equal" for what, *_ in ways)
        if in_line and not _lists_tables(old) and is_other:
            self.splices.append((*self.layout.values[way], self._value(new)))
            return
        gone: list[Way] = []
        for what, i, j, k, m in ways:
            if what == "equal":
                continue
            both = min(j - i, m - k)
            for one in range(both):
                self._change((*way, i + one), old[i + one], new[k + one])
            gone += [(*way, one) for one in range(i + both, j)]
            if k + both < m and in_line:
                self._inside(way, [], [self._value(one) for one in new[k + both : m]], j)
            elif k + both < m:
                self._insert_tables(way, new[k + both : m], j)
        if gone and in_line:
            self._inside(way, gone, [])
        elif gone:
            for table in gone:
                self._cut(table)

    def _insert_tables(self, way: Way, tables: Iterable[Any], before: int) -> None:
        """Insert tables of an array, each with its heading."""
        beside = (*way, before - 1 if before else 0)
        spans = [(one.start, one.end) for one in self.layout.sections if one.way[: len(beside)] == beside]
        if not spans:
            raise _NoPlace
        place = spans[-1][1] if before else spans[0][0]
        for one in tables:
            lines = "\n".join((f"[[{_path(way)}]]", *_table(one, _path(way)))) + "\n"
            self.splices.append((place, place, f"\n{lines}" if before else f"{lines}\n"))

    def _inside(self, way: Way, gone: Sequence[Way], new: Sequence[str], before: int | None = None) -> None:
        """Cut entries out of an array or an inline table, and insert others after the last one or before an index."""
        start, end = self.layout.values[way]
        inner = sorted((span, one) for one, span in self.layout.entries.items() if self._is_direct(way, one))
        spans = [span for span, _ in inner]
        out = [any(one[: len(k)] == k for k in gone) for _, one in inner]
        if all(out):
            pad = " " if self.text[start] == "{" and new else ""
            whole = f"{self.text[start]}{pad}{', '.join(new)}{pad}{self.text[end - 1]}"
            self.splices.append((start, end, whole))
            return
        for k in (k for k, is_out in enumerate(out) if is_out):
            self.splices.append((*self._with_comma(spans, k, not all(out[:k])), ""))
        at = len(spans) if before is None else before
        if new and at == len(spans):
            place, glue = spans[-1][1], self._glue(spans[-1][0])
            self.splices.append((place, place, "".join(f",{glue}{one}" for one in new)))
        elif new:
            place, glue = spans[at][0], self._glue(spans[at][0])
            self.splices.append((place, place, "".join(f"{one},{glue}" for one in new)))

    def _glue(self, place: int) -> str:
        """Return what stands between items: a line's end with its indentation, where this one begins its line."""
        before = self.text[self.layout.line_start(place) : place]
        return " " if before.strip() else f"\n{before}"

    def _with_comma(self, spans: Sequence[tuple[int, int]], k: int, is_after_others: bool) -> tuple[int, int]:
        """Return from where to where an item is cut out: with the comma before it, or after it where it is the first.

        A comment between the two stays: then a comma stays behind, which an array may end with.
        """
        start, end = spans[k]
        cut = (spans[k - 1][1], end) if is_after_others else (start, spans[k + 1][0])
        between = self.text[cut[0] : start] + self.text[end : cut[1]]
        if "#" not in between:
            return cut
        after = self.layout.skip_blank(end)
        return start, after + 1 if self.text[after : after + 1] == "," else end

    def _is_direct(self, way: Way, one: Way) -> bool:
        """Return whether an entry is of this array or inline table itself, not of one inside it."""
        inside = len(one) > len(way) and one[: len(way)] == way
        return inside and not any(one[:k] in self.layout.values for k in range(len(way) + 1, len(one)))

    def _cut(self, way: Way) -> None:
        """Cut out a key of a table: its lines and its sections, each with one of the empty lines before it."""
        size, before = len(way), len(self.splices)
        for one, (start, end) in self.layout.entries.items():
            if one[:size] == way and one in self.layout.own and len(self.layout.own[one]) < size:
                self.splices.append((self.layout.line_start(start), self.layout.line_end(end), ""))
        for section in self.layout.sections:
            if section.way and section.way[:size] == way:
                apart = _APART.search(self.text[: section.start])
                self.splices.append((section.start - len(apart[1]) if apart else section.start, section.end, ""))
        if len(self.splices) == before:
            raise _NoPlace

    def _insert(self, way: Way, key: str, value: Any) -> None:
        """Insert a key with its value into a table that is written in lines."""
        whole = _path((*way, key))
        if _has_own_heading(key, value, nested=len(way) > 1):
            lines = "\n".join(_section_of(whole, value) if way else _section(whole, value)) + "\n"
            # beside the tables of its kind, else at the end
            same = [one for one in self.layout.sections if way and one.way[: len(way)] == way]
            place = same[-1].end if same else len(self.text)
            self.splices.append((place, place, lines if place else lines.lstrip()))
            return
        home = next((one for one in self.layout.sections if one.way == way), None)
        if home is None:
            raise _NoPlace
        line = f"{_key(key)} = {_wrapped(value, WIDTH - len(_key(key)) - 3)}\n"
        self.splices.append((home.end, home.end, line))


def _path(way: Way) -> str:
    """Return the words of a heading; which table of an array it is, its place in the file tells."""
    return ".".join(_key(key) for key in way if isinstance(key, str))
