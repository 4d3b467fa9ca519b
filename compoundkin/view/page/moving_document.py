"""A report as a page with its moving sketch beside it, and the scripts, styles and data of that."""

from __future__ import annotations

from dataclasses import replace

from compoundkin.view.page.html_document import Document, asset, vendored
from compoundkin.view.page.live.lean_data import lean
from compoundkin.view.page.live.live_assets import FIGURES, PANEL_SCRIPTS, PANEL_STYLES, is_live, scripts_of, styles_of
from compoundkin.view.page.live.panel_section import KEY, TITLE, panel_section
from compoundkin.view.page.markup import data_script
from compoundkin.view.page.viewer import Viewer

# What draws the plots.
PLOTS = ("quantities.js", "curves.js", "plot_axis.js", "axes.js", "plot_panel.js", "plots.js")


def with_viewer(document: Document, moving: Viewer) -> Document:
    """Return a document with the moving sketch beside its text.

    Before that stand the panel of dimensions, where they can be changed, and the plots.
    """
    live = is_live(moving.data)
    first = ((KEY, TITLE, panel_section()),) if live else ()
    first = (*first, ("motion", "Motion", moving.section)) if moving.plots else first
    data = (*document.data, data_script("ck-motion", lean(moving.data)))
    library = vendored("uPlot.iife.min.js", "uPlot.LICENSE.txt", "uPlot")
    last, style = ((*FIGURES, *PANEL_SCRIPTS), PANEL_STYLES) if live else ((), ())
    scripts = *map(asset, scripts_of(moving.data)), library, *map(asset, (*PLOTS, *last))
    styles = asset("vendor/uPlot.min.css"), *map(asset, (*styles_of(moving.data), *style))
    sections = (*(text for _, _, text in first), *document.sections)
    before = tuple((key, title) for key, title, _ in first)
    changed = replace(document, viewer=moving.html, sections=sections, before=before)
    return replace(changed, data=data, scripts=scripts, styles=styles)
