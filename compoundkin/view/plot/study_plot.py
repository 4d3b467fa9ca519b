"""Plots of studies and tolerance analyses: percentile bands, histograms of a figure, contributions of tolerances.

`study_plot` chooses the one that suits a result.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.percentiles import percentiles_by_column
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import ASSEMBLED
from compoundkin.model.attributes import typeset_unit
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.study_program import StudyColumn
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import HEADROOM, PointLabel, broken_label, value_text
from compoundkin.view.plot.optimisation_plots import improvement
from compoundkin.view.plot.plot_style import COLOURS, INK, Plot
from compoundkin.view.plot.plotted_rows import Plotted, horizontal_axis
from compoundkin.view.plot.scatter_plots import scatter_matrix
from compoundkin.view.plot.study_columns import (
    FigureValues,
    StudyColumns,
    checked_pose,
    displayed_values,
    place_words,
    title_with_summary,
    toleranced_curves,
    toleranced_output,
    toleranced_outputs,
    value_at,
    value_words,
)
from compoundkin.view.report.wording import counted


@singledispatch
def study_plot(result: Any, *names: str, **options: Any) -> Plot:
    """Draw a result by the plot that suits it."""
    raise TypeError(f"{type(result).__name__} has no plot of its own")


@study_plot.register
def _(result: StudyResult, *names: str, **options: Any) -> Plot:
    """Bands of courses, a histogram of one figure, else a scatter matrix."""
    columns = [one for name in names for one in StudyColumns(result).named(name)]
    if columns and all(one.width for one in columns):
        return bands(result, *names, **options)
    return histogram(result, names[0], **options) if len(columns) == 1 else scatter_matrix(result, *names, **options)


@study_plot.register
def _(result: ToleranceAnalysis, *names: str, **options: Any) -> Plot:
    """Bands of courses, the contributions to one figure."""
    shown = [one for name in names for one in toleranced_outputs(result, name)] or list(result.values())
    if len(shown) == 1 and not shown[0].is_course:
        return contributions(result, shown[0].name, **options)
    return bands(result, *names, **options)


@study_plot.register
def _(result: Optimum, *names: str, **options: Any) -> Plot:
    """Paths and quantities before and after."""
    return improvement(result, *names, **options)


BANDS_BASE_HEIGHT, BANDS_PANEL_HEIGHT = 1.8, 2.2
# Percentiles that are drawn: the outermost two are the edges of the lightest band, and so on to the one in the middle.
BAND_PERCENTILES = (0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 100.0)
# How dark the outermost band is, and the innermost one.
LIGHT, DARK = 0.15, 0.5
# Percentiles of random designs within tolerances.
SAMPLED: Mapping[str, Any] = MappingProxyType({"color": COLOURS[1], "linestyle": (0, (4, 2)), "linewidth": 0.9})


@dataclass(frozen=True, eq=False)
class Bands:
    """A panel: pairs of edges, and lines, each with its name.

    The outermost edges come first.
    """

    title: Plotted
    edges: tuple[tuple[str, Number, Number], ...]
    lines: tuple[tuple[str, Number, dict[str, Any]], ...]

    @property
    def drawn(self) -> Number:
        """All values that are drawn."""
        rows = [row for _, low, high in self.edges for row in (low, high)]
        return np.concatenate([*rows, *(row for _, row, _ in self.lines)])


@checked
def bands(
    result: StudyResult | ToleranceAnalysis,
    *names: str,
    percentiles: Sequence[float] = BAND_PERCENTILES,
    relative: bool = True,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the scatter of quantities in a study or within tolerances.

    They are drawn over the driver, or over the time of a motion in time. `names` are quantities at every pose, of
    vectors both components; without any, all that there are. Of a study the bands lie between percentiles of its
    assembled designs, each with the one as far from the other end; a percentile of 50 is a line. Of tolerances they are
    the worst case and as many standard deviations as limits lie from the middle, with the percentiles of random designs
    beside them; what is drawn is the error, unless `relative` is False.

    Raises UnknownName for quantities that are unknown, InvalidInput for figures or without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.tolerances.tolerance import tolerance
    >>> result = tolerance(load("crank-rocker"), {"crank.B": 0.01, "rocker.C": 0.02}, "rocker.angle")
    >>> bands(result).figure.axes[0].get_ylabel()
    'error of rocker.angle\\n[°]'
    """
    said, motion, panels = _panels(result, names, percentiles, relative)
    x, is_input = horizontal_axis(motion, None)
    text = title_with_summary(motion.mechanism.title if title is None else title, said)
    with plot_style.styled():
        height = BANDS_BASE_HEIGHT + BANDS_PANEL_HEIGHT * len(panels)
        figure, axes = canvas.panels(len(panels), text, size or (canvas.WIDTH, height), sharex=True)
        if is_input and np.ptp(x.values) > 0:
            axes[0].set_xlim(x.values.min(), x.values.max())
        for one, panel in zip(axes, panels, strict=True):
            _draw(one, x, panel)
            canvas.axis_labels(one, x if one is axes[-1] else None, panel.title, canvas.PANEL)
            if not np.isfinite(panel.drawn).any():
                canvas.write_empty(one)
        canvas.legend_below(figure, axes[0].get_legend_handles_labels()[0])
        return canvas.finished(figure, ())


