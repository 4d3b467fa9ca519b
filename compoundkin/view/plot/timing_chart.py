"""`timing_chart`: what every driver or cam of a machine does, one below the other over one axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.model.attributes import DEGREES, TIME
from compoundkin.model.mechanism import Mechanism
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.plot_style import GREY, INK, SHADE, SMALL_PRINT, Plot
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import number
from compoundkin.view.plot.timing_rows import Phase, TimingRow, rows

# Heights in inches.
FIRST, EACH = 1.1, 1.35
# Parts of the height of a row: the strip that names phases, and the room above and below the curve.
STRIP, BELOW, ABOVE = 0.17, 0.10, 0.12
# A character of small print takes this part of an inch, and this much of the width is not axes.
CHARACTER, MARGINS = 0.075, 1.1
# Times of events nearer to each other than this part of the width would be written over each other.
NEAR = 0.055
# More levels than these would crowd the vertical axis.
MOST_LEVELS = 5
# Levels nearer than this part of the range are one.
SAME_LEVEL = 0.12
SHADES: Mapping[int, str] = MappingProxyType({1: "#9ecae8", -1: "#f3c19b", 0: SHADE})
CURVE, TINT, DWELL = "#0072B2", "#eaf3f9", "#f4f4f4"


@checked
def timing_chart(
    what: Mechanism | Mapping[str, Any],
    *,
    over: Literal["time", "rotation"] | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw when each driver, or cam's follower, rises, falls and dwells.

    One row for each driver with a law, over the time; or, of a mechanism whose drivers have none, and with
    ``over="rotation"``, one for each cam made for a motion program, over a turn of the cam. Laws and programs may also
    be given by name, without a mechanism: their values are then as they are. Where something begins or ends, a line
    goes through all rows. The range is that of the mechanism's times, else of all laws. `size` is in inches.

    Raises InvalidInput where there is nothing to draw or nothing tells for how long, over the rotation for a program
    that does not take a turn, or without Matplotlib.

    >>> from compoundkin.model.laws import dwell, fall, program, rise
    >>> clamp, feed = program(rise(2, over=1), dwell(2), fall(2, over=1)), program(dwell(1), rise(30, over=2), dwell(1))
    >>> picture = timing_chart({"clamp": clamp, "feed": feed})
    >>> [axes.get_ylabel() for axes in picture.figure.axes]
    ['clamp', 'feed']
    """
    plot_style.require_matplotlib()
    along, shown = rows(what, over)
    low, high = min(row.between[0] for row in shown), max(row.between[1] for row in shown)
    text = what.title if isinstance(what, Mechanism) and title is None else title or ""
    wide = size or (canvas.WIDTH, FIRST + EACH * len(shown))
    with plot_style.styled():
        figure, axes = canvas.panels(len(shown), text, wide, sharex=True)
        axes[0].set_xlim(low, high)
        for one, row in zip(axes, shown, strict=True):
            _draw(one, row, (wide[0] - MARGINS) / (high - low), "°" if along != TIME else " s")
        _events(axes, shown)
        across = Plotted("time", "s", np.array([low, high])) if along == TIME else _turn(low, high)
        axes[-1].set_xlabel(across.label)
        canvas.ticks(axes[-1].xaxis, across.is_angle, canvas.ACROSS)
        figure.align_ylabels(axes)
        return canvas.finished(figure, [])


def _turn(low: float, high: float) -> Plotted:
    return Plotted("rotation of the cam", DEGREES, np.array([low, high]))


def _draw(axes: Any, row: TimingRow, inches: float, unit: str) -> None:
    """A row: its dwells shaded, its curve, its levels, and the strip with its phases."""
    x, values = row.curve
    low, high = float(values.min()), float(values.max())
    span = high - low or abs(high) or 1.0
    height = span / (1.0 - STRIP - BELOW - ABOVE)
    bottom = low - (STRIP + BELOW) * height
    axes.set_ylim(bottom, bottom + height)
    axes.grid(visible=False)
    axes.fill_between(x, low, values, color=TINT, linewidth=0, zorder=1)
    axes.plot(x, values, color=CURVE, zorder=3)
    for phase in row.phases:
        if not phase.sense:
            axes.axvspan(phase.begin, phase.end, STRIP, 1.0, color=DWELL, linewidth=0, zorder=0.5)
        _name(axes, phase, bottom + STRIP * height / 2.0, inches, unit)
    levels = _levels(row, values)
    axes.hlines(levels, x[0], x[-1], color=SHADE, linewidth=0.6, zorder=1.5)
    axes.set_yticks(levels, [number(level, span) for level in levels])
    label = Plotted(row.name, row.unit, values).label
    axes.set_ylabel("\n[".join(label.rsplit(" [", 1)), fontsize=None if len(label) <= canvas.PANEL else SMALL_PRINT)


def _name(axes: Any, phase: Phase, y: float, inches: float, unit: str) -> None:
    """A part of the strip, with as much of "rise 0.75 s" as it has room for."""
    axes.axvspan(phase.begin, phase.end, 0.0, STRIP, facecolor=SHADES[phase.sense], edgecolor="white",
                 linewidth=0.8, zorder=2)  # fmt: skip
    span = number(phase.end - phase.begin)
    room = (phase.end - phase.begin) * inches / CHARACTER
    text = next((text for text in (f"{phase.word} {span}{unit}", f"{span}{unit}", span) if len(text) <= room), "")
    axes.text((phase.begin + phase.end) / 2.0, y, text, ha="center", va="center", fontsize=SMALL_PRINT, color=INK,
              zorder=4, clip_on=True)  # fmt: skip


def _levels(row: TimingRow, values: Any) -> list[float]:
    """The values between phases, the highest and the lowest first; those too near to another one are left out."""
    low, high = row.between
    inside = np.array([x for x in row.breaks if low < x < high])
    # between the pieces of a law it need not pause
    pauses = inside[np.abs(row.moved(inside)[1]) <= row.still] if inside.size else inside
    places = np.array([low, high, *(phase.begin for phase in row.phases), *pauses])
    ends = row.moved(places)[0] * row.scale
    least = SAME_LEVEL * float(np.ptp(values))
    found: list[float] = []
    for value in [float(values.min()), float(values.max()), *(float(end) for end in ends)]:
        if len(found) < MOST_LEVELS and all(abs(value - other) > least for other in found):
            found.append(value)
    return sorted(found)


def _events(axes: Sequence[Any], shown: Iterable[TimingRow]) -> None:
    """Lines through all rows where something begins or ends, with their places on top."""
    low, high = axes[0].get_xlim()
    ends = [phase.end for row in shown for phase in row.phases[:-1]]
    places = sorted({float(np.round(x, 12)) for x in ends})
    for one in axes:
        for x in places:
            one.axvline(x, STRIP, color=GREY, linewidth=0.6, linestyle=(0, (1.5, 2.5)), zorder=2.5)
    last = low
    for x in places:
        if x - last > NEAR * (high - low):
            axes[0].annotate(number(x), (x, 1.0), (0, 3), xycoords=("data", "axes fraction"),
                             textcoords="offset points", ha="center", fontsize=SMALL_PRINT, color=GREY)  # fmt: skip
            last = x
