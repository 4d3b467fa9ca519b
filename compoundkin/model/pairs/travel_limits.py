"""Travel limits of slots, guides and curved slots: their stops, and how far a pose is from them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import TURN, Number, wrapped
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.fields import Kind, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.pairs.symbols import Mark, known_range

# From where to where: a coordinate, a point of the link with the guide, or None for an end that is open.
Reach: TypeAlias = "tuple[Number | str | None, Number | str | None] | None"
# A full turn of an arc is full but for rounding of the degrees it was written in.
FULL = TURN * (1.0 + 1e-12)


class TravelLimited(Pair):
    """A pair whose guide may have ends, beyond which it is not assembled."""

    on: str
    reach: Reach

    def place_of(self, geometry: Geometry, letter: str) -> Number:
        """Return the coordinate of a point of the link with the guide."""
        guide = self.ends(geometry)[0]
        along: Number = guide.direction
        return (np.conjugate(along) * (geometry.points[self.on][letter] - guide.point)).real

    def bounds(self, geometry: Geometry) -> tuple[Number, Number]:
        """Return the coordinates at which the guide begins and ends, infinite at an open end."""
        assert self.reach is not None
        open_ends = (-np.inf, np.inf)
        low, high = (
            other if end is None else self.place_of(geometry, end) if isinstance(end, str) else _as_number(end)
            for end, other in zip(self.reach, open_ends, strict=True)
        )
        return low, high

    def inside(self, bounds: tuple[Number, Number], ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the distances from both ends of the guide, negative beyond them."""
        value = self.coordinate(ends, poses).c[0]
        return value - bounds[0], bounds[1] - value

    def passed(self, here: str, there: str, is_end: bool) -> str:
        """Return the message that a pose is beyond an end, with both coordinates."""
        word = "beyond the end" if is_end else "before the beginning"
        return f"{self.letters[0]} at {here} is {word} of {self.name}, {there}"

    def drawn_extent(self, bounds: tuple[Number, Number], values: Number) -> tuple[float, float, tuple[bool, bool]]:
        """Return from where to where the guide is drawn, to its ends or as far as it is used, and which ends it has."""
        used = known_range(values)
        low, high = (
            one if np.isfinite(one) else other
            for one, other in zip((1.0 * bound for bound in bounds), used, strict=True)
        )
        return low, high, (bool(np.isfinite(bounds[0])), bool(np.isfinite(bounds[1])))

    @abstractmethod
    def with_ends(
        self, marks: tuple[Mark, ...], bounds: tuple[Number, Number], ends: Ends, poses: Poses
    ) -> tuple[Mark, ...]:
        """Return the symbols of the pair with its whole guide."""

    def reach_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find invalid travel limits: not two, of unknown points, or in the wrong order."""
        if self.reach is None:
            return
        place, known = f"{where}.reach", links.get(self.on, ())
        if not isinstance(self.reach, tuple | list) or len(self.reach) != 2:
            yield Problem(place, f"{self.reach!r} is not two ends", "write from where to where, such as (0.8, 1.3)")
            return
        if all(end is None for end in self.reach):
            yield Problem(place, "both ends are open", "leave the reach out, or say where it ends")
        for letter in (end for end in self.reach if isinstance(end, str) and end not in known and known):
            yield Problem(place, f"link {self.on!r} has no point {letter!r}", suggestion(letter, list(known)))
        if isinstance(self.reach[0], str) and self.reach[0] == self.reach[1]:
            yield Problem(place, f"a guide from {self.reach[0]!r} to itself has no length")
        if not any(end is None or isinstance(end, str) for end in self.reach):
            yield from self._order_problems((_as_number(self.reach[0]), _as_number(self.reach[1])), place)

    def reach_misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find named ends that are not one after the other along the guide."""
        if self.reach is not None and any(isinstance(end, str) for end in self.reach):
            yield from self._order_problems(self.bounds(geometry), f"{where}.reach")

    def _order_problems(self, bounds: tuple[Number, Number], place: str) -> Iterator[Problem]:
        low, high = bounds
        if not np.all(np.asarray(low) < np.asarray(high)):
            assert self.reach is not None
            limits = " to ".join(_end_text(end, value) for end, value in zip(self.reach, bounds, strict=True))
            what = f"the guide has no length from {limits}: it must end after it begins"
            yield Problem(place, what, "give the lesser coordinate first")


class TravelLimitedArc(TravelLimited):
    """A curved guide whose coordinate is an angle. It reaches counterclockwise from its start to its end."""

    def place_of(self, geometry: Geometry, letter: str) -> Number:
        """Return the direction from the centre to a point."""
        return np.angle(geometry.points[self.on][letter] - self.ends(geometry)[0].point)

    def bounds(self, geometry: Geometry) -> tuple[Number, Number]:
        """Return the angles at which the arc begins and ends, counterclockwise. The second is the greater one."""
        low, high = super().bounds(geometry)
        assert self.reach is not None
        named = any(isinstance(end, str) for end in self.reach)
        return low, low + np.mod(high - low, TURN) if named else _counterclockwise_end(low, high)

    def inside(self, bounds: tuple[Number, Number], ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the distances from both ends of the arc, negative beyond them."""
        low, high = bounds
        half = (high - low) / 2.0
        off = wrapped(self.coordinate(ends, poses).c[0] - (low + high) / 2.0)
        return half + off, half - off

    def reach_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find invalid travel limits, and a single one."""
        yield from super().reach_problems(links, where)
        if isinstance(self.reach, tuple | list) and sum(end is None for end in self.reach) == 1:
            yield Problem(f"{where}.reach", "an arc needs both of its ends", "say where it begins and where it ends")

    def _order_problems(self, bounds: tuple[Number, Number], place: str) -> Iterator[Problem]:
        bounds = bounds[0], _counterclockwise_end(*bounds)
        yield from super()._order_problems(bounds, place)
        if np.any(np.asarray(bounds[1]) - bounds[0] > FULL):
            remedy = "angles are radians in Python, degrees in files; ck.deg makes radians of degrees"
            yield Problem(place, "the arc is more than a full turn", remedy)


def _counterclockwise_end(low: Number, high: Number) -> Number:
    """Return the end of an arc, counterclockwise of its beginning, so that 200 to 90 degrees goes through zero."""
    return np.where(np.asarray(high) < low, low + np.mod(high - np.asarray(low), TURN), high)[()]


def as_travel_limited(pair: Pair) -> TravelLimited | None:
    """Return a pair as one with travel limits, or None."""
    return pair if isinstance(pair, TravelLimited) and pair.reach is not None else None


def bounds_name(pair: Pair) -> str:
    """Return the key of a guide's limits among the pairs' ends. Names of pairs have no dots."""
    return f"{pair.name}.reach"


def reach_key(kind: Kind, doc: str) -> dict[str, Any]:
    """Return the metadata of the field with the travel limits."""
    both = "Beyond these two places there is no pose; each a coordinate, or a point of the link with the guide"
    return value_key(kind, f"{doc} {both}.")


def _as_number(end: Any) -> Number:
    return 1.0 * end if np.ndim(end) == 0 else np.asarray(end, dtype=float)


def _end_text(end: Number | str | None, value: Number) -> str:
    number = f"{float(np.ravel(value)[0]):.6g}"
    return f"{end!r} at {number}" if isinstance(end, str) else number