def _panels(
    result: StudyResult | ToleranceAnalysis, names: Sequence[str], percentiles: Sequence[float], relative: bool
) -> tuple[str, Motion, tuple[Bands, ...]]:
    """The summary of the designs, the motion of the horizontal axis, and the panels."""
    ordered = checked_percentiles(percentiles)
    if isinstance(result, StudyResult):
        among = StudyColumns(result)
        panels = tuple(_study_bands(among, one, ordered) for one in among.courses(names))
        return among.summary(), result.reference, panels
    said = [
        counted(result.count, "random design"),
        f"{result.unassembled:,} cannot be assembled" * bool(result.unassembled),
    ]
    panels = tuple(_tolerance_bands(result, one, relative) for one in toleranced_curves(result, names))
    return ", ".join(filter(None, said)), result.motion, panels


def checked_percentiles(percentiles: Sequence[float]) -> list[float]:
    """Return percentiles, lowest first. Raises InvalidInput for other numbers."""
    result: list[float] = np.unique(real_numbers("percentiles", percentiles)).tolist()
    wrong = [one for one in result if not 0.0 <= one <= 100.0]
    if wrong or not result:
        what = f"{wrong[0]:g} is not a percentile" if wrong else "none is given"
        raise InvalidInput(Problem("percentiles", what, "numbers from 0 to 100, such as (5, 50, 95)"))
    return result


def _study_bands(among: StudyColumns, column: StudyColumn, percentiles: Sequence[float]) -> Bands:
    there, name = among.result.rows, column.name
    courses = percentiles_by_column(
        lambda: (piece[name][piece[ASSEMBLED]] for piece in there.pieces(name, ASSEMBLED)),
        column.width or 0, percentiles,
    )  # fmt: skip
    quantity = displayed_values(column.name, column.unit, courses)
    rows = dict(zip(percentiles, quantity.values, strict=True))
    lower = [one for one in percentiles if one < 50.0 and 100.0 - one in rows]
    single = [one for one in percentiles if one not in lower and 100.0 - one not in lower]
    between = ["all designs" if one == 0.0 else f"{one:g} to {100.0 - one:g} %" for one in lower]
    edges = tuple((name, rows[one], rows[100.0 - one]) for name, one in zip(between, lower, strict=True))
    lines = tuple((_percentile(one), rows[one], {"color": COLOURS[0]}) for one in single)
    return Bands(quantity, edges, lines)


def _percentile(one: float) -> str:
    return "median" if one == 50.0 else f"{one:g} %"


