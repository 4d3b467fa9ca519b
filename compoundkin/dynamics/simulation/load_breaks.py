"""Where loads jump, wake or have corners, over the time and over coordinates: steps of a simulation end there.

An integrator that sees a load at a dozen places of a step may go over a short pulse without a trace. So functions are
sampled beforehand: those of the time over the whole simulation, those of a coordinate as far as that comes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import InvalidInput
from compoundkin.model.attributes import TIME
from compoundkin.model.loads.amounts import LoadFunction, LoadTable, corners
from compoundkin.model.loads.contract import RATE, Load, LoadedPoses
from compoundkin.model.mechanism import Mechanism

# Functions are sampled at so many places of a simulation, of a turn, or of the mechanism's size. Between two of them is
# a jump where the function changes by this part of its range at least, most of that between neighbouring numbers.
SAMPLED, CHANGES, MOST = 4096, 1e-6, 0.5
# A function wakes where it changes in another way than a cubic polynomial, behind so many places at which it did not.
STILL = 8
# Places that differ by this part of the whole are one place but for rounding.
SAME_PLACE = 1e-14
# A place is behind a break by so many roundings, in whatever way it is computed.
ROUNDINGS = 8.0
# What has more breaks than this in a simulation, or in a part of its coordinate, is followed by the length of steps.
CORNERS, ROUGH = 2000, 32
# A coordinate is sampled in parts of so many places, as it comes there.
PART = 256


class LoadBreak(NamedTuple):
    """A place at which a load jumps, wakes or has a corner, as the neighbouring numbers before and behind it."""

    before: float
    behind: float
    jumps: bool = False
    wakes: bool = False

    def moved(self, by: float, near: float) -> LoadBreak:
        """Return it so far on, with both sides a few roundings apart of numbers as large as `near`."""
        slack = ROUNDINGS * float(np.finfo(float).eps) * max(near, abs(self.behind + by))
        return self._replace(before=self.before + by - slack, behind=self.behind + by + slack)


def breaks_in_time(mechanism: Mechanism, until: float) -> tuple[LoadBreak, ...]:
    """Return the times within a simulation at which functions of the time jump or wake, or tables have corners."""
    found: list[LoadBreak] = []
    for amount in (part for load in mechanism.loads.values() for part in _parts(load)):
        if isinstance(amount, LoadFunction) and amount.takes == (TIME,):
            found += _sampled(partial(_at_times, amount), 0.0, until, SAMPLED)
        elif isinstance(amount, LoadTable) and amount.over == TIME:
            found += [LoadBreak(at, at) for at in corners(amount, 0.0, until, CORNERS)]
    return joined(found, SAME_PLACE * until)


def _at_times(function: LoadFunction, times: Number) -> Number:
    return function.value("amount", (times,))


def _parts(load: Load) -> Iterator[Any]:
    return (part for held in load.amounts_held for part in (held if isinstance(held, tuple) else (held,)))


def joined(breaks: Iterable[LoadBreak], near: float) -> tuple[LoadBreak, ...]:
    """Return breaks in order, those that are as near as that as one."""
    found: list[LoadBreak] = []
    for one in sorted(breaks):
        if found and one.before <= found[-1].behind + near:
            last = found[-1]
            behind = max(one.behind, last.behind)
            found[-1] = LoadBreak(last.before, behind, last.jumps or one.jumps, last.wakes or one.wakes)
        else:
            found.append(one)
    return tuple(found)


@dataclass(frozen=True)
class LoadPlace:
    """An amount of a load that is a function or a table over a coordinate, in parts that are sampled once."""

    load: Load
    amount: LoadFunction | LoadTable
    name: str  # the variable of a function, the coordinate of a table; empty for the load's own
    sampled: dict[int, tuple[LoadBreak, ...]] = field(default_factory=dict, compare=False)

    @property
    def pair(self) -> str:
        """The pair or the driver whose coordinate it is, empty for a length between points."""
        return self.name if isinstance(self.amount, LoadTable) and self.name else getattr(self.load, "pair", "")

    def value(self, at: LoadedPoses) -> Number:
        """Return the coordinate at poses."""
        if isinstance(self.amount, LoadTable) and self.name:
            return at.coordinate(self.name).c[0]
        own = self.load.variables(at)
        return own[self.name]() if self.name else next(iter(own.values()))()

    def sample(self, size: float) -> float:
        """Return the distance of sampled places, by the size of the mechanism."""
        return (TURN if getattr(self.load, "turns", False) else size) / SAMPLED

    def breaks(self, low: float, high: float, size: float, at: Callable[[], LoadedPoses]) -> tuple[LoadBreak, ...]:
        """Return the breaks between two places. What else a function takes is as at the only pose of `at`."""
        if isinstance(self.amount, LoadTable):
            return tuple(LoadBreak(one, one).moved(0.0, high - low) for one in corners(self.amount, low, high, CORNERS))
        sample = self.sample(size)
        width = PART * sample
        found: list[LoadBreak] = []
        for k in range(int(np.floor(low / width)), int(np.floor(high / width)) + 1):
            if k not in self.sampled:
                # parts overlap by what shows that a function was still
                over = (STILL + ORDER) * sample
                here = _sampled(
                    self._function(at()), k * width - over, (k + 1) * width + over, PART + 2 * (STILL + ORDER)
                )
                own = [one for one in here if k * width <= one.before < (k + 1) * width]
                apart = [one.moved(0.0, sample * SAMPLED) for one in own]
                self.sampled[k] = joined(apart, SAME_PLACE * size) if len(own) <= ROUGH else ()
            found += [one for one in self.sampled[k] if low <= one.behind and one.before <= high]
        return tuple(found)

    def _function(self, at: LoadedPoses) -> Callable[[Number], Number]:
        assert isinstance(self.amount, LoadFunction)
        function, name = self.amount, self.name
        known = {TIME: lambda: np.asarray(at.time), **self.load.variables(at)}
        others = {key: float(np.ravel(known[key]())[0]) for key in function.takes if key != name}

        def values(places: Number) -> Number:
            given = tuple(places if key == name else np.full_like(places, others[key]) for key in function.takes)
            return function.value(self.load.where, given)

        return values


def load_places(loads: Iterable[Load]) -> tuple[LoadPlace, ...]:
    """Return the amounts of loads that are functions or tables with corners over a coordinate."""
    found = []
    for load in loads:
        for amount in _parts(load):
            if isinstance(amount, LoadFunction):
                name = next((one for one in amount.takes if one not in (TIME, RATE)), None)
            elif isinstance(amount, LoadTable) and not amount.smooth:
                own = "" if load.own_variable not in (TIME, RATE) else None
                name = own if not amount.over else None if amount.over in (TIME, RATE) else amount.over
            else:
                continue
            if name is not None:
                found.append(LoadPlace(load, amount, name))
    return tuple(found)


# A cubic polynomial has no differences of this order.
ORDER = 4


def _sampled(values: Callable[[Number], Number], low: float, high: float, count: int) -> list[LoadBreak]:
    """Return where a function jumps, wakes and falls still between two places; nothing where it fails."""
    places = np.linspace(low, high, count + 1)
    try:
        known = values(places)
        jumps = list(_jumps(values, known, places))
    except InvalidInput:  # it is asked for where the motion need not come
        return []
    near = places[1] - places[0]
    steady = _wakes(known, places)
    return jumps + [one for one in steady if not any(abs(jump.before - one.before) <= near for jump in jumps)]


def _jumps(values: Callable[[Number], Number], known: Number, places: Number) -> Iterator[LoadBreak]:
    least = CHANGES * float(np.ptp(np.abs(known - known[0])))
    steps = np.abs(np.diff(known))
    # beside a jump a function changes less by far
    beside = np.fmin(np.append(steps[1:], np.inf), np.insert(steps[:-1], 0, np.inf))
    for k in np.flatnonzero((steps > least) & (steps > 2.0 * beside)):
        low, high = float(places[k]), float(places[k + 1])
        first, last = known[k], known[k + 1]
        while low < (middle := 0.5 * (low + high)) < high:
            found = values(np.array([middle]))[0]
            low, high, first, last = (
                (low, middle, first, found) if abs(found - first) > abs(found - last) else (middle, high, found, last)
            )
        if abs(last - first) > MOST * steps[k]:
            yield LoadBreak(low, high, jumps=True)


def _wakes(known: Number, places: Number) -> Iterator[LoadBreak]:
    """Yield where a function begins or ends to change otherwise than a polynomial: no step goes over a short pulse."""
    if len(known) <= ORDER:
        return
    rounding = SAME_PLACE * float(np.max(np.abs(known), initial=0.0))
    moves = np.abs(np.diff(known, ORDER)) > CHANGES * float(np.ptp(np.abs(known - known[0]))) + 2.0**ORDER * rounding
    for k in np.flatnonzero(moves):
        if k >= STILL and not moves[k - STILL : k].any():
            at = float(places[k + ORDER - 1])
            yield LoadBreak(at, at, wakes=True)
        if k + STILL < len(moves) and not moves[k + 1 : k + 1 + STILL].any():
            at = float(places[k + 1])
            yield LoadBreak(at, at, wakes=True)


class BreakPassed(NamedTuple):
    """A break that is passed, and the time just behind it."""

    time: float
    at: LoadBreak


def first_break(
    times: Sequence[float],
    places: Sequence[float],
    place: Callable[[float], float],
    breaks: Callable[[float, float], Sequence[LoadBreak]],
) -> BreakPassed | None:
    """Return the first break that is passed between places at times; in between the place is monotonous."""
    for (early, start), (late, end) in pairwise(zip(times, places, strict=True)):
        between = breaks(min(start, end), max(start, end))
        ahead = [one for one in between if (start < one.behind <= end if end > start else end <= one.before < start)]
        if ahead:
            one = ahead[0] if end > start else ahead[-1]
            return BreakPassed(_passage(place, early, late, one, end > start), one)
    return None


def _passage(place: Callable[[float], float], low: float, high: float, one: LoadBreak, rises: bool) -> float:
    """Return the time just behind a break."""
    from scipy.optimize import brentq

    def is_behind(time: float) -> bool:
        return place(time) >= one.behind if rises else place(time) <= one.before

    goal, fine = one.behind if rises else one.before, 1e-15 * max(abs(high), 1e-300)
    found = high if place(high) == goal else float(brentq(lambda time: place(time) - goal, low, high, xtol=fine))
    while found < high and not is_behind(found):
        found, fine = min(found + fine, high), 2.0 * fine
    return found
