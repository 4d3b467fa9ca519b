"""The units of a model, and the masses of its bodies: those that are given, and what stands for others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.mass import Mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import FORCES, LENGTHS, MASSES

# What a link weighs where nothing has a mass; a round number, so that it is seen to be made up.
_MADE_UP = 1.0
# What links without mass weigh beside others, as a part of all: MuJoCo moves nothing without mass, and steps badly
# where one link is lighter than this.
_SLIGHT = 1e-3
# The inertia of links that have none, by their mass and the mechanism's size squared: where the mass is made up, it is
# what makes them turn slowly enough for its steps; where it is given, it is next to nothing.
_MADE_UP_TURN, _OF_POINT = 1e-2, 1e-6


@dataclass(frozen=True)
class ModelUnits:
    """How many metres, kilograms and newtons a mechanism's units are, and words for it."""

    length: float
    mass: float
    force: float
    told: str

    @property
    def inertia(self) -> float:
        """The factor of inertias."""
        return self.mass * self.length**2


def units_of(mechanism: Mechanism) -> ModelUnits:
    """Return the units of a mechanism's model.

    MuJoCo has none, but its defaults suit metres and kilograms; lengths of an unknown unit stay as they are.

    >>> from compoundkin.files import load
    >>> units_of(load("six-bar")).told
    'lengths are in m (1 mm is 0.001 m), masses in kg, forces in N, torques in N m'
    """
    length = LENGTHS.get(mechanism.unit)
    units = mechanism.units
    mass, force = (1.0, 1.0) if units is None else (MASSES[units.mass], FORCES[units.force])
    forces = "masses in kg, forces in N, torques in N m"
    if length is None:
        unit = f"in {mechanism.unit}, which is unknown, and" if mechanism.unit else "without a unit and"
        return ModelUnits(1.0, mass, force, f"lengths are {unit} kept as they are; taken as m, {forces}")
    kept = "" if length == 1.0 else f" (1 {mechanism.unit} is {length:.12g} m)"
    return ModelUnits(length, mass, force, f"lengths are in m{kept}, {forces}")


@dataclass(frozen=True)
class BodyMass:
    """A body's mass, mass centre and inertia about that, in kilograms and metres.

    The centre is in the link's frame.
    """

    mass: float
    centre: complex
    inertia: float

    def shared(self, parts: int) -> BodyMass:
        """Return one of several equal parts at one place."""
        return replace(self, mass=self.mass / parts, inertia=self.inertia / parts)


def masses_of(shown: ShownMechanism, units: ModelUnits) -> tuple[Mapping[str, BodyMass], tuple[str, ...]]:
    """Return the masses of all moving links, and in sentences what is made up."""
    given = shown.mechanism.masses
    moving = [name for name in shown.mechanism.links if name != FRAME]
    without = [name for name in moving if name not in given]
    whole = sum(float(first_entry(one.mass)) for one in given.values()) * units.mass
    stand_in = (whole * _SLIGHT if given else _MADE_UP) / units.mass
    masses = {name: _mass(shown, given.get(name) or Mass(name, stand_in), units) for name in moving}
    points = [name for name, one in given.items() if not first_entry(one.inertia) and name in masses]
    return masses, (*_told(without, bool(given), stand_in * units.mass), *_told_points(points))


def _mass(shown: ShownMechanism, given: Mass, units: ModelUnits) -> BodyMass:
    points = shown.points[given.link]
    own = given.completed(points or {"": 0j})
    mass = float(first_entry(own.mass))
    centre = points[own.at] if isinstance(own.at, str) else complex(first_entry(own.at))
    inertia, scale = float(first_entry(own.inertia)), mass * shown.mechanism.geometry.size**2
    is_beside = bool(shown.mechanism.masses) and not given.is_complete
    if is_beside or not inertia:
        inertia = max(inertia, (_OF_POINT if given.is_complete else _MADE_UP_TURN) * scale)
    return BodyMass(mass * units.mass, centre * units.length, inertia * units.inertia)


def _told(without: list[str], some: bool, mass: float) -> Iterator[str]:
    if without and not some:
        yield f"no masses are given: every link is a uniform bar or plate of {mass:g} kg"
    elif without:
        names = ", ".join(without)
        yield f"no masses are given for {names}: {mass:.3g} kg each, a thousandth of all others, which shows in forces"


def _told_points(names: list[str]) -> Iterator[str]:
    if names:
        yield f"without inertia: {', '.join(names)}, given a millionth of mass times the mechanism's size squared"
