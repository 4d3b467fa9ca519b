"""What is written of masses and loads, by name."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

from compoundkin.base.series import Number
from compoundkin.model.elements import Friction, Gravity, Item, Link, Load, Mass, Pretension
from compoundkin.model.geometry import Geometry


class WrittenLoads:
    """The masses, the gravity and the loads of a mechanism, checked or not."""

    items: tuple[Item, ...]

    @property
    @abstractmethod
    def geometry(self) -> Geometry:
        """The dimensions as numbers."""

    @property
    @abstractmethod
    def links(self) -> dict[str, Link]:
        """The links by name."""

    @property
    @abstractmethod
    def carriers(self) -> dict[str, tuple[str, ...]]:
        """The links that carry each letter."""

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

    @cached_property
    def loads(self) -> dict[str, Load]:
        """The loads by name; those on pins are on a link of them."""
        points = {name: item.letters for name, item in self.links.items()}
        return {item.name: item.completed(self.carriers, points) for item in self.items if isinstance(item, Load)}

    @cached_property
    def frictions(self) -> dict[str, Friction]:
        """The frictions by their pairs. The letter of a multiple pin stands for all its pairs."""
        return {item.pair: item for item in self.items if isinstance(item, Friction)}

    @cached_property
    def pretensions(self) -> dict[str, Pretension]:
        """The pretensions by their belts."""
        return {item.pair: item for item in self.items if isinstance(item, Pretension)}
