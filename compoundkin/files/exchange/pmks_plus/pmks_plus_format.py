"""Share links and files of PMKS+: read of all ages, written as of 2026."""

from __future__ import annotations

from typing import ClassVar

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.exchanged import Imported
from compoundkin.files.exchange.pmks_plus.drawn_share import drawing_of_shared
from compoundkin.files.exchange.pmks_plus.record_fields import records_of
from compoundkin.files.exchange.pmks_plus.reference_problems import note_problems
from compoundkin.files.exchange.pmks_plus.share_text import is_share_string, sections_of
from compoundkin.files.exchange.problems import Problems

# How many records a link may have; the largest known has fifty.
MOST_RECORDS = 2000


class PmksPlusFormat(Readable):
    """Links of PMKS+, the web app, and its files, which hold the same string."""

    name: ClassVar[str] = "pmks+"
    program: ClassVar[str] = "PMKS+"
    title: ClassVar[str] = "PMKS+ share link"

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


FORMAT = PmksPlusFormat()
