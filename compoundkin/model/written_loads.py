"""What is written of masses and loads, by name."""

from __future__ import annotations

from functools import cached_property

from compoundkin.base.series import Number
from compoundkin.model.elements import Gravity, Item, Load, Mass


class WrittenLoads:
    """The masses, the gravity and the loads of a mechanism, checked or not."""

    items: tuple[Item, ...]

    @cached_property
    def masses(self) -> dict[str, Mass]:
        """The masses by their links."""
        return {item.link: item for item in self.items if isinstance(item, Mass)}

    @cached_property
    def gravity(self) -> Number:
        """The acceleration of free fall, m/s^2; zero where none is written."""
        return next((item.vector for item in self.items if isinstance(item, Gravity)), 0j)

    @cached_property
    def loads(self) -> dict[str, Load]:
        """The loads by name."""
        return {item.name: item for item in self.items if isinstance(item, Load)}
