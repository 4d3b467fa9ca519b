"""The kinds of kinematic pair: one file each, and this registry."""

from __future__ import annotations

from compoundkin.pairs.arc import ArcSlot, arc
from compoundkin.pairs.belt import Belt, belt
from compoundkin.pairs.cam import Cam, cam
from compoundkin.pairs.contract import Pair
from compoundkin.pairs.face import Face, face
from compoundkin.pairs.gear import Gear, gear
from compoundkin.pairs.prismatic import Prismatic, slide
from compoundkin.pairs.rack import Rack, rack
from compoundkin.pairs.revolute import Revolute
from compoundkin.pairs.rolling import Rolling, roll
from compoundkin.pairs.rolling_circle import RollingOnCircle, roll_around
from compoundkin.pairs.slot import Slot, slot

# In the order in which the letters of a group are written: RRP, not PRR.
KINDS: tuple[type[Pair], ...] = (
    *(Revolute, Prismatic, Slot, ArcSlot, Cam, Face),
    *(Gear, Belt, Rack, Rolling, RollingOnCircle),
)

# The kinds that a mechanism writes out, by their table in a file; pins follow from shared letters.
WRITTEN: dict[str, type[Pair]] = {kind.table: kind for kind in KINDS if kind.table}

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
    "rack",
    "roll",
    "roll_around",
    "slide",
    "slot",
]
