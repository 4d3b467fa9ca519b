"""GeoGebra, written: a construction as a .ggb file or as commands, with notes on what it leaves out."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any, ClassVar
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from compoundkin.base.display import count_phrase
from compoundkin.files.exchange.contract import Exported, Writable
from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.geogebra_xml import window_of, xml_of
from compoundkin.files.exchange.geogebra.mechanism_construction import construction_of, ranged_motion
from compoundkin.files.exchange.posed_mechanism import PosedMechanism

# The day that every file in the archive bears, so that the same mechanism makes the same bytes: the earliest there is.
_DAY = (1980, 1, 1, 0, 0, 0)


class GeogebraFile(Writable):
    """An archive with the construction in it."""

    name: ClassVar[str] = "geogebra"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra file"
    suffix: ClassVar[str] = ".ggb"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = xml_of(build, shown.mechanism.title, window_of(ranged_motion(shown)))
        content = BytesIO()
        with ZipFile(content, "w") as archive:
            entry = ZipInfo("geogebra.xml", _DAY)
            entry.compress_type = ZIP_DEFLATED
            archive.writestr(entry, text)
        return Exported(content.getvalue(), self.name, notes_of(shown, build))


FORMAT = GeogebraFile()


class GeogebraCommands(Writable):
    """The list of commands."""

    name: ClassVar[str] = "geogebra-commands"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra commands"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the commands. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = "\n".join(build.lines) + "\n"
        return Exported(text.encode(), self.name, notes_of(shown, build))


COMMANDS = GeogebraCommands()


def notes_of(shown: PosedMechanism, build: Construction) -> tuple[str, ...]:
    """Return what does not come across."""
    return tuple(_notes(shown, build))


def _notes(shown: PosedMechanism, build: Construction) -> Iterator[str]:
    mechanism = shown.mechanism
    loads = len(mechanism.loads) + len(mechanism.frictions) + len(mechanism.pretensions)
    kinds = ((len(mechanism.masses), "mass", "masses"), (loads, "load", ""), (len(mechanism.outlines), "outline", ""))
    if left := ", ".join(count_phrase(count, one, many) for count, one, many in kinds if count):
        yield f"left out: {left}"
    for lead in mechanism.prescribed_motions.values():
        yield f"what leads {lead.name} is not in the construction: its coordinates have sliders of their own"
    changing = [step.name for step in build.steps if step.look == "helper" and step.caption and "mode" in step.caption]
    for name in changing:
        yield f"{name} changes where the links are in line, as the motion does: with other lengths set it to 1 or -1"
    for name in build.beyond:
        yield f"{name} begins at the end of its range: the pose that is asked for, or drawn, lies beyond"
    for name, slider in build.driven.items():
        if not build.is_slider(slider):
            yield f"{name} has a single value: it is a number to be changed"
