"""Designs as points: scatter matrices of dimensions and figures, and Pareto fronts of two figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.studies.study_program import StudyColumn
from compoundkin.studies.study_result import StudyResult, pareto_rows
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel, broken_label, value_text
from compoundkin.view.plot.plot_style import COLOURS, FAINT, GREY, INK, Plot
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.study_columns import StudyColumns, drawn_rows, histogram_bins, title_with_summary

# So wide and high is a panel, and what stands beside and above all of them, inches.
PANEL, BESIDE = 1.45, 1.5
# The least width: a title has room.
NARROWEST = 7.0
# More columns than these cannot be read; the first ones are drawn where none is named.
MOST_COLUMNS = 8
# Characters that a panel has room for beside it, and ticks.
ROOM, TICKS = 19, 3
# Dots take so large an area all together, square points; one has so much at least and at most. A cross takes more.
ALL, SMALL, LARGE, CROSS = 4500.0, 1.5, 16.0, 1.8
# Free space at the ends of a column's range, a part of it.
EDGE = 0.05
# Of fewer designs than these no correlation is given.
FEWEST = 3


@dataclass(frozen=True, eq=False)
class MatrixDrawing:
    """The data of all panels: columns of the drawn designs, and their colours."""

    columns: tuple[Plotted, ...]
    assembled: Number
    shades: Any

    @property
    def dot(self) -> float:
        """The area of a dot."""
        return float(np.clip(ALL / max(1, len(self.assembled)), SMALL, LARGE))

    def panel(self, axes: Any, x: Plotted, y: Plotted) -> None:
        """Draw two columns against each other; designs that cannot be assembled are crosses."""
        missing = ~self.assembled
        axes.scatter(x.values[missing], y.values[missing], s=CROSS * self.dot, marker="x", color=FAINT, linewidths=0.9,
                     rasterized=True, zorder=1.5)  # fmt: skip
        own, look = self.assembled, {"s": self.dot, "linewidths": 0.0, "rasterized": True, "zorder": 2.0}
        colour = {"color": COLOURS[0]} if self.shades is None else {"c": self.shades[own], **self.scale}
        axes.scatter(x.values[own], y.values[own], **look, **colour)

    @property
    def scale(self) -> dict[str, Any]:
        """The colours of values, and which values they are for."""
        known = self.shades[np.isfinite(self.shades)]
        low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        return {"cmap": plot_style.FAMILY, "vmin": low, "vmax": high}

    def distribution(self, axes: Any, x: Plotted) -> None:
        """Draw how often values are. Designs that cannot be assembled are on top."""
        edges = histogram_bins(x.values, x.scale)
        parts = [x.values[self.assembled & np.isfinite(x.values)], x.values[~self.assembled & np.isfinite(x.values)]]
        axes.hist(parts, bins=edges, stacked=True, color=[COLOURS[0], FAINT])

    def correlation(self, axes: Any, x: Plotted, y: Plotted) -> None:
        """Write the rank correlation, larger where it is stronger."""
        axes.axis("off")
        found = rank_correlation(x.values[self.assembled], y.values[self.assembled])
        text, colour = ("", GREY) if found is None else (value_text(round(found, 2)), INK)
        size = plot_style.SMALL_PRINT + 6.0 * abs(found or 0.0)
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=size, color=colour)


@checked
def scatter_matrix(
    result: StudyResult,
    *names: str,
    colour: str | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw dimensions and figures of a study's designs against each other.

    `names` are columns with one number for each design, points being two; without any, all of them, at most eight. On
    the diagonal stands how often each value is, above it Spearman's rank correlation of the assembled designs drawn.
    Designs that cannot be assembled over the whole motion are grey crosses. With `colour` the dots have the colour of a
    column. Angles are in degrees, `size` in inches. Of very many designs some thousands are drawn, which the plot says.

    Raises UnknownName for columns that are unknown, InvalidInput for courses or without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.study import study
    >>> free = {"crank.B.x": (1.8, 2.2), "coupler.C.x": (5.5, 6.5)}
    >>> result = study(load("crank-rocker"), free, "rocker.angle.stroke", count=64).run()
    >>> len(scatter_matrix(result).figure.axes)
    9
    """
    among = StudyColumns(result)
    chosen = among.figures(names)
    shown = chosen if names else chosen[:MOST_COLUMNS]
    by = None if colour is None else among.figure(colour)
    rows = drawn_rows(len(result))
    shades = None if by is None else among.values(by, rows)
    columns = tuple(among.values(one, rows) for one in shown)
    drawing = MatrixDrawing(columns, among.assembled(rows), None if shades is None else shades.values)
    wide = max(NARROWEST, PANEL * len(columns) + BESIDE)
    with plot_style.styled():
        some = f"the first {len(shown)} of {len(chosen)} columns" if shown != chosen else ""
        text = title_with_summary(among.title if title is None else title, among.summary(len(rows), len(result)), some)
        figure, axes = canvas.panels(len(columns), text, size or (wide, PANEL * len(columns) + BESIDE), len(columns),
                                     sharex="col")  # fmt: skip
        _panels(np.reshape(np.array(axes, dtype=object), (len(columns), len(columns))), drawing)
        if shades is not None and np.isfinite(shades.values).any():
            _scale(figure, axes, drawing, shades)
        _legend(figure, drawing)
        return canvas.finished(figure, ())


