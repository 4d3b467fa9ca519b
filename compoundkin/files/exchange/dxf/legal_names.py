"""Texts of DXF files; names of layers and blocks, which have no punctuation of paths and no capitals of their own."""

from __future__ import annotations

import re

# What AutoCAD refuses in names of layers and blocks.
_REFUSED = re.compile(r"[<>/\\\":;?*|=`,]")
LONGEST = 200
# Layers that every file has, or that are not plotted.
RESERVED = ("0", "Defpoints")
# The last letter that DXF can write out.
LAST = 0xFFFF


def in_ascii(text: str) -> bytes:
    r"""Return a text with other letters written out as DXF has it.

    No code page matters then.

    >>> in_ascii("bär")
    b'b\\U+00E4r'
    """
    return "".join(c if c.isascii() else f"\\U+{ord(c):04X}" for c in text).encode("ascii")


def sayable(text: str) -> str:
    """Return a text with `_` for what DXF cannot say.

    That is what does not print, and letters beyond four digits.
    """
    return "".join(c if c.isprintable() and ord(c) <= LAST else "_" for c in text)


def literal(text: str) -> str:
    r"""Return a text in which signs that would command something stand for themselves.

    >>> print(literal("50%%c x^2"))
    50%%%%%%c x^ 2
    """
    return sayable(text).replace("%%", "%%%%%%").replace("^", "^ ").replace("\\U+", "\\U+005CU+")


class LegalNames:
    """Names given so far, each once.

    >>> names = LegalNames()
    >>> names.of("bar"), names.of("Bar"), names.of("a/b")
    ('bar', 'Bar-2', 'a_b')
    """

    def __init__(self, *taken: str) -> None:
        self._used = {name.casefold() for name in taken}

    def of(self, wanted: str) -> str:
        """Return a name like the one wanted, that nothing has yet."""
        name = own = _REFUSED.sub("_", sayable(wanted)).strip()[:LONGEST] or "_"
        k = 1
        while own.casefold() in self._used:
            k += 1
            own = f"{name}-{k}"
        self._used.add(own.casefold())
        return own
