"""Wrenches of a whole motion by name, put together of those of its blocks."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Generic, TypeVar

import numpy as np

from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.dynamics.reactions.redundant_reactions import own_wrenches
from compoundkin.dynamics.reactions.reverse_pass import Reactions
from compoundkin.kinematics.motion import Motion

Key = TypeVar("Key", bound=Hashable)
# What the mechanism does to its frame, among the wrenches by pairs.
ON_FRAME = ""


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


def joined_reactions(motion: Motion, parts: Iterable[tuple[LoadedBlock, Reactions]]) -> dict[str, Wrench]:
    """Return the wrenches in pairs and on the frame, of all blocks.

    Pairs are the mechanism's own.
    """
    store: JoinedWrenches[str] = JoinedWrenches(motion.failed.shape)
    for at, reactions in parts:
        for name, wrench in {**reactions.pairs, ON_FRAME: reactions.on_frame}.items():
            store.take(name, wrench, at.designs, at.poses)
    found = store.wrenches()
    if motion.structure.relaxation is not None:
        found.update(own_wrenches(motion.structure, found, motion.failed.shape))
    own = {pair.name for pair in motion.structure.pairs}
    wrenches = {name: found[name] for name in motion.solving_order.pairs if name in found and name in own}
    return {**wrenches, ON_FRAME: found[ON_FRAME]}
