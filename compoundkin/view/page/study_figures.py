"""Plots of studies, tolerance analyses and searches in their pages, and the free bodies of a sheet of forces."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from functools import singledispatch
from importlib.util import find_spec
from typing import TypeAlias

from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.page.markup import element, lines, safe
from compoundkin.view.page.report_page import is_legible, picture_figure
from compoundkin.view.plot import Plot, bands, contributions, improvement, scatter_matrix, starts
from compoundkin.view.report.force_sheet import ForceSheet
from compoundkin.view.sketch import draw

# More outputs than these are no page: the tables have all.
MOST_OUTPUTS = 6
# The key of a section, its plot, and its caption.
SectionPlot: TypeAlias = tuple[str, Plot, str]


def study_figures(found: object) -> dict[str, str]:
    """Return the plots of a study, a tolerance analysis or a search as figures, by the keys of sections.

    Without Matplotlib there are none. Of a sheet of forces they are the free body and the polygon of each link.
    """
    if isinstance(found, ForceSheet):
        return (
            {key: sheet_figures(found, link) for key, link in found.links.items()}
            if is_legible(found.forces.motion)
            else {}
        )
    pictures: dict[str, str] = {}
    for key, plot, caption in _study_plots(found) if find_spec("matplotlib") else ():
        pictures[key] = pictures.get(key, "") + _plot_figure(plot, caption)
    return pictures


def sheet_figures(known: ForceSheet, link: str) -> str:
    """Return the free body of a link beside the polygon of its forces, where two or more act."""
    design, pose = known.scene.pose
    body = draw(known.forces, kind="free-bodies", pose=pose, design=design, link=link)
    figures = [picture_figure(body, f"The free body of {link}.")]
    if sum(bool(one.force) for one in known.acting[link]) > 1:
        polygon = draw(known.forces, kind="force-polygon", pose=pose, design=design, link=link)
        figures.append(picture_figure(polygon, f"The polygon of the forces on {link}."))
    return element("div", lines(figures), class_="beside")


def _plot_figure(plot: Plot, caption: str) -> str:
    """Return a plot with a caption, as an image, so that ids of several plots do not clash."""
    source = f"data:image/svg+xml;base64,{b64encode(plot.content('svg')).decode('ascii')}"
    image = f'<img src="{source}" alt="{safe(caption)}" style="max-width:100%;height:auto">'
    return element("figure", f"{image}\n<figcaption>{safe(caption)}</figcaption>")


@singledispatch
def _study_plots(found: object) -> Iterator[SectionPlot]:
    yield from ()


@_study_plots.register
def _(found: StudyResult) -> Iterator[SectionPlot]:
    if any(one.is_figure for one in found.columns):
        caption = "Dimensions and figures against each other; above the diagonal their rank correlations."
        yield "figures", scatter_matrix(found, title=""), caption
    if any(one.width for one in found.columns):
        yield "figures", bands(found, title=""), "Quantities over the motion, between percentiles of the designs."


@_study_plots.register
def _(found: ToleranceAnalysis) -> Iterator[SectionPlot]:
    outputs = list(found.values())[:MOST_OUTPUTS]
    if any(one.is_course for one in outputs):
        names = [one.name for one in outputs if one.is_course]
        yield "bands", bands(found, *names, title=""), "Errors over the motion."
    for one in outputs:
        caption = f"Contributions to the error of {one.name}."
        yield "contributions", contributions(found, one.name, title=""), caption


@_study_plots.register
def _(found: Optimum) -> Iterator[SectionPlot]:
    yield "optimum", improvement(found, title=""), "What became better: the mechanism as it stood, and the best one."
    yield "minima", starts(found, title=""), "Where the searches began and ended."
