"""Plotted quantities as rows of real numbers (designs x poses) in display units, and the gaps between their poses.

Marked along a motion are gaps without assembled poses and change points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import Gap, gaps
from compoundkin.kinematics.quantities import Quantity, known_owners, whole_and_part
from compoundkin.model.attributes import (
    ADVANTAGE,
    LENGTH,
    OF_FORCES,
    PARTS,
    RATE_OF,
    SPEED,
    TIME,
    VALUE,
    motion_figure,
    unit_of,
    vector_and_part,
)

POSE, DRIVEN = "pose", "driver"
# The scale of angles, in degrees.
TURN = 360.0


@dataclass(frozen=True, eq=False, repr=False)
class Plotted(Quantity):
    """A quantity along an axis: `values` real or complex, (designs, poses), angles in degrees.

    `scale` is what its rounding is relative to; `vector` holds the vectors that `values` are the lengths of. What is a
    reciprocal `has_poles`, where that is zero.
    """

    scale: float = 1.0
    vector: Number | None = None
    has_poles: bool = False

    @property
    def is_unbounded(self) -> bool:
        """Whether it may grow without limit.

        Rates and forces do at limit positions, an advantage at toggle positions.
        """
        return self.has_poles or self.order > 0 or self.dimension in OF_FORCES

    @property
    def poles(self) -> Number:
        """Between which poses it changes its sign through infinity, (designs, poses less one)."""
        ahead = np.sign(self.values[:, :-1].real) * np.sign(self.values[:, 1:].real)
        return (ahead < 0) if self.has_poles else np.zeros(np.shape(ahead), dtype=bool)

    def curve(self, d: int, across: Self) -> tuple[Number, Number]:
        """Return the curve of a design over another quantity, a gap at each pole."""
        return self.parted(across, across.values[d], self.values[d])

    def parted(self, across: Self, x: Number, y: Number) -> tuple[Number, Number]:
        """Return a line with a gap wherever it changes its sign through infinity."""
        both = ((across, x), (self, y))
        flips = [one.has_poles & (np.sign(v[:-1].real) * np.sign(v[1:].real) < 0) for one, v in both]
        cuts = np.flatnonzero(flips[0] | flips[1]) + 1
        return np.insert(x.astype(float), cuts, np.nan), np.insert(y, cuts, np.nan)

    def part(self, name: str) -> Self:
        """Return a component or the length of a vector."""
        return replace(super().part(name), vector=self.values if name == LENGTH else None)

    @property
    def parts(self) -> tuple[Self, ...]:
        """The components and the length of a vector. A scalar is its own part."""
        return tuple(self.part(name) for name in PARTS) if self.is_vector else (self,)


def plotted_quantity(motion: Motion, name: str) -> Plotted:
    """Return the quantity of a name. A component or the length of a vector as "G.velocity.x", "G.velocity.length".

    Raises UnknownName with the nearest name there is.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> plotted_quantity(solve(load("six-bar")), "G.velocity.length").label
    'G.velocity.length [mm/s]'
    """
    whole, part = whole_and_part(motion, name)
    found = _rows(motion, whole)
    return found.part(part) if part else found


def rate_name(motion: Motion, name: str) -> str:
    """Return the name of the time derivative of a quantity. Raises UnknownName where it has none that can be named.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> rate_name(solve(load("six-bar")), "bar.angle")
    'bar.angular_velocity'
    """
    own = plotted_quantity(motion, name)
    vector, part = vector_and_part(name)
    owner, _, attribute = vector.rpartition(".") if "." in vector else (vector, "", "")
    for candidate in RATE_OF.get(f"{attribute}.{part}" if part else attribute, ()):
        try:
            found = plotted_quantity(motion, f"{owner}.{candidate}")
        except UnknownName:
            continue
        if not own.is_vector and not found.is_vector:
            return found.name
    remedy = "take an angle, a displacement, a coordinate such as G.x, or a component such as G.velocity.x"
    raise UnknownName(Problem(name, "a phase plot needs a quantity whose rate has a name", remedy))


def horizontal_axis(motion: Motion, against: str | None) -> tuple[Plotted, bool]:
    """Return the quantity of the horizontal axis, and whether it is known at every pose.

    It may not be where the mechanism cannot be assembled.

    None is the time of a motion in time, else its first driver that moves. Raises UnknownName.
    """
    if motion.inputs.poses < 2:
        what, remedy = "the motion has a single pose", "solve it at several values of a driver"
        raise InvalidInput(Problem("motion", what, remedy))
    if against == POSE:
        return Plotted(POSE, "", _shaped(motion, np.arange(motion.inputs.poses, dtype=float))), True
    if against == TIME or (against is None and motion.time is not None):
        if motion.time is None:
            raise InvalidInput(Problem(TIME, "this is not a motion in time", "solve(..., time=...)"))
        return Plotted(TIME, unit_of("", "time"), _shaped(motion, motion.time), dimension="time"), True
    if against in (None, DRIVEN):
        return moving_driver(motion), True
    found = _named(motion, str(against))
    if found.is_vector:
        listed = ", ".join(f"{against}.{part}" for part in PARTS)
        remedy = f"take a part of it: {listed}"
        raise InvalidInput(Problem(against, "nothing can be drawn against a vector", remedy))
    return found, False


def _named(motion: Motion, against: str) -> Plotted:
    try:
        return plotted_quantity(motion, against)
    except UnknownName:
        if "." in against:
            raise
        known = suggestion(against, [TIME, DRIVEN, POSE, *known_owners(motion)])
        raise UnknownName(Problem(against, "there is nothing of this name to draw against", known)) from None


def moving_driver(motion: Motion) -> Plotted:
    """Return the first driver that moves; the first of all where none does."""
    rows = {name: plotted_quantity(motion, f"{name}.{VALUE}") for name in motion.drives}
    if not rows:
        raise InvalidInput(Problem(DRIVEN, "the mechanism has no driver", f"against={POSE!r}"))
    moving = [name for name, row in rows.items() if np.ptp(row.values, axis=-1).any()]
    name = (moving or list(rows))[0]
    return replace(rows[name], name=name)


def plotted_quantities(motion: Motion, names: Sequence[str]) -> tuple[Plotted, ...]:
    """Return the quantities of names, else the mechanism's outputs. The outputs are what it states as such."""
    chosen = names or [name for name in motion.mechanism.outputs if not motion_figure(name)[1]]
    if not chosen:
        raise InvalidInput(Problem("quantities", "nothing is named", "name some: plot(motion, 'G.velocity')"))
    return tuple(plotted_quantity(motion, name) for name in chosen)


