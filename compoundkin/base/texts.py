"""Texts of users: characters that would hide, reorder or overwrite what is shown, found, written out, left out."""

from __future__ import annotations

import re

# Control characters but the ends of lines and tabulators, what reorders the text around it, halves of surrogate pairs.
_UNSEEN = re.compile(
    r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f"  # control characters
    r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # bidirectional ones, as Unicode lists them
    r"\ud800-\udfff]"  # surrogates
)


def unseen(text: str) -> str:
    r"""Return what is wrong with the characters of a text, or nothing.

    >>> unseen("crank"), unseen("a\x1b[2Jb")
    ('', 'it holds the control character U+001B')
    """
    found = None if text.isascii() and text.isprintable() else _UNSEEN.search(text)
    if found is None:
        return ""
    code = ord(found[0])
    kind = "half a surrogate pair," if 0xD800 <= code <= 0xDFFF else "the control character"
    return f"it holds {kind} U+{code:04X}"


def written_out(text: str) -> str:
    r"""Return a text that shows all its characters.

    >>> written_out("a\x1b[2Jb"), written_out("\u202egnp.exe")
    ('a\\x1b[2Jb', '\\u202egnp.exe')
    """
    if text.isascii() and text.isprintable():
        return text
    return _UNSEEN.sub(lambda found: found[0].encode("unicode_escape", "surrogatepass").decode("ascii"), text)


def printable(text: str) -> str:
    r"""Return a text with blanks for what does not print, ends of lines too.

    >>> printable("four\x00bar\n")
    'four bar '
    """
    return "".join(c if c.isprintable() else " " for c in text)
