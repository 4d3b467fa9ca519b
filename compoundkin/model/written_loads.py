"""What is written of masses, loads and outlines, by name."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.elements import Friction, Gravity, Item, LinkOutline, Load, Mass, Pretension
from compoundkin.model.geometry import Geometry
from compoundkin.model.loads.contract import WrittenNames
from compoundkin.model.units import Units


class WrittenLoads:
    """The masses, gravity, loads and outlines of a mechanism, checked or not."""

    items: tuple[Item, ...]
    units: Units | None

    @property
    def stated_units(self) -> Units:
        """The units of length, mass and force, which forces need. Raises InvalidInput where they are not stated."""
        if self.units is None:
            remedy = 'write Mechanism(..., units={"length": "mm", "mass": "kg", "force": "N"})'
            raise InvalidInput(Problem("units", "forces need units of length, mass and force", remedy))
        return self.units

    @property
    @abstractmethod
    def geometry(self) -> Geometry:
        """The dimensions as numbers."""

    @property
    @abstractmethod
    def names(self) -> WrittenNames:
        """The links, points and pairs that loads may name."""

    @cached_property
    def masses(self) -> dict[str, Mass]:
        """The masses by their links, what they leave out taken from their links' points."""
        given = [item for item in self.items if isinstance(item, Mass)]
        return {item.link: item if item.is_complete else item.completed(self.geometry.points[item.link])
                for item in given}  # fmt: skip

    @cached_property
    def gravity(self) -> Number:
        """The acceleration of free fall, m/s^2; zero where none is written."""
        return next((item.vector for item in self.items if isinstance(item, Gravity)), 0j)

    @property
    def free_fall(self) -> Number:
        """The acceleration of free fall in the mechanism's own unit of length."""
        return self.gravity * self.stated_units.metre

    def mass_centre(self, mass: Mass) -> Number:
        """Return the place of a mass centre in its link's frame."""
        return self.geometry.points[mass.link][mass.at] if isinstance(mass.at, str) else mass.at

    @cached_property
    def loads(self) -> dict[str, Load]:
        """The loads by name. Those on pins are on a link, those along pairs know their links."""
        return {item.name: item.completed(self.names) for item in self.items if isinstance(item, Load)}

    @cached_property
    def frictions(self) -> dict[str, Friction]:
        """The frictions by their pairs. The letter of a multiple pin stands for all its pairs."""
        return {self._pair_meant(item.pair): item for item in self.items if isinstance(item, Friction)}

    @cached_property
    def pretensions(self) -> dict[str, Pretension]:
        """The pretensions by their belts."""
        return {self._pair_meant(item.pair): item for item in self.items if isinstance(item, Pretension)}

    @cached_property
    def outlines(self) -> dict[str, LinkOutline]:
        """The outlines by name; of a link there may be several."""
        return {item.name: item for item in self.items if isinstance(item, LinkOutline)}

    def _pair_meant(self, name: str) -> str:
        """Return the name of the pair that a name means, be it that of its driver."""
        pair = self.names.pair(name)
        return name if pair is None else pair.name
