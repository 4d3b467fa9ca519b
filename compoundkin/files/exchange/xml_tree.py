"""XML as a tree with lines, read without document types, entities or external references, and held to bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from compoundkin.base.errors import InvalidInput, Problem

# What trees of mechanisms may hold: those known have some hundred elements, four deep.
MOST_ELEMENTS = 20_000
DEEPEST = 16


@dataclass(frozen=True)
class XmlElement:
    """An element with its line and its children; text is left out."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[XmlElement] = field(default_factory=list)

    def named(self, *tags: str) -> Iterator[XmlElement]:
        """Yield the children of some tags, in their order."""
        return (child for child in self.children if child.tag in tags)


def xml_tree(text: str, where: str = "") -> XmlElement:
    """Return the root of a text. Raises InvalidInput where it is not XML, or XML that asks for more than itself.

    >>> [child.line for child in xml_tree("<a>\\n<b/>\\n<b x='1'/></a>").named("b")]
    [2, 3]
    """
    builder = _TreeBuilder(where)
    try:
        builder.parser.Parse(text.encode("utf-8", "replace"), True)
    except expat.ExpatError as error:
        what = f"it is not XML: {expat.ErrorString(error.code)}"
        raise InvalidInput(_located(where, error.lineno, what, "save it again in its program")) from None
    return builder.root.children[0]


class _TreeBuilder:
    """Builds the tree while the parser reads."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.root = XmlElement("", {}, 0)
        self.open = [self.root]
        self.count = 0
        # with the encoding given, what the text says of its own is passed over
        self.parser = parser = expat.ParserCreate("utf-8")
        parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.StartDoctypeDeclHandler = self.refuse
        parser.EntityDeclHandler = self.refuse
        parser.ExternalEntityRefHandler = self.refuse

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        self.count += 1
        if self.count > MOST_ELEMENTS:
            self.stop(f"it has more than {MOST_ELEMENTS:,} elements", "look whether it is the right file")
        if len(self.open) > DEEPEST:
            self.stop(f"its elements are nested deeper than {DEEPEST}", "look whether it is the right file")
        element = XmlElement(tag, attributes, self.parser.CurrentLineNumber)
        self.open[-1].children.append(element)
        self.open.append(element)

    def end(self, tag: str) -> None:
        """Close it."""
        self.open.pop()

    def refuse(self, *_: object) -> NoReturn:
        """Refuse a document type or an entity: no program writes them, and they reach for other files."""
        self.stop("it declares a document type or entities, which are not read", "take the declaration out")

    def stop(self, what: str, remedy: str) -> NoReturn:
        """Raise a problem of the line that is read."""
        raise InvalidInput(_located(self.where, self.parser.CurrentLineNumber, what, remedy))


def _located(where: str, line: int, what: str, remedy: str) -> Problem:
    return Problem(f"{where}, line {line}" if where else f"line {line}", what, remedy)
