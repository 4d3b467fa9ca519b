"""Change of coordinate: another pair replaces a driver near a limit position of that driver.

Near a limit position other pairs move infinitely faster than the driver. The coordinate of the fastest determines the
pose as well and is regular there: the driver's coordinate is a smooth function of it.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, FewDigits
from compoundkin.base.poses import Pose
from compoundkin.dynamics.simulation.body_chart import BodyChart
from compoundkin.dynamics.simulation.driver_chart import DriverChart, still
from compoundkin.dynamics.simulation.driver_state import DriverState
from compoundkin.dynamics.simulation.friction_chart import FrictionChart
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.motion import Motion
from compoundkin.model.elements import Drive, Expectation, Mode
from compoundkin.model.fields import Item
from compoundkin.model.laws import Law
from compoundkin.model.mechanism import Mechanism, available_outputs
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, as_drivable, as_transmitting_pair

# What a simulation is integrated in: the coordinates of free drivers, or those of all links.
Chart = DriverChart | BodyChart
# The number of pairs that are tried instead of a driver.
TRIED = 4
# Poses solved by different drivers agree within this part of the size.
SAME_POSE = 1e-6


class FastPair(NamedTuple):
    """A pair and its scaled speed at unit rate of a driver."""

    pair: Pair
    ratio: float
    driver: str


def fastest_pairs(chart: DriverChart, state: DriverState) -> list[FastPair]:
    """Return the pairs that move fastest at unit rate of a free driver, the fastest first."""
    return sorted(_pairs(chart, state), key=lambda found: -found.ratio)[:TRIED]


def _pairs(chart: DriverChart, state: DriverState) -> Iterator[FastPair]:
    for pair in (one for one in chart.candidates if one.name not in chart.driven):
        slopes = np.abs(state.slopes(pair))[: len(chart.free)] * chart.scales
        slopes = slopes / (1.0 if pair.free_is_angle else chart.order.size)
        if np.isfinite(slopes).all():
            yield FastPair(pair, float(slopes.max()), chart.free[int(np.argmax(slopes))])


def driven_there(chart: DriverChart, state: DriverState, fast: FastPair) -> tuple[DriverChart, Number] | None:
    """Return the chart with a pair driven instead of a driver, and its state; None where it cannot be solved."""
    first, second = fast.pair.members
    taken = {own.name for own in chart.mechanism.drives}
    name = next(one for one in (second, f"{second} on {first}", f"{fast.pair.name} driven") if one not in taken)
    items = [Drive(name, second, first) if isinstance(item, Drive) and item.name == fast.driver else item
             for item in chart.mechanism.items]  # fmt: skip
    moved = state.loaded.coordinate(fast.pair.name)
    free = tuple(name if one == fast.driver else one for one in chart.free)
    values = dict(zip(chart.names, state.values, strict=True))
    speeds = dict(zip(chart.names, state.speeds, strict=True))
    sense = float(as_driven(fast.pair).driven_by(second))
    values[name], speeds[name] = float(moved.c[0]) * sense, float(moved.c[1]) * sense
    del values[fast.driver]
    try:
        mechanism = _written(chart.mechanism, items)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FewDigits)  # of the driver that is replaced
            start = solve(
                mechanism, {one: [value] for one, value in values.items()}, order=1, modes=_here(state, values)
            )
        found = chart_of(start, free, chart.laws) if _is_same(start, state) else None
    except CompoundkinError:
        return None
    if found is None:
        return None
    found.count_on(state)
    return found, np.array([*(values[one] for one in free), *(speeds[one] for one in free)])


def _is_same(start: Motion, state: DriverState) -> bool:
    """Whether a motion of one pose is in the configuration of a state."""
    here, there = (placed_at(poses, (0, 0)) for poses in (state.block.world, start.poses))
    return all(
        abs(one.z.c[0] - there[link].z.c[0]) < SAME_POSE * start.size
        and abs(one.u.c[0] - there[link].u.c[0]) < SAME_POSE
        for link, one in here.items()
    )


def _here(state: DriverState, values: dict[str, float]) -> Configuration:
    """Return the configuration of a state."""
    structure = state.chart.start.structure
    return Configuration(
        structure, values, placed_at(state.block.world, (0, 0)), {}, {}, dimensions_at(structure, 0, 0)
    )


def _written(mechanism: Mechanism, items: list[Item]) -> Mechanism:
    """Return a mechanism with other drivers, without modes and expectations."""
    kept = [item for item in items if not isinstance(item, Mode | Expectation)]
    outputs = available_outputs(mechanism, [item.name for item in kept if isinstance(item, Drive)])
    return Mechanism(mechanism.title, *kept, units=mechanism.units, outputs=outputs, source=mechanism.source)


def as_driven(pair: Pair) -> Drivable:
    """Return a pair that can be driven, as such."""
    found = as_drivable(pair)
    assert found is not None
    return found


def chart_of(start: Motion, free: tuple[str, ...], laws: Mapping[str, Law]) -> DriverChart:
    """Return the chart around a pose, with a table if there is a single driver.

    Friction is in no table where there are gears and belts, whose flanks and strands depend on the force.
    """
    frictions, only = start.mechanism.frictions, len(free) + len(laws) == 1
    if not frictions:
        return TabulatedChart(start, free, laws) if only else DriverChart(start, free, laws)
    geared = any(as_transmitting_pair(pair) for pair in start.solving_order.pairs.values())
    return DriverChart(start, free, laws) if geared or not only else FrictionTable(start, free, laws)


def integrable(chart: DriverChart, time: float, state: Number) -> tuple[Chart, Number]:
    """Return the chart to begin in, with its state: with several drivers the coordinates of all links."""
    if isinstance(chart, TabulatedChart):
        return chart, state
    n = len(chart.free)
    found, begun = by_links(chart, chart.state(time, state[:n], state[n : 2 * n]))
    return found, np.append(begun, state[-1])


def by_links(chart: DriverChart, state: DriverState) -> tuple[BodyChart, Number]:
    """Return the chart of the coordinates of all links, and a state of drivers in it."""
    world = {link: still(pose) for link, pose in state.block.world.items()}
    contacts = chart.stop_contacts, chart.closed, chart.phase, chart.open_pairs
    kind = FrictionChart if chart.mechanism.frictions else BodyChart
    found = kind(chart.start, chart.free, chart.laws, world, *contacts)
    rates = [_rates(state.block.world[link]) for link in found.links]
    return found, np.concatenate([found.first, np.ravel(rates)])


def _rates(pose: Pose) -> tuple[float, float, float]:
    """Return the rates of a link's coordinates: the last of a column, which is the true motion."""
    z, turning = (complex(np.ravel(c)[-1]) for c in (pose.z.derivative(1), pose.u.turning().c[0]))
    return z.real, z.imag, turning.real
