"""A recorded mechanism as a motion of one pose, and the outputs of a program read off it by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import and_
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, unwrapped
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics.driver_values import Inputs, PoseGrid
from compoundkin.kinematics.motion import LinkMotion, Motion, Named, PairMotion
from compoundkin.kinematics.quantities import check_part, owner_and_part, owner_of, read_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import (
    CORIOLIS,
    DERIVED,
    FORCES,
    OF_POINTS,
    PARTS,
    TRANSMISSION_INDEX,
    Attribute,
    Kind,
    motion_figure,
)
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber

# What is said of names that a motion knows and a program does not.
USE_SOLVE = "ask the motion: quantity(solve(...), name)"


class ProgramOutput(NamedTuple):
    """An owner's attribute that a name asks for, perhaps a part of a vector.

    An angle whose full turns nobody counts `is_wrapped`: made continuous along the motion afterwards.
    """

    name: str
    kind: Kind
    owner: str
    attribute: Attribute
    part: str = ""
    is_wrapped: bool = False

    @property
    def is_derived(self) -> bool:
        """Whether it is a figure that only some owners have."""
        return self.attribute.word in DERIVED[self.kind]

    def continuous(self, values: Number) -> Number:
        """Return its values along the motion, full turns of angles counted."""
        if not self.is_wrapped:
            return values
        # the sign of a zero, which no formula keeps, tells half a turn back from half a turn on
        back = values == -np.pi
        return unwrapped(np.where(back, np.pi, values) if back.any() else values)


def output_of(motion: Motion, name: str) -> ProgramOutput:
    """Return what a name asks for. Raises UnknownName, and InvalidInput for what no program tells."""
    if isinstance(name, str) and motion_figure(name)[1]:
        whole, figure = motion_figure(name)
        what = f"{figure!r} is a figure of a whole motion, a program tells {whole!r} at each pose"
        raise InvalidInput(Problem(name, what, USE_SOLVE))
    if not isinstance(name, str):
        raise InvalidInput(Problem("outputs", f"{name!r} is no name", 'write "G.velocity", one text for each'))
    owner, word, part = owner_and_part(motion, name)
    _check_recorded(motion, name, owner.kind, word)
    if part:
        check_part(name, part, word in (*OF_POINTS, CORIOLIS))
    known = DERIVED[owner.kind] if word in DERIVED[owner.kind] else owner.attributes
    is_wrapped = not part and _is_wrapped(motion, owner.kind, owner.name, known[word])
    return ProgramOutput(name, owner.kind, owner.name, known[word], part, is_wrapped)


def _check_recorded(motion: Motion, name: str, kind: Kind, word: str) -> None:
    """Raise InvalidInput for figures that are no straight-line arithmetic of one pose."""
    if word in FORCES[kind]:
        raise InvalidInput(Problem(name, "forces are no outputs of a program", "ask force_analysis(solve(...))"))
    owner = name.partition(".")[0]
    numbered = [solver.group.links for solver in motion.solving_order.solvers if solver.is_numbered]
    if word == TRANSMISSION_INDEX and any(owner in links for links in numbered):
        what = "the index of a group without a closed form is no output of a program"
        raise InvalidInput(Problem(name, what, USE_SOLVE))


def _is_wrapped(motion: Motion, kind: Kind, owner: str, attribute: Attribute) -> bool:
    """Tell whether an output is an angle without full turns."""
    if attribute.order or attribute.word in DERIVED[kind]:
        return False
    if kind == "links":
        return motion.poses[owner].theta is None
    if kind != "pairs":
        return False
    pair = motion.solving_order.pairs[owner]
    return pair.free_is_angle and any(motion.poses[member].theta is None for member in pair.members)


def record_outputs(mechanism: RecordedMechanism, outputs: Iterable[ProgramOutput]) -> tuple[RecordedNumber, ...]:
    """Return outputs as recorded numbers: complex for planar vectors.

    Raises InvalidInput for a figure that is no straight-line arithmetic of one pose.
    """
    motion = RecordedMotion(mechanism)
    return tuple(mechanism.number(_record_output(motion, output)) for output in outputs)


def _record_output(motion: RecordedMotion, output: ProgramOutput) -> Number:
    owner = owner_of(motion, output.kind, output.owner)
    try:
        found = read_of(owner, output.attribute.word)
    except (TypeError, AttributeError) as error:
        if not output.is_derived:
            raise
        raise InvalidInput(Problem(output.name, f"no program can tell it: {error}", USE_SOLVE)) from None
    return PARTS[output.part](found.values) if output.part else found.values


@dataclass(frozen=True)
class RecordedPoint:
    """The motion of a point of a link."""

    pose: Pose
    place: Number

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative of the position."""
        return self.pose.derivative(self.place, k) + 0j

    @property
    def x(self) -> Number:
        """The first coordinate of its position."""
        return self.derivative(0).real

    @property
    def y(self) -> Number:
        """The second coordinate of its position."""
        return self.derivative(0).imag

    @property
    def velocity(self) -> Number:
        """Its velocity."""
        return self.derivative(1)

    @property
    def speed(self) -> Number:
        """The length of its velocity."""
        return np.abs(self.derivative(1))


