"""Bars of what each tolerance contributes to the error of an output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.series import Number
from compoundkin.model.attributes import readable
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.label_lines import broken
from compoundkin.view.plot.plot_style import COLOURS, Plot
from compoundkin.view.plot.point_labels import number
from compoundkin.view.plot.study_columns import headed, shown_of
from compoundkin.view.plot.toleranced_outputs import output_of, place_words, pose_of, shown_words, value_at

FIRST, EACH = 1.7, 0.27
# More bars are one, of all others together.
MOST = 16
# Characters of a name in a line.
ROOM = 26
# Room behind the bars for their values, a part of the longest.
BEHIND = 0.28


@dataclass(frozen=True, eq=False)
class ContributionRows:
    """What each source contributes, the greatest share first.

    Shares are those of the variance in percent, parts those of the worst case.
    """

    names: tuple[str, ...]
    shares: Number
    parts: Number
    unit: str


@checked
def contributions(
    found: ToleranceAnalysis,
    name: str,
    *,
    pose: int | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw what each tolerance and loose pin contributes to the error of an output.

    At the left stand shares of the variance, at the right parts of the worst case; the greatest come first. `name` is a
    figure, or a quantity at the `pose` of that index; without it the pose at which the standard deviation is greatest.

    Raises UnknownName for outputs that there are not, InvalidInput for a vector, a pose that there is not, or without
    Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.tolerances.tolerance import tolerance
    >>> found = tolerance(load_named("crank-rocker"), {"crank.B": 0.01, "rocker.C": 0.02}, "rocker.angle")
    >>> [axes.get_xlabel() for axes in contributions(found, "rocker.angle", pose=30).figure.axes]
    ['share of the variance [%]', 'part of the worst case [deg]']
    """
    one = output_of(found, name)
    at = pose_of(one, pose)
    rows = contribution_rows(one, at)
    with plot_style.styled():
        text = headed(found.motion.mechanism.title if title is None else title, _told(found, one, at))
        height = FIRST + EACH * len(rows.names)
        figure, axes = canvas.panels(1, text, size or (canvas.WIDTH, height), 2, sharey=True)
        _bars(axes[0], rows, rows.shares, "share of the variance [%]", COLOURS[0])
        _bars(
            axes[1],
            rows,
            rows.parts,
            f"part of the worst case{f' [{readable(rows.unit)}]' if rows.unit else ''}",
            COLOURS[1],
        )
        axes[0].invert_yaxis()
        return canvas.finished(figure, ())


def contribution_rows(one: OutputTolerance, pose: int | None, most: int = MOST) -> ContributionRows:
    """Return what each source contributes at a pose. Small ones are together."""
    shares, parts = (
        np.array([value_at(own[name], pose) for name in own]) for own in (one.contributions, one.worst_parts)
    )
    shown = shown_of(one.name, one.unit, np.abs(parts))
    order = np.lexsort((-shown.values, -shares))
    names = tuple(one.contributions)
    first, rest = (order, order[:0]) if len(order) <= most else (order[: most - 1], order[most - 1 :])
    others = [f"{len(rest)} others"] if len(rest) else []
    rows = [np.append(own[first], [own[rest].sum()] * len(others)) for own in (100.0 * shares, shown.values)]
    return ContributionRows((*(names[k] for k in first), *others), rows[0], rows[1], shown.unit)


def _bars(axes: Any, rows: ContributionRows, values: Number, label: str, colour: str) -> None:
    places = np.arange(len(rows.names))
    axes.barh(places, values, color=colour, height=0.7)
    axes.grid(visible=False, axis="y")
    longest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    axes.set_xlim(0.0, (1.0 + BEHIND) * longest or 1.0)
    axes.set_xlabel(label)
    axes.set_yticks(places, [broken(name, ROOM) for name in rows.names])
    axes.tick_params(axis="y", length=0)
    for place, value in zip(places, values, strict=True):
        text = "-" if not np.isfinite(value) else number(float(f"{value:.3g}"), longest)
        axes.annotate(text, (value if np.isfinite(value) else 0.0, place), (4, 0), textcoords="offset points",
                      va="center", fontsize=plot_style.SMALL_PRINT)  # fmt: skip


def _told(found: ToleranceAnalysis, one: OutputTolerance, pose: int | None) -> str:
    """What the bars are of: the output and where, with its errors."""
    worst, deviation = (shown_words(one, value_at(own, pose)) for own in (one.worst, one.deviation))
    return f"{place_words(found, one, pose)}, worst case ±{worst}, standard deviation {deviation}"
