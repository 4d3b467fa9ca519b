"""The page of a report: its pictures, the moving sketch beside the text, plots of studies, all in one HTML file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.base.errors import CompoundkinError
from compoundkin.base.suffixes import Kind, suffix_for
from compoundkin.base.version import VERSION
from compoundkin.files.saved_files import Savable
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.page.html_blocks import Blocks
from compoundkin.view.page.html_document import Document, asset, vendored_library
from compoundkin.view.page.html_tables import names_of
from compoundkin.view.page.live.compact_data import compact
from compoundkin.view.page.live.live_assets import FIGURES, PANEL_SCRIPTS, PANEL_STYLES, is_live, scripts_of, styles_of
from compoundkin.view.page.markup import data_script, element, safe
from compoundkin.view.page.viewer import PANEL_KEY, PANEL_TITLE, Viewer, panel_section, viewer_of
from compoundkin.view.report.outputs_section import outputs_at_poses, outputs_table
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import ABOUT, Outcome, Section, Subject, TableBlock
from compoundkin.view.sketch import Picture, draw

# Of more links than this no picture is legible, and drawing takes long.
MOST_LINKS = 100
# The view of the structure at the head of a section, and its caption.
VIEWS = {
    "chain": ("graph", "The kinematic graph: links are its nodes, pairs the lines between them."),
    "groups": (
        "groups",
        "The mechanism taken apart, in solving order. Dashed circles are the pairs by which a group is attached.",
    ),
    "forces": (
        "free-bodies",
        "Free bodies: every link on its own with all that acts on it, to one scale, at the pose nearest the drawing.",
    ),
    "derivation": ("circle", "The circle diagram: a line for each instant centre, numbered in the order of the steps."),
}
OUTPUTS = "outputs"
# More cells than these make a page slow and large: the table then has the poses of the report.
MOST_CELLS = 12_000
# What draws the plots.
PLOTS = ("quantities.js", "curves.js", "plot_axis.js", "axes.js", "plot_panel.js", "plots.js")


def section_figures(sections: Sequence[Section], subject: Subject | None) -> dict[str, str]:
    """Return the figures at the heads of a report's sections, by their keys."""
    return dict(_view_figures(sections, subject)) if subject is not None and is_legible(subject) else {}


def sketch_figure(subject: Subject) -> str:
    """Return the kinematic sketch of one pose as a figure; "" where it cannot be drawn."""
    if not is_legible(subject):
        return ""
    try:
        picture = draw(subject)
    except CompoundkinError:
        return ""
    return element(
        "figure", f"{element('div', picture.inline, class_='picture')}\n<figcaption>The kinematic sketch.</figcaption>"
    )


def picture_figure(picture: Picture, caption: str) -> str:
    """Return a picture with a caption, in a box that scrolls where it would become too small."""
    attributes = {"role": "region", "aria_label": f"Picture: {caption}", "tabindex": "0"}
    box = element("div", picture.inline, class_="picture", style=f"--wide:{picture.width:.0f}px", **attributes)
    return element("figure", f"{box}\n<figcaption>{safe(caption)}</figcaption>")


def _view_figures(sections: Sequence[Section], subject: Subject) -> Iterator[tuple[str, str]]:
    for section in sections:
        if section.key in VIEWS:
            view, caption = VIEWS[section.key]
            try:
                yield section.key, picture_figure(draw(subject, kind=view), caption)
            except CompoundkinError:
                # a structure with faults cannot be decomposed
                continue


def is_legible(subject: Subject) -> bool:
    """Return whether a picture of all links can be read."""
    return len(subject.mechanism.links) <= MOST_LINKS


@dataclass(frozen=True, eq=False)
class EveryPose(Sample):
    """A sample that shows every pose."""

    @property
    def rows(self) -> tuple[int, ...]:
        """All poses."""
        return tuple(range(self.poses))


def with_every_pose(
    sections: Sequence[Section], motion: Motion, outputs: Sequence[str], design: int
) -> tuple[Sequence[Section], tuple[int, ...]]:
    """Return sections with the outputs at every pose, and the poses of the rows.

    `outputs` are those that the report was made with.
    """
    section = next((one for one in sections if one.key == OUTPUTS), None)
    table = _first_table(section)
    if section is None or table is None:
        return sections, ()
    sample = Sample(motion, design)
    if len(sample.rows) == sample.poses or sample.poses * len(table.columns) > MOST_CELLS:
        return sections, sample.rows
    every = EveryPose(motion, design)
    whole = outputs_table(every, outputs_at_poses(every, chosen_outputs(motion, outputs)))
    if [c.name for c in whole.columns] != [c.name for c in table.columns]:
        # the report is about other outputs
        return sections, sample.rows
    full = replace(whole, shown=sample.rows)
    changed = replace(section, blocks=tuple(full if block is table else block for block in section.blocks))
    return tuple(changed if one is section else one for one in sections), tuple(range(sample.poses))


