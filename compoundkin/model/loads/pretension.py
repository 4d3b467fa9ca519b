"""The pretension of belts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.attachments import PairProperty
from compoundkin.model.loads.contract import NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Pretension(PairProperty):
    """The pretension of a belt. It is half the sum of the forces in its strands."""

    pair: str = field(metadata=value_key("name", "The belt, by the name of its pair."))
    force: Number = field(metadata=value_key("length", "Half the sum of the forces in its two strands."))

    title: ClassVar[str] = "pretension"
    table: ClassVar[str] = "pretensions"

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, one without strands, and a negative force."""
        pair = written.pair(self.pair)
        if pair is None:
            yield from self.unknown(written, where)
        elif self.title not in pair.takes:
            yield Problem(f"{where}.pair", f"{self.pair!r} is a {pair.title}, which has no strands", "name a belt")
        if np.any(np.asarray(self.force) < 0.0):
            yield Problem(f"{where}.{self.keys[1].name}", "a belt does not push", "give a force above zero")


@checked
def pretension(pair: str, force: Any) -> Pretension:
    """Return the pretension of a belt. It is half the sum of the forces in its strands.

    >>> pretension("belt", 150).force
    150.0
    """
    return Pretension(pair, real(f"pretensions.{pair}", force))