def _rows(motion: Motion, found: Quantity) -> Plotted:
    values = _shaped(motion, found.shown.values)
    largest = float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))
    natural = TURN if found.is_angle else 1.0 if found.dimension in ("angle", "number") else motion.size
    scale = max(largest, found.scale or natural * _pace(motion) ** found.order)
    owner, _, attribute = found.name.rpartition(".")
    is_speed = attribute == SPEED and owner in motion.points
    vector = _shaped(motion, motion.points[owner].velocity) if is_speed else None
    own = {**vars(found.shown), "values": values, "scale": scale}
    return Plotted(**own, vector=vector, has_poles=attribute == ADVANTAGE)


def _pace(motion: Motion) -> float:
    """The greatest speed of the drivers, in sizes of the mechanism or radians a second."""
    if not motion.order:
        return 0.0
    rates = [np.abs(drive.rate) / (1.0 if drive.is_angle else motion.size) for drive in motion.drives.values()]
    return max((float(np.max(rate)) for rate in rates), default=0.0)


def _shaped(motion: Motion, values: Any) -> Number:
    full = np.broadcast_to(np.asarray(values), motion.shape)
    return full.reshape(motion.inputs.designs, motion.inputs.poses)


# A curve that varies less than this part of its size is constant but for rounding.
CONSTANT = 1e-9


@dataclass(frozen=True)
class Blank:
    """A part of one design's motion without assembled poses. Its places are along the motion (pose 0, 1, 2 ...).

    `limits` tells for its begin and its end whether it is a limit position or the end of a guide; otherwise
    the motion ends there.
    """

    design: int
    begin: float
    end: float
    limits: tuple[bool, bool]


@dataclass(frozen=True)
class Events:
    """The gaps and change points of a motion, at places along it."""

    blanks: tuple[Blank, ...]
    changes: tuple[tuple[int, float], ...]  # design and place of every change point

    def beside(self, design: int, poses: int) -> Number:
        """Return a design's last poses before and first ones after limit positions."""
        found = []
        for blank in self.blanks:
            if blank.design == design:
                places = (np.floor(blank.begin), np.ceil(blank.end))
                found += [int(s) for s, is_limit in zip(places, blank.limits, strict=True) if is_limit]
        return np.array([s for s in found if 0 <= s < poses], dtype=int)


def events(motion: Motion) -> Events:
    """Return the gaps and change points of a motion.

    >>> import warnings
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load("triple-rocker"), {"driver": np.deg2rad([80.0, 88.0, 90.0])})
    >>> [round(blank.begin, 3) for blank in events(motion).blanks]     # the limit is interpolated 88.98 degrees
    [1.488]
    """
    found = gaps(motion) if np.any(motion.failed) else ()
    changes = [
        (design, float(place))
        for _, places in sorted(motion.change_points.items())
        for design, row in enumerate(places)
        for place in row[np.isfinite(row)]
    ]
    return Events(tuple(_blank(motion, gap) for gap in found), tuple(dict.fromkeys(changes)))


def interpolated(row: Number, place: float) -> float:
    """Return a quantity at a place, linear between poses as drivers and times are."""
    return float(np.interp(place, np.arange(len(row)), row))


def _blank(motion: Motion, gap: Gap) -> Blank:
    design = int(np.ravel_multi_index(gap.design, motion.shape[:-1])) if gap.design else 0
    begin = float(gap.first) if gap.open_begin else _place(motion, design, dict(gap.begin), gap.first - 1, gap.first)
    end = float(gap.last) if gap.open_end else _place(motion, design, dict(gap.end), gap.last + 1, gap.last)
    return Blank(design, begin, end, (not gap.open_begin, not gap.open_end))


def _place(motion: Motion, design: int, values: dict[str, float], good: int, bad: int) -> float:
    """The place between two poses where the drivers have these values."""
    rows = {n: np.broadcast_to(motion.drives[n].value, motion.shape).reshape(motion.failed.shape) for n in values}
    moved = {name: float(row[design, bad] - row[design, good]) for name, row in rows.items()}
    name = max(moved, key=lambda n: abs(moved[n]), default=None)
    if name is None or moved[name] == 0.0:
        return (good + bad) / 2.0
    return good + (values[name] - float(rows[name][design, good])) / moved[name] * (bad - good)
