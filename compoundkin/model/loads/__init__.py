"""Masses, gravity and loads as they are written: one file each, and this registry."""

from __future__ import annotations

from typing import Any, TypeAlias

from compoundkin.model.loads.attachments import Effort, PairLoad, effort
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.damper import Damper, PairDamper, damper
from compoundkin.model.loads.force import Force, Torque, force, torque
from compoundkin.model.loads.friction import Friction, friction
from compoundkin.model.loads.gravity import Gravity, gravity
from compoundkin.model.loads.latch import Latch, Release, latch, release
from compoundkin.model.loads.mass import Mass, mass
from compoundkin.model.loads.motor import Motor, motor
from compoundkin.model.loads.pressure import Pressure, pressure
from compoundkin.model.loads.pretension import Pretension, pretension
from compoundkin.model.loads.spring import PairSpring, Spring, spring
from compoundkin.model.loads.stop import Stop, stop

__all__ = [
    "KINDS",
    "WRITTEN",
    "Damper",
    "Effort",
    "Force",
    "Friction",
    "Gravity",
    "Latch",
    "Load",
    "LoadElement",
    "Mass",
    "Motor",
    "PairDamper",
    "PairLoad",
    "PairSpring",
    "Pressure",
    "Pretension",
    "Release",
    "Spring",
    "Stop",
    "Torque",
    "damper",
    "effort",
    "force",
    "friction",
    "gravity",
    "latch",
    "mass",
    "motor",
    "pressure",
    "pretension",
    "release",
    "spring",
    "stop",
    "torque",
]
# Every kind of load.
KINDS: tuple[type[Load], ...] = (
    Force,
    Torque,
    Effort,
    Spring,
    PairSpring,
    Damper,
    PairDamper,
    Motor,
    Pressure,
    Stop,
    Latch,
    Release,
)
# What each table of a mechanism file may hold.
_TABLED: tuple[type[Any], ...] = (Mass, *KINDS, Friction, Pretension)
WRITTEN: dict[str, tuple[type[Any], ...]] = {
    kind.table: tuple(other for other in _TABLED if other.table == kind.table) for kind in _TABLED
}
# What is written of masses and forces.
LoadElement: TypeAlias = Mass | Gravity | Load | Friction | Pretension
