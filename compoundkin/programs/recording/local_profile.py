"""Profiles at the places where they are touched: a search finds these, a Taylor polynomial goes on from there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import comb
from typing import Any, ClassVar

from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import Samples
from compoundkin.base.curves.touch_points import farthest, foot
from compoundkin.base.series import Number, Series, as_series
from compoundkin.model.fields import Key
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profiled
from compoundkin.model.profiles import Profile
from compoundkin.programs.graph.input_kinds import SEED
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_number import RecordedNumber

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

    def _made(self) -> Curve:
        return self.local

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Middle and radius of a profile that is a circle all round."""
        return self.whole.circle


def with_local_profile(pair: Pair, graph: OperationGraph, order: int) -> Pair:
    """Return a pair whose profile is known beside its contact only, by inputs.

    One without a profile is returned as it is.
    """
    profiled = as_profiled(pair)
    if profiled is None:
        return pair
    parameter = RecordedNumber.given(graph, InputNumber(SEED, pair.name, "parameter"))
    coefficients = [
        RecordedNumber.given(graph, *(InputNumber(SEED, pair.name, f"{part}{k}") for part in "xy"))
        for k in range(max(order, LEAST_ORDER) + MORE_ORDERS + 1)
    ]
    curve = LocalCurve(profiled.curve, parameter, coefficients)
    changed: dict[str, Any] = {"profile": LocalProfile(profiled.profile, curve)}
    return replace(profiled, **changed)
