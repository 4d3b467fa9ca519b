"""Where searches of better dimensions began and ended: how sure one can be of the best."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.series import Number
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.plot_style import COLOURS, FAINT, GREY, INK, Plot
from compoundkin.view.plot.study_columns import headed
from compoundkin.view.report.objective_words import objective_words, shown_objective

SIZE = (7.0, 4.2)
# Objectives that differ by this factor are drawn by their powers of ten.
FAR = 50.0
# An objective that is nothing is drawn at this part of the least that is something.
BELOW = 0.1


@checked
def starts(optimum: Optimum, *, title: str | None = None, size: tuple[float, float] | None = None) -> Plot:
    """Draw at which objectives the searches of an optimum began and ended.

    The best come first. Where many ended at the best objective, one can be surer of it. Searches that ended where
    constraints do not hold as well as at the best are crosses where they began. Raises InvalidInput without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.goals.least_goal import least
    >>> from compoundkin.studies.optimisation.better_dimensions import optimise
    >>> free = {"rocker.C.x": (3.5, 4.5)}
    >>> found = optimise(load_named("crank-rocker"), free, least("rocker.angle.stroke"), starts=4)
    >>> starts(found).figure.axes[0].get_xlabel()
    'searches, the best first'
    """
    with plot_style.styled():
        said = f"{optimum.agreed:,} of {optimum.starts:,} searches agree"
        text = headed(optimum.motion.mechanism.title if title is None else title, said)
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        _draw(axes, optimum)
        axes.set_xlabel("searches, the best first")
        axes.set_ylabel(shown_objective(optimum, 0.0).label)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, ())


def _draw(axes: Any, optimum: Optimum) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    order = np.argsort(np.where(np.isfinite(optimum.ended), optimum.ended, np.inf), kind="stable")
    begun, ended = (shown_objective(optimum, own[order]).values for own in (optimum.begun, optimum.ended))
    before = float(shown_objective(optimum, optimum.value_before).values)
    least = _least(np.concatenate([begun, ended, [before]]))
    ranks = np.arange(1, len(begun) + 1)
    lost = ~np.isfinite(ended)
    low = np.maximum(ended, least) if least is not None else ended
    axes.vlines(ranks[~lost], low[~lost], begun[~lost], color=FAINT, linewidth=0.8, zorder=1.5)
    dots: dict[str, Any] = {"linestyle": "none", "clip_on": False, "zorder": 3}
    axes.plot(ranks[~lost], begun[~lost], marker="o", markersize=3.0, color=FAINT, label="began", **dots)
    axes.plot(ranks[~lost], low[~lost], marker="o", markersize=4.5, color=COLOURS[0], label="ended", **dots)
    if lost.any():
        axes.plot(
            ranks[lost], begun[lost], marker="x", markersize=4.5, color=GREY, label="constraints do not hold", **dots
        )
    if np.isfinite(before):
        said = f"before: {objective_words(optimum, optimum.value_before)}"
        axes.axhline(before, color=INK, linestyle="--", linewidth=1.0, label=said)
    if least is not None:
        axes.set_yscale("log")
        # powers of ten as numbers: the style of the house reads no formulas
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlim(0.5, len(begun) + 0.5)
    few = len(begun) <= canvas.ACROSS
    axes.xaxis.set_major_locator(FixedLocator(ranks.tolist()) if few else MaxNLocator(canvas.ACROSS, integer=True))


def _least(values: Number) -> float | None:
    """The least that is drawn by powers of ten; None where objectives are drawn as they are."""
    known = values[np.isfinite(values)]
    some = known[known > 0.0]
    if not len(some) or (known < 0.0).any() or known.max() <= FAR * some.min():
        return None
    return float(some.min()) * (BELOW if (known == 0.0).any() else 1.0)
