"""The solving order of a structure: a solver for each group, bound once, run over any block; ends of guides."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from copy import copy
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.buffers import without_collection
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import CLIPPED, SIZES, Block, LimitRule, size_in
from compoundkin.kinematics.groups import GroupSolver, solver_of
from compoundkin.kinematics.groups.pair_sides import Reason, Words, reason_text, spot
from compoundkin.model.definition import matching_pairs, pair_by_name
from compoundkin.model.geometry import Geometry
from compoundkin.model.load_validation import load_designs
from compoundkin.model.outline_validation import outline_designs
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import DimensionFit, Ends, as_turn_counting, constraint_scales
from compoundkin.model.pairs.travel_limits import TravelLimited, as_travel_limited, bounds_name
from compoundkin.structure.four_bars import FourBarLoops, four_bar_loops
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import DrivenPair


class SolvingOrder(ShortRepr):
    """The order in which a structure is solved.

    First come the driven links of the frame, then the solvers of its groups. `ends` are the pairs' sides and the ends
    of guides where these are not the mechanism's own numbers but stand for them.
    """

    def __init__(self, structure: Structure, ends: Mapping[str, Ends] | None = None) -> None:
        self.structure = structure
        geometry = structure.mechanism.geometry
        self.size = geometry.size
        pairs = {p.name: p for p in structure.pairs}
        for group in structure.groups:
            pairs.update({p.name: p for p in (*group.inner, *group.outer)})
        for body in self.structure.bodies:
            pairs.update({d.pair.name: d.pair for d in body.driven})
        self.pairs = pairs
        self.guide_ends = GuideEnds(structure, self.size)
        self.fits = Fits(structure, ends)
        own = None if ends is not None else {**self.guide_ends.bounds(geometry), **self.fits.rooms}
        self.ends: dict[str, Ends] = dict(ends or {name: pair.ends(geometry) for name, pair in pairs.items()})
        self.solvers: tuple[GroupSolver, ...] = tuple(
            solver_of(k, group, self.size, self.ends) for k, group in enumerate(structure.groups)
        )
        for solver in self.solvers:
            self.ends.update(solver.ends)
        self.ends.update(own or {})
        if ends is None and np.ndim(geometry.sizes):
            self.ends[SIZES] = (End(geometry.sizes),)
        self._meant: dict[str, tuple[Pair, int] | None] = {}

    def pair_meant(self, name: str) -> tuple[Pair, int] | None:
        """Return the pair of a name, as it is solved, and the sign of the coordinate; None for an unknown name."""
        if name not in self._meant:
            found = pair_by_name(self.structure.mechanism, name)
            for own in matching_pairs(self.pairs, found[0]) if found is not None else ():
                assert found is not None
                found = own, found[1] * (1 if own.members == found[0].members else -1)
                break
            self._meant[name] = found
        return self._meant[name]

    @cached_property
    def dimension_arrays(self) -> tuple[tuple[str, Number], ...]:
        """What of dimensions, loads and outlines are arrays, with their places."""
        named = [(name, v) for name, ends in self.ends.items() for end in ends for v in end if v is not None]
        points = self.structure.mechanism.geometry.points
        named += [(f"links.{name}.points.{k}", v) for name, placed in points.items() for k, v in placed.items()]
        named += [*load_designs(self.structure.mechanism), *outline_designs(self.structure.mechanism)]
        return tuple((where, value) for where, value in named if isinstance(value, np.ndarray))

    @cached_property
    def is_of_numbers(self) -> bool:
        """Whether every dimension is one number."""
        dimensions = (v for ends in self.ends.values() for end in ends for v in end if v is not None)
        return all(isinstance(v, complex | float | int) for v in dimensions)

    @cached_property
    def turning(self) -> frozenset[str]:
        """The links whose angles count with full turns.

        Some pair asks for them; those from which such angles count belong to them.
        """
        asked = {name for pair in self.pairs.values() if as_turn_counting(pair) for name in pair.members}
        return frozenset(asked.union(*(solver.counted_from for solver in self.solvers)))

    @cached_property
    def numbered(self) -> tuple[int, ...]:
        """The indices of the groups whose configurations are numbered."""
        return tuple(solver.index for solver in self.solvers if solver.is_numbered)

    @cached_property
    def followable(self) -> frozenset[int]:
        """The groups with signs that have other configurations too, by their indices."""
        return frozenset(solver.index for solver in self.solvers if solver.followed())

    def unit(self, name: str) -> float:
        """Return by how much a driver goes where it goes far. It is a radian, or the mechanism's size."""
        return 1.0 if self.structure.driven_angles[name] else self.size

    def unit_in(self, ends: Mapping[str, Ends], name: str) -> Number:
        """Return by how much a driver goes in each design where it goes far: the number, or an array (designs, 1)."""
        return 1.0 if self.structure.driven_angles[name] else size_in(ends, self.size)

    @cached_property
    def four_bars(self) -> Mapping[int, FourBarLoops]:
        """The four-bar loops of pins that dyads close, by the indices of these groups."""
        return four_bar_loops(self.structure)

    def following(self, k: int) -> SolvingOrder:
        """Return it with a group followed that else has signs.

        It is to be in a configuration that has none.
        """
        solver = self.solvers[k].followed()
        assert solver is not None
        return self._solved_by((*self.solvers[:k], solver, *self.solvers[k + 1 :]))

    def from_states(self, steps: int = 0) -> SolvingOrder:
        """Return it with groups that are searched or followed closed from their states instead."""
        return self._solved_by(tuple(solver.from_state(steps) or solver for solver in self.solvers))

    def _solved_by(self, solvers: tuple[GroupSolver, ...]) -> SolvingOrder:
        other = copy(self)
        other.solvers = solvers
        for found in ("numbered", "followable"):
            other.__dict__.pop(found, None)
        return other

    def start(
        self,
        ends: Mapping[str, Ends],
        drives: Mapping[str, Series],
        order: int,
        shape: tuple[int, ...],
        limits: LimitRule = CLIPPED,
    ) -> Block:
        """Return a block in which only the frame and driven links are known.

        The latter are those that the frame drives.
        """
        world: dict[str, Pose] = {}
        local: dict[str, Pose] = {}
        for body in self.structure.bodies:
            placed = {body.links[0]: FIXED}
            for driven in body.driven:
                placed[driven.link] = placed[driven.parent].compose(_driven(driven, ends, drives))
            if body is self.structure.ground:
                world.update(placed)
            else:
                local.update({k: v for k, v in placed.items() if v is not FIXED})
        return Block(shape, ends, world, local, order, limits)

    def broken(self, failed: int, block: Block, at: int) -> Broken | None:
        """Return what keeps a failed pose of a column from being assembled, if it is an end of a guide or a misfit."""
        return self.guide_ends.passed(failed, block, at) or self.fits.misfit(failed, block, at)

    def named(self, failed: int) -> str:
        """Return the name of the pair by whose end or misfit a pose failed."""
        k = failed - 1 - len(self.structure.groups)
        ends = self.guide_ends.pairs
        return ends[k].name if k < len(ends) else self.fits.pairs[k - len(ends)].name

    def closing(self, solver: GroupSolver) -> tuple[Pair, ...]:
        """Return the redundant pairs that close or open with a group.

        They do so as it is assembled, all links before it being known.
        """
        if not self.structure.redundant:
            return ()
        before: dict[str, None] = dict.fromkeys(self.structure.ground.links)
        for other in self.solvers[: solver.index]:
            before.update(dict.fromkeys(other.group.links))
        known = {*before, *solver.group.links}
        closing = (pair for pair in self.structure.redundant if known.issuperset(pair.members))
        return tuple(pair for pair in closing if not before.keys() >= {*pair.members})


