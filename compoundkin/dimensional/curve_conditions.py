"""Conditions on many designs of a chain at once, where they are laid on a curve: what they hold at poses of a turn.

They are those of `tasks.Conditions` and a greatest size. Pivots and lengths are read off the designs; transmission
angles, and whether pins and links keep clear of obstacles, are outputs of a program over a turn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dimensional.candidates import POINT
from compoundkin.dimensional.curve_chains import CRANK, CurveChain, turn
from compoundkin.dimensional.tasks import Conditions, inside, meets
from compoundkin.model.attributes import POSITION, TRANSMISSION_INDEX, component_names
from compoundkin.model.geometry import FRAME
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile
from compoundkin.structure import decompose

# Poses of a turn at which conditions are looked at, and designs whose motion is looked at together.
POSES, TOGETHER = 64, 256
# Before designs are laid their sizes are known within this factor, and where they lie within this part of the curve's
# radius; of those that are less like it nothing is known.
NEARLY, ASIDE, LEAST_ALIKE = 1.1, 0.05, 0.3
# Steps of a refinement keep so much more of a transmission angle (radians), for what lies between poses.
BETWEEN = 0.01


class LaidDesigns(NamedTuple):
    """Designs of a chain (designs, numbers) and how each is laid: arrays (designs,) of the parts of a `Laying`."""

    chain: CurveChain
    designs: Number
    scale: Number
    place: Number
    mirrored: Number

    def some(self, kept: Number) -> LaidDesigns:
        """Return some of them."""
        return LaidDesigns(self.chain, *(each[kept] for each in self[1:]))

    def laid(self, z: Number) -> Number:
        """Return places of the chain, (designs,) or (designs, poses), where they lie."""
        shape = (len(self.designs),) + (1,) * (np.ndim(z) - 1)
        found = self.scale.reshape(shape) * z + self.place.reshape(shape)
        return np.where(self.mirrored.reshape(shape), np.conj(found), found)


class UnlaidDesigns(NamedTuple):
    """Designs of a chain (designs, numbers) that are not laid on a curve: arrays (designs,) of what is known before.

    `likeness` to the curve; `radius` and `middle` of their own. The curve has a `size`, its RMS radius, and a `center`.
    """

    chain: CurveChain
    designs: Number
    likeness: Number
    radius: Number
    middle: Number
    size: float
    center: complex


class CurveConditions(NamedTuple):
    """Conditions on linkages that trace a curve, and the greatest sum of their lengths."""

    wanted: Conditions
    size: float | None = None

    def __bool__(self) -> bool:
        return any((self.wanted.region is not None, self.wanted.lengths, self.wanted.transmission,
                    self.wanted.obstacles, self.size is not None))  # fmt: skip

    def held(self, laid: LaidDesigns) -> Number:
        """Return which designs hold them, (designs,)."""
        held = np.ones(len(laid.designs), bool)
        for holds in (self._pivots, self._lengths, self._motion):
            left = np.flatnonzero(held)
            if not len(left):
                break
            held[left] = holds(laid.some(left))
        return held

    def possible(self, seen: UnlaidDesigns) -> Number:
        """Return which designs may hold them where they will lie, (designs,): what plainly fails need not be laid."""
        plan = _points(seen.chain)
        places, scale = plan.places(seen), (seen.likeness * seen.size / seen.radius)[:, None]
        lengths = scale * np.abs(places[:, plan.ends[1]] - places[:, plan.ends[0]])
        may = np.ones(len(scale), bool)
        if self.wanted.lengths is not None:
            least, greatest = self.wanted.lengths
            may &= ((lengths >= least / NEARLY) & (lengths <= greatest * NEARLY)).all(axis=1)
        pivots = places[:, plan.pivots]
        if self.size is not None:
            ground = scale[:, 0] * np.abs(pivots[:, 0] - pivots[:, -1])
            may &= lengths.sum(axis=1) + ground <= self.size * NEARLY
        if self.wanted.region is not None:
            # whichever way it lies, a pivot is as far from the middle
            far, aside = scale * np.abs(pivots - seen.middle[:, None]), ASIDE * seen.size
            corners = self.wanted.region - seen.center
            nearest = 0.0 if inside(np.zeros(1, complex), corners)[0] else _distance(corners)
            may &= ((far * NEARLY + aside >= nearest) & (far / NEARLY - aside <= np.abs(corners).max())).all(axis=1)
        may |= seen.likeness < LEAST_ALIKE
        may[may] = self._transmits(seen.chain, seen.designs[may])
        return may

    def _pivots(self, laid: LaidDesigns) -> Number:
        held, region = np.ones(len(laid.designs), bool), self.wanted.region
        if region is None and not self.wanted.obstacles:
            return held
        plan = _points(laid.chain)
        for pivot in plan.places(laid)[:, plan.pivots].T:
            place = laid.laid(pivot)
            if region is not None:
                held &= inside(place, region)
            for obstacle in self.wanted.obstacles:
                held &= ~inside(place, obstacle)
        return held

    def _lengths(self, laid: LaidDesigns) -> Number:
        held, bounds = np.ones(len(laid.designs), bool), self.wanted.lengths
        if bounds is None and self.size is None:
            return held
        plan, scale = _points(laid.chain), np.abs(laid.scale)
        places = plan.places(laid)
        lengths = scale[:, None] * np.abs(places[:, plan.ends[1]] - places[:, plan.ends[0]])
        if bounds is not None:
            held &= ((lengths >= bounds[0]) & (lengths <= bounds[1])).all(axis=1)
        if self.size is not None:
            ground = scale * np.abs(places[:, plan.pivots[0]] - places[:, plan.pivots[-1]])
            held &= lengths.sum(axis=1) + ground <= self.size
        return held

    def _motion(self, laid: LaidDesigns) -> Number:
        held = np.ones(len(laid.designs), bool)
        if not self.wanted.transmission and not self.wanted.obstacles:
            return held
        for first in range(0, len(held), TOGETHER):
            held[first : first + TOGETHER] = self._moving(laid.some(np.arange(len(held))[first : first + TOGETHER]))
        return held

    def _transmits(self, chain: CurveChain, designs: Number) -> Number:
        """Return which designs have the least transmission angle over a turn, wherever they lie."""
        held = np.ones(len(designs), bool)
        if self.wanted.transmission and len(designs):
            found, clear = _indices(chain).programs.unscreened(_turning(chain, designs))
            held &= clear[: len(held)]
            for index in found.values():
                held &= (index >= np.sin(self.wanted.transmission)).all(axis=1)[: len(held)]
        return held

    def _moving(self, laid: LaidDesigns) -> Number:
        chain, held = laid.chain, self._transmits(laid.chain, laid.designs)
        if self.wanted.obstacles and held.any():
            found, clear = _places(chain).programs.unscreened(_turning(chain, laid.designs))
            held &= clear[: len(held)]
            at = {name.removesuffix(f".{POSITION}"): laid.laid(z[: len(held)] + np.zeros(POSES))
                  for name, z in found.items()}  # fmt: skip
            for a, b in bars(chain.mechanism.geometry.points):
                for obstacle in self.wanted.obstacles:
                    held[held] &= ~meets(at[a][held], at[b][held], obstacle).any(axis=1)
        return held


def _turning(chain: CurveChain, designs: Number) -> Call:
    """Return a call of a chain's programs over a turn, for two designs or more."""
    return Call({CRANK: turn(POSES)}, chain.dimensions(np.repeat(designs, 2, axis=0) if len(designs) == 1 else designs))


