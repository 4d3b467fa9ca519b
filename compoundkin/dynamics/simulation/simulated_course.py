"""The course of a simulation: its steps, what happened, and its states at times, chart by chart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent, Watch


@dataclass(frozen=True, eq=False)
class Step:
    """A step of the integration. Its chart, its times, and the state in between as a function of time."""

    chart: DriverChart
    first: float
    last: float
    between: Callable[[Number], Number]
    memory: tuple[Any, ...]  # what keeps the configuration at its beginning

    def told(self, times: Number, states: Number) -> Number:
        """Return the accelerations of the free drivers at times in it, in columns."""
        n = len(self.chart.free)
        self.chart.recall(self.memory)
        found = [self.chart.told(t, y[:n], y[n : 2 * n]) for t, y in zip(times, states.T, strict=True)]
        return np.array(found).T


@dataclass(frozen=True, eq=False)
class ChartStretch:
    """The course in one chart. States at times are in columns, its first and last among them.

    `asked` tells which of the times were asked for.
    """

    chart: DriverChart
    times: Number
    states: Number
    accelerations: Number
    asked: Number


@dataclass(eq=False)
class SimulatedCourse:
    """The steps from the start on. A state is the free drivers' values, their speeds, and the work done.

    `fastest` is the approach of the fastest impact.
    """

    until: float
    tolerance: float
    watched: tuple[Watch, ...] = ()
    restitution: float | None = None
    steps: list[Step] = field(default_factory=list)
    events: list[SimulationEvent] = field(default_factory=list)
    evaluations: int = 0
    fastest: float = 0.0
    changed: float = -np.inf  # the time of the last change of coordinate

    def at(self, times: Number) -> list[ChartStretch]:
        """Return the states at times in order, chart by chart."""
        charts = list(dict.fromkeys(step.chart for step in self.steps))
        runs = [[step for step in self.steps if step.chart is chart] for chart in charts]
        return [_stretch(steps, times, k == 0) for k, steps in enumerate(runs)]

    def cut(self, time: float) -> None:
        """Let the last step end at a time. It is left out where nothing is left of it."""
        step = self.steps.pop()
        if time > step.first or not self.steps:
            self.steps.append(replace(step, last=time))

    @property
    def last(self) -> float:
        """The time that is reached."""
        return self.steps[-1].last if self.steps else 0.0


def _stretch(steps: list[Step], times: Number, is_first: bool) -> ChartStretch:
    """Return the states at times in the steps of one chart. A time at which charts change belongs to the first."""
    first, last = steps[0].first, steps[-1].last
    own = times[((times >= first) if is_first else (times > first)) & (times <= last)]
    whole = np.unique(np.concatenate([[first], own, [last]]))
    index = np.minimum(np.searchsorted([step.last for step in steps], whole), len(steps) - 1)
    states, accelerations = [], []
    for k in np.unique(index):
        here = whole[index == k]
        states.append(steps[k].between(here))
        accelerations.append(steps[k].told(here, states[-1]))
    whole_states, told = (np.concatenate(parts, axis=1) for parts in (states, accelerations))
    return ChartStretch(steps[0].chart, whole, whole_states, told, np.isin(whole, own))
