"""Curves in a plane: lines with their direction, and marks at every so many poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.marked_places import Events, events
from compoundkin.view.plot.plotted_rows import Plotted, along
from compoundkin.view.plot.point_labels import PointLabel, number

# About so many marks along a curve, where it is not said after how many poses they come.
MARKS = 12
# Nearer than this part of a curve's size to the first one, the last mark is the same.
SAME = 1e-6


@dataclass(frozen=True, eq=False)
class SharedCurves:
    """What all curves of a plot share. The driver or time, events, names of designs, labels to be placed."""

    x: Plotted
    happened: Events
    called: Sequence[str]
    every: int
    labels: list[PointLabel]

    @property
    def designs(self) -> int:
        """How many designs there are."""
        return len(self.x.values)


def drawing(motion: Motion, designs: Sequence[str], every: int | None) -> SharedCurves:
    """Return what the curves of a plot share. Raises InvalidInput for wrong names or distances of marks."""
    x, _ = along(motion, None)
    called = canvas.design_names(motion.shape, designs)
    if every is not None and every < 1:
        raise InvalidInput(Problem("every", f"{every} is no number of poses", "give 1 or more, or leave it out"))
    default = max(1, round((motion.inputs.poses - 1) / MARKS))
    return SharedCurves(x, events(motion), called, every or default, [])


def curve(axes: Any, shared: SharedCurves, d: int, z: Number, colour: Any, name: str) -> None:
    """Draw one curve with an arrow, and rings next to limit positions. The curve is complex, pose by pose."""
    axes.plot(z.real, z.imag, color=colour, label=name)
    canvas.arrow(axes, z.real, z.imag, colour)
    beside = shared.happened.beside(d, len(z))
    canvas.ring(axes, z.real[beside], z.imag[beside], colour)


def curves(axes: Any, shared: SharedCurves, drawn: Sequence[Number], names: Sequence[str]) -> None:
    """Draw curves of all designs with their marks, in their colours.

    The colours are their own or, where there are several, of designs.
    """
    shades: Any = plot_style.colours(len(drawn), shared.designs)
    for k, (rows, name) in enumerate(zip(drawn, names, strict=True)):
        for d in range(shared.designs):
            colour = shades[k if shared.designs == 1 else d]
            curve(axes, shared, d, rows[d], colour, name)
            marks(axes, shared, d, rows[d], colour, shared.designs == len(drawn) == 1)


def marks(axes: Any, shared: SharedCurves, d: int, z: Number, colour: Any, labelled: bool = True) -> None:
    """Draw dots at every so many poses, with the driver's value or time. Large families have none."""
    if shared.designs > canvas.LISTED:
        return
    index = np.arange(0, len(z), shared.every)
    index = index[np.isfinite(z[index])]
    if not len(index):
        return
    known = z[np.isfinite(z)]
    size = float(np.max(np.abs(known - known[0])))
    index = index[(index == index[0]) | (np.abs(z[index] - z[index[0]]) > SAME * size)]
    canvas.dot(axes, z[index].real, z[index].imag, colour, 3.5)
    middle = complex(np.mean(known))
    unit = "°" if shared.x.is_angle else ""
    for k in index if labelled else ():
        away = complex(z[k]) - middle
        text = number(float(shared.x.values[d, k]), shared.x.scale) + unit
        shared.labels.append(PointLabel(axes, z[k].real, z[k].imag, text, away if away else 1j, plot_style.GREY))


def finish(figure: Any, axes: Sequence[Any], shared: SharedCurves, marked: bool) -> None:
    """Draw the legends of curves, designs, rings and marks."""
    if shared.designs > 1:
        canvas.designs_legend(figure, axes, shared.called)
    else:
        for one in axes:
            canvas.legend(one)
    limits = any(any(blank.limits) for blank in shared.happened.blanks)
    what = f"every {shared.every} poses: {shared.x.label}" if shared.every > 1 else f"every pose: {shared.x.label}"
    canvas.events_legend(figure, False, limits, False, what if marked and shared.designs <= canvas.LISTED else "")
