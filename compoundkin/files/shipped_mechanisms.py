"""The shipped mechanisms, one file each, known by name."""

from __future__ import annotations

import tomllib
from functools import cache
from os import PathLike, fspath
from os.path import isfile
from pathlib import Path

from compoundkin.base.arguments import checked
from compoundkin.base.errors import OTHER_WORDS, InvalidInput, Problem, UnknownName, plain_word, suggestion
from compoundkin.base.suffixes import SUFFIXES, suffix_for

SUFFIX = suffix_for("mechanism", "toml")
# A wheel carries the files inside the package; a checkout or an editable install has them beside it.
# How alike a name must be to one of the catalog to be that with a slip in it (difflib, 1 is the same).
SURELY = 0.8
FOLDERS = (Path(__file__).parents[1] / "_catalog", Path(__file__).parents[2] / "catalog")


@cache
def folder() -> Path:
    """Return where the files are; the first of `FOLDERS` that exists."""
    return next((place for place in FOLDERS if place.is_dir()), FOLDERS[0])


@cache
def shipped() -> tuple[str, ...]:
    """Return the names of all shipped mechanisms, in alphabetical order.

    >>> "six-bar" in shipped()
    True
    """
    return tuple(sorted(file.stem for file in folder().glob(f"*{SUFFIX}")))


@checked
def path(name: str) -> Path:
    """Return the file of a shipped mechanism. Raises UnknownName with the nearest name there is.

    >>> path("six-bar").name
    'six-bar.toml'
    >>> path("sixbar")
    Traceback (most recent call last):
    compoundkin.base.errors.UnknownName: sixbar: the catalog has no such mechanism; did you mean 'six-bar'?
    """
    if name not in shipped():
        raise UnknownName(Problem(name, "the catalog has no such mechanism", _meant(name)))
    return folder() / (name + SUFFIX)


@checked
def resolve(name_or_path: str | PathLike[str]) -> Path:
    """Return the file that a user means. An existing file, or else a shipped mechanism's.

    Raises InvalidInput for what is written as a path and does not exist, UnknownName for any other text.

    >>> resolve("six-bar") == path("six-bar")
    True
    >>> resolve("drafts/six-bar.toml")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: drafts/six-bar.toml: there is no such file
    >>> resolve("six-bra")
    Traceback (most recent call last):
    compoundkin.base.errors.UnknownName: six-bra: neither a file nor in the catalog; did you mean 'six-bar'?
    """
    text = fspath(name_or_path)
    if isfile(text):
        return Path(text)
    if text in shipped():
        return path(text)
    if Path(text).suffix in SUFFIXES["mechanism"] or "/" in text or "\\" in text:
        raise InvalidInput(Problem(text, "there is no such file", _remedy(text)))
    raise UnknownName(Problem(text, "neither a file nor in the catalog", _meant(text)))


def titles(word: str = "") -> dict[str, str]:
    """Return the titles of shipped mechanisms by name: of all, or of those that have a word.

    A word is looked for in names and titles, and where it is in none of them, in descriptions.

    >>> list(titles("scotch"))
    ['scotch-yoke']
    """
    words = {plain_word(word), *map(plain_word, OTHER_WORDS.get(plain_word(word), ()))}
    whole = {name: tomllib.loads(path(name).read_text(encoding="utf-8")) for name in shipped()}
    for keys in (("title",), ("title", "description")):
        texts = {name: plain_word(" ".join([name, *(own.get(key, "") for key in keys)])) for name, own in whole.items()}
        if found := [name for name, text in texts.items() if any(one in text for one in words)]:
            return {name: whole[name]["title"] for name in found}
    return {}


def _meant(text: str) -> str:
    """Return the remedy for a name that the catalog does not have: those with the word, or the closest."""
    from difflib import get_close_matches

    if ":" in text:
        name, _, lengths = text.partition(":")
        made = f"compoundkin.linkages.{name.strip().replace('-', '_')}({lengths.strip()})"
        return f"in Python a linkage is made from its lengths by {made}"
    found = {} if get_close_matches(text, shipped(), 1, SURELY) else titles(text)
    if not found:
        return suggestion(text, shipped())
    return f"in the catalog: {', '.join([*found][:8])}{' ...' if len(found) > 8 else ''}"


def _remedy(text: str) -> str:
    """Return a bare file name that is a catalog name with a suffix. Say so."""
    stem = Path(text).stem
    return f"the catalog's mechanism is called {stem!r}" if text == stem + SUFFIX and stem in shipped() else ""
