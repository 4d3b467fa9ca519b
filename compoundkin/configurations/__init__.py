"""All configurations of a mechanism, the circuits they lie on, their branches and limit positions."""

from __future__ import annotations

from compoundkin.configurations.circuit import Branch, ChangePoint, Circuit, Limit, Place, Toggle
from compoundkin.configurations.circuit_search import Circuits, circuits
from compoundkin.configurations.enumeration import AllConfigurations, configurations
from compoundkin.configurations.routes import Route

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
