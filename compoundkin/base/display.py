"""How objects are shown: display functions for notebooks, short texts, texts without hidden characters."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cached_property
from importlib import import_module
from itertools import islice
from typing import Any

import numpy as np

# Display functions by name, as "module:function"; a module is imported on first use.
_DISPLAYS: dict[str, str] = {}


def register(**functions: str) -> None:
    """Enter functions that show objects, each as ``module:function``."""
    _DISPLAYS.update(functions)


def display_function(name: str) -> Callable[..., Any]:
    """Return a registered function; its module is loaded now."""
    return import_function(_DISPLAYS[name])


def import_function(function: str) -> Callable[..., Any]:
    """Return the function that is written as ``module:function``; its module is loaded now."""
    module, _, name = function.partition(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


def count_phrase(number: int, one: str, many: str = "") -> str:
    """Return a count with its noun, in the singular for one.

    >>> count_phrase(1, "driver"), count_phrase(2, "branch", "branches")
    ('1 driver', '2 branches')
    """
    return f"{number} {one if number == 1 else many or one + 's'}"


def abbreviated_list(texts: Sequence[str], most: int = 8) -> str:
    """Return the first texts of a list, and how many more there are.

    >>> abbreviated_list(["A", "B"]), abbreviated_list(["A", "B", "C", "D"], 2)
    ('A, B', 'A, B and 2 more')
    """
    more = f" and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def aligned_text(rows: Sequence[Sequence[str | float]]) -> str:
    """Return rows as lines of text with aligned columns: numbers with six digits on the right, words on the left.

    A row of one cell is a heading.

    >>> print(aligned_text([("crank",), ("mean torque", 12.5, "N m"), ("work", 1000 / 3, "J")]))
    crank
    mean torque     12.5  N m
    work         333.333  J
    """
    wide, right = dict[int, int](), set[int]()
    texts = [[one if isinstance(one, str) else f"{one + 0.0:.6g}" for one in row] for row in rows]
    for row, text in zip(rows, texts, strict=True):
        for k in range(len(row)) if len(row) > 1 else ():
            wide[k] = max(wide.get(k, 0), len(text[k]))
            right |= set() if isinstance(row[k], str) else {k}
    cells = ([one.rjust(wide.get(k, 0)) if k in right else one.ljust(wide.get(k, 0)) for k, one in enumerate(text)]
             for text in texts)  # fmt: skip
    return "\n".join("  ".join(row).rstrip() for row in cells)


class DisplaysText:
    """What has a report of its own, written as text."""

    def text(self) -> str:
        """Return the report on it as text, no line longer than 80 letters; of several designs the first."""
        made: str = display_function("text")(self)
        return made


class DisplaysHtml:
    """What a notebook shows of an object: tables and pictures as HTML."""

    def _repr_html_(self) -> str | None:
        """As HTML; None where the text is better, or where HTML would take long."""
        made: str | None = display_function("html")(self)
        return made


class DisplaysPicture(DisplaysHtml):
    """An object that has a picture too, drawn once."""

    def _repr_svg_(self) -> str | None:
        """As SVG; None where there is no picture, or where it would take long."""
        return self._picture

    @cached_property
    def _picture(self) -> str | None:
        made: str | None = display_function("svg")(self)
        return made


# So many entries of a mapping or a tuple are printed; of more, their number. Of parts and of the whole so many letters.
_PRINTED, _OF_PARTS, _OF_ALL = 4, 80, 400


class ShortRepr:
    """A dataclass that prints in short.

    It prints its arrays as their shapes, what is long as its length or its class.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        text = ""
        for name in _parts(self):
            part = f"{', ' if text else ''}{name}={short_repr(getattr(self, name))}"
            if len(text) + len(part) > _OF_ALL:
                return f"{type(self).__name__}({text}, ...)"
            text += part
        return f"{type(self).__name__}({text})"


def _parts(thing: Any) -> list[str]:
    """Return the names of an object's fields, or of its members where it is not a dataclass."""
    if is_dataclass(thing):
        return [field.name for field in fields(thing) if field.repr]
    return [name for name in getattr(thing, "__slots__", None) or vars(thing) if not name.startswith("_")]


def short_repr(value: Any) -> str:
    """Print a value in a few words.

    >>> short_repr(np.zeros((2, 360))), short_repr((1, 2)), short_repr(range(9)), short_repr(tuple(range(9)))
    ('array (2, 360)', '(1, 2)', 'range(0, 9)', '9 values')
    >>> short_repr(["word"] * 30), short_repr(short_repr)
    ('list(...)', 'function(...)')
    """
    if isinstance(value, np.ndarray):
        return f"array {value.shape}"
    if isinstance(value, Mapping):
        inside = ", ".join(f"{key}: {short_repr(one)}" for key, one in islice(value.items(), _PRINTED + 1))
        return f"{{{inside}}}" if len(value) <= _PRINTED and len(inside) < _OF_PARTS else f"{len(value)} entries"
    if type(value) is tuple:
        inside = ", ".join(map(short_repr, value[: _PRINTED + 1])) + ("," if len(value) == 1 else "")
        return f"({inside})" if len(value) <= _PRINTED and len(inside) < _OF_PARTS else f"{len(value)} values"
    text = repr(value)
    return text if len(text) <= _OF_PARTS and " at 0x" not in text else f"{type(value).__name__}(...)"


# Control characters but the ends of lines and tabulators, what reorders the text around it, halves of surrogate pairs.
_HIDDEN = re.compile(
    r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f"  # control characters
    r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # bidirectional ones, as Unicode lists them
    r"\ud800-\udfff]"  # surrogates
)


def hidden_character_problem(text: str) -> str:
    r"""Return what is wrong with the characters of a text, or nothing.

    >>> hidden_character_problem("crank"), hidden_character_problem("a\x1b[2Jb")
    ('', 'it holds the control character U+001B')
    """
    found = None if text.isascii() and text.isprintable() else _HIDDEN.search(text)
    if found is None:
        return ""
    code = ord(found[0])
    kind = "half a surrogate pair," if 0xD800 <= code <= 0xDFFF else "the control character"
    return f"it holds {kind} U+{code:04X}"


def escaped_text(text: str) -> str:
    r"""Return a text that shows all its characters.

    >>> escaped_text("a\x1b[2Jb"), escaped_text("\u202egnp.exe")
    ('a\\x1b[2Jb', '\\u202egnp.exe')
    """
    if text.isascii() and text.isprintable():
        return text
    return _HIDDEN.sub(lambda found: found[0].encode("unicode_escape", "surrogatepass").decode("ascii"), text)


def printable(text: str) -> str:
    r"""Return a text with blanks for what does not print, ends of lines too.

    >>> printable("four\x00bar\n")
    'four bar '
    """
    return "".join(c if c.isprintable() else " " for c in text)
