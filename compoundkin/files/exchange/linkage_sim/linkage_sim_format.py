"""The JSON of linkage_sim, read."""

from __future__ import annotations

from typing import ClassVar

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable
from compoundkin.files.exchange.exchanged import Imported
from compoundkin.files.exchange.json_text import parsed_json
from compoundkin.files.exchange.linkage_sim.sim_mechanism import sim_mechanism
from compoundkin.files.exchange.linkage_sim.sim_records import sim_file
from compoundkin.files.exchange.problems import Problems


class LinkageSimFormat(Readable):
    """The JSON of linkage_sim."""

    name: ClassVar[str] = "linkage-sim"
    program: ClassVar[str] = "linkage_sim"
    title: ClassVar[str] = "JSON of linkage_sim"

    def recognises(self, content: Content) -> bool:
        """Return whether it has bodies with points of their own."""
        words = (b'"bodies"', b'"attachment_points"')
        return content.is_text and content.head.startswith("{") and all(word in content.raw for word in words)

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a file. No pose is in it, so its mode is chosen, and told."""
        problems = Problems(content.where)
        file = sim_file(parsed_json(content), problems)
        problems.raise_if_any()
        title = content.name or "Mechanism of linkage_sim"
        try:
            mechanism, notes = sim_mechanism(file, problems, title)
        except InvalidMechanism as error:
            heading = f"{content.where or title}: it cannot be a mechanism"
            raise InvalidInput(error.problems, heading=heading) from None
        if file.load_cases:
            notes.append(f"left out: {count_phrase(file.load_cases, 'load case')}")
        return Imported(mechanism, self.name, tuple(notes))


FORMAT = LinkageSimFormat()
