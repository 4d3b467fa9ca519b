"""Masses, gravity and loads as they are written: one file each, and this registry."""

from __future__ import annotations

from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.force import Force, Torque, force, torque
from compoundkin.model.loads.mass import Gravity, Mass, gravity, mass

__all__ = ["KINDS", "Force", "Gravity", "Load", "Mass", "Torque", "force", "gravity", "mass", "torque"]

# Every kind of load.
KINDS: tuple[type[Load], ...] = (Force, Torque)