def rank_correlation(x: Number, y: Number) -> float | None:
    """Return Spearman's rank correlation of two columns, of rows known in both.

    It is None where there are too few, or where one does not change.

    >>> rank_correlation(np.array([1.0, 2.0, 3.0, np.nan]), np.array([1.0, 8.0, 27.0, 0.0]))
    1.0
    """
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < FEWEST or any(canvas.constant_limits(one, 0.0) for one in (x, y)):
        return None
    from scipy.stats import spearmanr

    return float(spearmanr(x, y).statistic)


def _panels(grid: Number, drawing: MatrixDrawing) -> None:
    """Draw all panels; names and ticks stand at the left and below."""
    last = len(drawing.columns) - 1
    for (row, column), axes in np.ndenumerate(grid):
        x, y = drawing.columns[column], drawing.columns[row]
        if row == column:
            drawing.distribution(axes, x)
            axes.set_yticks([])
        elif row < column:
            drawing.correlation(axes, x, y)
        else:
            drawing.panel(axes, x, y)
        if row == last:
            axes.set_xlabel(broken_label(x.label, ROOM), fontsize=plot_style.SMALL_PRINT)
        if column == 0:
            axes.set_ylabel(broken_label(y.label, ROOM), fontsize=plot_style.SMALL_PRINT)
        if 0 < column < row:
            axes.tick_params(labelleft=False)
        axes.tick_params(labelsize=plot_style.SMALL_PRINT - 1.0)
    _ranges(grid, drawing)


def _ranges(grid: Number, drawing: MatrixDrawing) -> None:
    """Set equal ranges of a column wherever it is drawn, and their ticks."""
    for k, column in enumerate(drawing.columns):
        known = column.values[np.isfinite(column.values)]
        if not len(known):
            for axes in grid[k, : k + 1]:
                canvas.write_empty(axes)
            grid[-1, k].set_xticks([])
            continue
        edge = EDGE * np.ptp(known)
        grid[0, k].set_xlim(*(canvas.constant_limits(known, column.scale) or (known.min() - edge, known.max() + edge)))
        canvas.set_round_ticks(grid[0, k].xaxis, column.is_angle, TICKS)
        grid[-1, k].ticklabel_format(axis="x", useOffset=False)
        for axes in grid[k, :k]:
            axes.set_ylim(grid[0, k].get_xlim())
            canvas.set_round_ticks(axes.yaxis, column.is_angle, TICKS)
            axes.ticklabel_format(axis="y", useOffset=False)


def _scale(figure: Any, axes: Sequence[Any], drawing: MatrixDrawing, shades: Plotted) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    scale = drawing.scale
    bar = figure.colorbar(ScalarMappable(Normalize(scale["vmin"], scale["vmax"]), scale["cmap"]), ax=list(axes),
                          aspect=35, pad=0.02)  # fmt: skip
    bar.set_label(shades.label)
    bar.outline.set_visible(False)


