"""Masses, forces and gravity as they are written: in the program's units, at places as drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from compoundkin.base.display import count_phrase
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnMass
from compoundkin.files.exchange.pmks_plus.share_joints import ShareJoints, plain_name
from compoundkin.files.exchange.pmks_plus.share_scale import ShareScale
from compoundkin.files.exchange.pmks_plus.shared_records import GRAVITY, INERTIA_UNITS, UNITS, SharedForce, SharedLink
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import FORCES, LENGTHS, MASSES

# How long forces are drawn, as a part of the size.
_DRAWN = 0.2
# The standard acceleration of gravity is within this part of the program's; others are told.
_NEAR = 1e-3


@dataclass
class ToldLoads:
    """The loads of a drawing. Enlarged links have none: they would do something else."""

    drawing: Drawing
    scale: ShareScale
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        drawing = self.drawing
        self._is_told = drawing.units is not None and self.scale.enlarged == 1.0
        self._masses = {mass.link: mass for mass in drawing.masses if mass.link != FRAME} if self._is_told else {}
        self._size = 1.0
        many = len(drawing.masses) + len(drawing.forces)
        if many and not self._is_told:
            self.notes.append(
                f"{count_phrase(many, 'mass or force', 'masses and forces')} left out, which larger links change"
            )
        if drawing.gravity is not None and abs(drawing.gravity + 1j * GRAVITY) > _NEAR * GRAVITY:
            self.notes.append(f"gravity is {GRAVITY:g} m/s^2 downward in PMKS+")

    @property
    def has_gravity(self) -> bool:
        """Whether links weigh."""
        return self.drawing.gravity is not None and bool(self._masses)

    def weighed(self, key: str, link: SharedLink, table: ShareJoints) -> SharedLink:
        """Return a link with its mass. One without has its mass centre amid its joints."""
        places = [table.joints[id_].at for id_ in link.joints]
        mass = self._masses.get(key)
        if mass is None:
            return link if link.is_block else replace(link, centre=sum(places) / len(places))
        if link.is_block:
            return self._block(mass, link, places[0])
        own, inertia = self._numbers(mass)
        centre = sum(places) / len(places) if mass.centre is None else mass.centre * self.scale.factor
        told = {(False, False): "Y", (True, False): "M", (False, True): "G", (True, True): "A"}
        flag = told[mass.inertia is None, mass.centre is None]
        return replace(link, mass=own, inertia=inertia, centre=centre, flag=flag)

    def forces(self, ids: Mapping[str, str]) -> Iterator[SharedForce]:
        """Yield the forces; `ids` are those of the links by their keys."""
        if not self._is_told:
            return
        assert self.drawing.units is not None
        unit = FORCES[self.drawing.units[2]] / FORCES[UNITS[self.scale.length][2]]
        for number, force in enumerate(self.drawing.forces, 1):
            if force.link == FRAME or not force.force:
                continue
            start = force.at * self.scale.factor
            end = start + force.force / abs(force.force) * self.scale.size * _DRAWN
            name = plain_name(force.name) or f"F{number}"
            yield SharedForce(f"F{number}", ids[force.link], name, start, end, abs(force.force) * unit, force.turns)

    def _numbers(self, mass: DrawnMass) -> tuple[float, float]:
        """Return mass and inertia in the program's units."""
        assert self.drawing.units is not None
        length, unit, _ = self.drawing.units
        ours, theirs = MASSES[unit], MASSES[UNITS[self.scale.length][1]]
        area = (LENGTHS[length] / LENGTHS[UNITS[self.scale.length][0]]) ** 2
        inertia = (mass.inertia or 0.0) * ours / theirs * area / INERTIA_UNITS[self.scale.length]
        return mass.mass * ours / theirs, inertia

    def _block(self, mass: DrawnMass, link: SharedLink, pin: complex) -> SharedLink:
        """Return a block with its mass, which is at its pin and has no inertia; what differs is told."""
        own, inertia = self._numbers(mass)
        off = mass.centre is not None and abs(mass.centre * self.scale.factor - pin) > _NEAR * self.scale.size
        if inertia or off:
            self.notes.append(f"the mass of {link.name} is at its pin, without inertia: it is written as a block")
        return replace(link, mass=own)
