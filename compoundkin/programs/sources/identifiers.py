"""Names of variables: those of a mechanism made fit for every language, no two alike."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

# A name may have 63 characters in MATLAB; what is put before and behind it must have room too.
LONGEST = 40
_GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (\w+)")

# Words that mean something in one of the languages, and those that the texts use themselves. They are the same for all
# languages, so that a quantity is called alike everywhere.
_OF_C = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool true false
    alignas alignof and and_eq asm bitand bitor catch class compl concept consteval constexpr constinit decltype delete
    dynamic_cast explicit export friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private
    protected public reinterpret_cast requires static_assert static_cast template this thread_local throw try typeid
    typename using virtual wchar_t xor xor_eq complex I NAN INFINITY NULL main div gamma j0 j1 jn y0 y1 yn linux unix
"""
_OF_PYTHON = """
    False None True and as assert async await break class continue def del elif else except finally for from global if
    import in is lambda match nonlocal not or pass raise return try type while with yield abs max min round math nan inf
"""
_OF_JAVASCRIPT = """
    arguments await break case catch class const continue debugger default delete do else enum eval export extends false
    finally for function if implements import in instanceof interface let new null package private protected public
    return static super switch this throw true try typeof undefined var void while with yield Infinity NaN Math Number
    Object module exports require window globalThis name
"""
_OF_MATLAB = """
    break case catch classdef continue else elseif end for function global if otherwise parfor persistent return spmd
    switch try while do until endif endfor endwhile endfunction end_try_catch unwind_protect ans pi e i j Inf NaN eps
    true false nargin nargout varargin varargout isempty struct zeros ones size disp
"""
_OF_TEXTS = """
    in out assembled given abs fabs sqrt sin cos tan atan2 exp log floor ceil round rint fix mod sign max min fmax fmin
    isnan copysign inputs outputs root quotient choice greatest least greater lesser nearest logarithm power sine cosine
"""
RESERVED = frozenset(" ".join((_OF_C, _OF_PYTHON, _OF_JAVASCRIPT, _OF_MATLAB, _OF_TEXTS)).split())


def identifier(name: str) -> str:
    """Return a name that every language takes.

    >>> identifier("plate.C.x"), identifier("α-bar 2"), identifier("4th"), identifier("for"), identifier("__")
    ('plate_C_x', 'alpha_bar_2', 'n4th', 'for_', 'n')
    """
    plain = "".join(map(_letters, unicodedata.normalize("NFKD", name)))
    plain = re.sub(r"[^0-9A-Za-z]+", "_", plain).strip("_")[:LONGEST]
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    return f"{plain}_" if plain in RESERVED else plain


def _letters(letter: str) -> str:
    """What stands for a letter: nothing for an accent, the name of a Greek letter."""
    if unicodedata.combining(letter):
        return ""
    greek = _GREEK.fullmatch(unicodedata.name(letter, ""))
    return letter if greek is None else greek[1].lower()


class Identifiers:
    """The names that are taken in one text."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def take(self, name: str) -> str:
        """Return a name like this one that nothing else has.

        >>> names = Identifiers()
        >>> names.take("a.b"), names.take("a-b"), names.take("a_b")
        ('a_b', 'a_b_2', 'a_b_3')
        """
        wanted = found = identifier(name)
        count = 2
        while found in self._taken:
            found, count = f"{wanted}_{count}", count + 1
        self._taken.add(found)
        return found

    def take_numbered(self, letter: str, first: int) -> tuple[str, int]:
        """Return a letter with a number that nothing else has, and the number.

        It is the first one from `first` on.
        """
        while f"{letter}{first}" in self._taken:
            first += 1
        self._taken.add(f"{letter}{first}")
        return f"{letter}{first}", first
