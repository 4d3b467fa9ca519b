"""The units of a model: metres, kilograms and newtons, where the mechanism's own are known."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import LENGTHS, MASSES


@dataclass(frozen=True)
class ModelUnits:
    """How many metres and kilograms a mechanism's units are, and words for it."""

    length: float
    mass: float
    told: str

    @property
    def inertia(self) -> float:
        """The factor of inertias."""
        return self.mass * self.length**2


def units_of(mechanism: Mechanism) -> ModelUnits:
    """Return the units of a mechanism's model.

    MuJoCo has none, but its defaults suit metres and kilograms; lengths of an unknown unit stay as they are.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> units_of(load_named("six-bar")).told
    'lengths are in m (1 mm is 0.001 m), masses in kg, forces in N, torques in N m'
    """
    length = LENGTHS.get(mechanism.unit)
    mass = 1.0 if mechanism.units is None else MASSES[mechanism.units.mass]
    forces = "masses in kg, forces in N, torques in N m"
    if length is None:
        unit = f"in {mechanism.unit}, which is unknown, and" if mechanism.unit else "without a unit and"
        return ModelUnits(1.0, mass, f"lengths are {unit} kept as they are; taken as m, {forces}")
    kept = "" if length == 1.0 else f" (1 {mechanism.unit} is {length!r} m)"
    return ModelUnits(length, mass, f"lengths are in m{kept}, {forces}")
