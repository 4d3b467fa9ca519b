"""The kinds of kinematic pair: one file each, and this registry."""

from __future__ import annotations

from compoundkin.pairs.arc import Arc, arc
from compoundkin.pairs.belt import Belt, belt
from compoundkin.pairs.contract import Pair
from compoundkin.pairs.gear import Gear, gear
from compoundkin.pairs.prismatic import Prismatic, slide
from compoundkin.pairs.revolute import Revolute
from compoundkin.pairs.slot import Slot, slot

# In the order in which the letters of a group are written: RRP, not PRR.
KINDS: tuple[type[Pair], ...] = (Revolute, Prismatic, Slot, Arc, Gear, Belt)

# The kinds that a mechanism writes out, by their table in a file; pins follow from shared letters.
WRITTEN: dict[str, type[Pair]] = {kind.table: kind for kind in KINDS if kind.table}

__all__ = [
    "KINDS",
    "WRITTEN",
    "Arc",
    "Belt",
    "Gear",
    "Pair",
    "Prismatic",
    "Revolute",
    "Slot",
    "arc",
    "belt",
    "gear",
    "slide",
    "slot",
]
