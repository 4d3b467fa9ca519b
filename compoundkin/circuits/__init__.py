"""All configurations of a mechanism, the circuits they lie on, their branches and limit positions."""

from __future__ import annotations

from compoundkin.circuits.all_of import AllConfigurations, configurations
from compoundkin.circuits.finding import Circuits, circuits
from compoundkin.circuits.model import Branch, ChangePoint, Circuit, Limit, Place, Toggle
from compoundkin.circuits.routes import Route

__all__ = [
    "AllConfigurations",
    "Branch",
    "ChangePoint",
    "Circuit",
    "Circuits",
    "Limit",
    "Place",
    "Route",
    "Toggle",
    "circuits",
    "configurations",
]
