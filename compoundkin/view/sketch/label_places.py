"""Where labels go: of some places for each the one that is in the way of least; the same every time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.sketch.label_obstacles import obstacles
from compoundkin.view.sketch.shapes import Shape

# Width of a letter in parts of its height, a little more than in the usual fonts.
WIDE = 0.62
# What it costs to be in the way: of another label, of the edge of the picture, of a line, of a circle.
LABEL, EDGE, LINE, ROUND = 1000.0, 4000.0, 12.0, 30.0
# Places are tried at so many directions and distances around a point.
DIRECTIONS = 16
RINGS = (0.0, 5.0, 11.0, 18.0, 27.0, 38.0, 52.0, 70.0)
AROUND = np.exp(2j * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
# What it costs to be a picture unit farther away.
FAR = 1.1
# Labels keep this distance.
ROOM = 1.5
# Costs that differ beyond these digits are equal: rounding must not decide.
DIGITS = 6
# What is drawn last is placed again so many times, when all others are known.
ROUNDS = 2


@dataclass(frozen=True)
class Label:
    """A label to be placed. Half its width and height, and its places in the order of preference, with their costs.

    `own` are lines that it may be on.
    """

    key: str
    half: complex
    places: tuple[complex, ...]
    costs: tuple[float, ...]
    own: tuple[tuple[complex, complex], ...] = ()

    def with_costs(self, more: Number) -> Label:
        """Return the same label, its places the dearer by some costs."""
        costs = tuple((np.array(self.costs) + more).tolist())
        return Label(self.key, self.half, self.places, costs, self.own)


def text_half(text: str, size: float) -> complex:
    """Return half the width and height of a line of text."""
    return complex(max(1, len(text)) * WIDE * size / 2.0, 0.42 * size)


def around(key: str, at: complex, half: complex, clear: float, prefer: complex = 1 - 1j) -> Label:
    """Return a label beside a point, from `clear` away on. Rather to the side `prefer`."""
    better = prefer / abs(prefer)
    reach = np.abs(AROUND.real) * half.real + np.abs(AROUND.imag) * half.imag
    rings = np.array(RINGS)[:, None]
    places = (at + AROUND * (clear + reach + rings)).ravel()
    costs = (FAR * rings + 2.5 * (1.0 - (np.conjugate(better) * AROUND).real)).ravel()
    return Label(key, half, tuple(places.tolist()), tuple(costs.tolist()))


def placed(labels: Sequence[Label], shapes: Iterable[Shape], width: float, height: float) -> dict[str, complex]:
    """Return a place for each label, in the order of the labels. All are placed again twice."""
    lines, rounds = obstacles(shapes)
    fixed = {}
    for label in labels:
        at, half = np.array(label.places), label.half + ROOM * (1 + 1j)
        covered = on_shapes(at, half, lines, rounds) + beyond(at, half, width, height)
        fixed[label.key] = np.array(label.costs) + covered - on_own(label, at, half)
    still = np.ones((1, len(labels)), dtype=complex)
    return settled(labels, fixed, LabelCrowd(labels, still, 0.0 * still))


def settled(labels: Sequence[Label], fixed: Mapping[str, Number], crowd: LabelCrowd) -> dict[str, complex]:
    """Return a place for each label. All are placed again twice, by fixed costs and those of being on others."""
    found: dict[str, complex] = {}
    for _ in range(1 + ROUNDS):
        for k, label in enumerate(labels):
            costs = fixed[label.key] + crowd.costs(k, label)
            found[label.key] = label.places[int(np.argmin(np.round(costs, DIGITS)))]
            crowd.put(k, found[label.key])
    return found


class LabelCrowd:
    """Where labels are at some poses, and what others cost there.

    Places are turned about zero, then shifted: complex (poses, labels), both.
    """

    def __init__(self, labels: Sequence[Label], turn: Number, shift: Number) -> None:
        self._turn, self._shift = turn, shift
        self._half = np.array([label.half for label in labels])
        # what is nowhere yet is near nothing
        self._middles: Number = np.full(turn.shape, complex(np.nan, np.nan))

    def put(self, k: int, place: complex) -> None:
        """Put a label at a place."""
        self._middles[:, k] = place * self._turn[:, k] + self._shift[:, k]

    def costs(self, k: int, label: Label) -> Number:
        """Return what each place of a label costs, on the average of the poses."""
        places = np.array(label.places) * self._turn[:, k, None] + self._shift[:, k, None]
        near = self._near(k, places)
        gap = places[:, :, None] - self._middles[:, None, near]
        found: Number = crowded(gap, label.half, self._half[near]).sum(axis=2).mean(axis=0)
        return found

    def _near(self, k: int, places: Number) -> Number:
        """Indices of the others that any of the places is near at any pose: of all else nothing is counted."""
        reach = self._half[k] + self._half + ROOM * (1 + 1j)
        x, y, at = places.real, places.imag, self._middles
        wide = (at.real - x.max(axis=1, keepdims=True) < reach.real) & (
            x.min(axis=1, keepdims=True) - at.real < reach.real
        )
        high = (at.imag - y.max(axis=1, keepdims=True) < reach.imag) & (
            y.min(axis=1, keepdims=True) - at.imag < reach.imag
        )
        near = (wide & high).any(axis=0)
        near[k] = False
        return np.flatnonzero(near)


def beyond(at: Number, half: complex, width: float, height: float) -> Number:
    """Return what it costs places to be outside the picture."""
    outside = np.maximum(0.0, half.real - at.real) + np.maximum(0.0, at.real + half.real - width)
    return EDGE * (outside + np.maximum(0.0, half.imag - at.imag) + np.maximum(0.0, at.imag + half.imag - height))


def on_own(label: Label, at: Number, half: complex) -> Number:
    """Return what `on_shapes` counts of lines that a label may be on."""
    return LINE * inside(at, half, np.array(label.own)).sum(axis=1) if label.own else 0.0


def on_shapes(at: Number, half: complex, lines: Number, rounds: Number) -> Number:
    """Return what it costs places to be on lines and circles."""
    costs: Number = np.zeros(len(at))
    lines = lines[_within(at, half, lines.real.min(axis=1), lines.real.max(axis=1), 1)] if len(lines) else lines
    lines = lines[_within(at, half, lines.imag.min(axis=1), lines.imag.max(axis=1), 1j)] if len(lines) else lines
    if len(lines):
        costs = costs + LINE * inside(at, half, lines).sum(axis=1)
    if len(rounds):
        gap = np.abs((at[:, None] - rounds[None, :, 0]).real) - half.real - rounds[None, :, 1].real
        high = np.abs((at[:, None] - rounds[None, :, 0]).imag) - half.imag - rounds[None, :, 1].real
        costs = costs + ROUND * ((gap < 0) & (high < 0)).sum(axis=1)
    return costs


def _within(at: Number, half: complex, low: Number, high: Number, axis: complex) -> Number:
    """Tell which of some ranges along an axis can be met by any of the places: the others cost nothing."""
    along, reach = (np.conjugate(axis) * at).real, half.real if axis == 1 else half.imag
    return (low <= along.max() + reach) & (high >= along.min() - reach)


def inside(at: Number, half: complex, lines: Number) -> Number:
    """Return the length of each line in the box around each place.

    It is in parts of the box's half diagonal, at least one.
    """
    a, d = lines[None, :, 0] - at[:, None], (lines[:, 1] - lines[:, 0])[None]
    low: Number = np.zeros(np.broadcast_shapes(a.shape, d.shape))
    high = np.ones_like(low)
    with np.errstate(divide="ignore", invalid="ignore"):
        for start, way, reach in ((a.real, d.real, half.real), (a.imag, d.imag, half.imag)):
            one, two = (-reach - start) / way, (reach - start) / way
            still = way == 0
            near, far = np.where(still, -np.inf, np.minimum(one, two)), np.where(still, np.inf, np.maximum(one, two))
            out = still & (np.abs(start) > reach)
            low, high = np.maximum(low, np.where(out, np.inf, near)), np.minimum(high, far)
    length = np.maximum(high - low, 0.0) * np.abs(d)
    return np.where(high > low, 1.0 + length / abs(half), 0.0)


def crowded(gap: Number, half: complex, others: Number) -> Number:
    """Return what it costs labels to be on others. `gap` is from middle to middle."""
    wide = half.real + others.real + ROOM - np.abs(gap.real)
    high = half.imag + others.imag + ROOM - np.abs(gap.imag)
    return LABEL * np.where((wide > 0) & (high > 0), 1.0 + np.minimum(wide, high), 0.0)
