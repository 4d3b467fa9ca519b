"""A solving order whose groups are all straight-line arithmetic: results of searches and of continuation are seeds.

A search finds where a profile is touched; a Taylor polynomial continues from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import comb
from typing import Any, ClassVar

from compoundkin.base.arrays import Number
from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import Samples
from compoundkin.base.curves.touch_points import farthest, foot
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.fields import Key
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact
from compoundkin.model.profiles import Profile
from compoundkin.programs.graph.operation_graph import (
    PARAMETER,
    SEED,
    SIGN,
    TURNS,
    InputNumber,
    OperationGraph,
    group_seed,
)
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Group


def seeded_order(
    order: SolvingOrder, ends: Mapping[str, Ends], graph: OperationGraph, highest: int, steps: int = 0
) -> SolvingOrder:
    """Return a solving order on other ends, its searches replaced by seeds.

    It is run for derivatives up to the highest.
    """
    found = SolvingOrder(_with_local_profiles(order.structure, graph, highest), ends)
    for solver in order.solvers:
        # a group that has signs else, but is in a configuration that has none
        if solver.is_numbered and not found.solvers[solver.index].is_numbered:
            found = found.following(solver.index)
    return found.from_states(steps)


def _with_local_profiles(structure: Structure, graph: OperationGraph, highest: int) -> Structure:
    changed: dict[str, Pair] = {}

    def local(pair: Pair) -> Pair:
        if pair.name not in changed:
            changed[pair.name] = with_local_profile(pair, graph, highest)
        return changed[pair.name]

    def within(group: Group) -> Group:
        return replace(group, inner=tuple(map(local, group.inner)), outer=tuple(map(local, group.outer)))

    return replace(structure, pairs=tuple(map(local, structure.pairs)), groups=tuple(map(within, structure.groups)))


@dataclass(frozen=True)
class SeededChoice:
    """The choice of known signs. Others are inputs, as states and counted turns are."""

    graph: OperationGraph
    signs: Mapping[int, Number]

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the sign of a group, or its state."""
        if solver.width:
            return [self._seed(group_seed(solver.index), str(k)) for k in range(solver.width)]
        sign = self.signs.get(solver.index)
        return self._seed(group_seed(solver.index), SIGN) if sign is None else float(sign)

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return about which angle a link has."""
        return self._seed(link, TURNS)

    def _seed(self, name: str, part: str) -> RecordedNumber:
        return RecordedNumber.given(self.graph, InputNumber(SEED, name, part))


# A profile is expanded by so many orders more than the motion: one for its tangent, one for what changes with
# dimensions.
MORE_ORDERS = 2


# The step of Newton to a contact takes the slope of its gap, of positions alone too.
LEAST_ORDER = 1


class LocalCurve(Curve):
    """A curve by its expansion at a parameter of each pose.

    What is sought there is near it.
    """

    def __init__(self, curve: Curve, parameter: Number, coefficients: Sequence[Number]) -> None:
        self.curve, self.parameter, self.coefficients = curve, parameter, coefficients
        self.low, self.high, self.closed = curve.low, curve.high, curve.closed

    def _expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        if s is self.parameter:
            return tuple(self.coefficients[: order + 1])
        away, known = s - self.parameter, self.coefficients
        # what is sought is nearer than rounding shows: one order more tells how it changes
        return tuple(known[k] + known[k + 1] * (comb(k + 1, k) * away) for k in range(order + 1))

    def wrapped(self, s: Number) -> Number:
        """Return parameters as they are."""
        return s

    def foot(self, p: Series | Number) -> Series:
        """Return the parameter of the point nearest to a moving point."""
        return foot(self, as_series(p), self.parameter)

    def support(self, n: Series | Number) -> Series:
        """Return the parameter of the point farthest in a direction that turns."""
        return farthest(self, as_series(n), self.parameter)

    @property
    def samples(self) -> Samples:
        """Those of the whole curve."""
        return self.curve.samples

    @property
    def end_points(self) -> tuple[complex, ...]:
        """Both ends of the whole curve, if it is open."""
        return self.curve.end_points

    @property
    def size(self) -> float:
        """The length scale of the whole curve."""
        return self.curve.size

    @property
    def is_counterclockwise(self) -> bool:
        """Whether the area inside the whole curve is on the left."""
        return self.curve.is_counterclockwise


@dataclass(frozen=True, eq=False)
class LocalProfile(Profile):
    """A profile known beside the places where it is touched."""

    kind: ClassVar[str] = "local"
    keys: ClassVar[tuple[Key, ...]] = ()

    whole: Profile
    local: LocalCurve

    def _built_curve(self) -> Curve:
        return self.local

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Middle and radius of a profile that is a circle all round."""
        return self.whole.circle


def whole_curve(pair: ProfileContact) -> Curve:
    """Return the whole profile of a pair that was recorded beside its contact."""
    return pair.curve.curve if isinstance(pair.curve, LocalCurve) else pair.curve


def with_local_profile(pair: Pair, graph: OperationGraph, order: int) -> Pair:
    """Return a pair whose profile is known beside its contact only, by inputs.

    One without a profile is returned as it is.
    """
    profiled = as_profile_contact(pair)
    if profiled is None:
        return pair
    parameter = RecordedNumber.given(graph, InputNumber(SEED, pair.name, PARAMETER))
    coefficients = [
        RecordedNumber.given(graph, *(InputNumber(SEED, pair.name, f"{part}{k}") for part in "xy"))
        for k in range(max(order, LEAST_ORDER) + MORE_ORDERS + 1)
    ]
    curve = LocalCurve(profiled.curve, parameter, coefficients)
    changed: dict[str, Any] = {"profile": LocalProfile(profiled.profile, curve)}
    return replace(profiled, **changed)
