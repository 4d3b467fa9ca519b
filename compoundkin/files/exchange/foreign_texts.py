"""Names and numbers as other programs write them: legal letters, the shortest exact decimals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import count

from compoundkin.base.display import printable
from compoundkin.model.geometry import FRAME

# What names of other programs may hold and ours may not, and what stands for it.
_REPLACED = str.maketrans({".": "-", ",": "-"})


LONGEST = 80


def legal(name: str) -> str:
    """Return a name that a link or a point may have.

    It is empty where nothing of it is left.

    >>> legal(" coupler.0_tip "), legal("\\t")
    ('coupler-0_tip', '')
    """
    return printable(name).translate(_REPLACED).strip()[:LONGEST].strip()


def letters(taken: Iterable[str] = ()) -> Iterator[str]:
    """Yield A, B ... Z, A1, B1 ..., without those that are taken.

    >>> from itertools import islice
    >>> list(islice(letters({"B"}), 3))
    ['A', 'C', 'D']
    """
    used = set(taken)
    for k in count():
        for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ":
            name = f"{letter}{k or ''}"
            if name not in used:
                yield name


class ForeignNames:
    """The names given so far, each once, for links and points together."""

    def __init__(self) -> None:
        self._used: set[str] = {FRAME}
        self.changed: list[tuple[str, str]] = []

    def give(self, wanted: str, otherwise: str) -> str:
        """Return the name wanted, or the nearest that can be had.

        It is noted where it differs.
        """
        name = unused = legal(wanted) or legal(otherwise) or "x"
        for k in count(2):
            if unused not in self._used:
                break
            unused = f"{name}-{k}"
        self._used.add(unused)
        if unused != wanted:
            self.changed.append((wanted, unused))
        return unused


def shortest(value: float) -> str:
    """Return a number with all its digits, a whole one without a point.

    >>> shortest(10.0), shortest(-0.0), shortest(0.1), shortest(1e-7)
    ('10', '0', '0.1', '1e-07')
    """
    return repr(float(value) + 0.0).removesuffix(".0")
