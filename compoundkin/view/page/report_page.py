"""`page`: a report with its pictures as one HTML file."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from compoundkin.base.version import VERSION
from compoundkin.files.atomic import write_atomically
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.page.all_poses import OUTPUTS, all_poses
from compoundkin.view.page.asset_files import asset, vendored
from compoundkin.view.page.figures import figures, sketch
from compoundkin.view.page.html_blocks import Blocks
from compoundkin.view.page.html_document import Document
from compoundkin.view.page.link_names import names_of
from compoundkin.view.page.markup import data_script
from compoundkin.view.page.viewer import Viewer, viewer_of
from compoundkin.view.report import Report, report


@dataclass(frozen=True)
class Page:
    """A page as HTML that needs no other file and no network."""

    html: str
    title: str = ""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file, whole or not at all.

        Raises InvalidInput where the file cannot be written.
        """
        made = self.html.encode("utf-8")
        write_atomically(path, lambda file: file.write(made))

    def open(self) -> Path:
        """Write it to a temporary file and show that in the browser, where there is one; the file's path."""
        path = temporary()
        self.save(path)
        shown_in_browser(path)
        return path


def page(subject: Structure | Motion, outputs: Sequence[str] = (), design: int = 0) -> Page:
    """The report of a motion, or of a structure before it is solved, as a page; the arguments are those of `report`.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.structure import decompose
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> page(decompose(crank)).html.splitlines()[0]
    '<!DOCTYPE html>'
    """
    made = report(subject, outputs, design)
    if isinstance(subject, Motion):
        return page_of(made, motion=subject, design=design, outputs=outputs)
    return page_of(made, structure=subject)


def page_of(
    report: Report,
    structure: Structure | None = None,
    motion: Motion | None = None,
    design: int = 0,
    outputs: Sequence[str] = (),
) -> Page:
    """Any report as a page: with pictures where its structure is given, with the moving sketch where its motion is."""
    subject = motion if motion is not None else structure
    known = motion.structure if motion is not None else structure
    poses: dict[str, Sequence[int]] = {}
    if motion is not None and report.section(OUTPUTS):
        report, poses[OUTPUTS] = all_poses(report, motion, outputs, design)
    blocks = Blocks(names_of(known), figures(report, subject), poses)
    document = _document(report, blocks)
    moving = None if motion is None else viewer_of(motion, design, outputs)
    if moving is not None:
        return Page(_with_viewer(document, moving).html, report.title)
    return Page(replace(document, viewer=sketch(subject) if subject is not None else "").html, report.title)


def _document(report: Report, blocks: Blocks) -> Document:
    data = data_script("ck-groups", {"groups": blocks.names.members})
    return Document(report, blocks.about(report), tuple(blocks.sections(report)), VERSION, data=(data,))


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
    handle, name = tempfile.mkstemp(prefix="compoundkin-", suffix=".html")
    os.close(handle)
    return Path(name)


def shown_in_browser(path: Path) -> bool:
    """Whether a browser could be asked to show a file."""
    try:
        return webbrowser.open(path.resolve().as_uri())
    except (OSError, webbrowser.Error):
        return False
