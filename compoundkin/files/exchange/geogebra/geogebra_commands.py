"""A construction as commands of GeoGebra's input bar, one a line."""

from __future__ import annotations

from typing import Any, ClassVar

from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.geogebra.construction_notes import notes_of
from compoundkin.files.exchange.geogebra.mechanism_construction import construction_of
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


class GeogebraCommands(Writable):
    """The list of commands."""

    name: ClassVar[str] = "geogebra-commands"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra commands"

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the commands. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = "\n".join(build.lines) + "\n"
        return Exported(text.encode(), self.name, notes_of(shown, build))


FORMAT = GeogebraCommands()