class Choice(Protocol):
    """The choices that the loop over the groups is told.

    Which mode each is to be in, and where angles are counted from.
    """

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the mode of a group, all before it being assembled.

        It is a sign, a state, or anything where it has one.
        """

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return about which angle, full turns counted, a link of a group has. It is None where it is not counted."""


# Of more groups than these the poses are so many objects that looking for cycles among them takes a sixth of the time.
MANY = 500


def run(solving_order: SolvingOrder, block: Block, choose: Choice, upto: int | None = None, since: int = 0) -> Block:
    """Assemble the groups one after another, from one up to one; return the block.

    Each is in the mode that is chosen.
    """
    with without_collection() if len(solving_order.solvers) > MANY else nullcontext():
        return _run(solving_order, block, choose, upto, since)


def _run(solving_order: SolvingOrder, block: Block, choose: Choice, upto: int | None, since: int) -> Block:
    guide_ends = solving_order.guide_ends
    has_ends, turning = bool(guide_ends.pairs), solving_order.turning
    solving_order.fits.mask(block)
    if has_ends:
        guide_ends.mask(block, BEFORE)
    for solver in solving_order.solvers[since:upto]:
        solver.close(block, choose.mode(block, solver))
        if has_ends:
            guide_ends.mask(block, solver.index)
        for link in solver.group.links if turning else ():
            pose = block.world[link]
            near = choose.angle(solver, link) if link in turning and pose.theta is None else None
            if near is not None:
                block.world[link] = pose.counted(near)
    return block


def residual(pairs: Sequence[Pair], block: Block, size: float) -> Number:
    """Return the sum of squares of what left-out pairs ought to hold. Lengths are parts of the size."""
    total: Number = 0.0
    size = size_in(block.ends, size)
    for pair in pairs:
        poses = tuple(block.world[name] for name in pair.members)
        held = pair.closure(block.ends[pair.name], poses)
        for one, scale in zip(held, constraint_scales(pair, size), strict=True):
            total = total + np.abs(one.c[0] / scale) ** 2
    return total


