"""Wrenches of a whole motion, by name: filled block by block."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Generic, TypeVar

import numpy as np

from compoundkin.base.wrenches import Wrench

Key = TypeVar("Key", bound=Hashable)


class JoinedWrenches(Generic[Key]):
    """Arrays of wrenches by name. Blocks are added; it is complete when all have been."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self._found: dict[Key, Wrench] = {}

    def take(self, name: Key, wrench: Wrench, designs: slice, poses: slice) -> None:
        """Add a block."""
        if name not in self._found:
            self._found[name] = Wrench(np.zeros(self.shape, dtype=complex), np.zeros(self.shape))
        whole = self._found[name]
        whole.force[designs, poses] += wrench.force
        whole.moment[designs, poses] += wrench.moment

    def wrenches(self) -> dict[Key, Wrench]:
        """Return the wrenches over all blocks."""
        return self._found
