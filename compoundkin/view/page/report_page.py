"""A report with its pictures as one HTML file."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

from compoundkin.base.suffixes import Kind, suffix_for
from compoundkin.base.version import VERSION
from compoundkin.files.saved_files import Savable
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.page.all_poses import OUTPUTS, all_poses
from compoundkin.view.page.asset_files import asset, vendored
from compoundkin.view.page.figures import figures, sketch
from compoundkin.view.page.html_blocks import ABOUT, Blocks
from compoundkin.view.page.html_document import Document
from compoundkin.view.page.link_names import names_of
from compoundkin.view.page.markup import data_script
from compoundkin.view.page.viewer import Viewer, viewer_of
from compoundkin.view.report.report_data import Outcome, Section


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
        """Write it to a temporary file and show that in the browser, where there is one; the file's path."""
        path = temporary()
        self.save(path)
        shown_in_browser(path)
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
) -> Page:
    """Return any report as a page: with pictures of its subject, with the moving sketch where that is a motion."""
    motion = subject if isinstance(subject, Motion) else None
    known = subject.structure if isinstance(subject, Motion) else subject
    poses: dict[str, Sequence[int]] = {}
    if motion is not None:
        sections, poses[OUTPUTS] = all_poses(sections, motion, outputs, design)
    blocks = Blocks(names_of(known), figures(sections, subject), poses)
    document = _document(title, sections, outcome, blocks)
    moving = None if motion is None else viewer_of(motion, design, outputs)
    if moving is not None:
        return Page(_with_viewer(document, moving).html, title)
    return Page(replace(document, viewer=sketch(subject) if subject is not None else "").html, title)


def _document(title: str, sections: Sequence[Section], outcome: Outcome, blocks: Blocks) -> Document:
    data = data_script("ck-groups", {"groups": blocks.names.members})
    contents = tuple((section.key, section.title) for section in sections)
    text = tuple(blocks.section(section) for section in sections if section.key != ABOUT)
    return Document(title, outcome, contents, blocks.about(sections), text, VERSION, data=(data,))


def _with_viewer(document: Document, moving: Viewer) -> Document:
    """The document with the moving sketch beside its text and the plots before it."""
    plots = (moving.section, *document.sections) if moving.plots else document.sections
    before = (("motion", "Motion"),) if moving.plots else ()
    data = (*document.data, data_script("ck-motion", moving.data))
    scripts = asset("player.js"), vendored("uPlot.iife.min.js", "uPlot.LICENSE.txt", "uPlot"), asset("plots.js")
    styles = asset("vendor/uPlot.min.css"), asset("player.css")
    changed = replace(document, viewer=moving.html, sections=plots, before=before)
    return replace(changed, data=data, scripts=scripts, styles=styles)


def temporary() -> Path:
    """A new file for a page that is only looked at."""
    handle, name = tempfile.mkstemp(prefix="compoundkin-", suffix=suffix_for("page", "html"))
    os.close(handle)
    return Path(name)


def shown_in_browser(path: Path) -> bool:
    """Whether a browser could be asked to show a file."""
    try:
        return webbrowser.open(path.resolve().as_uri())
    except (OSError, webbrowser.Error):
        return False
