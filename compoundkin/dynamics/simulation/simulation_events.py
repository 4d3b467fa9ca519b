"""Events of a simulation: zeros of watched functions of the state, and how they are found in a step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.driver_state import LoadedState, SimulatedState
from compoundkin.dynamics.simulation.load_breaks import BreakPassed, LoadBreak, LoadPlace, first_break
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart

# Each watched function is sampled at so many places of a step, so that double zeros are found as well.
EVENT_SAMPLES = 4
# A function that starts below zero is sampled at these parts of a step too: a bounce may be far shorter.
EARLY = 2.0 ** np.arange(-44.0, -2.0)
Function = Callable[[SimulatedState], Any]


@dataclass(frozen=True)
class SimulationEvent:
    """An event: its time, its name, whether the simulation stopped there, and the energy `lost` in it."""

    time: float
    name: str
    text: str
    stops: bool
    lost: float = 0.0  # the energy lost in it
    loser: str = ""  # the stop or the pair that takes it

    def __repr__(self) -> str:
        return f"SimulationEvent({self.name!r} at {self.time:.6g} s: {self.text})"


# States in a step by the time.
Between = Callable[[Number], Number]


@dataclass(frozen=True, eq=False)
class Watch(ABC):
    """What is watched in a simulation. If it `falls`, only downward zeros count, or a negative value at the start.

    A user's own is `asked`.
    """

    name: str
    text: str
    stops: bool
    falls: bool = False
    asked: bool = False

    def is_idle(self, chart: Chart) -> bool:
        """Return whether nothing is passed in the last step of a chart for sure."""
        return False

    @abstractmethod
    def passages(self, chart: Chart, times: tuple[float, float], between: Between, by_ends: Between) -> list[Passed]:
        """Return what is passed in a step.

        `between` are the states in the step, and `by_ends` those by both ends alone: a pulse that the step has not met
        may be in the former.
        """


@dataclass(frozen=True, eq=False)
class Passed:
    """A zero of a watched function, or a break of a load: its time, and the state there."""

    watch: Watch
    time: float
    state: Number
    at: LoadBreak | None = None


@dataclass(frozen=True, eq=False)
class ZeroWatch(Watch):
    """A function of the state whose zeros are events."""

    # so many places of a step are looked at
    samples: ClassVar[int] = EVENT_SAMPLES
    # and whether it may dip below zero between them
    has_dips: ClassVar[bool] = False

    @abstractmethod
    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the function at a state."""

    def passages(self, chart: Chart, times: tuple[float, float], between: Between, by_ends: Between) -> list[Passed]:
        """Return the zeros in a step; of all but a user's own the first, which interrupts the step."""
        zeros = _zeros(self, chart, times, between)
        return [Passed(self, time, between(np.array(time))) for time in (zeros if self.asked else islice(zeros, 1))]