def _driven(driven: DrivenPair, ends: Mapping[str, Ends], drives: Mapping[str, Series]) -> Pose:
    """Return the pose of a driven link in its parent's frame."""
    pair = driven.pair
    value = constant(0.0) if driven.is_passive else drives[driven.drive.name]
    free = value if pair.driven_by(driven.drive.link) > 0 else -value
    pose = pair.placed(ends[pair.name], free)
    return pose if driven.link == pair.members[1] else pose.inverse()


# An end is reached, not passed, within this part of the size (or radians): positions are right to a few units of
# 1e-12, and gaps are found to 1e-9.
AT_END = 1e-11


# Where a sentence tells the two places.
HERE, THERE = "{here}", "{there}"


# What is known before any group is solved.
BEFORE = -1


class Broken(NamedTuple):
    """What a pair forbids: a pose beyond an end of its guide, dimensions that do not fit; and the words for it."""

    pair: Pair
    reason: str


class Fits(ShortRepr):
    """What of the dimensions of pairs must fit, in designs of which it is not known that it does.

    A design in which it does not fails at all poses, by a number above those of guides. `rooms`, with the numbers in
    the words, go with the pairs' sides; they are among the `ends` where these are given.
    """

    def __init__(self, structure: Structure, ends: Mapping[str, Ends] | None = None) -> None:
        self.pairs, geometry = structure.mechanism.written_pairs, structure.mechanism.geometry
        self.first = len(structure.groups) + sum(as_travel_limited(pair) is not None for pair in self.pairs)
        self.rooms = {} if ends else {name: room for pair in self.pairs for name, room in rooms_of(pair, geometry)}
        known = ends or self.rooms
        found = (dict(_named_fits(pair, geometry)) for pair in self.pairs)
        asked = ({name: fit for name, fit in fits.items() if name in known} for fits in found)
        self.asked = {k: fits for k, fits in enumerate(asked) if fits}

    def mask(self, block: Block) -> None:
        """Note the designs in which something does not fit."""
        for k, fits in self.asked.items():
            for room in (spot(block.ends[name][0]) for name in fits):
                if np.any(room <= 0.0):
                    block.fail(room > 0.0, self.first + k)

    def misfit(self, failed: int, block: Block, at: int) -> Broken | None:
        """Return the pair that does not fit at a failed pose of a column. None where it failed otherwise."""
        k = failed - 1 - self.first
        return None if k < 0 else Broken(self.pairs[k], reason_text(self.reasons(block, k), at))

    def reasons(self, block: Block, k: int) -> tuple[Reason, ...]:
        """Return why a pair may not fit."""
        found = []
        for name, fit in self.asked.get(k, {}).items():
            room, *numbers = map(spot, block.ends[name])
            words = (word if isinstance(word, str) else numbers.pop(0) for word in fit.words)
            found.append(Reason(room <= 0.0, tuple(words)))
        return tuple(found)


def rooms_of(pair: Pair, geometry: Geometry) -> Iterator[tuple[str, Ends]]:
    """Yield the room of what of a pair is not known to fit, and the numbers in its words, as sides with a name."""
    for name, fit in _named_fits(pair, geometry):
        if not (isinstance(fit.room, float | int) and fit.room > 0.0):
            yield name, (End(fit.room), *(End(word) for word in fit.words if not isinstance(word, str)))


def _named_fits(pair: Pair, geometry: Geometry) -> Iterator[tuple[str, DimensionFit]]:
    for k, fit in enumerate(pair.fits(geometry)):
        yield f"{pair.name} (fit {k + 1})", fit


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

    def passed(self, failed: int, block: Block, at: int) -> Broken | None:
        """Return which end a failed pose of a column is beyond. None where it failed otherwise."""
        if not self._groups < failed <= self._groups + len(self.pairs):
            return None
        pair = self.pairs[failed - self._groups - 1]
        return Broken(pair, reason_text(self.reasons(block, pair), at))

    def reasons(self, block: Block, pair: TravelLimited) -> tuple[Reason, ...]:
        """Return why a pose may be beyond a guide's end or its beginning."""
        start, stop = self._distances(block, pair)
        poses = tuple(block.world[name] for name in pair.members)
        here = _named(pair, pair.coordinate(block.ends[pair.name], poses).c[0])
        ends = (_named(pair, side.point) for side in block.ends[bounds_name(pair)])
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
        scale = 1.0 if pair.free_is_angle else size_in(block.ends, self.size)
        return np.minimum(*self._distances(block, pair)) / scale + AT_END

    def _distances(self, block: Block, pair: TravelLimited) -> tuple[Number, Number]:
        poses = tuple(block.world[name] for name in pair.members)
        low, high = (side.point for side in block.ends[bounds_name(pair)])
        return pair.inside((low, high), block.ends[pair.name], poses)


def _named(pair: TravelLimited, value: Any) -> Words:
    return (np.rad2deg(value), " degrees") if pair.free_is_angle else (value,)


def _filled(sentence: str, here: Words, there: Words) -> Words:
    """Return a sentence about two places as words and numbers."""
    before, between, after = re.split(f"{HERE}|{THERE}", sentence)
    return (before, *here, between, *there, after)
