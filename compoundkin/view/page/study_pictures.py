"""Plots in the pages of studies, tolerance analyses and searches, by the sections that they stand in."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from functools import singledispatch
from importlib.util import find_spec
from typing import TypeAlias

from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.page.markup import element, safe
from compoundkin.view.plot import Plot, bands, contributions, improvement, scatter_matrix, starts

# More outputs than these are no page: the tables have all.
MOST = 6
# The key of a section, its plot, and what is said below it.
SectionPlot: TypeAlias = tuple[str, Plot, str]


def study_pictures(found: object) -> dict[str, str]:
    """Return the plots of what is reported as figures, by the keys of sections.

    They are none without Matplotlib, and of what is neither a study nor the like.
    """
    pictures: dict[str, str] = {}
    for key, plot, caption in _plots(found) if find_spec("matplotlib") else ():
        pictures[key] = pictures.get(key, "") + _figure(plot, caption)
    return pictures


def _figure(plot: Plot, caption: str) -> str:
    """A plot with what is said below it; as an image, for its names would meet those of others."""
    source = f"data:image/svg+xml;base64,{b64encode(plot.content('svg')).decode('ascii')}"
    image = f'<img src="{source}" alt="{safe(caption)}" style="max-width:100%;height:auto">'
    return element("figure", f"{image}\n<figcaption>{safe(caption)}</figcaption>")


@singledispatch
def _plots(found: object) -> Iterator[SectionPlot]:
    yield from ()


@_plots.register
def _(found: StudyResult) -> Iterator[SectionPlot]:
    if any(one.is_figure for one in found.columns):
        told = "Dimensions and figures against each other; above the diagonal their rank correlations."
        yield "figures", scatter_matrix(found, title=""), told
    if any(one.width for one in found.columns):
        yield "figures", bands(found, title=""), "Quantities over the motion, between percentiles of the designs."


@_plots.register
def _(found: ToleranceAnalysis) -> Iterator[SectionPlot]:
    outputs = list(found.values())[:MOST]
    if any(one.is_course for one in outputs):
        names = [one.name for one in outputs if one.is_course]
        yield "bands", bands(found, *names, title=""), "Errors over the motion."
    for one in outputs:
        said = f"What contributes to the error of {one.name}."
        yield "contributions", contributions(found, one.name, title=""), said


@_plots.register
def _(found: Optimum) -> Iterator[SectionPlot]:
    yield "optimum", improvement(found, title=""), "What became better: the mechanism as it stood, and the best one."
    yield "minima", starts(found, title=""), "Where the searches began and ended."
