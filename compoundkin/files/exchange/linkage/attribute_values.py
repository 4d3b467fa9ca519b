"""The values of an element's attributes: numbers, flags, ids; what is none is a problem of its line."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.xml_tree import XmlElement

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?")
# No number of a drawing is larger; what is computed of such stays finite.
_LARGEST = 1e12
_WHOLE = re.compile(r"[+-]?\d{1,9}")
_FLAGS = {"": False, "false": False, "true": True}

# What is read, and what is known to be looks; of others nobody knows here whether they move anything.
_READ = (
    "id x y layer anchor input rpm draw slider slideradius alwaysmanual fastenlink fastenconnector name actuator throw"
    " cpm measurementelement gear type sizeassize size units scalefactor limitangle"
)
_LOOKS = (
    "selected linesize color usercolor fillcolor solid polyline drawcircle zoom xoffset yoffset textonly drawfat"
    " fontsize transparency locked"
)
_KNOWN = frozenset((_READ + " " + _LOOKS).split())


def unknown_attributes(root: XmlElement) -> Iterator[str]:
    """Yield the note that names attributes which are not looked at."""
    met: dict[str, int] = {}
    waiting = [root]
    while waiting:
        element = waiting.pop()
        waiting += reversed([child for child in element.children if child.tag not in ("background", "selected")])
        for name in element.attributes:
            if name not in _KNOWN:
                met.setdefault(name[:40], element.line)
    if met:
        said = [f"{name} (line {line})" for name, line in met.items()]
        yield f"attributes that are not known are not looked at: {abbreviated_list(said)}"


@dataclass(frozen=True)
class AttributeValues:
    """An element's attributes as values. Those that are missing are false, 0 or nothing."""

    element: XmlElement
    problems: Problems

    @property
    def where(self) -> str:
        """The element by its line and its id, for messages."""
        named = self.element.attributes.get("id", "").strip()[:20]
        return f"line {self.element.line}, {self.element.tag.lower()} {named}".rstrip()

    def text(self, name: str) -> str:
        """Return a text."""
        return self.element.attributes.get(name, "").strip()

    def number(self, name: str, otherwise: float = 0.0) -> float:
        """Return a number."""
        text = self.text(name)
        value = float(text) if _NUMBER.fullmatch(text) else math.nan
        if text and not abs(value) <= _LARGEST:
            what = "is not a number" if math.isnan(value) else "is beyond all drawings"
            self.problems.add(self.where, f"{name} {text[:40]!r} {what}", "write it as 12.5")
        return value if abs(value) <= _LARGEST else otherwise

    def flag(self, name: str) -> bool:
        """Return whether something holds."""
        text = self.text(name).lower()
        if text not in _FLAGS:
            self.problems.add(self.where, f"{name} {text[:40]!r} is neither true nor false", "write true or false")
        return _FLAGS.get(text, False)

    def whole(self, name: str) -> int | None:
        """Return a whole number, an id for one, or nothing."""
        text = self.text(name)
        if text and not _WHOLE.fullmatch(text):
            self.problems.add(self.where, f"{name} {text[:40]!r} is not a whole number", "write it as 12")
        return int(text) if _WHOLE.fullmatch(text) else None

    def id(self) -> int | None:
        """Return the id of an element that is nothing without one."""
        found = self.whole("id")
        if not self.text("id"):
            self.problems.add(self.where, "it has no id", "give it one")
        return found
