"""All configurations of a mechanism, the circuits they lie on, their branches and limit positions."""

from __future__ import annotations

from compoundkin.branches.all_of import AllConfigurations, configurations
from compoundkin.branches.finding import Circuits, circuits
from compoundkin.branches.model import Branch, ChangePoint, Circuit, Limit, Place, Toggle
from compoundkin.branches.routes import Route

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
