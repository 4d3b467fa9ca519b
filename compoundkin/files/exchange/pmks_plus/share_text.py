"""A share string out of a link or a file, its checks, and the sections it is made of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from urllib.parse import quote, unquote

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import MOST_OF_LINK
from compoundkin.files.exchange.pmks_plus.packed_numbers import check_character, hash_of

ADDRESS = "https://app.pmksplus.com/?"
# How a share string begins: eight flags, decimals, integers, three units or more.
_BEGINNING = re.compile(r"[0-9A-Za-z_-]{1,2}\.[0-9A-Za-z_,-]+\.[0-9A-Za-z_,-]+\.[0-9A-Za-z_-]{1,6}\.")
# A link alone, with or without its scheme, spaces in its names or not; or one of the app within other text.
_LINK = re.compile(r"(https?://)?[\w.-]{1,100}(:\d+)?/[^?#\s]{0,100}\?(?P<query>[^#\r\n]*)")
_WITHIN = re.compile(r"https?://[^?#\s]{0,100}pmks[^?#\s]{0,100}\?(?P<query>[^#\s]+)")
_HASH = re.compile(r"\*(?P<hash>[0-9A-Za-z]{1,6})$")
# What is left as it is: of the signs that have a meaning in links the app decodes none.
_PLAIN = ",.-_~*;/?:@&=+$!'()"
# What stands around a link in mails and notes, and what services put behind it: neither is ever its check character.
_AROUND = "<>()[]{}\"'`“”’«».,;: "
_TRACKED = re.compile(r"&(utm_|fbclid|gclid|sa=|usg=|source=).*", re.DOTALL)
_AGAIN = "copy the link again, whole, from its first character to its last"


@dataclass(frozen=True)
class Sections:
    """The settings, the records of joints, links and forces, and what follows."""

    settings: tuple[str, str, str, str]
    joints: tuple[str, ...]
    links: tuple[str, ...]
    forces: tuple[str, ...]
    rest: tuple[str, ...]


def is_share_string(text: str) -> bool:
    """Return whether a text begins as a share string or its link does."""
    return bool(_BEGINNING.match(unquote(_query(text))))


def sections_of(text: str, where: str) -> Sections:
    """Return the sections of a link or a share string. Raises InvalidInput where it is cut off or changed."""
    if len(text) > MOST_OF_LINK:
        what = f"it has {len(text):,} characters; a link has at most {MOST_OF_LINK:,}"
        raise InvalidInput(Problem(where, what, "look whether it is the right one"))
    wrapped = "".join(line.strip() for line in text.splitlines())
    body = _checked([_query(text), _query(wrapped)], where)
    records = iter(body.split("."))
    one, two, three, four = (next(records, "") for _ in range(4))
    joints, links, forces = (_until_empty(records) for _ in range(3))
    for missing, section in (("joints", joints), ("links", links)):
        if not section or section[-1]:
            raise InvalidInput(Problem(where, f"it is cut off: its {missing} do not end", _AGAIN))
    # links of before 2024 end with the forces
    ends = forces[:-1] if forces and not forces[-1] else forces
    return Sections((one, two, three, four), joints[:-1], links[:-1], ends, tuple(records))


def link_of(body: str) -> str:
    """Return the link of a share string without its check character."""
    whole = body + check_character(body)
    return ADDRESS + quote(whole, safe=_PLAIN)


def _query(text: str) -> str:
    """Return what follows the question mark of a link, or the text itself.

    >>> _query("[InternetShortcut]\\nURL=https://app.pmksplus.com/?0P.Fe.K,0.101.4A,A")
    '0P.Fe.K,0.101.4A,A'
    """
    stripped = text.strip()
    found = _LINK.match(stripped) or _WITHIN.search(stripped)
    return found["query"] if found else stripped


def _checked(texts: Iterable[str], where: str) -> str:
    """Return the first share string whose check character fits, without it.

    Links have names written with percent signs, files as is; mails break lines and put signs around.
    """
    given = next(iter(texts))
    for whole in dict.fromkeys(one for text in texts for one in _spellings(text)):
        body = _body(whole)
        if body is not None:
            return body
    what = f"its check character {given[-1:]!r} does not fit its length of {len(given) - 1}: it is cut off or changed"
    raise InvalidInput(Problem(where, what, _AGAIN))


def _spellings(text: str) -> Iterator[str]:
    """Yield what a text may have been before it was sent about, the likeliest first."""
    for whole in (unquote(text), text):
        yield whole
        yield whole.rstrip(_AROUND)
        yield _TRACKED.sub("", whole)


def _body(whole: str) -> str | None:
    """Return a share string without its check character. None where that, or its hash, does not fit."""
    hashed = _HASH.search(whole)
    if hashed:
        whole = whole[: hashed.start()]
        if hash_of(whole).lstrip("0") != hashed["hash"].lstrip("0"):
            return None
    return whole[:-1] if whole and whole[-1] == check_character(whole[:-1]) else None


def _until_empty(records: Iterator[str]) -> tuple[str, ...]:
    """Return the records up to the one that is empty, which ends a section, and that one."""
    found: list[str] = []
    for record in records:
        found.append(record)
        if not record:
            break
    return tuple(found)
