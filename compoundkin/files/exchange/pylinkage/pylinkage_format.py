"""The JSON of pylinkage, in and out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.drawings.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.json_text import parsed_json
from compoundkin.files.exchange.option_values import whole
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pylinkage.pylinkage_elements import pylinkage_drawing
from compoundkin.files.exchange.pylinkage.pylinkage_records import pylinkage_file
from compoundkin.files.exchange.pylinkage.pylinkage_writer import pylinkage_text
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

# What stands in their files of mechanisms, and of structures alone: graphs, and graphs of graphs.
_LISTS, _TOPOLOGY = (b'"joints"', b'"links"'), ((b'"nodes"', b'"edges"'), (b'"instances"', b'"connections"'))
# Steps of a turn, where nothing is said: pylinkage's own.
_STEPS, _MOST_STEPS = 360, 10_000_000
_REMEDY = "save the mechanism itself: mechanism_to_json(to_mechanism(graph, dimensions), path)"


class PylinkageFormat(Readable, Writable):
    """The JSON of pylinkage."""

    name: ClassVar[str] = "pylinkage"
    program: ClassVar[str] = "pylinkage"
    title: ClassVar[str] = "JSON of pylinkage"
    suffix: ClassVar[str] = suffix_for("mechanism", "json")
    options: ClassVar[Mapping[str, str]] = {"steps": f"steps in a turn of the fastest crank; {_STEPS} if left out"}

    def recognises(self, content: Content) -> bool:
        """Return whether it has joints and links, or nodes and edges."""
        if not (content.is_text and content.head.startswith("{")) or b'"bodies"' in content.raw:
            return False
        return any(all(word in content.raw for word in words) for words in (_LISTS, *_TOPOLOGY))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a file."""
        return imported(parsed_json(content), content.where, content.name)

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing what is no pin, and no slot of the frame."""
        steps = whole("steps", options.get("steps", _STEPS), 1, _MOST_STEPS)
        text, notes = pylinkage_text(drawing_of(shown), steps)
        return Exported(text.encode(), self.name, notes)


def imported(data: Any, where: str, title: str) -> Imported:
    """Return the mechanism that a document of pylinkage says. Raises InvalidInput for what it cannot say."""
    problems = Problems(where)
    if isinstance(data, dict) and "links" not in data and {"nodes", "instances"} & {*data}:
        raise InvalidInput(Problem(where, "this is topology only: a graph without dimensions", _REMEDY))
    file = pylinkage_file(data, problems)
    problems.raise_if_any()
    return mechanism_of(pylinkage_drawing(file, problems, title or "Mechanism of pylinkage"), "pylinkage", where)


FORMAT = PylinkageFormat()
