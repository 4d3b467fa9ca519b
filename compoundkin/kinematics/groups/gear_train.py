"""Trains: bodies that turn on pins, all of whose angles gear pairs give together."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.linear import inverted
from compoundkin.base.series import Number, Series, constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.mounts import FLAT, Mounted
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import table
from compoundkin.structure.parts import Body, Group


class TrainStep:
    """Bodies that turn on pins, all of whose angles gear pairs give together: one system of linear equations.

    Source: Willis's equation for every pair, e.g. R. L. Norton, Design of Machinery, section 9.8.
    """

    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    def __init__(self, index: int, group: Group, lowers: tuple[tuple[Pair, Body], ...], highers: tuple[Pair, ...]):
        self.index = index
        self.group = group
        self.mounted = tuple(Mounted(pair, highers[0], body) for pair, body in lowers)
        self.highers = highers
        others = [mounted.side.other for mounted in self.mounted]
        self.links = tuple(dict.fromkeys([*others, *(name for pair in highers for name in pair.members)]))

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The links from which its coordinates count."""
        return tuple(mounted.side.other for mounted in self.mounted)

    @classmethod
    def of(cls, index: int, group: Group) -> TrainStep | None:
        """The step for a group whose bodies hang on pins one after another, joined by gear pairs; None for others."""
        pairs = (*group.inner, *group.outer)
        highers = tuple(pair for pair in pairs if pair.adds_angles)
        pins = [pair for pair in pairs if pair.is_simple and pair.free_is_angle]
        if not highers or len(pins) + len(highers) < len(pairs) or len(pins) != len(group.bodies):
            return None
        left, found = list(group.bodies), list[tuple[Pair, Body]]()
        for _ in pins:
            hung = [(pair, body) for body in left for pair in pins if _hangs(pair, body, left)]
            found += hung[:1]
            left = [body for body in left if body not in [b for _, b in found]]
        return None if left else cls(index, group, tuple(found), highers)

    def run(self, block: Block) -> None:
        """Close the group: the closures where all coordinates are zero, by their slopes, give the coordinates."""
        rest = [constant(0.0)] * len(self.mounted)
        start = self._closures(block.copy(), rest)
        units = ([*rest[:j], Series((0.0, 1.0)), *rest[j + 1 :]] for j in range(len(rest)))
        slopes = [[_second(c) for c in self._closures(block.leading(self.links), unit)] for unit in units]
        inverse = inverted(table(*zip(*slopes, strict=True)))
        free = ~(np.abs(inverse).max(axis=(-1, -2)) < 1.0 / FLAT)
        block.failed = np.where((block.failed == 0) & free, self.index + 1, block.failed)
        inverse = np.where(free[..., None, None], np.nan, inverse)
        solved = []
        for k in range(max(len(c.c) for c in start)):
            lacking = np.stack(np.broadcast_arrays(*(c.c[k] if len(c.c) > k else 0.0 for c in start)), -1)
            solved.append(-np.einsum("...ij,...j->...i", inverse, lacking))
        self._place(block, [Series(tuple([c[..., j] for c in solved])) for j in range(len(rest))])

    def _closures(self, block: Block, coordinates: list[Series]) -> list[Series]:
        self._place(block, coordinates)
        members = (tuple(block.world[name] for name in pair.members) for pair in self.highers)
        return [p.closure(block.ends[p.name], m)[0] for p, m in zip(self.highers, members, strict=True)]

    def _place(self, block: Block, coordinates: list[Series]) -> None:
        for mounted, coordinate in zip(self.mounted, coordinates, strict=True):
            block.publish(mounted.body, mounted.placed(block, coordinate))

    def explain(self, block: Block, at: int) -> str:
        """It can be assembled wherever what it hangs on can, unless its ratios leave it free."""
        return f"the ratios of {', '.join(pair.name for pair in self.highers)} do not determine it"


def _hangs(pair: Pair, body: Body, left: list[Body]) -> bool:
    """Whether a pin joins a body to a link that is known, or to a body that is placed already."""
    own = [name for name in pair.members if name in body.links]
    waiting = [name for name in pair.members if any(name in other.links for other in left)]
    return len(own) == 1 and waiting == own


def _second(series: Series) -> Number:
    return series.c[1] if len(series.c) > 1 else 0.0
