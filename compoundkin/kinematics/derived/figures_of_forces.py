"""What is read of the forces of a motion, as figures: each is asked of the forces, which know its values."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.base.display import display_function
from compoundkin.kinematics.derived.contract import Figure, HasQuantities, Lack
from compoundkin.model.attributes import FORCES, Kind


def force_figures(kind: Kind) -> Mapping[str, Figure]:
    """Return the figures of forces that points, links, pairs or drivers have."""
    return {word: _figure(kind, word) for word in FORCES[kind]}


def _figure(kind: Kind, word: str) -> Figure:
    """Return a figure that is asked of forces. They are known when it is asked for."""

    def own() -> Figure:
        found: Figure = display_function("force_figure")(kind, word)
        return found

    def values(motion: HasQuantities, name: str) -> Number:
        return own().values(forces_of(motion), name)

    def lack(motion: HasQuantities, name: str) -> Lack | None:
        if motion.mechanism.units is None:
            return Lack("the mechanism has no units of mass and force", "state them: Mechanism(..., units={...})")
        return own().lack(motion, name)

    def unit(motion: HasQuantities, name: str) -> str:
        asked = own().unit
        return asked(forces_of(motion), name) if asked else ""

    def scale(motion: HasQuantities, name: str) -> float:
        asked = own().scale
        return asked(forces_of(motion), name) if asked else 0.0

    return Figure(values, lack, unit, scale)


class AsksForces:
    """A motion whose forces can be asked for."""

    loading: Mapping[str, Any]

    @cached_property
    def forces(self) -> Any:
        """Its forces, of `force_analysis` with what is in `loading`."""
        return display_function("forces")(self, **self.loading)


def forces_of(motion: HasQuantities) -> Any:
    """Return the forces of a motion. They are found when they are first asked for."""
    whole: Any = motion
    return whole.forces