def _first_table(section: Section | None) -> TableBlock | None:
    """Return the first table of a section."""
    blocks = section.blocks if section else ()
    return next((block for block in blocks if isinstance(block, TableBlock)), None)


@dataclass(frozen=True)
class Page(Savable):
    """A page as HTML that needs no other file and no network."""

    saved_as: ClassVar[Kind] = "page"

    html: str
    title: str = ""

    def content(self, form: str) -> bytes:
        """Return the bytes of the file; `form` is "html"."""
        return self.html.encode("utf-8")

    def open(self) -> Path:
        """Write it to a temporary file, show that in the browser if there is one, and return its path."""
        path = temporary_page()
        self.save(path)
        open_in_browser(path)
        return path

    def __repr__(self) -> str:
        return f"Page({self.title!r}, {len(self.html) / 1000:.0f} kB)"


def page_of(
    title: str,
    sections: Sequence[Section],
    outcome: Outcome,
    subject: Structure | Motion | None = None,
    outputs: Sequence[str] = (),
    design: int = 0,
    figures: Mapping[str, str] | None = None,
) -> Page:
    """Return any report as a page, with pictures of its subject, the moving sketch of a motion, and further figures."""
    motion = subject if isinstance(subject, Motion) else None
    known = subject.structure if isinstance(subject, Motion) else subject
    poses: dict[str, Sequence[int]] = {}
    if motion is not None:
        sections, poses[OUTPUTS] = with_every_pose(sections, motion, outputs, design)
    pictures = section_figures(sections, subject) | dict(figures or {})
    blocks = Blocks(names_of(known), pictures, poses)
    document = _document(title, sections, outcome, blocks)
    moving = None if motion is None else viewer_of(motion, design, outputs)
    if moving is not None:
        return Page(with_viewer(document, moving).html, title)
    return Page(replace(document, viewer=sketch_figure(subject) if subject is not None else "").html, title)


def _document(title: str, sections: Sequence[Section], outcome: Outcome, blocks: Blocks) -> Document:
    data = data_script("ck-groups", {"groups": blocks.names.members})
    contents = tuple((section.key, section.title) for section in sections)
    text = tuple(blocks.section(section) for section in sections if section.key != ABOUT)
    return Document(title, outcome, contents, blocks.about(sections), text, VERSION, data=(data,))


def temporary_page() -> Path:
    """Return a new temporary file for a page."""
    handle, name = tempfile.mkstemp(prefix="compoundkin-", suffix=suffix_for("page", "html"))
    os.close(handle)
    return Path(name)


def open_in_browser(path: Path) -> bool:
    """Return whether a browser could be started to show a file."""
    import webbrowser  # few pages are opened, and it starts processes

    try:
        return webbrowser.open(path.resolve().as_uri())
    except (OSError, webbrowser.Error):
        return False


def with_viewer(document: Document, moving: Viewer) -> Document:
    """Return a document with the moving sketch, its plots beside it, above its text.

    Before the text stands the panel of dimensions, where they can be changed.
    """
    live = is_live(moving.data)
    first = ((PANEL_KEY, PANEL_TITLE, panel_section()),) if live else ()
    beside = element("div", f"\n{moving.section}\n", class_="aside") if moving.plots else ""
    data = (*document.data, data_script("ck-motion", compact(moving.data)))
    library = vendored_library("uPlot.iife.min.js", "uPlot.LICENSE.txt", "uPlot")
    last, style = ((*FIGURES, *PANEL_SCRIPTS), PANEL_STYLES) if live else ((), ())
    scripts = *map(asset, scripts_of(moving.data)), library, *map(asset, (*PLOTS, *last))
    styles = asset("vendor/uPlot.min.css"), *map(asset, (*styles_of(moving.data), *style))
    sections = (*(text for _, _, text in first), *document.sections)
    before = (*((("motion", "Motion"),) if beside else ()), *((key, title) for key, title, _ in first))
    changed = replace(document, viewer=f"{moving.html}\n{beside}", sections=sections, before=before)
    return replace(changed, data=data, scripts=scripts, styles=styles)
