"""Masses, gravity and loads as they are written: one file each, and this registry.

A load and the word that writes it are imported from its file, `loads.spring`. The registry knows loads by their tables
in files and imports theirs when they are first asked for: most mechanisms have none.
"""

from __future__ import annotations

from compoundkin.model.fields import LateKinds
from compoundkin.model.loads.contract import ListedLoad, Load, LoadElement

# What each table of a mechanism file holds, in the order in which they are written.
WRITTEN = LateKinds[type[ListedLoad]](
    __name__,
    {
        "masses": "mass.Mass",
        "forces": "force.Force",
        "torques": "force.Torque",
        "efforts": "attachments.Effort",
        "springs": "spring.Spring",
        "dampers": "damper.Damper",
        "motors": "motor.Motor",
        "pressures": "pressure.Pressure",
        "stops": "stop.Stop",
        "latches": "latch.Latch",
        "releases": "latch.Release",
        "frictions": "friction.Friction",
        "pretensions": "pretension.Pretension",
    },
)
# What some of them hold where a pair is named instead of points.
ALONG_PAIRS = LateKinds[type[ListedLoad]](__name__, {"springs": "spring.PairSpring", "dampers": "damper.PairDamper"})

__all__ = ["ALONG_PAIRS", "WRITTEN", "ListedLoad", "Load", "LoadElement"]
