"""What studies, tolerance analyses and searches of better dimensions draw of themselves."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot.contribution_bars import contributions
from compoundkin.view.plot.figure_histogram import histogram
from compoundkin.view.plot.improvement_plot import improvement
from compoundkin.view.plot.percentile_bands import bands
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.scatter_matrix import scatter_matrix
from compoundkin.view.plot.study_columns import StudyColumns
from compoundkin.view.plot.toleranced_outputs import outputs_of


@singledispatch
def study_plot(found: Any, *names: str, **options: Any) -> Plot:
    """Draw what is found by the plot that suits it."""
    raise TypeError(f"{type(found).__name__} has no plot of its own")


@study_plot.register
def _(found: StudyResult, *names: str, **options: Any) -> Plot:
    """Bands of courses, a histogram of one figure, else a scatter matrix."""
    columns = [one for name in names for one in StudyColumns(found).named(name)]
    if columns and all(one.width for one in columns):
        return bands(found, *names, **options)
    return histogram(found, names[0], **options) if len(columns) == 1 else scatter_matrix(found, *names, **options)


@study_plot.register
def _(found: ToleranceAnalysis, *names: str, **options: Any) -> Plot:
    """Bands of courses, the contributions to one figure."""
    shown = [one for name in names for one in outputs_of(found, name)] or list(found.values())
    if len(shown) == 1 and not shown[0].is_course:
        return contributions(found, shown[0].name, **options)
    return bands(found, *names, **options)


@study_plot.register
def _(found: Optimum, *names: str, **options: Any) -> Plot:
    """What became better."""
    return improvement(found, *names, **options)