def _distance(corners: Number) -> float:
    """Return how far the sides of a polygon are from zero."""
    way = np.roll(corners, -1) - corners
    part = np.clip(-(corners * np.conj(way)).real / np.maximum(np.abs(way) ** 2, np.finfo(float).tiny), 0.0, 1.0)
    return float(np.abs(corners + part * way).min())


def keeps_transmission(chain: CurveChain, designs: Number, least: float) -> Number:
    """Return of which designs of a chain, two or more, the transmission angles stay above a least one, (designs,)."""
    if not least:
        return np.ones(len(designs), bool)
    found, clear = _indices(chain).programs.unscreened(Call({CRANK: turn(POSES)}, chain.dimensions(designs)))
    return clear & np.all([each.min(axis=1) >= np.sin(least + BETWEEN) for each in found.values()], axis=0)


def bars(links: Mapping[str, Iterable[str]]) -> Iterator[tuple[str, str]]:
    """Yield the letters of points that lines of moving links join, of the letters of each link."""
    for name, letters in links.items():
        if name != FRAME:
            yield from combinations(letters, 2)


class _ChainPoints(NamedTuple):
    """The points of all links of a chain in their links' own coordinates: of numbers (numbers, points), and fixed.

    `pivots` are those of the frame, `ends` those of the lengths of moving links, (2, lengths).
    """

    of_numbers: Number
    fixed: Number
    pivots: list[int]
    ends: Number

    def places(self, laid: LaidDesigns | UnlaidDesigns) -> Number:
        """Return the points of designs in units of the chain, (designs, points)."""
        return laid.chain.measures(laid.designs) @ self.of_numbers + self.fixed


@cache
def _points(chain: CurveChain) -> _ChainPoints:
    names = {one.name: k for k, one in enumerate(chain.numbers)}
    of_numbers, fixed, ends, pivots = list[Number](), list[complex](), list[tuple[int, int]](), list[int]()
    for name, each in chain.mechanism.geometry.points.items():
        own = list[int]()
        for letter, p in each.items():
            if name == FRAME or letter != POINT:
                own.append(len(fixed))
            column = np.zeros(len(names), complex)
            for part, unit in zip(component_names(f"{name}.{letter}"), (1.0, 1j), strict=True):
                if part in names:
                    column[names[part]] = unit
            of_numbers.append(column)
            fixed.append(0j if column.any() else complex(np.ravel(p)[0]))
        if name == FRAME:
            pivots = own
        else:
            ends += combinations(own, 2)
    return _ChainPoints(np.transpose(of_numbers), np.array(fixed), pivots, np.array(ends).T)


@cache
def _indices(chain: CurveChain) -> CompiledPath:
    """Return the program of the transmission indices of a chain's dyads."""
    groups = decompose(chain.mechanism).groups
    dyads = [group.links[0] for group in groups if len(group.links) == 2]
    return _compiled(chain, [f"{name}.{TRANSMISSION_INDEX}" for name in dyads])


@cache
def _places(chain: CurveChain) -> CompiledPath:
    """Return the program of the places of all points of a chain."""
    return _compiled(chain, [f"{letter}.{POSITION}" for letter in chain.mechanism.carriers])


def _compiled(chain: CurveChain, outputs: list[str]) -> CompiledPath:
    return compile(chain.mechanism, outputs, free=chain.program.free)
