"""The kinds of kinematic pair: one file each, and this registry."""

from __future__ import annotations

from collections.abc import Iterable

from compoundkin.model.pairs.arc import ArcSlot, arc
from compoundkin.model.pairs.belt import Belt, belt
from compoundkin.model.pairs.cam import Cam, cam
from compoundkin.model.pairs.contract import Pair
from compoundkin.model.pairs.face import Face, face
from compoundkin.model.pairs.gear import Gear, gear
from compoundkin.model.pairs.prismatic import Prismatic, slide
from compoundkin.model.pairs.rack import Rack, rack
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.rolling import Rolling, RollingOnCircle, roll, roll_around
from compoundkin.model.pairs.slot import Slot, slot

# In the order in which the letters of a group are written: RRP, not PRR.
KINDS: tuple[type[Pair], ...] = (
    *(Revolute, Prismatic, Slot, ArcSlot, Cam, Face),
    *(Gear, Belt, Rack, Rolling, RollingOnCircle),
)
# The kinds that a mechanism writes out, by their table in a file; pins follow from shared letters.
WRITTEN: dict[str, type[Pair]] = {kind.table: kind for kind in KINDS if kind.table}


def pairs_among(items: Iterable[object]) -> tuple[Pair, ...]:
    """Return the pairs among the words of a mechanism, as written."""
    return tuple(item for item in items if isinstance(item, Pair))


__all__ = [
    "KINDS",
    "WRITTEN",
    "ArcSlot",
    "Belt",
    "Cam",
    "Face",
    "Gear",
    "Pair",
    "Prismatic",
    "Rack",
    "Revolute",
    "Rolling",
    "RollingOnCircle",
    "Slot",
    "arc",
    "belt",
    "cam",
    "face",
    "gear",
    "pairs_among",
    "rack",
    "roll",
    "roll_around",
    "slide",
    "slot",
]
