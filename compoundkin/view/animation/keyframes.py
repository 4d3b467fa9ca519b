"""Keyframes: values over time as straight lines between few of them, and as attributes of SVG."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import whole_turns
from compoundkin.base.series import Number
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.picture import BETWEEN, MOST_PLACES, smooth

# What is between keyframes may be off by this much, picture units: with two of them and rounding less than 0.2.
DEVIATION = 0.09
# So many intervals of even length are tried; an even key is written in half the letters, for it needs no time.
EVEN = tuple(n for n in range(2, 721) if 720 % n == 0 or (n > 90 and n % 12 == 0))
CHEAPER = 1.6
# Times that differ by less are one.
SAME_TIME = 1e-6
# Digits after the point: of times in parts of the whole, of places, of degrees.
OF_TIMES, OF_PLACES, OF_DEGREES = 5, 2, 2
# What is not on the picture waits here.
AWAY = -1000.0 - 1000.0j


@dataclass(frozen=True, eq=False)
class Keys:
    """Times from 0 to 1 and the values there, (times, columns). Two equal times where the values leap.

    `is_even` where the times are as far apart as they can be, `is_steady` where values stay until the next time.
    """

    times: Number
    values: Number
    is_even: bool = False
    is_steady: bool = False


def keys_of(
    timeline: Timeline,
    values: Number,
    deviation: float,
    one_by_one: bool = False,
    shown: Number | None = None,
    away: complex = 0j,
) -> Keys:
    """Return the keyframes of values at the poses of a timeline.

    They are (poses,) or (poses, columns), complex or real.

    Where they are not `shown` they are `away`; poses may be shown `one_by_one`.
    """
    columns = np.asarray(values).reshape(len(values), -1)
    seen = np.ones(len(columns), dtype=bool) if shown is None else np.asarray(shown)
    if one_by_one:
        return _one_by_one(timeline, np.where(seen[:, None], columns, away) if shown is not None else columns)
    parts = [part for leg in timeline.slices for part in _parted(leg, seen)]
    runs = [_run(timeline.times[part], columns[part], bool(seen[part].all()), away) for part in parts]
    thin = [(t[keep], v[keep]) for t, v in runs for keep in [_needed(t, v, deviation)]]
    found = _distinct(*_joined(thin))
    even = _even(*_joined(runs), deviation, CHEAPER * len(found.times))
    return found if even is None or len(found.times) < 3 else even


def _joined(runs: list[tuple[Number, Number]]) -> tuple[Number, Number]:
    return np.concatenate([times for times, _ in runs]), np.concatenate([values for _, values in runs])


def _run(times: Number, values: Number, seen: bool, away: complex) -> tuple[Number, Number]:
    """Times and values with those between them; of what is not seen, the first and the last time."""
    return _smoothed(times, values) if seen else (times[[0, -1]], np.full((2, values.shape[1]), away))


def _even(times: Number, values: Number, deviation: float, most: float) -> Keys | None:
    """As few values as will do at even times, which need not be written; None where too many are needed."""
    for count in (count for count in EVEN if count < most):
        asked = np.linspace(0.0, 1.0, count + 1)
        found = np.stack([np.interp(asked, times, column) for column in values.T], axis=1)
        lines = np.stack([np.interp(times, asked, column) for column in found.T], axis=1)
        if np.max(np.abs(lines - values)) <= deviation:
            return Keys(asked, found, is_even=True)
    return None


def _parted(leg: slice, seen: Number) -> list[slice]:
    """A leg in parts that are shown throughout, and those between them."""
    cuts = leg.start + 1 + np.flatnonzero(np.diff(seen[leg].astype(int)))
    parts = pairwise([leg.start, *(int(cut) for cut in cuts), leg.stop])
    # what is not shown lasts from the last pose that is to the next one
    return [slice(a, b) if seen[a] else slice(max(a - 1, leg.start), min(b + 1, leg.stop)) for a, b in parts]


def _smoothed(times: Number, values: Number) -> tuple[Number, Number]:
    """Times and values with those between them, on a smooth line, where they are few."""
    if not 3 <= len(values) <= MOST_PLACES:
        return times, values
    between = np.linspace(0.0, 1.0, BETWEEN + 1)[:-1]
    full = np.append((times[:-1, None] + np.diff(times)[:, None] * between).ravel(), times[-1])
    return full, np.stack([_line(values[:, k]) for k in range(values.shape[1])], axis=1)


def _line(values: Number) -> Number:
    if np.ptp(np.real(values)) + np.ptp(np.imag(values)) == 0.0:
        return np.full((len(values) - 1) * BETWEEN + 1, values[0])
    line = smooth(np.asarray(values, dtype=complex))
    return line if np.iscomplexobj(values) else line.real


def _needed(times: Number, values: Number, deviation: float) -> Number:
    """Which values are needed so that lines between them in time are nowhere off by more than a deviation.

    Source: the division of D. Douglas and T. Peucker, 1973, with deviations at the same time.
    """
    keep = np.zeros(len(times), dtype=bool)
    keep[[0, -1]] = True
    parts = [(0, len(times) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        whole = times[last] - times[first]
        share = (times[first + 1 : last] - times[first]) / whole if whole > 0 else np.zeros(last - first - 1)
        line = values[first] + share[:, None] * (values[last] - values[first])
        off = np.max(np.abs(values[first + 1 : last] - line), axis=1)
        worst = int(np.argmax(off))
        if off[worst] > deviation:
            middle = first + 1 + worst
            keep[middle] = True
            parts += [(first, middle), (middle, last)]
    return keep


def _one_by_one(timeline: Timeline, values: Number) -> Keys:
    """Every pose until the next one; the end of what returns is its beginning."""
    times = timeline.times
    kept = times < 1.0 if timeline.returns else np.ones(len(times), dtype=bool)
    if not timeline.returns and len(times) > 1:
        # the last pose is shown as long as the others
        times = times * (1.0 - 1.0 / len(times))
    keys = _distinct(times[kept], values[kept])
    even = np.arange(len(keys.times)) / len(keys.times)
    if len(even) > 1 and np.max(np.abs(keys.times - even)) < SAME_TIME:
        return replace(keys, is_even=True, is_steady=True)
    return _distinct(times[kept], values[kept], steady=True)


def _distinct(times: Number, values: Number, steady: bool = False) -> Keys:
    """Keys without those that repeat the one before; a single one where nothing changes."""
    if np.all(values == values[:1]):
        return Keys(times[:1], values[:1], is_steady=steady)
    same = (np.diff(times) == 0.0) & np.all(np.diff(values, axis=0) == 0.0, axis=1)
    if steady:
        same |= np.all(np.diff(values, axis=0) == 0.0, axis=1)
    kept = np.concatenate([[True], ~same])
    return Keys(times[kept], values[kept], is_steady=steady)


def short(value: float, digits: int) -> str:
    """Return a number as a short text.

    >>> short(0.25, 2), short(10.0, 2), short(-0.001, 2), short(-0.5, 1)
    ('.25', '10', '0', '-.5')
    """
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    if text in ("-0", "0", ""):
        return "0"
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


@dataclass(frozen=True, eq=False)
class Writer:
    """Writes keyframes of a timeline; `one_by_one` where poses are shown so."""

    timeline: Timeline
    one_by_one: bool

    def keys(self, values: Number, deviation: float = DEVIATION, shown: Number | None = None) -> Keys:
        """Return the keyframes of values at the poses of the timeline."""
        return keys_of(self.timeline, values, deviation, self.one_by_one, shown, AWAY)

    def timing(self, keys: Keys, written: Callable[[Number], str]) -> str:
        """Return the attributes that say which values there are when."""
        words = [f'dur="{short(self.timeline.seconds, 3)}s" repeatCount="indefinite"']
        words += ['calcMode="discrete"'] if keys.is_steady else []
        words += [] if keys.is_even else [f'keyTimes="{";".join(short(float(t), OF_TIMES) for t in keys.times)}"']
        return " ".join([*words, f'values="{";".join(map(written, keys.values))}"'])

    def moving(self, kind: str, keys: Keys, written: Callable[[Number], str], inside: list[str]) -> list[str]:
        """Return elements in a group that is moved ("translate") or turned ("rotate") by keyframes."""
        first = written(keys.values[0])
        if len(keys.times) == 1:
            return [f'<g transform="{kind}({first})">', *inside, "</g>"] if first.strip("0 ") else inside
        how = f'<animateTransform attributeName="transform" type="{kind}" {self.timing(keys, written)}/>'
        return [f'<g transform="{kind}({first})">', how, *inside, "</g>"]

    def translated(self, places: Number, inside: list[str], shown: Number | None = None) -> list[str]:
        """Return elements moved along places at the poses of the timeline."""
        return self.moving("translate", self.keys(places, shown=shown), place, inside)

    def turned(self, angles: Number, deviation: float, inside: list[str]) -> list[str]:
        """Return elements turned by angles over the assembled poses, radians, clockwise on the picture."""
        return self.moving("rotate", self.turns(angles, deviation), _degrees, inside)

    def turns(self, angles: Number, deviation: float) -> Keys:
        """Return the keyframes of those angles, in degrees."""
        shown = np.rad2deg(self.timeline.turning(angles))
        return self.keys(shown - whole_turns(shown[0], 360.0), np.rad2deg(deviation))


def place(value: Number) -> str:
    """Return a place as the specification of SVG has it."""
    return f"{short(float(value[0].real), OF_PLACES)} {short(float(value[0].imag), OF_PLACES)}"


def _degrees(value: Number) -> str:
    return short(float(value[0].real), OF_DEGREES)
