"""Histograms of a figure over designs, with its percentiles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.figure_bins import bins
from compoundkin.view.plot.percentile_bands import held_percentiles
from compoundkin.view.plot.plot_style import COLOURS, INK, Plot
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import PointLabel, number
from compoundkin.view.plot.study_columns import StudyColumns, headed, shown_of
from compoundkin.view.plot.toleranced_outputs import output_of, place_words, pose_of, value_at
from compoundkin.view.report.wording import counted

SIZE = (7.0, 4.0)
PERCENTILES = (5.0, 50.0, 95.0)
# Room above the bars for the values of percentiles, a part of their height.
ROOM = 0.25
# Places of the curve of a normal distribution.
PLACES = 400


@dataclass(frozen=True, eq=False)
class FigureDistribution:
    """What a histogram shows: values, percentiles, named lines, a normal distribution."""

    title: str
    told: str
    values: Plotted
    percentiles: Sequence[float]
    lines: tuple[tuple[str, float], ...] = ()
    normal: tuple[float, float] | None = None


@checked
def histogram(
    found: StudyResult | ToleranceAnalysis,
    name: str,
    *,
    pose: int | None = None,
    percentiles: Sequence[float] | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw how often a figure has which values, in a study or within tolerances.

    `name` is an output with one number for each design, or within tolerances a quantity at the `pose` of that index, or
    else the pose of the greatest deviation. Counted are assembled designs. `percentiles` are dashed, with their values.
    Within tolerances the worst case is drawn too, and the normal distribution of the deviation found by slopes.

    Raises UnknownName for what there is not, InvalidInput for courses of a study, vectors, or without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.study import study
    >>> asked = "rocker.angle.stroke"
    >>> result = study(load_named("crank-rocker"), {"crank.B.x": (1.8, 2.2)}, asked, count=64).run()
    >>> int(sum(patch.get_height() for patch in histogram(result, asked).figure.axes[0].patches))
    64
    """
    asked = None if percentiles is None else held_percentiles(percentiles)
    if isinstance(found, StudyResult):
        shown = _of_study(found, name, pose, asked)
    else:
        shown = _of_tolerance(found, name, pose, asked)
    labels: list[PointLabel] = []
    with plot_style.styled():
        text = headed(shown.title if title is None else title, shown.told)
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        _bars(axes, shown, labels)
        axes.set_xlabel(shown.values.label)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, labels)


def _of_study(
    found: StudyResult, name: str, pose: int | None, percentiles: Sequence[float] | None
) -> FigureDistribution:
    if pose is not None:
        raise InvalidInput(Problem("pose", "a study has one number of each design here", "leave it out"))
    among = StudyColumns(found)
    shown = among.values(among.figure(name), np.flatnonzero(among.assembled))
    return FigureDistribution(among.title, among.told(), shown, PERCENTILES if percentiles is None else percentiles)


def _of_tolerance(
    found: ToleranceAnalysis, name: str, pose: int | None, percentiles: Sequence[float] | None
) -> FigureDistribution:
    one = output_of(found, name)
    at = pose_of(one, pose)
    sample = one.sample.values
    values = shown_of(one.name, one.unit, sample if at is None else sample[:, at])

    def shown(own: Number) -> float:
        return float(shown_of(one.name, one.unit, np.array([value_at(own, at)])).values[0])

    lines = (("worst case", shown(one.low)), ("_", shown(one.high)))
    told = f"{place_words(found, one, at)}, {counted(one.sample.count, 'random design')}"
    normal = shown(one.mean), shown(one.deviation)
    return FigureDistribution(found.mechanism.title, told, values, percentiles or found.percentiles, lines, normal)


def _bars(axes: Any, shown: FigureDistribution, labels: list[PointLabel]) -> None:
    from matplotlib.ticker import MaxNLocator

    values = shown.values.values[np.isfinite(shown.values.values)]
    if not len(values):
        canvas.blank(axes)
        axes.set_xticks([])
        return
    edges = bins(values, shown.values.scale)
    counts, _, _ = axes.hist(values, bins=edges, color=COLOURS[0], alpha=0.75)
    axes.set_ylim(0.0, (1.0 + ROOM) * float(np.max(counts)))
    if shown.normal is not None and shown.normal[1] > 0.0:
        _normal(axes, shown.normal, len(values) * (edges[1] - edges[0]))
    for name, place in shown.lines:
        axes.axvline(place, color=COLOURS[1], linewidth=1.2, label=name)
    _percentiles(axes, shown, values, labels)
    axes.set_ylabel("designs")
    axes.yaxis.set_major_locator(MaxNLocator(canvas.UPWARDS, integer=True))
    canvas.ticks(axes.xaxis, shown.values.is_angle, canvas.ACROSS)


def _normal(axes: Any, normal: tuple[float, float], area: float) -> None:
    """The normal distribution of a mean and a deviation, of the same area as the bars."""
    mean, deviation = normal
    z = np.linspace(-4.0, 4.0, PLACES)
    density = area * np.exp(-(z**2) / 2.0) / (deviation * np.sqrt(2.0 * np.pi))
    axes.plot(mean + deviation * z, density, color=INK, linewidth=1.2, label="normal, by slopes")
    axes.set_ylim(0.0, max(axes.get_ylim()[1], (1.0 + ROOM) * float(density.max())))


def _percentiles(axes: Any, shown: FigureDistribution, values: Number, labels: list[PointLabel]) -> None:
    top, scale = axes.get_ylim()[1], shown.values.scale
    for one, value in zip(shown.percentiles, np.percentile(values, shown.percentiles), strict=True):
        axes.axvline(value, color=INK, linestyle="--", linewidth=1.0)
        word = "median" if one == 50.0 else f"{one:g} %"
        labels.append(PointLabel(axes, float(value), 0.97 * top, f"{word}: {number(float(value), scale)}", 1.0))