def _legend(figure: Any, drawing: MatrixDrawing) -> None:
    from matplotlib.lines import Line2D

    if not drawing.assembled.all():
        look: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": FAINT}
        canvas.legend_below(figure, [Line2D([], [], **look, label="cannot be assembled over the whole motion")])


SIZE = (7.0, 5.0)
# Beside so many rows of the front at most stand their numbers.
NAMED = 12
# Dots of all designs, and of the front.
DESIGN_DOT, FRONT_DOT = 6.0, 22.0
LOOK: Mapping[str, Any] = MappingProxyType({"linewidths": 0.0, "rasterized": True, "clip_on": False})


@checked
def pareto(
    result: StudyResult,
    first: str,
    second: str,
    *,
    greatest: Sequence[str] = (),
    colour: str | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw two figures of designs against each other, and the front of the best.

    On the front are the assembled designs of which no other one is better in one figure and no worse in the other.
    Better is less; of the figures in `greatest` it is more. The front is that of all designs; of the others some
    thousands are drawn. Rows of the front have their numbers, for `result.mechanism(row)`, where they are few. With
    `colour` the dots have the colour of a column.

    Raises UnknownName for columns that are unknown, InvalidInput for courses or without Matplotlib. Source of the
    name: V. Pareto, Manuale di economia politica (1906).

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.study import study
    >>> free, outputs = {"crank.B.x": (1.8, 2.2)}, ["rocker.angle.stroke", "rocker.angle.least"]
    >>> result = study(load("crank-rocker"), free, outputs, count=64).run()
    >>> pareto(result, *outputs, greatest=["rocker.angle.stroke"]).figure.axes[0].get_xlabel()
    'rocker.angle.stroke [°], greatest'
    """
    among = StudyColumns(result)
    upward = _upward((first, second), greatest)
    figures = [among.figure(name) for name in (first, second)]
    by = None if colour is None else among.figure(colour)
    known, front = known_and_best(among, figures, upward)
    others = np.setdiff1d(_known_rows(among, figures, drawn_rows(known.count)), front)
    rows = np.concatenate([others, front])
    both = [replace(among.values(one, rows), scale=known.scale(k)) for k, one in enumerate(figures)]
    dots = FrontDrawing(both, len(others), front, None if by is None else among.values(by, rows))
    with plot_style.styled():
        missing = "" if known.count else "none has both figures"
        text = title_with_summary(
            among.title if title is None else title, among.summary(len(rows), known.count), missing
        )
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        dots.draw(figure, axes)
        _axes(axes, both, upward, known)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, dots.numbers(axes, upward))


def _upward(both: Sequence[str], greatest: Sequence[str]) -> list[bool]:
    """Whether more is better, for each figure. Raises InvalidInput for unknown figures."""
    wrong = next((one for one in greatest if one not in both), None)
    if wrong is not None:
        raise InvalidInput(Problem("greatest", f"{wrong!r} is neither figure", suggestion(str(wrong), list(both))))
    return [name in greatest for name in both]


@dataclass(frozen=True, eq=False)
class KnownDesigns:
    """How many designs have two figures, and the least and the greatest value of each, (figures, 2)."""

    count: int
    ends: Number

    def scale(self, figure: int) -> float:
        """Return the greatest size of a figure."""
        return float(np.max(np.abs(self.ends[figure]), initial=0.0)) if self.count else 0.0


def known_and_best(
    among: StudyColumns, figures: Sequence[StudyColumn], upward: Sequence[bool]
) -> tuple[KnownDesigns, Number]:
    """Return the designs that are assembled and have two figures, and the rows of the front of these.

    The front of all is that of the fronts of their pieces.
    """
    signs = [-1.0 if up else 1.0 for up in upward]
    rows, best, count = np.empty(0, dtype=int), np.empty((2, 0)), 0
    ends = np.array([[np.inf, -np.inf]] * 2)
    for places, values in among.pieces(*figures):
        if not len(places):
            continue
        count += len(places)
        for k, own in enumerate(values):
            ends[k] = min(ends[k, 0], own.min()), max(ends[k, 1], own.max())
        signed = np.stack([sign * own for sign, own in zip(signs, values, strict=True)])
        if len(rows):
            # most are worse than a row of the front so far: that with the next lesser first figure tells
            before = np.searchsorted(best[0], signed[0], side="right") - 1
            may = (before < 0) | (best[1][before] >= signed[1])
            places, signed = places[may], signed[:, may]
        rows, best = np.concatenate([rows, places]), np.concatenate([best, signed], axis=1)
        front = pareto_rows(*best)
        rows, best = rows[front], best[:, front]
    return KnownDesigns(count, ends), rows


def _known_rows(among: StudyColumns, figures: Sequence[StudyColumn], which: Number) -> Number:
    """Return the rows of some of the designs that have both figures, by their numbers among these."""
    found, start = [np.empty(0, dtype=int)], 0
    for places, _ in among.pieces(*figures):
        found.append(places[which[(which >= start) & (which < start + len(places))] - start])
        start += len(places)
    return np.concatenate(found)


def _label(figure: Plotted, upward: bool) -> str:
    return f"{figure.label}, {'greatest' if upward else 'least'}"


@dataclass(frozen=True, eq=False)
class FrontDrawing:
    """Two figures of the designs that are drawn: of `others`, so many, and then of the rows of the `front`."""

    both: Sequence[Plotted]
    others: int
    front: Number
    shades: Plotted | None

    def draw(self, figure: Any, axes: Any) -> None:
        """Draw all as dots, and the front as steps."""
        (x, ahead_x), (y, ahead_y) = (np.split(one.values, [self.others]) for one in self.both)
        axes.plot(ahead_x, ahead_y, color=COLOURS[1], linewidth=1.0, drawstyle="steps-post", zorder=0.9, label="_front")
        if self.shades is None:
            if self.others:
                axes.scatter(x, y, s=DESIGN_DOT, color=FAINT, label="other designs", **LOOK)
            axes.scatter(ahead_x, ahead_y, s=FRONT_DOT, color=COLOURS[1], zorder=3.0, label="front", **LOOK)
            return
        sizes = np.where(np.arange(len(self.shades.values)) < self.others, DESIGN_DOT, FRONT_DOT)
        shown = axes.scatter(*(one.values for one in self.both), s=sizes, c=self.shades.values,
                             cmap=plot_style.FAMILY, **LOOK)  # fmt: skip
        ring = {**LOOK, "linewidths": 1.0}
        axes.scatter(ahead_x, ahead_y, s=FRONT_DOT, facecolors="none", edgecolors=COLOURS[1], label="front", **ring)
        bar = figure.colorbar(shown, ax=axes, aspect=35, pad=0.02)
        bar.set_label(self.shades.label)
        bar.outline.set_visible(False)

    def numbers(self, axes: Any, upward: Sequence[bool]) -> list[PointLabel]:
        """Return the rows of the front, beyond it; left out on a long front."""
        beyond = complex(*(1.0 if up else -1.0 for up in upward))
        places = zip(*(one.values[self.others :].tolist() for one in self.both), self.front.tolist(), strict=True)
        named = places if len(self.front) <= NAMED else ()
        return [PointLabel(axes, x, y, str(row), beyond, COLOURS[1]) for x, y, row in named]


def _axes(axes: Any, both: Sequence[Plotted], upward: Sequence[bool], known: KnownDesigns) -> None:
    """Name the axes, and set their ranges and ticks."""
    axes.set_xlabel(_label(both[0], upward[0]))
    axes.set_ylabel(_label(both[1], upward[1]))
    if not known.count:
        canvas.write_empty(axes)
        axes.set_xticks([])
        return
    drawn = zip((axes.xaxis, axes.yaxis), both, known.ends, (canvas.ACROSS, canvas.UPWARDS), strict=True)
    for axis, one, ends, most in drawn:
        still = canvas.constant_limits(ends, one.scale)
        if still is not None:
            axes.set(**{f"{axis.axis_name}lim": still})
        canvas.set_round_ticks(axis, one.is_angle, most)
