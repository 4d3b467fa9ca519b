"""Share links and files of PMKS+: read of all ages, written as of 2026."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.files.exchange.content import Content, Problems
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable, flag, positive
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.pmks_plus_reader import drawing_of_shared, note_problems
from compoundkin.files.exchange.pmks_plus_text import body_of, is_share_string, link_of, records_of, sections_of
from compoundkin.files.exchange.pmks_plus_writer import share_of_drawing
from compoundkin.files.exchange.posed_mechanism import PosedMechanism

# How many records a link may have; the largest known has fifty.
MOST_RECORDS = 1000


class PmksPlusFormat(Readable, Writable):
    """Links of PMKS+, the web app, and its files, which hold the same string."""

    name: ClassVar[str] = "pmks+"
    program: ClassVar[str] = "PMKS+"
    title: ClassVar[str] = "PMKS+ share link"
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "scale": "by how much lengths are multiplied (else small mechanisms are written 100 units large or more)",
            "on_rails": "whether guides on the frame are links that it holds, so that their angles are not rounded",
        }
    )

    def recognises(self, content: Content) -> bool:
        """Return whether a content begins as a share string or a link with one."""
        return content.is_text and is_share_string(content.head)

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a link. Raises InvalidInput with all that is wrong."""
        where = content.where or "the link"
        problems = Problems(content.where)
        sections = sections_of(content.text, where)
        if len(sections.joints) + len(sections.links) + len(sections.forces) > MOST_RECORDS:
            problems.add("", f"it has more than {MOST_RECORDS} joints, links and forces")
            problems.raise_if_any()
        shared = records_of(sections, problems)
        note_problems(shared, problems)
        problems.raise_if_any()
        drawing = drawing_of_shared(shared, content.name or "PMKS+ mechanism", problems)
        problems.raise_if_any()
        return mechanism_of(drawing, self.name, content.where)

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the link."""
        scale = None if options.get("scale") is None else positive("scale", options["scale"], 1.0)
        shared = share_of_drawing(drawing_of(shown), scale, flag("on_rails", options.get("on_rails")))
        notes = shared.notes
        if shown.structure.redundant:
            named = ", ".join(pair.name for pair in shown.structure.redundant)
            notes += (f"it is held more than once ({named}): places of 3 decimals may not fit each other",)
        return Exported(link_of(body_of(shared)).encode(), self.name, notes)


FORMAT = PmksPlusFormat()
