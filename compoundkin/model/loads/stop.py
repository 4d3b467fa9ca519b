"""Stops: the ends of travel along the coordinate of a pair, rigid or elastic."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.base.series import Series
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.attachments import PairLoad, rate_of
from compoundkin.model.loads.contract import COORDINATE, Load, LoadedPoses, NamedParts

# The sides of a stop: the coordinate is not below `low`, and not above `high`.
LOW, HIGH = 1.0, -1.0


@dataclass(frozen=True, eq=False, repr=False)
class Stop(PairLoad):
    """The ends of travel along the free coordinate of a pair, rigid with a restitution, or elastic.

    An elastic end pushes with stiffness times the depth plus damping times its rate, and never pulls. A rigid one has
    no force of its own here: simulations know its impulses, and hold the coordinate at it.
    """

    low: Number | None = field(
        default=None, kw_only=True, metadata=value_key("coordinate", "The least coordinate; degrees of an angle.")
    )
    high: Number | None = field(
        default=None, kw_only=True, metadata=value_key("coordinate", "The greatest coordinate; degrees of an angle.")
    )
    restitution: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("length", "The part of the speed with which a rigid end is left, 0 to 1."),
    )
    stiffness: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("length", "Force or torque for a unit of depth in an elastic end."),
    )
    damping: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("length", "Force or torque for a unit of speed in an elastic end."),
    )

    title: ClassVar[str] = "stop"
    table: ClassVar[str] = "stops"
    own_variable: ClassVar[str] = COORDINATE

    @property
    def is_elastic(self) -> bool:
        """Whether its ends have a stiffness."""
        return self.stiffness is not None

    @property
    def is_damped(self) -> bool:
        """Whether its ends have a damping, so that they give less back than they take."""
        return self.damping is not None and bool(np.any(np.asarray(self.damping) != 0.0))

    @property
    def ends(self) -> tuple[tuple[float, Number], ...]:
        """Its sides, LOW and HIGH, with their coordinates."""
        given = ((LOW, self.low), (HIGH, self.high))
        return tuple((side, end) for side, end in given if end is not None)

    @property
    def needs_rates(self) -> bool:
        """Whether its force depends on the rate of the coordinate."""
        return self.damping is not None

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, missing or exchanged ends, and numbers out of range."""
        yield from super().problems(written, where)
        if not self.ends:
            yield Problem(where, "it has no end", "give low, high or both")
        if len(self.ends) == 2 and np.any(np.asarray(self.low) > np.asarray(self.high)):
            what = f"its low end {_shown(self.low)} is above its high end {_shown(self.high)}"
            yield Problem(f"{where}.low", what, "give the lesser coordinate as low")
        elif len(self.ends) == 2 and np.any(np.asarray(self.low) == np.asarray(self.high)):
            what = f"both ends are at {_shown(self.high)}: nothing moves between them"
            yield Problem(f"{where}.high", what, "move one of them; ck.latch holds a coordinate where it is")
        e = self.restitution
        if e is not None and not np.all((np.asarray(e) >= 0.0) & (np.asarray(e) <= 1.0)):
            yield Problem(f"{where}.restitution", f"{_shown(e)} is no coefficient of restitution", "0 to 1")
        if e is not None and self.is_elastic:
            what = "an elastic end has no coefficient of restitution"
            yield Problem(f"{where}.restitution", what, "leave it or the stiffness out")
        if self.stiffness is not None and not np.all(np.asarray(self.stiffness) > 0.0):
            yield Problem(f"{where}.stiffness", "a stiffness is above zero", "leave it out for a rigid end")
        if self.damping is not None and not self.is_elastic:
            remedy = "give the stiffness too, or a restitution in place of the damping"
            yield Problem(f"{where}.damping", "a rigid end has no damping", remedy)
        if self.damping is not None and np.any(np.asarray(self.damping) < 0.0):
            yield Problem(f"{where}.damping", "a damper of negative rate drives", "give a damping above zero")

    def depth(self, side: float, end: Number, series: Series, at: LoadedPoses) -> Number:
        """Return how deep a coordinate is in an end, negative where it is off."""
        return side * (at.fitted(end, self.where) - series.c[0])

    def push(self, side: float, depth: Number, series: Series, at: LoadedPoses) -> Number:
        """Return the force of an elastic end at a depth, negative where it would have to pull."""
        damping = 0.0 if self.damping is None else at.fitted(self.damping, self.where)
        return at.fitted(self.stiffness, self.where) * depth - side * damping * rate_of(series)

    def effort(self, at: LoadedPoses) -> Number:
        """Return the effort of its elastic ends."""
        series = at.coordinate(self.pair)
        total: Number = 0.0 * series.c[0]
        for side, end in self.ends if self.is_elastic else ():
            depth = self.depth(side, end, series, at)
            push = self.push(side, depth, series, at)
            total = total + side * np.where((depth > 0.0) & (push > 0.0), push, np.where(np.isnan(push), push, 0.0))
        return total

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return the energy of elastic ends without damping; None with damping."""
        if self.is_damped:
            return None
        series = at.coordinate(self.pair)
        total: Number = 0.0 * series.c[0]
        for side, end in self.ends if self.is_elastic else ():
            depth = np.maximum(self.depth(side, end, series, at), 0.0)
            total = total + at.fitted(self.stiffness, self.where) * depth * depth / 2.0
        return total


def as_stop(load: Load) -> Stop | None:
    """Return a load as a stop, or None."""
    return load if isinstance(load, Stop) else None


def _shown(value: Any) -> str:
    return f"{float(np.ravel(value)[0]):g}"


@checked
def stop(
    pair: str,
    low: Any = None,
    high: Any = None,
    *,
    restitution: Any = None,
    stiffness: Any = None,
    damping: Any = None,
    name: str = "",
) -> Stop:
    """Return the ends of travel along the free coordinate of a pair.

    The pair is meant as of `effort`: by its name, a pin's letter or a driver. The coordinate is not below `low` and not
    above `high` (radians, with full turns counted, or a length); one of both may be left out. Rigid ends are left with
    the part `restitution` of the speed, 0 if it is left out. With a `stiffness` they are elastic: they push with
    stiffness times the depth and `damping` times its rate, and never pull. Numbers, or arrays for designs.

    >>> stop("stroke", 0.0, 0.2, restitution=0.5).name
    'stop along stroke'
    >>> stop("A", high=1.2, stiffness=4000, damping=12).is_elastic
    True
    """
    where = f"stops.{name or pair}"
    given = {"low": low, "high": high, "restitution": restitution, "stiffness": stiffness, "damping": damping}
    numbers: dict[str, Any] = {
        key: None if value is None else real(f"{where}.{key}", value) for key, value in given.items()
    }
    return Stop(pair, **numbers, name=name)