class RecordedLink(LinkMotion):
    """The motion of a link."""

    @property
    def origin(self) -> RecordedPoint:  # type: ignore[override]
        """The motion of the origin of its frame."""
        return RecordedPoint(self._pose, 0j)


@dataclass(frozen=True, repr=False)
class RecordedMotion(ShortRepr):
    """A recorded mechanism as a motion of one pose. Its numbers are nodes of a graph."""

    recorded: RecordedMechanism

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism that was recorded."""
        return self.solving_order.structure.mechanism

    @property
    def solving_order(self) -> SolvingOrder:
        """The solving order that was run."""
        return self.recorded.order

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""
        return self.recorded.block.world

    @cached_property
    def inputs(self) -> Inputs:
        """The ends of pairs, and the drivers."""
        return Inputs((), self.recorded.block.ends, {name: series.c for name, series in self.recorded.drives.items()})

    @cached_property
    def grid(self) -> PoseGrid:
        """That of one assembled pose."""
        return PoseGrid((), self.recorded.recording.order, np.zeros(()))

    @cached_property
    def regular(self) -> Number:
        """Whether all rates are finite."""
        rates = [c for pose in self.poses.values() for c in (*pose.z.c[1:], *pose.u.c[1:])]
        return reduce(and_, map(np.isfinite, rates), self.recorded.number(True))

    @cached_property
    def points(self) -> Mapping[str, Any]:
        """The points by their letters."""
        return Named("point", tuple(self.mechanism.carriers), self._point)

    @cached_property
    def links(self) -> Mapping[str, Any]:
        """The links by their names."""
        return Named("link", tuple(self.mechanism.links), lambda name: RecordedLink(self.grid, self.poses[name], name))

    @cached_property
    def pairs(self) -> Mapping[str, Any]:
        """The pairs by their names."""
        return Named("pair", tuple(self.solving_order.pairs), self._pair)

    @cached_property
    def drives(self) -> Mapping[str, Any]:
        """The drivers by their names."""
        return Named("driver", tuple(self.recorded.drives), self._drive)

    def _point(self, name: str) -> RecordedPoint:
        link = self.mechanism.carriers[name][0]
        return RecordedPoint(self.poses[link], self.recorded.geometry.points[link][name])

    def _pair(self, name: str) -> PairMotion:
        pair = self.solving_order.pairs[name]
        poses = tuple(self.poses[member] for member in pair.members)
        return PairMotion(self.grid, pair.coordinate(self.inputs.ends[name], poses), pair.free_is_angle)

    def _drive(self, name: str) -> PairMotion:
        is_angle = self.solving_order.structure.driven_angles[name]
        return PairMotion(self.grid, self.recorded.drives[name], is_angle, prescribed=True)