def _tolerance_bands(result: ToleranceAnalysis, one: OutputTolerance, relative: bool) -> Bands:
    base, sigmas = one.nominal if relative else 0.0 * one.nominal, result.chances.sigmas

    def shown(values: Any) -> Number:
        return displayed_values(one.name, one.unit, values - base).values

    spread = sigmas * one.deviation
    edges = (
        ("worst case", shown(one.low), shown(one.high)),
        (f"±{sigmas:g} standard deviations", shown(one.mean - spread), shown(one.mean + spread)),
    )
    whole = displayed_values(one.name, one.unit, one.high - base)
    quantity = replace(whole, name=f"error of {one.name}") if relative else whole
    lines = [("nominal", shown(one.nominal), {"color": INK, "linewidth": 1.0})]
    # one name for all of them: the legend is one line
    word = ", ".join(f"{own:g}" for own in one.sample.percents)
    for k, row in enumerate(one.sample.percentiles):
        lines.append((f"_{k}" if k else f"{word} % of random designs", shown(row), dict(SAMPLED)))
    return Bands(quantity, edges, tuple(lines))


def _draw(axes: Any, x: Plotted, panel: Bands) -> None:
    across = x.values[0]
    for k, (name, low, high) in enumerate(panel.edges):
        shade = _shade(LIGHT + (DARK - LIGHT) * k / max(1, len(panel.edges) - 1))
        axes.fill_between(across, low, high, facecolor=shade, edgecolor=COLOURS[0], linewidth=0.4, label=name)
    for name, values, look in panel.lines:
        axes.plot(across, values, label=name, **look)
    canvas.set_vertical_margins(axes, panel.drawn, panel.title.scale, HEADROOM)


def _shade(dark: float) -> tuple[float, ...]:
    """The colour of a band, opaque: transparent bands on each other would be darker than in the legend."""
    from matplotlib.colors import to_rgb

    return tuple(1.0 - dark * (1.0 - part) for part in to_rgb(COLOURS[0]))


SIZE = (7.0, 4.0)
HISTOGRAM_PERCENTILES = (5.0, 50.0, 95.0)
# Room above the bars for the values of percentiles, a part of their height.
HISTOGRAM_MARGIN = 0.25
# Places of the curve of a normal distribution.
PLACES = 400


@dataclass(frozen=True, eq=False)
class FigureDistribution:
    """The content of a histogram: values, percentiles, named lines, a normal distribution."""

    title: str
    summary: str
    values: FigureValues
    percentiles: Sequence[float]
    lines: tuple[tuple[str, float], ...] = ()
    normal: tuple[float, float] | None = None


