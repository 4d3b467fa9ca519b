"""Pareto fronts: designs of which no other one is better in both of two figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.series import Number
from compoundkin.studies.runs.pareto_rows import pareto_rows
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.plot_style import COLOURS, FAINT, Plot
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import PointLabel
from compoundkin.view.plot.study_columns import StudyColumns, drawn_rows, headed

SIZE = (7.0, 5.0)
# Beside so many rows of the front at most stand their numbers.
NAMED = 12
# Dots of all designs, and of the front.
DOT, LARGE = 6.0, 22.0
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

    Raises UnknownName for columns that there are not, InvalidInput for courses or without Matplotlib. Source of the
    name: V. Pareto, Manuale di economia politica (1906).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.study import study
    >>> free, asked = {"crank.B.x": (1.8, 2.2)}, ["rocker.angle.stroke", "rocker.angle.least"]
    >>> result = study(load_named("crank-rocker"), free, asked, count=64).run()
    >>> pareto(result, *asked, greatest=["rocker.angle.stroke"]).figure.axes[0].get_xlabel()
    'rocker.angle.stroke [deg], greatest'
    """
    among = StudyColumns(result)
    upward = _upward((first, second), greatest)
    both = [among.values(among.figure(name)) for name in (first, second)]
    shades = None if colour is None else among.values(among.figure(colour))
    front = front_rows(both, among.assembled, upward)
    known = np.flatnonzero(among.assembled & np.isfinite(both[0].values) & np.isfinite(both[1].values))
    others = np.setdiff1d(drawn_rows(known), front)
    with plot_style.styled():
        missing = "" if len(known) else "none has both figures"
        text = headed(
            among.title if title is None else title, among.told(len(others) + len(front), len(known)), missing
        )
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        _dots(figure, axes, both, others, front, shades)
        _line(axes, both, front)
        _axes(axes, both, upward, known)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, _numbers(axes, both, front, upward))


def _upward(both: Sequence[str], greatest: Sequence[str]) -> list[bool]:
    """Of which figures more is better. Raises InvalidInput for others."""
    wrong = next((one for one in greatest if one not in both), None)
    if wrong is not None:
        raise InvalidInput(Problem("greatest", f"{wrong!r} is neither figure", nearest(str(wrong), list(both))))
    return [name in greatest for name in both]


def front_rows(both: Sequence[Plotted], assembled: Number, upward: Sequence[bool]) -> Number:
    """Return the rows of the front, of the assembled designs."""
    signed = [
        np.where(assembled, -one.values if up else one.values, np.nan) for one, up in zip(both, upward, strict=True)
    ]
    return pareto_rows(*signed)


def _label(figure: Plotted, upward: bool) -> str:
    return f"{figure.label}, {'greatest' if upward else 'least'}"


def _dots(
    figure: Any, axes: Any, both: Sequence[Plotted], others: Number, front: Number, shades: Plotted | None
) -> None:
    x, y = (one.values for one in both)
    if shades is None:
        if len(others):
            axes.scatter(x[others], y[others], s=DOT, color=FAINT, label="other designs", **LOOK)
        axes.scatter(x[front], y[front], s=LARGE, color=COLOURS[1], zorder=3.0, label="front", **LOOK)
        return
    rows = np.concatenate([others, front])
    sizes = np.where(np.arange(len(rows)) < len(others), DOT, LARGE)
    shown = axes.scatter(x[rows], y[rows], s=sizes, c=shades.values[rows], cmap=plot_style.FAMILY, **LOOK)
    ring = {**LOOK, "linewidths": 1.0}
    axes.scatter(x[front], y[front], s=LARGE, facecolors="none", edgecolors=COLOURS[1], label="front", **ring)
    bar = figure.colorbar(shown, ax=axes, aspect=35, pad=0.02)
    bar.set_label(shades.label)
    bar.outline.set_visible(False)


def _numbers(axes: Any, both: Sequence[Plotted], front: Number, upward: Sequence[bool]) -> list[PointLabel]:
    """The rows of the front, beyond it; none of very many."""
    beyond = complex(*(1.0 if up else -1.0 for up in upward))
    places = zip(*(one.values[front].tolist() for one in both), front.tolist(), strict=True)
    named = places if len(front) <= NAMED else ()
    return [PointLabel(axes, x, y, str(row), beyond, COLOURS[1]) for x, y, row in named]


def _line(axes: Any, both: Sequence[Plotted], front: Number) -> None:
    """The edge of what is bettered: along the front in steps."""
    x, y = (one.values[front] for one in both)
    axes.plot(x, y, color=COLOURS[1], linewidth=1.0, drawstyle="steps-post", zorder=0.9, label="_front")


def _axes(axes: Any, both: Sequence[Plotted], upward: Sequence[bool], known: Number) -> None:
    """Name the axes, and set their ranges and ticks."""
    axes.set_xlabel(_label(both[0], upward[0]))
    axes.set_ylabel(_label(both[1], upward[1]))
    if not len(known):
        canvas.blank(axes)
        axes.set_xticks([])
        return
    for axis, one, most in ((axes.xaxis, both[0], canvas.ACROSS), (axes.yaxis, both[1], canvas.UPWARDS)):
        still = canvas.steady(one.values[known], one.scale)
        if still is not None:
            axes.set(**{f"{axis.axis_name}lim": still})
        canvas.ticks(axis, one.is_angle, most)
