"""Reasons why a group cannot be assembled: words with numbers in between, and where each reason holds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

from compoundkin.base.arrays import Number
from compoundkin.kinematics.groups.dyad_sides import element, text

Words: TypeAlias = "tuple[str | Number, ...]"


class Reason(NamedTuple):
    """One reason. It `holds` where it is true, everywhere if it is True.

    Of several the first that holds is told. Numbers among the words are arrays over the poses, or recorded.
    """

    holds: Number | bool
    words: Words


def told(reasons: Iterable[Reason], at: int) -> str:
    """Return the first reason that holds at a pose's flat index, in words. It is "" where none does.

    >>> told([Reason(False, ("never",)), Reason(True, ("|AB| = ", 2.0, " < ", 3.0))], 0)
    '|AB| = 2 < 3'
    """
    for reason in reasons:
        if reason.holds is True or element(reason.holds, at):
            return "".join(one if isinstance(one, str) else text(one, at) for one in reason.words)
    return ""


def alone(*words: str | Number) -> tuple[Reason]:
    """Return what is the only reason.

    >>> told(alone("the guides are parallel"), 0)
    'the guides are parallel'
    """
    return (Reason(True, words),)
