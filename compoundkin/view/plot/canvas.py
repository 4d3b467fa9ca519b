"""Figures and axes: their making, their ticks, legends and marks."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.view.plot.marked_places import CONSTANT
from compoundkin.view.plot.plot_style import GREY, INK, SHADE, SMALL_PRINT, Plot, colours
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import PointLabel, place

WIDTH = 7.0
# Characters of a title in a line.
TITLE = 78
# More designs than this get a scale of colours instead of a legend.
LISTED = 8
# Steps of ticks in degrees, as people count them.
DEGREES = (1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720)
ACROSS, UPWARDS = 9, 6
# Characters that the height of a panel and of a whole figure have room for.
PANEL, WHOLE = 24, 60
# The width of a letter in a legend, inches, and how many letters a handle is wide.
LETTER, HANDLE = 0.078, 9
# How poses next to limit positions are marked.
RING: Mapping[str, Any] = MappingProxyType(
    {"linestyle": "none", "marker": "o", "markersize": 5.5, "markerfacecolor": "white", "markeredgewidth": 1.2}
)


def panels(rows: int, title: str, size: tuple[float, float], columns: int = 1, **options: Any) -> tuple[Any, list[Any]]:
    """Make a figure with a title and its axes, row by row. Raises InvalidInput for a size that is none."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not all(0.0 < one < np.inf for one in size):
        raise InvalidInput(Problem("size", f"{size!r} is no size", "give width and height in inches, such as (7, 4)"))
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(textwrap.fill(title, TITLE), x=0.01, ha="left")
    grid = figure.subplots(rows, columns, squeeze=False, **options)
    return figure, list(grid.ravel())


def finished(figure: Any, labels: Sequence[PointLabel]) -> Plot:
    """Return the picture, its labels placed after everything else has its place."""
    place(figure, labels)
    return Plot(figure)


def degree_step(span: float, most: int) -> float | None:
    """Return the distance between ticks of degrees. None where the usual ones for decimal numbers suit.

    >>> degree_step(360.0, 9), degree_step(44.0, 6), degree_step(1.5, 6)
    (45, 10, None)
    """
    if span < DEGREES[1]:
        return None
    return next((step for step in DEGREES if span / step <= most), None)


def ticks(axis: Any, is_angle: bool, most: int) -> None:
    """Draw ticks at round numbers: of degrees at parts of a turn."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    low, high = axis.get_view_interval()
    step = degree_step(abs(high - low), most) if is_angle else None
    axis.set_major_locator(MultipleLocator(step) if step else MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)))


def axis_labels(axes: Any, x: Plotted | None, y: Plotted, room: int) -> None:
    """Write names and units, and set the ticks that suit them.

    The unit goes below a name with more than `room` characters.
    """
    if x is not None:
        axes.set_xlabel(x.label)
        ticks(axes.xaxis, x.is_angle, ACROSS)
    lines = y.label.rsplit(" [", 1) if len(y.label) > room else [y.label]
    small = {"fontsize": SMALL_PRINT} if len(lines[0]) > room else {}
    axes.set_ylabel("\n[".join(lines), **small)
    ticks(axes.yaxis, y.is_angle, UPWARDS)


def steady(values: Number, scale: float) -> tuple[float, float] | None:
    """Return limits around values constant but for rounding. None where they are not.

    >>> steady(np.array([1.0, 1.0]), 1.0)
    (0.5, 1.5)
    """
    known = values[np.isfinite(values)]
    if not len(known) or np.ptp(known) > CONSTANT * max(scale, float(np.max(np.abs(known)))):
        return None
    middle = float(np.mean(known))
    half = abs(middle) / 2.0 if abs(middle) > CONSTANT * scale else scale or 1.0
    return middle - half, middle + half


def blank(axes: Any) -> None:
    """Say that there is nothing to draw, instead of ticks that mean nothing."""
    axes.text(0.5, 0.5, "no values", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_yticks([])


def plane(axes: Any, x: str, y: str) -> None:
    """Draw the axes of a plane: equal scales."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.margins(0.1)


