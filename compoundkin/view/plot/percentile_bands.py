"""Percentile bands: what a quantity of many designs, or of one within its tolerances, is over the driver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.given_numbers import real_numbers
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.studies.runs.study_program import StudyColumn
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.plot_style import COLOURS, INK, Plot
from compoundkin.view.plot.plotted_rows import Plotted, along
from compoundkin.view.plot.study_columns import StudyColumns, headed, shown_of
from compoundkin.view.plot.toleranced_outputs import courses_of
from compoundkin.view.plot.vertical_ranges import HEADROOM
from compoundkin.view.report.wording import counted

FIRST, EACH = 1.8, 2.2
# Percentiles that are drawn: the outermost two are the edges of the lightest band, and so on to the one in the middle.
PERCENTILES = (0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 100.0)
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
    found: StudyResult | ToleranceAnalysis,
    *names: str,
    percentiles: Sequence[float] = PERCENTILES,
    relative: bool = True,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw how far quantities lie apart in a study or within tolerances.

    They are drawn over the driver, or over the time of a motion in time. `names` are quantities at every pose, of
    vectors both components; without any, all that there are. Of a study the bands lie between percentiles of its
    assembled designs, each with the one as far from the other end; a percentile of 50 is a line. Of tolerances they are
    the worst case and as many standard deviations as limits lie from the middle, with the percentiles of random designs
    beside them; what is drawn is the error, unless `relative` is False.

    Raises UnknownName for quantities that there are not, InvalidInput for figures or without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.tolerances.tolerance import tolerance
    >>> found = tolerance(load_named("crank-rocker"), {"crank.B": 0.01, "rocker.C": 0.02}, "rocker.angle")
    >>> bands(found).figure.axes[0].get_ylabel()
    'error of rocker.angle\\n[deg]'
    """
    told, motion, panels = _panels(found, names, percentiles, relative)
    x, is_input = along(motion, None)
    text = headed(motion.mechanism.title if title is None else title, told)
    with plot_style.styled():
        height = FIRST + EACH * len(panels)
        figure, axes = canvas.panels(len(panels), text, size or (canvas.WIDTH, height), sharex=True)
        if is_input and np.ptp(x.values) > 0:
            axes[0].set_xlim(x.values.min(), x.values.max())
        for one, panel in zip(axes, panels, strict=True):
            _draw(one, x, panel)
            canvas.axis_labels(one, x if one is axes[-1] else None, panel.title, canvas.PANEL)
            if not np.isfinite(panel.drawn).any():
                canvas.blank(one)
        canvas.legend_below(figure, axes[0].get_legend_handles_labels()[0])
        return canvas.finished(figure, ())


def _panels(
    found: StudyResult | ToleranceAnalysis, names: Sequence[str], percentiles: Sequence[float], relative: bool
) -> tuple[str, Motion, tuple[Bands, ...]]:
    """What is said below the panels, the motion that they are over, and the panels."""
    ordered = held_percentiles(percentiles)
    if isinstance(found, StudyResult):
        among = StudyColumns(found)
        panels = tuple(_of_study(among, one, ordered) for one in among.courses(names))
        return among.told(), found.reference, panels
    told = [counted(found.count, "random design"), _missing(found.unassembled)]
    panels = tuple(_of_tolerance(found, one, relative) for one in courses_of(found, names))
    return ", ".join(filter(None, told)), found.motion, panels


def _missing(number: int) -> str:
    return f"{number:,} cannot be assembled" if number else ""


def held_percentiles(percentiles: Sequence[float]) -> list[float]:
    """Return percentiles, lowest first. Raises InvalidInput for what is none."""
    found: list[float] = np.unique(real_numbers("percentiles", percentiles)).tolist()
    wrong = [one for one in found if not 0.0 <= one <= 100.0]
    if wrong or not found:
        what = f"{wrong[0]:g} is no percentile" if wrong else "there is none"
        raise InvalidInput(Problem("percentiles", what, "numbers from 0 to 100, such as (5, 50, 95)"))
    return found


def percentile_courses(values: Number, chosen: Number, percentiles: Sequence[float]) -> Number:
    """Return percentiles of the chosen designs at every pose, (percentiles, poses).

    They are NaN where no design is known.

    >>> values = np.array([[0.0, np.nan], [1.0, np.nan], [4.0, np.nan], [9.0, 9.0]])
    >>> percentile_courses(values, np.array([True, True, True, False]), [50.0]).tolist()
    [[1.0, nan]]
    """
    found = np.full((len(percentiles), values.shape[-1]), np.nan)
    # pose by pose: all at once would need the memory of all designs again
    for pose in range(values.shape[-1]):
        known = values[:, pose][chosen & np.isfinite(values[:, pose])]
        if len(known):
            found[:, pose] = np.percentile(known, percentiles, overwrite_input=True)
    return found


def _of_study(among: StudyColumns, column: StudyColumn, percentiles: Sequence[float]) -> Bands:
    courses = percentile_courses(np.asarray(among.found[column.name]), among.assembled, percentiles)
    quantity = shown_of(column.name, column.unit, courses)
    rows = dict(zip(percentiles, quantity.values, strict=True))
    lower = [one for one in percentiles if one < 50.0 and 100.0 - one in rows]
    single = [one for one in percentiles if one not in lower and 100.0 - one not in lower]
    edges = tuple((_between(one), rows[one], rows[100.0 - one]) for one in lower)
    lines = tuple((_percentile(one), rows[one], {"color": COLOURS[0]}) for one in single)
    return Bands(quantity, edges, lines)


def _between(low: float) -> str:
    return "all designs" if low == 0.0 else f"{low:g} to {100.0 - low:g} %"


def _percentile(one: float) -> str:
    return "median" if one == 50.0 else f"{one:g} %"


def _of_tolerance(found: ToleranceAnalysis, one: OutputTolerance, relative: bool) -> Bands:
    base, sigmas = one.nominal if relative else 0.0 * one.nominal, found.chances.sigmas

    def shown(values: Any) -> Number:
        return shown_of(one.name, one.unit, values - base).values

    spread = sigmas * one.deviation
    edges = (
        ("worst case", shown(one.low), shown(one.high)),
        (f"±{sigmas:g} standard deviations", shown(one.mean - spread), shown(one.mean + spread)),
    )
    whole = shown_of(one.name, one.unit, one.high - base)
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
    still = canvas.steady(panel.drawn, panel.title.scale)
    if still is not None:
        axes.set_ylim(*still)
    else:
        axes.margins(y=HEADROOM)


def _shade(dark: float) -> tuple[float, ...]:
    """The colour of a band, on white: bands that could be seen through would be darker than in the legend."""
    from matplotlib.colors import to_rgb

    return tuple(1.0 - dark * (1.0 - part) for part in to_rgb(COLOURS[0]))
