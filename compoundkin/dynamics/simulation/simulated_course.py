"""The course of a simulation: its steps, each with the state as a function of time, and what is read from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.friction.friction_contacts import LoadedContact
from compoundkin.dynamics.simulation.coordinate_change import Chart
from compoundkin.dynamics.simulation.dormand_prince import PlainStep, states_between
from compoundkin.dynamics.simulation.driver_state import KnownState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.load_breaks import LoadBreak
from compoundkin.dynamics.simulation.simulation_events import BreakWatch, SimulationEvent, Watch
from compoundkin.dynamics.simulation.stop_contacts import StopContact, holding
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.model.loads.latch import Latch
from compoundkin.model.loads.stop import Stop

# The nodes of a quadrature over a step: exact to the order 16, above that of the method.
NODES = 8


@dataclass(frozen=True, eq=False)
class Step:
    """A step of the integration: its chart, its times, and the state as a function of time."""

    chart: Chart
    first: float
    last: float
    between: Callable[[Number], Number]
    memory: tuple[Any, ...]  # the configuration at its beginning

    def integral(self, function: Callable[[KnownState], float]) -> float:
        """Return the integral of a function of the state over the step."""
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        half = (self.last - self.first) / 2.0
        return half * float(weights @ [function(self.state(self.first + half * (one + 1.0))) for one in nodes])

    def state(self, time: float) -> KnownState:
        """Return the state at a time in the step."""
        n, y, memory = len(self.chart.free), self.between(np.array(time)), self.chart.memory
        self.chart.recall(self.memory)
        found = self.chart.state(float(time), y[:n], y[n : 2 * n])
        self.chart.recall(memory)
        return found

    def rubbed(self) -> dict[str, float]:
        """Return the energy that each pair with friction takes in the step, by its name."""
        chart, n = self.chart, len(self.chart.free)
        if not isinstance(chart, FrictionTable | FrictionChart):
            return {}
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        half, memory, found = (self.last - self.first) / 2.0, chart.memory, np.zeros(len(chart.contacts))
        chart.recall(self.memory)
        for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True):
            time = self.first + half * (node + 1.0)
            y = chart.settled(time, self.between(np.array(time)))
            found -= half * weight * chart.friction_powers(time, y[:n], y[n : 2 * n])
        chart.recall(memory)
        return {one.name: lost for one, lost in zip(chart.contacts, found.tolist(), strict=True)}

    def sticking(self, time: float) -> list[tuple[LoadedContact, float]]:
        """Return the pairs that friction holds at a time in the step, with their efforts."""
        if not isinstance(self.chart, FrictionChart):
            return []
        memory = self.chart.memory
        self.chart.recall(self.memory)
        found = self.chart.sticking(time, self.chart.settled(time, self.between(np.array(time))))
        self.chart.recall(memory)
        return found

    def holding(self, time: float) -> list[tuple[StopContact, float]]:
        """Return the contacts that hold a coordinate at a time in the step, with their forces."""
        if not self.memory[0][1]:  # none is closed
            return []
        chart, memory, n = self.chart, self.chart.memory, len(self.chart.free)
        chart.recall(self.memory)
        rigid, y, forces = chart.rigid, self.between(np.array(time)), np.empty(0)
        if rigid:
            here = chart.state(time, y[:n], y[n : 2 * n])
            free = chart.unheld_rates(time, y[:n], y[n : 2 * n])
            forces = holding([one.at(here) for one in rigid], here, free)
        chart.recall(memory)
        return list(zip(rigid, forces.tolist(), strict=True))

    def settled(self, times: Number) -> Number:
        """Return the states at times in the step, in columns."""
        self.chart.recall(self.memory)
        return np.array([self.chart.settled(t, y) for t, y in zip(times, self.between(times).T, strict=True)]).T

    def accelerations_at(self, times: Number, states: Number) -> Number:
        """Return the accelerations of the free drivers at times in the step, in columns."""
        n, chart = len(self.chart.free), self.chart
        chart.recall(self.memory)
        if type(chart) is TabulatedChart:
            plain = chart.plain_rates()
            return np.array([[plain(t, *y)[0] for t, y in zip(times.tolist(), states[:2].T.tolist(), strict=True)]])
        found = [chart.accelerations_at(t, y[:n], y[n : 2 * n]) for t, y in zip(times, states.T, strict=True)]
        return np.array(found).T

    @property
    def moved(self) -> Number:
        """How far each free driver has moved."""
        n, between = len(self.chart.free), self.between
        if isinstance(between, PlainStep) and self.last == between.first + between.length:
            return np.array([between.end[0] - between.begin[0]])
        found: Number = between(np.array(self.last))[:n] - between(np.array(self.first))[:n]
        return found


@dataclass(frozen=True, eq=False)
class ChartStretch:
    """The course in one chart, with states in columns, its first and last among them.

    `asked` is a mask of the requested times.
    """

    chart: Chart
    times: Number
    states: Number
    accelerations: Number
    asked: Number


@dataclass(eq=False)
class SimulatedCourse:
    """The steps from the start. A state is the free drivers' values, their speeds, and the work done.

    `fastest` is the approach speed of the fastest impact.
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
    breaks: tuple[LoadBreak, ...] = ()
    near: BreakWatch | None = None  # of a break behind the present step
    places: list[tuple[float, LoadBreak]] = field(default_factory=list)  # breaks over coordinates, when passed
    restarts: list[float] = field(default_factory=list)  # times of restarts behind steps that collapsed
    ended: bool = False
    may_wedge: bool = False  # whether friction had a second motion at the end of the last step
    implicit: bool = False  # whether an implicit method has taken over
    short: int = 0  # checks in a row at which another method would do better
    left: float = 0.0  # the rate of decay at which the implicit method was last left

    def at(self, times: Number) -> list[ChartStretch]:
        """Return the states at times in order, chart by chart."""
        charts = list(dict.fromkeys(step.chart for step in self.steps))
        runs = [[step for step in self.steps if step.chart is chart] for chart in charts]
        return [_stretch(steps, times, k == 0) for k, steps in enumerate(runs)]

    def cut(self, time: float, keeps_one: bool = True) -> None:
        """Let the last step end at a time; an empty step is dropped, the only one if another follows."""
        step = self.steps.pop()
        if time > step.first or (keeps_one and not self.steps):
            self.steps.append(replace(step, last=time))

    def damped(self, contact: StopContact, is_left: bool) -> float:
        """Return the energy that an elastic stop has taken since its contact closed; zero where it is open.

        What is stored when it is left, where the damping holds it back, is lost too.
        """
        total, first = 0.0, None
        for step in reversed(self.steps):
            if contact not in step.memory[0][1] or not contact.stop.needs_rates:
                break
            total, first = total + step.integral(contact.damping_power), step
        if first is not None:
            total -= contact.stored(first.state(first.first))
            total += contact.stored(self.steps[-1].state(self.last)) if is_left else 0.0
        return total

    def holding(self, phase: int, times: Number) -> dict[Stop | Latch, Number]:
        """Return the efforts that rigid stops and latches have at times in a phase while they hold a coordinate."""
        steps = [step for step in self.steps if step.chart.phase == phase]
        index = np.minimum(np.searchsorted([step.last for step in steps], times), len(steps) - 1)
        found: dict[Stop | Latch, Number] = {}
        for k, time in enumerate(times):
            for one, force in steps[index[k]].holding(float(time)):
                found.setdefault(one.stop, np.zeros(len(times)))[k] += one.side * force
        return found

    def sticking(self, phase: int, times: Number) -> dict[str, Number]:
        """Return the efforts at times in a phase with which friction holds pairs, by their names."""
        steps = [step for step in self.steps if step.chart.phase == phase]
        index = np.minimum(np.searchsorted([step.last for step in steps], times), len(steps) - 1)
        found: dict[str, Number] = {}
        for k, time in enumerate(times):
            for one, force in steps[index[k]].sticking(float(time)):
                found.setdefault(one.name, np.zeros(len(times)))[k] += force
        return found

    @property
    def losses(self) -> dict[str, float]:
        """The energy lost up to now, by stops and pairs."""
        found = {one.loser: 0.0 for one in self.events if one.loser}
        for event in self.events:
            if event.loser:
                found[event.loser] += event.lost
        for contact in self.steps[-1].memory[0][1]:
            found[contact.stop.name] = found.get(contact.stop.name, 0.0) + self.damped(contact, False)
        for step in self.steps:
            for name, lost in step.rubbed().items():
                found[f"friction in {name}"] = found.get(f"friction in {name}", 0.0) + lost
        return found

    def stop(self, name: str, text: str) -> None:
        """Let the course end here, by an event."""
        self.ended = True
        self.events.append(SimulationEvent(self.last, name, text, True))

    @property
    def last(self) -> float:
        """The time reached."""
        return self.steps[-1].last if self.steps else 0.0


def _stretch(steps: list[Step], times: Number, is_first: bool) -> ChartStretch:
    """Return the states at times in the steps of one chart. A time at which charts change belongs to the first."""
    first, last = steps[0].first, steps[-1].last
    own = times[((times >= first) if is_first else (times > first)) & (times <= last)]
    whole = np.unique(np.concatenate([[first], own, [last]]))
    index = np.minimum(np.searchsorted([step.last for step in steps], whole), len(steps) - 1)
    used, firsts = np.unique(index, return_index=True)
    cuts = [slice(a, b) for a, b in pairwise([*firsts.tolist(), len(whole)])]
    plain = [step.between for step in steps if isinstance(step.between, PlainStep)]
    if len(plain) == len(steps):
        states = states_between(plain, index, whole)
    else:
        states = np.concatenate([steps[k].settled(whole[cut]) for k, cut in zip(used, cuts, strict=True)], axis=1)
    rates = [steps[k].accelerations_at(whole[cut], states[:, cut]) for k, cut in zip(used, cuts, strict=True)]
    return ChartStretch(steps[0].chart, whole, states, np.concatenate(rates, axis=1), np.isin(whole, own))
