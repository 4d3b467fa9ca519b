"""The kinds of kinematic pair: one file each, and this registry.

A kind and the word that writes it are imported from its file, `pairs.slot`. The registry knows kinds by name and
imports their files when they are first asked for: most mechanisms have one kind or two.
"""

from __future__ import annotations

from collections.abc import Iterable

from compoundkin.model.fields import LateKinds
from compoundkin.model.pairs.contract import Pair
from compoundkin.model.pairs.revolute import Revolute

# Each kind's letter in the names of groups, its table in files (pins follow from shared letters), its file and class.
# In the order in which the letters of a group are written: RRP, not PRR.
_KINDS = (
    ("R", "", "revolute.Revolute"),
    ("P", "slides", "prismatic.Prismatic"),
    ("S", "slots", "slot.Slot"),
    ("A", "arcs", "arc.ArcSlot"),
    ("C", "cams", "cam.Cam"),
    ("F", "faces", "face.Face"),
    ("G", "gears", "gear.Gear"),
    ("B", "belts", "belt.Belt"),
    ("K", "racks", "rack.Rack"),
    ("L", "rollings", "rolling.Rolling"),
    ("O", "circular_rollings", "rolling.RollingOnCircle"),
)
KINDS = LateKinds[type[Pair]](__name__, {code: place for code, _, place in _KINDS})
# The kinds that a mechanism writes out, by their tables.
WRITTEN = LateKinds[type[Pair]](__name__, {table: place for _, table, place in _KINDS if table})


def pairs_among(items: Iterable[object]) -> tuple[Pair, ...]:
    """Return the pairs among the words of a mechanism, as written."""
    return tuple(item for item in items if isinstance(item, Pair))


__all__ = ["KINDS", "WRITTEN", "Pair", "Revolute", "pairs_among"]
