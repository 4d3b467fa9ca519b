"""Short texts beside points, placed so that they cover neither each other nor the curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.plot.plot_style import INK, SMALL_PRINT

# Distance from a point to the edge of its text, in points.
CLEARANCE = 4.0
# Directions that are tried, as parts of a turn counterclockwise from the one that is wished for.
TURNS = (0.0, 0.125, -0.125, 0.25, -0.25, 0.375, -0.375, 0.5)
# A text that is farther away from its point: twice and three times the clearance, after all else.
FARTHER = (1.0, 2.5, 4.5)
# Points nearer to each other than so many pixels are one.
SAME = 3.0
# White around a text that keeps curves off it.
HALO = 1.5
# Places of a curve looked at, a few pixels from each other.
PLACES = 1500
# A value smaller than this part of its scale is zero but for interpolation.
NOTHING = 1e-6
# From where four digits would need a power of ten, and from where one is easier to read than the digits.
MANY_DIGITS, POWER_OF_TEN = 1e4, 1e6


@dataclass(frozen=True, eq=False)
class PointLabel:
    """A text that belongs to a point of an axes' plot. `towards` is the direction (complex) it is best put in."""

    axes: Any
    x: float
    y: float
    text: str
    towards: complex = 1j
    colour: Any = INK


def number(value: float, scale: float = 0.0) -> str:
    """Return a value in four digits, with a proper minus sign. Zero where it is nothing beside the scale.

    >>> number(-12.34567), number(12345.6), number(1e-14, 1.0)
    ('−12.35', '12346', '0')
    """
    if abs(value) <= NOTHING * scale:
        return "0"
    form = ".0f" if MANY_DIGITS <= abs(value) < POWER_OF_TEN else ".4g"
    return format(value, form).replace("-", "−")


def place(figure: Any, labels: Sequence[PointLabel]) -> None:
    """Write the labels, each where it covers least. One that finds no free place is left out."""
    figure.draw_without_rendering()
    # settled now: the labels are placed for this layout, and writing a file need not find it again
    figure.set_layout_engine("none")
    renderer = figure.canvas.get_renderer()
    scale = figure.dpi / 72.0
    taken: dict[Any, list[Number]] = {}
    curves: dict[Any, Number] = {}
    for label in _distinct(labels):
        written = _written(label)
        if label.axes not in curves:
            curves[label.axes], taken[label.axes] = _pixels(label.axes), []
        box = written.get_window_extent(renderer)
        half = np.array([box.width, box.height]) / 2.0 + HALO
        anchor = label.axes.transData.transform((label.x, label.y))
        found = _free(
            anchor, half, label.towards, scale, curves[label.axes], taken[label.axes], label.axes.bbox.extents
        )
        if found is None:
            written.remove()
            continue
        taken[label.axes].append(np.concatenate([found - half, found + half]))
        written.set_position(tuple((found - anchor) / scale))


def _distinct(labels: Sequence[PointLabel]) -> list[PointLabel]:
    """The labels without those that say the same of the same place: of a component that is the whole length."""
    found: list[PointLabel] = []
    for label in labels:
        place = label.axes.transData.transform((label.x, label.y))
        same = (one for one in found if (one.axes, one.text) == (label.axes, label.text))
        if all(np.abs(place - one.axes.transData.transform((one.x, one.y))).max() > SAME for one in same):
            found.append(label)
    return found


def _written(label: PointLabel) -> Any:
    from matplotlib.patheffects import withStroke

    written = label.axes.annotate(
        label.text,
        (label.x, label.y),
        (0.0, 0.0),
        textcoords="offset points",
        ha="center",
        va="center",
        color=label.colour,
        fontsize=SMALL_PRINT,
        path_effects=[withStroke(linewidth=2.0 * HALO, foreground="white")],
        zorder=6,
    )
    # where it stands is settled here; the layout must not move the axes for it again
    written.set_in_layout(False)
    return written


def _free(
    anchor: Number, half: Number, towards: complex, scale: float, curves: Number, taken: list[Number], inside: Number
) -> Number | None:
    """The middle of the place that covers least of the curves, and nothing else; None where there is none."""
    best, least = None, np.inf
    for farther in FARTHER:
        for turn in TURNS:
            way = towards / abs(towards) * np.exp(2j * np.pi * turn)
            heading = np.array([way.real, way.imag])
            middle = anchor + heading * (CLEARANCE * scale * farther + half)
            low, high = middle - half, middle + half
            if (low < inside[:2]).any() or (high > inside[2:]).any() or any(_overlap(low, high, b) for b in taken):
                continue
            covered = int(((curves > low) & (curves < high)).all(axis=1).sum())
            if covered < least:
                best, least = middle, covered
        if least == 0:
            break
    return best


def _overlap(low: Number, high: Number, box: Number) -> bool:
    return bool((low < box[2:]).all() and (high > box[:2]).all())


def _pixels(axes: Any) -> Number:
    """Places of all curves of an axes on the canvas, close to each other."""
    found = [np.zeros((0, 2))]
    for line in axes.get_lines():
        if line.get_transform() != axes.transData or len(line.get_xdata()) < 2:
            continue
        corners = axes.transData.transform(np.column_stack([line.get_xdata(), line.get_ydata()]).astype(float))
        steps = np.linspace(0.0, len(corners) - 1.0, PLACES)
        found.append(np.column_stack([np.interp(steps, np.arange(len(corners)), corners[:, k]) for k in (0, 1)]))
    return np.concatenate(found)
