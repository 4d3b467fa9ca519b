"""What is marked in plots: gaps, change points, the highest and the lowest values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import Gap, gaps

# A curve that varies less than this part of its size is constant but for rounding.
CONSTANT = 1e-9
# Two ends nearer than this part of the curve's range are one place: the motion is a closed cycle.
CLOSED = 1e-6
# What interpolation may add beyond a pose, in second differences. The vertex of a parabola whose middle sample is the
# highest adds an eighth; what adds far more follows a kink of the data. A length that passes zero adds up to a half.
MOST_ADDED = {False: 0.25, True: 0.5}


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
    """All that is marked in plots of a motion, in places along it."""

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
    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load_named("triple-rocker"), {"driver": np.deg2rad([80.0, 88.0, 90.0])})
    >>> [round(blank.begin, 3) for blank in events(motion).blanks]     # the limit is at 88.98 degrees
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


def at(row: Number, place: float) -> float:
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


@dataclass(frozen=True)
class MarkedExtreme:
    """A highest or lowest value `y` of a curve, with its `x`."""

    x: float
    y: float
    is_highest: bool


def extremes(
    x: Number, y: Number, grows: bool = False, scale: float = 0.0, vector: Number | None = None
) -> tuple[MarkedExtreme, ...]:
    """Return the highest and lowest value of a curve. It is 1-D, NaN where there is none; a constant has none.

    Between poses they are interpolated by five poses, or three. With `grows` a value next to a gap is none, for there a
    rate grows without limit. `scale` is what rounding is relative to, if it is larger than the values. `vector` are the
    vectors that `y` are the lengths of: a length has a kink where its vector passes zero, the vector has none.

    >>> x = np.arange(0.0, 6.3, 0.1)
    >>> [(round(e.x, 4), round(e.y, 4)) for e in extremes(x, np.sin(x))]
    [(1.5708, 1.0), (4.7124, -1.0)]
    """
    known = np.isfinite(x) & np.isfinite(y)
    if known.sum() < 2 or np.ptp(y[known]) <= CONSTANT * max(scale, float(np.max(np.abs(y[known])))):
        return ()
    t = x if _is_monotonic(x[known]) else np.arange(len(x), dtype=float)
    of = y.astype(float) if vector is None else vector
    found = []
    for sign in (1.0, -1.0):
        up = np.where(known, sign * y, -np.inf)
        if not (grows and _next_to(~known)[np.argmax(up)]):
            found.append(MarkedExtreme(*_best(_Curve(t, x, of), up, sign), sign > 0))
    return tuple(found)


def _next_to(unknown: Number) -> Number:
    padded = np.pad(unknown, 1)
    return np.asarray(padded[:-2] | padded[2:])


def _is_monotonic(x: Number) -> bool:
    steps = np.diff(x)
    return bool((steps > 0).all() or (steps < 0).all())


@dataclass(frozen=True, eq=False)
class _Curve:
    """A curve by its parameter; `y` are vectors where it is the length of them."""

    t: Number
    x: Number
    y: Number

    @property
    def is_length(self) -> bool:
        return np.iscomplexobj(self.y)

    def around(self, k: int, half: int) -> _Curve | None:
        """Return the poses around a pose, beyond the ends of a closed cycle as well; None where some are not known."""
        last = len(self.t) - 1
        index = np.arange(k - half, k + half + 1)
        turns = np.where(index < 0, -1, np.where(index > last, 1, 0))
        if turns.any() and not (last > 2 * half and self._closed):
            return None
        index = index - turns * last
        t, x = (v[index] + turns * (v[-1] - v[0]) for v in (self.t, self.x))
        found = _Curve(t, x, self.y[index])
        return found if np.isfinite([t, x, np.abs(found.y)]).all() else None

    @property
    def _closed(self) -> bool:
        size = np.ptp(self.y[np.isfinite(self.y)].view(float))
        return bool(abs(self.y[-1] - self.y[0]) <= CLOSED * size)

    def vertices(self) -> list[tuple[float, float]]:
        """Return the highest and lowest points of the polynomial through all poses, within a pose of the middle one."""
        middle = len(self.t) // 2
        u = (self.t - self.t[middle]) / (np.ptp(self.t) / 2.0)
        of_x, re, im = (_through(u, v) for v in (self.x, self.y.real, self.y.imag))
        square = re * re + im * im if self.is_length else re
        roots = square.deriv().roots()
        real = roots[np.abs(roots.imag) < CONSTANT].real
        ends = sorted((u[middle - 1], u[middle + 1]))
        near = real[(real >= ends[0]) & (real <= ends[1])]
        values = np.sqrt(np.maximum(square(near), 0.0)) if self.is_length else square(near)
        return list(zip(of_x(near).tolist(), values.tolist(), strict=True))


def _through(u: Number, v: Number) -> np.polynomial.Polynomial:
    return np.polynomial.Polynomial(np.linalg.solve(np.vander(u, increasing=True), v))


def _best(curve: _Curve, up: Number, sign: float) -> tuple[float, float]:
    """Where the curve, or its negative, is highest: the best of its highest poses, refined."""
    highest = float(up.max())
    finite = up[np.isfinite(up)]
    # poses whose interpolated value may pass that of the highest one
    reach = MOST_ADDED[curve.is_length] * float(np.max(np.abs(np.diff(finite, 2)), initial=0.0))
    inner = np.pad(up, 1, constant_values=-np.inf)
    tops = (up >= inner[:-2]) & (up >= inner[2:]) & (up >= highest - reach) & np.isfinite(up)
    found = [_refined(curve, up, sign, int(k)) for k in np.flatnonzero(tops)]
    best = max(value for _, value in found)
    place, value = next(one for one in found if one[1] >= best - CONSTANT * float(np.ptp(finite)))
    return place, sign * value


def _refined(curve: _Curve, up: Number, sign: float, k: int) -> tuple[float, float]:
    """The vertex of the polynomial through the poses around a pose that is higher than its neighbours."""
    own = float(curve.x[k]), float(up[k])
    three = curve.around(k, 1)
    if three is None:
        return own
    before, after = (np.abs(three.y) if three.is_length else three.y)[[0, 2]] * sign
    most = MOST_ADDED[curve.is_length] * abs(before - 2.0 * own[1] + after)
    for window in (curve.around(k, 2), three):
        for place, value in window.vertices() if window is not None else ():
            if 0.0 <= sign * value - own[1] <= most:
                return place, sign * value
    return own
