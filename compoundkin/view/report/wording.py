"""Words of reports: lists, numbers of things, links by their number of pairs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

_KINDS = ("free", "singular", "binary", "ternary", "quaternary", "quinary", "senary")


def listed(names: Iterable[str]) -> str:
    """Names in a row, the last two joined by "and".

    >>> listed(["crank"]), listed(["crank", "rod", "frame"])
    ('crank', 'crank, rod and frame')
    """
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def counted(number: int, word: str) -> str:
    """A number of things.

    >>> counted(1, "pair"), counted(1200, "pose")
    ('1 pair', '1,200 poses')
    """
    return f"{number:,} {word}{'' if number == 1 else 's'}"


def kind_of_link(pairs: int) -> str:
    """What a link with so many pairs is called.

    >>> kind_of_link(3), kind_of_link(9)
    ('ternary', 'with 9 pairs')
    """
    return _KINDS[pairs] if pairs < len(_KINDS) else f"with {pairs} pairs"


def ordinal(number: int) -> str:
    """ "2nd" of 2.

    >>> [ordinal(k) for k in (2, 3, 4, 11, 12, 21)]
    ['2nd', '3rd', '4th', '11th', '12th', '21st']
    """
    ending = "th" if 10 <= number % 100 <= 20 else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def joined(links: Sequence[str]) -> str:
    """Links that a pair joins.

    >>> joined(["crank", "rod"])
    'crank - rod'
    """
    return " - ".join(links)
