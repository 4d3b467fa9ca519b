"""The masses of a model's bodies: those that are given, and what stands for those that are not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.mjcf.model_units import ModelUnits
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.elements import Mass
from compoundkin.model.geometry import FRAME

# What a link weighs where nothing has a mass; a round number, so that it is seen to be made up.
_MADE_UP = 1.0
# What links without mass weigh beside others, as a part of all: MuJoCo moves nothing without mass.
_SLIGHT = 1e-6
# The inertia of a point mass, by its mass and the mechanism's size squared: it has none, MuJoCo asks for one.
_OF_POINT = 1e-6


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
    least = _OF_POINT * shown.mechanism.geometry.size**2
    masses = {name: _mass(shown, given.get(name) or Mass(name, stand_in), units, least) for name in moving}
    return masses, tuple(_told(without, bool(given), stand_in * units.mass))


def _mass(shown: ShownMechanism, given: Mass, units: ModelUnits, least: float) -> BodyMass:
    points = shown.points[given.link]
    own = given.completed(points or {"": 0j})
    mass = float(first_entry(own.mass))
    centre = points[own.at] if isinstance(own.at, str) else complex(first_entry(own.at))
    inertia = max(float(first_entry(own.inertia)), least * mass)
    return BodyMass(mass * units.mass, centre * units.length, inertia * units.inertia)


def _told(without: list[str], some: bool, mass: float) -> Iterator[str]:
    if without and not some:
        yield f"no masses are given: every link is a uniform bar or plate of {mass:g} kg"
    elif without:
        yield f"{', '.join(without)} without mass: {mass:.3g} kg each, a millionth of all others"
