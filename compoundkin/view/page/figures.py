"""Pictures as figures of a page: the mechanism taken apart, its graph, the circle diagram of its centres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.page.markup import element, safe
from compoundkin.view.report.report_data import Section
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
    "derivation": ("circle", "The circle diagram: a line for each instant centre, numbered in the order of the steps."),
}


def figures(sections: Sequence[Section], subject: Subject | None) -> dict[str, str]:
    """The figures at the heads of the sections of a report, by the sections' keys."""
    return dict(_figures(sections, subject)) if subject is not None and _drawn(subject) else {}


def sketch(subject: Subject) -> str:
    """The kinematic sketch of one pose as a figure; "" where there is none."""
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
    """A picture with what is said below it, in a box that scrolls where it would become too small."""
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
