"""A report with its pictures as one HTML file: the mechanism taken apart, its graph, the outputs at all poses."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, TypeAlias

from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs
from compoundkin.base.errors import CompoundkinError
from compoundkin.base.suffixes import Kind, suffix_for
from compoundkin.base.version import VERSION
from compoundkin.files.saved_files import Savable
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.page.html_blocks import ABOUT, Blocks
from compoundkin.view.page.html_document import Document
from compoundkin.view.page.html_tables import names_of
from compoundkin.view.page.markup import data_script, element, safe
from compoundkin.view.page.moving_document import with_viewer
from compoundkin.view.page.study_pictures import study_pictures
from compoundkin.view.page.viewer import viewer_of
from compoundkin.view.report.outputs_section import outputs_at_poses, outputs_table
from compoundkin.view.report.report_data import Outcome, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.sketch import Picture, draw

# Of more links than this no picture is legible, and drawing takes long.
MOST_LINKS = 100

Subject: TypeAlias = Structure | Motion

# Which view of the structure stands at the head of which section, and what is said below it.
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


def figures(sections: Sequence[Section], subject: Subject | None) -> dict[str, str]:
    """Return the figures at the heads of a report's sections, by their keys."""
    return dict(_figures(sections, subject)) if subject is not None and _drawn(subject) else {}


def sketch(subject: Subject) -> str:
    """Return the kinematic sketch of one pose as a figure. It is "" where there is none."""
    if not _drawn(subject):
        return ""
    try:
        picture = draw(subject)
    except CompoundkinError:
        return ""
    return element(
        "figure", f"{element('div', picture.inline, class_='picture')}\n<figcaption>The kinematic sketch.</figcaption>"
    )


def figure(picture: Picture, caption: str) -> str:
    """Return a picture with what is said below it. It is in a box that scrolls where it would become too small."""
    told = {"role": "region", "aria_label": f"Picture: {caption}", "tabindex": "0"}
    box = element("div", picture.inline, class_="picture", style=f"--wide:{picture.width:.0f}px", **told)
    return element("figure", f"{box}\n<figcaption>{safe(caption)}</figcaption>")


def _figures(sections: Sequence[Section], subject: Subject) -> Iterator[tuple[str, str]]:
    for section in sections:
        if section.key in VIEWS:
            view, caption = VIEWS[section.key]
            try:
                yield section.key, figure(draw(subject, kind=view), caption)
            except CompoundkinError:
                # what has faults cannot be taken apart; the report says why
                continue


def _drawn(subject: Subject) -> bool:
    return len(subject.mechanism.links) <= MOST_LINKS


@dataclass(frozen=True, eq=False)
class Whole(Sample):
    """A sample that shows every pose."""

    @property
    def rows(self) -> tuple[int, ...]:
        """All poses."""
        return tuple(range(self.poses))


def all_poses(
    sections: Sequence[Section], motion: Motion, outputs: Sequence[str], design: int
) -> tuple[Sequence[Section], tuple[int, ...]]:
    """Return sections with the outputs at every pose, and the rows' poses. The rows are those of the table.

    `outputs` are those that the report was made with.
    """
    section = next((one for one in sections if one.key == OUTPUTS), None)
    table = _table(section)
    if section is None or table is None:
        return sections, ()
    sample = Sample(motion, design)
    if len(sample.rows) == sample.poses or sample.poses * len(table.columns) > MOST_CELLS:
        return sections, sample.rows
    every = Whole(motion, design)
    whole = outputs_table(every, outputs_at_poses(every, chosen_outputs(motion, outputs)))
    if [c.name for c in whole.columns] != [c.name for c in table.columns]:
        # the report is about other outputs
        return sections, sample.rows
    full = replace(whole, shown=sample.rows)
    changed = replace(section, blocks=tuple(full if block is table else block for block in section.blocks))
    return tuple(changed if one is section else one for one in sections), tuple(range(sample.poses))


def _table(section: Section | None) -> TableBlock | None:
    """The first table of a section."""
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
        """Write it to a temporary file and show that in the browser.

        It is shown where there is one; the file's path is returned.
        """
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
    studied: object = None,
) -> Page:
    """Return any report as a page. It has pictures of its subject, and the moving sketch of a motion."""
    motion = subject if isinstance(subject, Motion) else None
    known = subject.structure if isinstance(subject, Motion) else subject
    poses: dict[str, Sequence[int]] = {}
    if motion is not None:
        sections, poses[OUTPUTS] = all_poses(sections, motion, outputs, design)
    pictures = figures(sections, subject) | study_pictures(studied)
    blocks = Blocks(names_of(known), pictures, poses)
    document = _document(title, sections, outcome, blocks)
    moving = None if motion is None else viewer_of(motion, design, outputs)
    if moving is not None:
        return Page(with_viewer(document, moving).html, title)
    return Page(replace(document, viewer=sketch(subject) if subject is not None else "").html, title)


def _document(title: str, sections: Sequence[Section], outcome: Outcome, blocks: Blocks) -> Document:
    data = data_script("ck-groups", {"groups": blocks.names.members})
    contents = tuple((section.key, section.title) for section in sections)
    text = tuple(blocks.section(section) for section in sections if section.key != ABOUT)
    return Document(title, outcome, contents, blocks.about(sections), text, VERSION, data=(data,))


def temporary() -> Path:
    """Return a new file for a page that is only looked at."""
    handle, name = tempfile.mkstemp(prefix="compoundkin-", suffix=suffix_for("page", "html"))
    os.close(handle)
    return Path(name)


def shown_in_browser(path: Path) -> bool:
    """Tell whether a browser could be asked to show a file."""
    try:
        return webbrowser.open(path.resolve().as_uri())
    except (OSError, webbrowser.Error):
        return False
