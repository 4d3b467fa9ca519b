"""Ends of guides while a block is solved: poses beyond them are not assembled, and the end is named."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import End
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.reasons import Reason, Words, told
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.travel_limits import TravelLimited, as_travel_limited, bounds_name
from compoundkin.structure.kinematic_structure import Structure

# An end is reached, not passed, within this part of the size (or radians): positions are right to a few units of
# 1e-12, and gaps are found to 1e-9.
AT_END = 1e-11
# Where a sentence tells the two places.
HERE, THERE = "{here}", "{there}"
# What is known before any group is solved.
BEFORE = -1


class PassedEnd(NamedTuple):
    """An end of a guide that a pose is beyond. Its pair, and the words for it."""

    pair: TravelLimited
    reason: str


class GuideEnds(ShortRepr):
    """The pairs of a structure whose guides have ends.

    They go by the group after which all their links are known (`known_by`). A pose
    beyond an end fails as one of a group does: as the first failure, by a number above those of the groups.
    """

    def __init__(self, structure: Structure, size: float) -> None:
        self.size = size
        self.pairs = tuple(own for pair in structure.mechanism.written_pairs if (own := as_travel_limited(pair)))
        self._groups = len(structure.groups)
        # before all groups, or after the one by which the last of its links is known
        self._after: dict[int, list[tuple[int, TravelLimited]]] = {}
        self.known_by: list[int] = []
        known = {link: index for index, group in enumerate(structure.groups) for link in group.links if self.pairs}
        for k, pair in enumerate(self.pairs):
            last = max(known.get(name, BEFORE) for name in pair.members)
            self._after.setdefault(last, []).append((k, pair))
            self.known_by.append(last)

    def bounds(self, geometry: Geometry) -> dict[str, Ends]:
        """Return where guides begin and end, as numbers that go with the pairs' sides."""
        return {bounds_name(pair): tuple(End(value) for value in pair.bounds(geometry)) for pair in self.pairs}

    def mask(self, block: Block, index: int) -> None:
        """Note the poses beyond an end that is known after a group. BEFORE is that of none."""
        for k, pair in self._after.get(index, ()):
            outside = self._margin(block, pair) < 0.0
            if np.any(outside):
                block.fail(~outside, self._groups + k)

    def margin(self, block: Block) -> Number:
        """Return how far a block is from the nearest end, negative beyond.

        It is in parts of the size, or radians.
        """
        return np.minimum.reduce([np.broadcast_to(one, block.shape) for one in self._margins(block)])

    def nearest(self, block: Block) -> Number:
        """Return the index of the pair whose end is nearest, or passed by most."""
        return np.argmin([np.broadcast_to(one, block.shape) for one in self._margins(block)], axis=0)

    def passed(self, failed: int, block: Block, at: int) -> PassedEnd | None:
        """Return which end a failed pose of a column is beyond. None where a group does not close."""
        if failed <= self._groups:
            return None
        pair = self.pairs[failed - self._groups - 1]
        return PassedEnd(pair, told(self.reasons(block, pair), at))

    def reasons(self, block: Block, pair: TravelLimited) -> tuple[Reason, ...]:
        """Return why a pose may be beyond a guide's end or its beginning."""
        start, stop = self._distances(block, pair)
        poses = tuple(block.world[name] for name in pair.members)
        here = _shown(pair, pair.coordinate(block.ends[pair.name], poses).c[0])
        ends = (_shown(pair, side.point) for side in block.ends[bounds_name(pair)])
        assert pair.reach is not None
        named = [
            (f"{letter} at ", *end) if isinstance(letter, str) else end
            for letter, end in zip(pair.reach, ends, strict=True)
        ]
        first, last = (_filled(pair.passed(HERE, THERE, is_end), here, named[is_end]) for is_end in (False, True))
        return Reason(stop < start, last), Reason(True, first)

    def _margins(self, block: Block) -> list[Number]:
        return [self._margin(block, pair) for pair in self.pairs]

    def _margin(self, block: Block, pair: TravelLimited) -> Number:
        scale = 1.0 if pair.free_is_angle else self.size
        return np.minimum(*self._distances(block, pair)) / scale + AT_END

    def _distances(self, block: Block, pair: TravelLimited) -> tuple[Number, Number]:
        poses = tuple(block.world[name] for name in pair.members)
        low, high = (side.point for side in block.ends[bounds_name(pair)])
        return pair.inside((low, high), block.ends[pair.name], poses)


def _shown(pair: TravelLimited, value: Any) -> Words:
    return (np.rad2deg(value), " degrees") if pair.free_is_angle else (value,)


def _filled(sentence: str, here: Words, there: Words) -> Words:
    """Return a sentence about two places as words and numbers."""
    before, between, after = re.split(f"{HERE}|{THERE}", sentence)
    return (before, *here, between, *there, after)
