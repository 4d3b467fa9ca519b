"""The format of the Linkage program: XML in files with the suffix `.linkage2`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, ClassVar

from compoundkin.files.exchange.content import MOST_BYTES, Content
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.linkage.linkage_reader import drawing_in
from compoundkin.files.exchange.linkage.linkage_writer import linkage_text
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.structure import Structure, decompose
from compoundkin.structure.assur_groups import roman

# The highest class of group that the program's own solver knows.
DYADS = 2


class LinkageFormat(Readable, Writable):
    """Files of the Linkage program, which solves dyads only."""

    # they may have a picture in the background
    most: ClassVar[int] = MOST_BYTES

    name: ClassVar[str] = "linkage"
    program: ClassVar[str] = "Linkage"
    title: ClassVar[str] = "Linkage file (.linkage2)"
    suffix: ClassVar[str] = ".linkage2"

    def recognises(self, content: Content) -> bool:
        """Return whether it begins as XML with an element `linkage2`, or nearly."""
        return content.head.startswith("<") and "<linkage" in content.head

    def read(self, content: Content) -> Imported:
        """Return the mechanism, and what the program could not make of it."""
        drawing, hints = drawing_in(content)
        found = mechanism_of(drawing, self.name, content.where)
        return replace(found, notes=(*found.notes, *_of_structure(found, hints)))

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing all that it cannot say."""
        text, notes = linkage_text(shown)
        return Exported(text.encode(), self.name, (*notes, *_beyond_dyads(shown.structure)))


def _of_structure(found: Imported, hints: str) -> Iterator[str]:
    """Yield what is told of the structure: groups that the program cannot simulate, freedoms that nothing drives."""
    structure = decompose(found.mechanism)
    yield from _beyond_dyads(structure)
    if not found.mechanism.drives:
        yield "nothing drives it: no connector is an input, no link an actuator"
    if hints and structure.faults:
        yield hints


def _beyond_dyads(structure: Structure) -> Iterator[str]:
    """Yield which groups the program's own solver does not know."""
    for group in structure.groups:
        if group.class_ > DYADS:
            links = ", ".join(group.links)
            yield (
                f"Linkage cannot simulate it: {links} are an Assur group of class {roman(group.class_)}"
                f" ({group.name}), and its solver knows dyads only; here all its configurations are found"
            )


FORMAT = LinkageFormat()
