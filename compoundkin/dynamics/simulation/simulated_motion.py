"""The motion in time that a simulation found: solved again at its times, by a law of every driver."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.simulated_course import ChartStretch
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import first_configuration
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import motion_table

# Accelerations are what forces take.
ORDER = 2
# So many coordinates are tried, the last ones first.
TRIES = 3
# Poses that two drivers tell agree within this part of the size.
SAME = 1e-6
# Value, speed and acceleration of a coordinate at times.
Moved = tuple[Number, Number, Number]


def simulated_motion(stretches: list[ChartStretch]) -> Motion:
    """Return the motion of all stretches together, at the times that were asked for.

    It is driven by a coordinate that tells the pose all the time, where there is one.
    """
    if len(stretches) == 1:
        return _alone(stretches[0])
    parts = [in_time(one.chart, one.times, _moved(one), first_configuration(one.chart.start, 0)) for one in stretches]
    times = np.concatenate([one.times[one.asked] for one in stretches])
    poses = _joined(parts, stretches)
    charts = {one.chart.free: one.chart for one in reversed(stretches)}
    tried: list[Motion] = []
    for chart in list(charts.values())[:TRIES]:
        motion, agrees = _driven_by(chart, parts, stretches, times, poses)
        if agrees:
            return motion
        tried.append(motion)
    # no coordinate is regular everywhere: each pose as it was found in the coordinate that was
    motion = tried[0]
    mended = motion.mended(np.zeros(len(times), dtype=int), np.arange(len(times)), poses)
    return replace(mended, failed=np.zeros_like(motion.failed))


def _alone(stretch: ChartStretch) -> Motion:
    some = stretch.asked
    states, accelerations = stretch.states[:, some], stretch.accelerations[:, some]
    asked = replace(stretch, times=stretch.times[some], states=states, accelerations=accelerations)
    return in_time(stretch.chart, asked.times, _moved(asked), first_configuration(stretch.chart.start, 0))


def _joined(parts: list[Motion], stretches: list[ChartStretch]) -> dict[str, Pose]:
    """Return the poses of all links at the times that were asked for, in a row."""

    def row(name: str, side: str, k: int) -> Number:
        found = []
        for motion, one in zip(parts, stretches, strict=True):
            c = getattr(motion.poses[name], side).c
            value = c[k] if k < len(c) else 0.0
            found.append(np.broadcast_to(value, motion.failed.shape)[:, one.asked])
        return np.concatenate(found, axis=1)

    def series(name: str, side: str) -> Series:
        return Series(tuple([row(name, side, k) for k in range(ORDER + 1)]))

    return {name: FIXED if name == FRAME else Pose(series(name, "z"), series(name, "u")) for name in parts[0].poses}


def _driven_by(
    chart: DriverChart, parts: list[Motion], stretches: list[ChartStretch], times: Number, poses: Mapping[str, Pose]
) -> tuple[Motion, bool]:
    """Return the motion by the free drivers of one chart, and whether its poses are those that were found."""
    moved = {name: _followed(chart, name, parts, stretches) for name in chart.free}
    first = Configuration(chart.start.structure, {}, placed_at(poses, (0, 0)), {}, {},
                          dimensions_at(chart.start.structure, 0, 0))  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = in_time(chart, times, moved, first)
    off = [np.abs(one.c[0] - other.c[0]) / scale for name, pose in motion.poses.items()
           for one, other, scale in ((pose.z, poses[name].z, motion.size), (pose.u, poses[name].u, 1.0))]  # fmt: skip
    agrees = bool(np.all(motion.regular)) and all(bool(np.all(one < SAME)) for one in off)
    return motion, agrees


def _followed(chart: DriverChart, name: str, parts: list[Motion], stretches: list[ChartStretch]) -> Moved:
    """Return how a driver of a chart moves all the time, read off the motions of all stretches."""
    own = chart.start.structure.driven[name]
    sense, found, last = float(own.pair.driven_by(own.drive.link)), [], None
    for motion, one in zip(parts, stretches, strict=True):
        # by the poses: at a multiple pin another driver makes other pairs
        ends = motion.inputs.ends.get(own.pair.name) or own.pair.ends(motion.mechanism.geometry)
        series = own.pair.coordinate(ends, tuple(motion.poses[link] for link in own.pair.members))
        rows = [np.broadcast_to(series.derivative(k), motion.failed.shape)[0] * sense for k in range(ORDER + 1)]
        if own.pair.free_is_angle:
            rows[0] = np.unwrap(rows[0])
            rows[0] = rows[0] + (0.0 if last is None else whole_turns(last - rows[0][0]))
        last = rows[0][-1]
        found.append(np.array(rows)[:, one.asked])
    value, speed, acceleration = np.concatenate(found, axis=1)
    return value, speed, acceleration


def _moved(stretch: ChartStretch) -> dict[str, Moved]:
    """Return how the free drivers move in a stretch."""
    chart, n = stretch.chart, len(stretch.chart.free)
    values, speeds = stretch.states[:n], stretch.states[n : 2 * n]
    rates = stretch.accelerations
    if not np.isfinite(rates).all():
        late = stretch.times[np.argmin(np.isfinite(rates).all(axis=0))]
        what = f"at {late:g} s the mechanism is at a limit position of its drivers, where their rates are not known"
        raise InvalidInput(Problem("until", what, "end before, or let other links be its drivers"))
    return {name: (values[k], speeds[k], rates[k]) for k, name in enumerate(chart.free)}


def in_time(chart: DriverChart, times: Number, moved: Mapping[str, Moved], first: Configuration | None) -> Motion:
    """Return a motion in time of a chart's mechanism. Its free drivers have a law that goes through what they did."""
    laws = {**chart.laws, **{name: motion_table(times, *one) for name, one in moved.items()}}
    drives = [Drive(item.name, item.link, item.on, item.pair, law=laws[item.name]) for item in chart.mechanism.items
              if isinstance(item, Drive)]  # fmt: skip
    mechanism = chart.mechanism.replace(*drives, time=times)
    return solve(mechanism, time=times, order=ORDER, modes=first)
