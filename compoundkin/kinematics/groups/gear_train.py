"""Gear trains: wheels and racks whose angles or displacements gear pairs give in proportion; one wheel is a train."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import Inverse
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import Block, size_in
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.pair_sides import MountedBody, Reason, alone
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, Ends, as_drivable, as_turn_counting, constraint_scales
from compoundkin.structure.mobility_count import Body, Group

# A higher pair whose closure a coordinate changes by less than this (both in parts of the size, or radians) does not
# determine it: rounding of a right angle between a rack and its pinion's guide, or of a ratio with which a train locks.
FLAT = 1e-13
UNIT = Series((0.0, 1.0))


class GearTrainSolver(GroupSolver):
    """The solver of bodies on pins whose angles gear pairs give together.

    It also takes one that a gear or rack moves in proportion.

    The closures where all coordinates are zero, by their slopes, give the coordinates: linear equations.
    Source: Willis's equation for every pair, e.g. R. L. Norton, Design of Machinery, section 9.8.
    """

    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    def __init__(
        self,
        index: int,
        group: Group,
        size: float,
        lowers: tuple[tuple[Drivable, Body], ...],
        highers: tuple[Pair, ...],
    ) -> None:
        super().__init__(index, group)
        self.size = size
        self.mounted = tuple(MountedBody(pair, highers[0], body) for pair, body in lowers)
        self.highers = highers
        self.counted_from = tuple(mounted.side.other for mounted in self.mounted)
        self.slid = tuple(
            mounted for mounted in self.mounted if not mounted.lower.free_is_angle and mounted.lower.is_simple
        )
        beside = (name for pair in highers for name in pair.members)
        own = (name for _, body in lowers for name in body.links)
        self.links = tuple(dict.fromkeys([*self.counted_from, *beside, *own]))

    @classmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> Self | None:
        """Return the solver of a wheel, and of bodies that gear pairs join.

        The bodies hang on pins one after another.
        """
        pairs = (*group.inner, *group.outer)
        if len(group.bodies) == 1 and len(group.outer) == 2:
            lower, higher = sorted(pairs, key=lambda pair: -pair.held)
            own = next(j for j, name in enumerate(higher.members) if name in group.links)
            mount, wheel = as_drivable(lower), as_turn_counting(higher)
            if mount and wheel and wheel.is_affine(lower, own):
                return cls(index, group, size, ((mount, group.bodies[0]),), (higher,))
        highers = tuple(pair for pair in pairs if pair.is_geared)
        pins = [pin for pair in pairs if pair.is_simple and pair.free_is_angle and (pin := as_drivable(pair))]
        if not highers or len(pins) + len(highers) < len(pairs) or len(pins) != len(group.bodies):
            return None
        left, found = list(group.bodies), list[tuple[Drivable, Body]]()
        for _ in pins:
            hung = [(pair, body) for body in left for pair in pins if _hangs(pair, body, left)]
            found += hung[:1]
            left = [body for body in left if body not in [b for _, b in found]]
        return None if left else cls(index, group, size, tuple(found), highers)

    def close(self, block: Block, mode: Number) -> None:
        """Assemble the group; a mode has no effect."""
        start = self._closures(block.copy(), [constant(0.0)] * len(self.mounted))
        self._place(block, self._alone(block, start) if len(start) == 1 else self._together(block, start))

    def _alone(self, block: Block, start: list[Series]) -> list[Series]:
        """Return the coordinate of one body, whose slope changes where a rack and a guide turn on each other."""
        lead = self._closures(block.leading(self.links), [UNIT])[0].c[1]
        rates = (self._closures(block.copy(), [constant(1.0)])[0] - start[0]).c[1:]
        slope = Series((lead, *rates) if any(np.any(rate != 0.0) for rate in rates) else (lead,))
        free = np.abs(lead) <= self._flat(block)
        if np.any(free):
            slope = Series((np.where(free, np.nan, lead), *slope.c[1:]))
            block.fail(~free, self.index)
        return [-start[0] / slope]

    def _together(self, block: Block, start: list[Series]) -> list[Series]:
        """Return the coordinates of several bodies, whose slopes are ratios."""
        rest = [constant(0.0)] * len(self.mounted)
        units = ([*rest[:j], UNIT, *rest[j + 1 :]] for j in range(len(rest)))
        slopes = [[_second(c) for c in self._closures(block.leading(self.links), unit)] for unit in units]
        # the closures are rows, the coordinates columns
        inverse = Inverse([dict(enumerate(row)) for row in zip(*slopes, strict=True)], len(rest))
        good = inverse.largest < 1.0 / self._flat(block)
        block.fail(good, self.index)
        solved = []
        for k in range(max(len(c.c) for c in start)):
            found = inverse.times([c.c[k] if len(c.c) > k else 0.0 for c in start])
            solved.append([np.where(good, -value, np.nan)[()] for value in found])
        return [Series(coefficients) for coefficients in zip(*solved, strict=True)]

    def _flat(self, block: Block) -> Number:
        """Return the slope below which a closure does not determine a coordinate; of several bodies all are angles."""
        size = size_in(block.ends, self.size)
        return (
            FLAT * constraint_scales(self.highers[0], size)[0] / (1.0 if self.mounted[0].lower.free_is_angle else size)
        )

    def _closures(self, block: Block, coordinates: list[Series]) -> list[Series]:
        self._place(block, coordinates)
        members = (tuple(block.world[name] for name in pair.members) for pair in self.highers)
        return [p.closure(block.ends[p.name], m)[0] for p, m in zip(self.highers, members, strict=True)]

    def _place(self, block: Block, coordinates: list[Series]) -> None:
        for mounted, coordinate in zip(self.mounted, coordinates, strict=True):
            block.publish(mounted.body, mounted.placed(block, coordinate))

    def every(self, block: Block) -> Configurations:
        """Return the only configuration."""
        return self.in_modes(block)

    def reasons(self, block: Block) -> tuple[Reason, ...]:
        """Return what leaves it free. Otherwise it can be assembled wherever what it hangs on can."""
        if len(self.mounted) == 1:
            return alone(f"{self.mounted[0].side.pair.name} may move without any effect on {self.highers[0].name}")
        return alone(f"the ratios of {', '.join(pair.name for pair in self.highers)} do not determine it")


def _hangs(pair: Pair, body: Body, left: list[Body]) -> bool:
    """Return whether a pin joins a body to a link that is known, or to a body that is placed already."""
    own = [name for name in pair.members if name in body.links]
    waiting = [name for name in pair.members if any(name in other.links for other in left)]
    return len(own) == 1 and waiting == own


def _second(series: Series) -> Number:
    return series.c[1] if len(series.c) > 1 else 0.0
