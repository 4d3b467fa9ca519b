"""A structure made ready for numbers: what each group needs, bound once, run over any block of poses."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import DYADS
from compoundkin.kinematics.groups.gear_train import TrainStep
from compoundkin.kinematics.groups.steps import AffineStep, DyadStep, FollowerStep, GeneralStep, Step
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, Equivalent
from compoundkin.structure.assur_groups import named_group
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Body, DrivenPair, Group


class Plan:
    """The steps that solve a structure, in order: the driven links of the frame, then the groups."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        geometry = structure.mechanism.geometry
        self.size = geometry.size
        pairs = {p.name: p for p in structure.pairs}
        for group in structure.groups:
            pairs.update({p.name: p for p in (*group.inner, *group.outer)})
        for body in self.bodies:
            pairs.update({d.pair.name: d.pair for d in body.driven})
        self.pairs = pairs
        self.ends: dict[str, Ends] = {name: pair.ends(geometry) for name, pair in pairs.items()}
        self.steps: tuple[Step, ...] = tuple(self._step(k, g) for k, g in enumerate(structure.groups))

    def _step(self, k: int, group: Group) -> Step:
        """How a group is solved: in closed form, by lower pairs that stand for a higher one, or in general."""
        if group.name in DYADS:
            return DyadStep(k, group, self.size)
        if len(group.bodies) == 1 and len(group.outer) == 2:
            lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
            own = next(j for j, name in enumerate(higher.members) if name in group.links)
            if higher.is_affine(lower, own):
                return AffineStep(k, group, lower, higher)
            if higher.has_profile and lower.is_simple and higher.equivalent(self.ends[higher.name]) is None:
                return FollowerStep(k, group, lower, higher, self.size)
            found = higher.equivalent(self.ends[higher.name])
            if found is not None:
                dyad = _by_lower_pairs(group, lower, own, found)
                if dyad.name in DYADS:
                    self.ends.update(found.ends)
                    return DyadStep(k, group, self.size, dyad)
        return TrainStep.of(k, group) or GeneralStep(k, group, self.size)

    @cached_property
    def turning(self) -> frozenset[str]:
        """The links whose angles some pair asks for with full turns, and those from which such angles count."""
        asked = {name for pair in self.pairs.values() if pair.counts_turns for name in pair.members}
        hung = (step.hangs_on for step in self.steps if isinstance(step, AffineStep | TrainStep))
        return frozenset(asked.union(*hung))

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The frame's composite, then every group's."""
        return (self.structure.ground, *(b for g in self.structure.groups for b in g.bodies))

    @cached_property
    def driven(self) -> dict[str, DrivenPair]:
        """The driven pairs by the names of their drivers."""
        return {d.drive.name: d for body in self.bodies for d in body.driven if not d.is_passive}

    @cached_property
    def general(self) -> tuple[int, ...]:
        """The indices of the groups without a closed form."""
        return tuple(k for k, step in enumerate(self.steps) if isinstance(step, GeneralStep))

    def start(
        self, ends: Mapping[str, Ends], drives: Mapping[str, Series], order: int, shape: tuple[int, ...]
    ) -> Block:
        """Return a block in which only the frame and the links it drives are known."""
        world: dict[str, Pose] = {}
        local: dict[str, Pose] = {}
        for body in self.bodies:
            placed = {body.links[0]: FIXED}
            for driven in body.driven:
                placed[driven.link] = placed[driven.parent].compose(_driven(driven, ends, drives))
            if body is self.structure.ground:
                world.update(placed)
            else:
                local.update({k: v for k, v in placed.items() if v is not FIXED})
        return Block(shape, ends, world, local, order)


def _driven(driven: DrivenPair, ends: Mapping[str, Ends], drives: Mapping[str, Series]) -> Pose:
    """The pose of a driven link in its parent's frame."""
    pair = driven.pair
    value = constant(0.0) if driven.is_passive else drives[driven.drive.name]
    free = value if pair.driven_by(driven.drive.link) > 0 else -value
    pose = pair.placed(ends[pair.name], free)
    return pose if driven.link == pair.members[1] else pose.inverse()


def _by_lower_pairs(group: Group, lower: Pair, own: int, found: Equivalent) -> Group:
    """The dyad of a body and the link that stands, with two lower pairs, for its higher pair."""
    inner, outer = found.pairs[own], found.pairs[1 - own]
    return named_group([*group.bodies, Body((found.link,))], [inner], [lower, outer])
