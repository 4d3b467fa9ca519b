"""What only some kinds of pairs answer of forces: wheels that roll, teeth and strands with what comes beside them."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from compoundkin.base.series import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import NORMAL, TANGENTIAL
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.pairs.optional_answers import Accompanied


class Rolls(Pair):
    """A wheel that rolls without slip. What presses it and what turns it act at the contact."""

    force_words: ClassVar[tuple[str, ...]] = (NORMAL, TANGENTIAL)

    @abstractmethod
    def contact(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return where the wheel touches, and the normal there. It is a unit vector into the wheel."""

    @property
    def acts_at(self) -> str:
        """The contact."""
        return "contact"

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the place of contact."""
        return self.contact(ends, poses)[0]


class Strapped(Accompanied):
    """A pair of pulleys with a belt, whose two strands pull."""

    @abstractmethod
    def strands(self, ends: Ends, poses: Poses) -> tuple[Wrench, Wrench]:
        """Return what a unit pull in each strand does to the second pulley."""


def as_strapped(pair: Pair) -> Strapped | None:
    """Return a pair as one whose strands pull, or None."""
    return pair if isinstance(pair, Strapped) else None