@dataclass(frozen=True, eq=False)
class FunctionWatch(ZeroWatch):
    """A function of a simulated state, most often a user's own."""

    function: Function = field(kw_only=True)

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the function at a state. Raises InvalidInput where it returns no number."""
        n = len(chart.free)
        here = SimulatedState(chart.state(time, state[:n], state[n : 2 * n]), chart.order)
        try:
            returned = np.ravel(self.function(here))
            if self.asked and returned.size != 1:
                raise ValueError(f"it returns {returned.size} numbers")
            result = returned[0]
            if self.asked and (np.iscomplexobj(result) or np.isnan(result)):
                raise ValueError(f"it returns {result}")
            found = float(result)
        except CompoundkinError:
            raise
        except Exception as error:  # whatever a user's function does
            remedy = 'give a function of the state that passes through zero: lambda state: state["B.y"] - 20'
            raise InvalidInput(Problem(f"events.{self.name}", f"its function fails: {error}", remedy)) from error
        return found


class BreakWatch(Watch):
    """Places of the driver at which loads in its table jump, wake or have corners."""

    def passages(self, chart: Chart, times: tuple[float, float], between: Between, by_ends: Between) -> list[Passed]:
        """Return the first place that is passed in a step."""
        found = self.passed(chart, times, by_ends)
        return [] if found is None else [Passed(self, found.time, between(np.array(found.time)), found.at)]

    def is_idle(self, chart: Chart) -> bool:
        """Return whether there are none."""
        return not (isinstance(chart, TabulatedChart) and chart.table is not None and chart.table.breaks)

    def passed(self, chart: Chart, times: tuple[float, float], between: Between) -> BreakPassed | None:
        """Return the first one that is passed in a step."""
        assert isinstance(chart, TabulatedChart)
        samples = np.linspace(*times, EVENT_SAMPLES + 1)
        return first_break(samples.tolist(), between(samples)[0].tolist(), lambda t: float(between(np.array(t))[0]),
                           chart.breaks)  # fmt: skip


@dataclass(frozen=True, eq=False)
class PlaceWatch(BreakWatch):
    """Places of a coordinate at which a load that is in no table jumps, wakes or has corners."""

    place: LoadPlace = field(kw_only=True)

    def is_idle(self, chart: Chart) -> bool:
        """Return whether the load acts no more."""
        return self.place.load.name not in chart.mechanism.loads

    def value(self, chart: Chart, time: float, state: Number) -> float:
        """Return the coordinate."""
        n = len(chart.free)
        return float(np.ravel(self.place.value(chart.seen(time, state[:n], state[n : 2 * n]).loaded))[0])

    def passed(self, chart: Chart, times: tuple[float, float], between: Between) -> BreakPassed | None:
        """Return the first one that is passed in a step."""
        n, samples = len(chart.free), np.linspace(*times, EVENT_SAMPLES + 1)
        states = between(samples)
        if isinstance(chart, TabulatedChart) and chart.has_in_table(self.place.load, states[0]):
            return None
        slope, offset = chart.straight(self.place) if isinstance(chart, TabulatedChart) else (0.0, 0.0)
        if slope:
            places = (slope * states[0] + offset).tolist()
        else:
            places = [self.value(chart, t, y) for t, y in zip(samples.tolist(), states.T, strict=True)]

        def place(time: float) -> float:
            y = between(np.array(time))
            return slope * float(y[0]) + offset if slope else self.value(chart, time, y)

        def begun() -> LoadedState:
            return chart.seen(times[0], states[:n, 0], states[n : 2 * n, 0]).loaded

        def breaks(low: float, high: float) -> Sequence[LoadBreak]:
            return self.place.breaks(low, high, chart.order.size, begun)

        return first_break(samples.tolist(), places, place, breaks)


def first_passed(
    watched: tuple[Watch, ...], chart: Chart, times: tuple[float, float], between: Between, by_ends: Between
) -> list[Passed]:
    """Return what is passed in a step, in the order of time. `between` and `by_ends` are those of `Watch.passages`."""
    # which are idle is known before any is searched, for a search meets other states
    searched = [one for one in watched if not one.is_idle(chart)]
    found = [passed for one in searched for passed in one.passages(chart, times, between, by_ends)]
    return sorted(found, key=lambda one: one.time)


def _zeros(watch: ZeroWatch, chart: Chart, times: tuple[float, float], between: Between) -> Iterator[float]:
    """Yield the times of zeros; the first time where the function is negative throughout."""

    def value(time: float) -> float:
        return watch.value(chart, time, between(np.array(time)))

    samples = np.linspace(*times, watch.samples + 1)
    known = [value(float(time)) for time in samples]
    if watch.falls and known[0] <= 0.0:
        early = times[0] + (times[1] - times[0]) * EARLY
        samples = np.concatenate([samples[:1], early, samples[1:]])
        known = [known[0], *(value(float(time)) for time in early), *known[1:]]
        if max(known) <= 0.0 > min(known):
            yield times[0]
    if watch.has_dips:
        for time in list(_dips(samples, known)):
            at = int(np.searchsorted(samples, time))
            samples, known = np.insert(samples, at, time), [*known[:at], value(time), *known[at:]]
    for low, high, first, last in zip(samples[:-1], samples[1:], known[:-1], known[1:], strict=True):
        if first > 0.0 >= last or (not watch.falls and first < 0.0 <= last):
            yield _zero(value, float(low), float(high))


def _dips(samples: Number, known: Sequence[float]) -> Iterator[float]:
    """Yield the vertices of the parabolas through three values whose middle one is the least."""
    for k in range(1, len(known) - 1):
        fall, rise = known[k - 1] - known[k], known[k + 1] - known[k]
        if known[k] > 0.0 and fall > 0.0 and rise > 0.0:
            yield float(samples[k] + 0.5 * (samples[k + 1] - samples[k]) * (fall - rise) / (fall + rise))


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    fine = 1e-14 * max(abs(high), 1e-300)
    found, is_above = float(brentq(function, low, high, xtol=fine, rtol=1e-14)), function(low) > 0.0
    # the far side of the zero, so that the continuation does not meet it again
    while found < high and (function(found) > 0.0) is is_above:
        found, fine = min(found + fine, high), 2.0 * fine
    return found