def legend(axes: Any) -> None:
    """Draw the legend of an axes, above it at the right. It is drawn if there is more than one thing to distinguish."""
    handles, _ = axes.get_legend_handles_labels()
    if len(handles) > 1:
        columns = min(len(handles), 4)
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2)


def designs_legend(
    figure: Any, axes: Sequence[Any], names: Sequence[str], shades: Sequence[Any] = (), beside: bool = True
) -> None:
    """Say which colour is which design. Names beside the plot or above it, or a scale where there are many."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.lines import Line2D

    shades = shades or colours(1, len(names))
    if len(names) <= LISTED:
        handles = [Line2D([], [], color=colour, label=name) for colour, name in zip(shades, names, strict=True)]
        figure.legend(handles=handles, loc="outside right upper" if beside else "outside upper left")
        return
    from matplotlib.cm import ScalarMappable

    scale = LinearSegmentedColormap.from_list("designs", shades, N=len(names))
    bar = figure.colorbar(ScalarMappable(Normalize(-0.5, len(names) - 0.5), scale), ax=list(axes), aspect=35, pad=0.02)
    shown = np.unique(np.linspace(0, len(names) - 1, 6).round().astype(int))
    bar.set_ticks(shown.tolist(), labels=[names[k] for k in shown])
    bar.outline.set_visible(False)


def events_legend(figure: Any, gaps: bool, limits: bool, changes: bool, marks: str = "") -> None:
    """Say what the shades, rings, dashes and dots mean, below the plot."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if gaps:
        handles.append(Patch(color=SHADE, label="cannot be assembled"))
    if marks:
        handles.append(Line2D([], [], linestyle="none", marker="o", markersize=3.5, color=GREY, label=marks))
    if limits:
        handles.append(ring_handle("next to a gap"))
    if changes:
        handles.append(Line2D([], [], color=GREY, linestyle="--", linewidth=1.0, label="change point"))
    legend_below(figure, handles)


def legend_below(figure: Any, handles: Sequence[Any]) -> None:
    """Draw the legend of a whole figure below it. A long one has two rows."""
    if handles:
        letters = sum(len(one.get_label()) + HANDLE for one in handles)
        rows = 1 if letters * LETTER <= figure.get_figwidth() else 2
        figure.legend(handles=handles, loc="outside lower right", ncols=-(-len(handles) // rows))


def ring_handle(label: str) -> Any:
    """Return the legend's ring for a pose next to a gap."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **RING, color=INK, label=label)


def ring(axes: Any, x: Number, y: Number, colour: Any) -> None:
    """Draw rings around poses next to limit positions and ends of guides."""
    if len(x):
        axes.plot(x, y, **RING, color=colour, zorder=4)


def dot(axes: Any, x: Any, y: Any, colour: Any, size: float = 4.5) -> None:
    """Draw dots on a curve."""
    axes.plot(x, y, linestyle="none", marker="o", markersize=size, color=colour, zorder=5, clip_on=False)


def arrow(axes: Any, x: Number, y: Number, colour: Any) -> None:
    """Draw an arrow along a curve, an eighth of its poses after its begin. None where nothing moves."""
    known = np.isfinite(x) & np.isfinite(y)
    moves = np.flatnonzero(known[:-1] & known[1:] & ((np.diff(x) != 0) | (np.diff(y) != 0)))
    if len(moves):
        k = int(moves[len(moves) // 8])
        style = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 13}
        axes.annotate("", (x[k + 1], y[k + 1]), (x[k], y[k]), arrowprops=style, zorder=5)


def note(axes: Any, text: str) -> None:
    """Write a remark in small print above an axes, at the left."""
    axes.set_title(text, loc="left", fontsize=SMALL_PRINT, color=GREY)


def design_names(shape: tuple[int, ...], given: Sequence[str]) -> tuple[str, ...]:
    """Tell what designs are called: as given, or by their indices.

    >>> design_names((2, 5), ()), design_names((1, 2, 5), ())
    (('design 0', 'design 1'), ('design 0, 0', 'design 0, 1'))
    """
    indices = np.ndindex(*shape[:-1])
    return tuple(given) or tuple("design " + ", ".join(map(str, index)) for index in indices)
