"""Stretches of a point's path beside the line or the circle from which they are least far."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.characteristics.figure import moving_drivers
from compoundkin.analysis.characteristics.path_fits import Fit, fitted_lines, projected
from compoundkin.analysis.characteristics.point_places import path_of
from compoundkin.analysis.characteristics.traced_path import TracedPath
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion

# A driver's value beyond an end of its range by less than this (radians, or parts of the size) is at the end: rounding
# of degrees.
AT_END = 1e-9


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a path near a line or a circle. `radius` is infinite for a line, of which `centre` is a point.

    `begin` and `end` are the drivers' values at its ends (radians or lengths), `deviation` the greatest distance from
    the line or circle on either side, `length` the extent along the line or the arc, `ends` its first and last point.
    """

    begin: dict[str, float]
    end: dict[str, float]
    ends: tuple[complex, complex]
    length: float
    deviation: float
    direction: complex
    centre: complex
    radius: float

    @property
    def is_straight(self) -> bool:
        """Whether it is compared with a line."""
        return not np.isfinite(self.radius)

    @property
    def straightness(self) -> float:
        """The width of the strip it stays in, as a part of its length."""
        return 2.0 * self.deviation / self.length

    def __repr__(self) -> str:
        kind = "line" if self.is_straight else f"circle of radius {self.radius:.6g}"
        where = "; ".join(f"{name} {a:.6g} to {self.end[name]:.6g}" for name, a in self.begin.items())
        return f"Stretch({self.length:.6g} long within {self.deviation:.2g} of a {kind}, {where})"


def stretch_of(path: TracedPath, fit: Callable[[Number], Fit], first: int, last: int) -> Stretch:
    """Return the stretch of a path between two of its samples.

    On a closed one they count on beyond the end.
    """
    samples = path.samples
    points = samples.points[np.arange(first, last + 1) % len(samples.points)]
    found = fit(points)
    if not np.isfinite(found.radius):
        found = fitted_lines(points)  # no circle goes through points on a line
    radius = float(found.radius)
    if np.isfinite(radius):
        length = radius * float(np.ptp(np.unwrap(np.angle(points - found.place))))
    else:
        length = float(np.ptp(projected(points, found)))
    begin = float(samples.s[0]) + first * samples.step
    at, until = path.drivers(begin, begin + (last - first) * samples.step)
    ends = complex(points[0]), complex(points[-1])
    line = complex(found.direction), complex(found.place)
    return Stretch(at, until, ends, length, float(found.deviation), *line, radius)


@checked
def straightness(motion: Motion, point: str, begin: float, end: float, design: int = 0) -> Stretch:
    """Return how straight a point's path is between two values of the driver.

    They are of the only driver that moves (radians or length). The line is that of least greatest distance. Raises as
    `path_features`, and InvalidInput for values outside.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.catalog.load_named("hoecken-straight-line"))
    >>> stretch = straightness(motion, "P", *ck.deg([90, 270]))
    >>> round(100 * stretch.straightness, 2)
    0.24
    """
    path, _ = path_of(motion, point, design, whole=True)
    drives = moving_drivers(motion, design)
    if len(drives) != 1:
        what = f"{len(drives)} drivers move ({', '.join(drives) or 'none'})"
        raise InvalidInput(Problem("begin, end", what, "a stretch is named by the values of the only one that does"))
    first, last = sorted(_place_of(path, value, drives[0]) for value in (begin, end))
    part = path.part(first, last)
    return stretch_of(part, fitted_lines, 0, len(part.samples.points) - 1)


def _place_of(path: TracedPath, value: float, driver: str) -> float:
    """Return the place along a path at which the driver has a value."""
    poses = np.arange(round(path.first), round(path.last) + 1)
    values = np.array([at[driver] for at in path.drivers(poses[0], poses[-1])])
    slack = AT_END * path.motion.solving_order.unit(driver)
    inside = min(values) - slack <= value <= max(values) + slack
    if not inside or values[0] == values[1]:
        span = f"{driver} goes from {values[0]:g} to {values[1]:g}"
        raise InvalidInput(Problem("begin, end", f"{value:g} is outside: {span}", "give values between (radians)"))
    rows = np.broadcast_to(path.motion.inputs.drives[driver][0], path.motion.failed.shape)[path.design, poses]
    way = np.sign(values[1] - values[0])
    return float(np.interp(way * value, way * rows, poses))
