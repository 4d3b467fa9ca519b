"""Project files of Pyslvs-UI: the part of YAML that they are written in, as texts by their keys.

Nothing but texts is made of it: no tags, no anchors, no objects.
"""

from __future__ import annotations

import re

from compoundkin.base.display import short_repr
from compoundkin.files.exchange.pmks.joint_text import is_short
from compoundkin.files.exchange.problems import Problems

_ENTRY = re.compile(r"(['\"]?)(\w+)\1:(?:\s+(.*))?")
_ESCAPED = re.compile(r"\\(?:x([0-9a-fA-F]{2})|u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))", re.DOTALL)
_PLAIN_ESCAPES = {"n": "\n", "t": "\t", "\\": "\\", '"': '"', "'": "'", " ": " ", "/": "/", "r": "\r", "0": ""}
# What stands before keeps the search from beginning anew at every blank of a row.
_JOINED = re.compile(r"(?<!\\)(?:\\\\)*\\$")
# Recorded paths may make projects long.
_MOST_CHARACTERS = 2_000_000
# Projects have a dozen.
_MOST_ENTRIES = 1000
# What begins a tag, an anchor, an alias: never in what these programs write of a mechanism.
_REFUSED = ("!", "&", "*")


def project_entries(text: str, problems: Problems) -> dict[str, tuple[str, int]]:
    """Return the raw text of each key of a project with its line.

    >>> project_entries("input:\\n- - 0\\n  - 1\\n", Problems())
    {'input': ('\\n- - 0\\n  - 1', 1)}
    """
    if not is_short(text, problems, _MOST_CHARACTERS):
        return {}
    if text.lstrip().startswith("{"):
        return _of_one_line(text.strip(), problems)
    found: dict[str, tuple[list[str], int]] = {}
    key = ""
    for number, line in enumerate(text.splitlines(), 1):
        entry = _ENTRY.fullmatch(line)
        if entry:
            key = entry[2]
            if key in found:
                problems.add(f"line {number}", f"{key!r} is given twice", "leave one of them out")
            found[key] = ([entry[3] or ""], number)
        elif key and (not line.strip() or line[0] in " \t-"):
            found[key][0].append(line)
        elif line.strip() and not line.startswith(("#", "---", "...", "%YAML")):
            problems.add(
                f"line {number}", f"{short_repr(line[:40])} is no entry of a project", "entries are key: value"
            )
            if len(problems.found) > _MOST_ENTRIES:
                break
    return {key: ("\n".join(lines), number) for key, (lines, number) in found.items()}


def _of_one_line(text: str, problems: Problems) -> dict[str, tuple[str, int]]:
    """Return the raw texts of a project in braces, as some versions write it."""
    found: dict[str, tuple[str, int]] = {}
    for piece in _pieces(text, problems):
        entry = re.match(r"\s*(['\"]?)(\w+)\1\s*:\s", f"{piece} ")
        if entry is None:
            if piece.strip():
                problems.add("", f"{short_repr(piece.strip()[:40])} is no entry of a project", "entries are key: value")
            continue
        if entry[2] in found:
            problems.add("", f"{entry[2]!r} is given twice", "leave one of them out")
        found[entry[2]] = (piece[entry.end() :] if entry.end() <= len(piece) else "", 1)
    return found


def _pieces(text: str, problems: Problems) -> list[str]:
    """Return what stands between the commas of the outermost braces; quotes and brackets are kept whole."""
    pieces, depth, quote, start = [], 0, "", 1
    for k, sign in enumerate(text):
        if quote:
            quote = "" if sign == quote and (quote == "'" or text[k - 1] != "\\") else quote
        elif sign in "'\"" and text[k - 1] in " ,:[{(\n":
            quote = sign
        elif sign in "{[(":
            depth += 1
        elif sign in "}])":
            depth -= 1
        if not quote and (depth == 0 or (depth == 1 and sign == ",")):
            pieces.append(text[start:k])
            start = k + 1
            if depth == 0 or len(pieces) > _MOST_ENTRIES:
                return pieces
    problems.add("", "the project ends too early: } is missing", "look whether the file is whole")
    return pieces


def entry_count(raw: str) -> int:
    """Return how many entries a raw text has.

    They stand between its commas, or at the depth of the first.

    >>> entry_count("{a: M[], b: M[]}"), entry_count("\\n  a: M[]\\n  b:\\n   c"), entry_count("{}")
    (2, 2, 0)
    """
    text = raw.strip()
    if text[:1] in ("{", "["):
        return sum(1 for piece in _pieces(text, Problems()) if piece.strip())
    lines = [line for line in raw.splitlines() if line.strip()]
    depths = [len(line) - len(line.lstrip()) for line in lines]
    return depths.count(depths[0]) if depths else 0


def scalar(raw: str, where: str, problems: Problems) -> str:
    """Return the text that a raw one means: quoted, folded, or plain."""
    text = raw.strip()
    if text.startswith(_REFUSED):
        problems.add(where, f"{short_repr(text[:20])} is a tag or an anchor of YAML", "only plain texts are read")
        return ""
    if not is_short(text, problems):
        return ""
    if text[:1] in ("'", '"'):
        if len(text) < 2 or text[-1] != text[0]:
            problems.add(where, "a quoted text does not end", "look whether the file is whole")
            return ""
        return _folded(text[1:-1].replace("''", "'")) if text[0] == "'" else _unescaped(text[1:-1])
    if text[:1] in ("|", ">"):
        text = text.partition("\n")[2]
    return _folded(text)


def _folded(text: str) -> str:
    return " ".join(line.strip() for line in text.split("\n"))


def _unescaped(text: str) -> str:
    """Return what a text in double quotes means: a backslash at the end of a line joins it to the next."""
    lines = [line.strip() for line in text.split("\n")]
    joined = "".join(line[:-1] if _JOINED.search(line) else f"{line} " for line in lines)
    return _ESCAPED.sub(_meant, joined)


def _meant(found: re.Match[str]) -> str:
    code = found[1] or found[2] or found[3]
    if not code:
        return _PLAIN_ESCAPES.get(found[4], found[4])
    number = int(code, 16)
    return chr(number) if number <= 0x10FFFF else "?"
