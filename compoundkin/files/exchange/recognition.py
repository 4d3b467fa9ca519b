"""Which format a content is of, and what is said of a content that is of none."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Content, hold_size
from compoundkin.files.exchange.contract import Readable

_TABLE = "save a table of its joints as text: link names, type, x, y"
# What is no mechanism of a program that is read, but often meant for one: what it is, and what helps.
_STRANGERS: tuple[tuple[Callable[[Content], object], str, str], ...] = (
    (lambda c: not c.raw.strip(), "it is empty", ""),
    (lambda c: c.raw.startswith(b"PK\x03\x04"), "it is a zip archive, such as GeoGebra and spreadsheets save", _TABLE),
    (lambda c: not c.is_text, "it is a binary file, which only its own program can read", _TABLE),
    (lambda c: re.match(r'format\s*=\s*\d|\{\s*"format"\s*:\s*\d', c.head), "it is a mechanism file of compoundkin",
     "load it"),
    (lambda c: re.search(r"<mujoco\b", c.head), "it is a MuJoCo model, which is only written", ""),
    (lambda c: re.search(r"<geogebra\b", c.head), "it is a GeoGebra construction, which is only written", ""),
    (lambda c: re.search(r"<robot\b", c.head), "it is a robot (URDF), which has no closed loops", ""),
    (lambda c: re.match(r"(?i)<!doctype html|<html\b", c.head), "it is a web page", "copy the link, or save its file"),
    (lambda c: re.match(r"0\r?\n\s*SECTION", c.head), "it is a DXF drawing, which is only written", _TABLE),
    (lambda c: re.match(r"https?://", c.head), "it is a link that holds no mechanism; nothing is fetched",
     "download what it leads to, and name that file"),
)  # fmt: skip


def recognised(content: Content, known: Mapping[str, Readable], form: str = "") -> Readable:
    """Return the format of a content.

    Raises InvalidInput where it is of another than `form`, or of none, or larger than any of its format.
    """
    found = _found(content, known, form)
    hold_size(content.where or "the text", len(content.raw), found.most)
    return found


def _found(content: Content, known: Mapping[str, Readable], form: str) -> Readable:
    if form and known[form].recognises(content):
        return known[form]
    found = next((one for one in known.values() if one.recognises(content)), None)
    if form and found is not None:
        what = f"this is no {known[form].title} but {found.title}"
        raise InvalidInput(Problem(content.where, what, f"leave the form out, or name {found.name!r}"))
    if found is not None:
        return found
    for is_such, what, remedy in _STRANGERS:
        if is_such(content):
            raise InvalidInput(Problem(content.where, what, remedy))
    if form:
        # it tells better what is wrong with its own
        return known[form]
    what = "it is no mechanism of a program that is known here"
    raise InvalidInput(Problem(content.where, what, f"known: {', '.join(one.title for one in known.values())}"))