@checked
def histogram(
    result: StudyResult | ToleranceAnalysis,
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
    Within tolerances the worst case is drawn too, and the normal distribution of the deviation result by slopes.

    Raises UnknownName for unknown names, InvalidInput for courses of a study, vectors, or without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.study import study
    >>> stroke = "rocker.angle.stroke"
    >>> result = study(load("crank-rocker"), {"crank.B.x": (1.8, 2.2)}, stroke, count=64).run()
    >>> int(sum(patch.get_height() for patch in histogram(result, stroke).figure.axes[0].patches))
    64
    """
    chosen = None if percentiles is None else checked_percentiles(percentiles)
    if isinstance(result, StudyResult):
        shown = _study_distribution(result, name, pose, chosen)
    else:
        shown = _tolerance_distribution(result, name, pose, chosen)
    labels: list[PointLabel] = []
    with plot_style.styled():
        text = title_with_summary(shown.title if title is None else title, shown.summary)
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        _draw_histogram(axes, shown, labels)
        axes.set_xlabel(shown.values.quantity.label)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, labels)


def _study_distribution(
    result: StudyResult, name: str, pose: int | None, percentiles: Sequence[float] | None
) -> FigureDistribution:
    if pose is not None:
        raise InvalidInput(Problem("pose", "a study has one number of each design here", "leave it out"))
    among = StudyColumns(result)
    shown = among.distribution(among.figure(name))
    return FigureDistribution(
        among.title, among.summary(), shown, HISTOGRAM_PERCENTILES if percentiles is None else percentiles
    )


def _tolerance_distribution(
    result: ToleranceAnalysis, name: str, pose: int | None, percentiles: Sequence[float] | None
) -> FigureDistribution:
    one = toleranced_output(result, name)
    at = checked_pose(one, pose)
    sample = one.sample.values
    own = displayed_values(one.name, one.unit, sample if at is None else sample[:, at]).values
    values = FigureValues.of(one.name, one.unit, lambda: [own[np.isfinite(own)]])

    def shown(own: Number) -> float:
        return float(displayed_values(one.name, one.unit, np.array([value_at(own, at)])).values[0])

    lines = (("worst case", shown(one.low)), ("_", shown(one.high)))
    said = f"{place_words(result, one, at)}, {counted(one.sample.count, 'random design')}"
    normal = shown(one.mean), shown(one.deviation)
    return FigureDistribution(result.mechanism.title, said, values, percentiles or result.percentiles, lines, normal)


def _draw_histogram(axes: Any, shown: FigureDistribution, labels: list[PointLabel]) -> None:
    from matplotlib.ticker import MaxNLocator

    if not shown.values.count:
        canvas.write_empty(axes)
        axes.set_xticks([])
        return
    edges, counts = shown.values.bins, shown.values.counts()
    axes.hist(edges[:-1], bins=edges, weights=counts, color=COLOURS[0], alpha=0.75)
    axes.set_ylim(0.0, (1.0 + HISTOGRAM_MARGIN) * float(np.max(counts)))
    if shown.normal is not None and shown.normal[1] > 0.0:
        _normal(axes, shown.normal, shown.values.count * (edges[1] - edges[0]))
    for name, place in shown.lines:
        axes.axvline(place, color=COLOURS[1], linewidth=1.2, label=name)
    _percentiles(axes, shown, labels)
    axes.set_ylabel("designs")
    axes.yaxis.set_major_locator(MaxNLocator(canvas.UPWARDS, integer=True))
    canvas.set_round_ticks(axes.xaxis, shown.values.quantity.is_angle, canvas.ACROSS)


def _normal(axes: Any, normal: tuple[float, float], area: float) -> None:
    """The normal distribution of a mean and a deviation, of the same area as the bars."""
    mean, deviation = normal
    z = np.linspace(-4.0, 4.0, PLACES)
    density = area * np.exp(-(z**2) / 2.0) / (deviation * np.sqrt(2.0 * np.pi))
    axes.plot(mean + deviation * z, density, color=INK, linewidth=1.2, label="normal, by slopes")
    axes.set_ylim(0.0, max(axes.get_ylim()[1], (1.0 + HISTOGRAM_MARGIN) * float(density.max())))


def _percentiles(axes: Any, shown: FigureDistribution, labels: list[PointLabel]) -> None:
    top, scale = axes.get_ylim()[1], shown.values.quantity.scale
    for one, value in zip(shown.percentiles, shown.values.percentiles(shown.percentiles), strict=True):
        axes.axvline(value, color=INK, linestyle="--", linewidth=1.0)
        labels.append(PointLabel(axes, value, 0.97 * top, f"{_percentile(one)}: {value_text(value, scale)}", 1.0))


BARS_BASE_HEIGHT, BAR_HEIGHT = 1.7, 0.27
# More bars are one, of all others together.
MOST = 16
# Characters of a name in a line.
NAME_CHARACTERS = 26
# Room behind the bars for their values, a part of the longest.
BEHIND = 0.28


@dataclass(frozen=True, eq=False)
class ContributionRows:
    """The contribution of each source, the greatest share first.

    Shares are those of the variance in percent, parts those of the worst case.
    """

    names: tuple[str, ...]
    shares: Number
    parts: Number
    unit: str


@checked
def contributions(
    result: ToleranceAnalysis,
    name: str,
    *,
    pose: int | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw what each tolerance and loose pin contributes to the error of an output.

    At the left stand shares of the variance, at the right parts of the worst case; the greatest come first. `name` is a
    figure, or a quantity at the `pose` of that index; without it the pose at which the standard deviation is greatest.

    Raises UnknownName for outputs that are unknown, InvalidInput for a vector, a pose that there is not, or without
    Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.tolerances.tolerance import tolerance
    >>> result = tolerance(load("crank-rocker"), {"crank.B": 0.01, "rocker.C": 0.02}, "rocker.angle")
    >>> [axes.get_xlabel() for axes in contributions(result, "rocker.angle", pose=30).figure.axes]
    ['share of the variance [%]', 'part of the worst case [°]']
    """
    one = toleranced_output(result, name)
    at = checked_pose(one, pose)
    rows = contribution_rows(one, at)
    with plot_style.styled():
        text = title_with_summary(
            result.motion.mechanism.title if title is None else title, _contribution_heading(result, one, at)
        )
        height = BARS_BASE_HEIGHT + BAR_HEIGHT * len(rows.names)
        figure, axes = canvas.panels(1, text, size or (canvas.WIDTH, height), 2, sharey=True)
        _draw_contributions(axes[0], rows, rows.shares, "share of the variance [%]", COLOURS[0])
        _draw_contributions(
            axes[1],
            rows,
            rows.parts,
            f"part of the worst case{f' [{typeset_unit(rows.unit)}]' if rows.unit else ''}",
            COLOURS[1],
        )
        axes[0].invert_yaxis()
        return canvas.finished(figure, ())


def contribution_rows(one: OutputTolerance, pose: int | None, most: int = MOST) -> ContributionRows:
    """Return the contributions at a pose. Small ones are summed."""
    shares, parts = (
        np.array([value_at(own[name], pose) for name in own]) for own in (one.contributions, one.worst_parts)
    )
    shown = displayed_values(one.name, one.unit, np.abs(parts))
    order = np.lexsort((-shown.values, -shares))
    names = tuple(one.contributions)
    first, rest = (order, order[:0]) if len(order) <= most else (order[: most - 1], order[most - 1 :])
    others = [f"{len(rest)} others"] if len(rest) else []
    rows = [np.append(own[first], [own[rest].sum()] * len(others)) for own in (100.0 * shares, shown.values)]
    return ContributionRows((*(names[k] for k in first), *others), rows[0], rows[1], shown.unit)


def _draw_contributions(axes: Any, rows: ContributionRows, values: Number, label: str, colour: str) -> None:
    places = np.arange(len(rows.names))
    axes.barh(places, values, color=colour, height=0.7)
    axes.grid(visible=False, axis="y")
    longest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    axes.set_xlim(0.0, (1.0 + BEHIND) * longest or 1.0)
    axes.set_xlabel(label)
    axes.set_yticks(places, [broken_label(name, NAME_CHARACTERS) for name in rows.names])
    axes.tick_params(axis="y", length=0)
    for place, value in zip(places, values, strict=True):
        text = "-" if not np.isfinite(value) else value_text(float(f"{value:.3g}"), longest)
        axes.annotate(text, (value if np.isfinite(value) else 0.0, place), (4, 0), textcoords="offset points",
                      va="center", fontsize=plot_style.SMALL_PRINT)  # fmt: skip


def _contribution_heading(result: ToleranceAnalysis, one: OutputTolerance, pose: int | None) -> str:
    """The output and its pose, with its errors."""
    worst, deviation = (value_words(one, value_at(own, pose)) for own in (one.worst, one.deviation))
    return f"{place_words(result, one, pose)}, worst case ±{worst}, standard deviation {deviation}"
