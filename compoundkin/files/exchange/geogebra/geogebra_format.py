"""A construction as a file of GeoGebra, .ggb."""

from __future__ import annotations

from io import BytesIO
from typing import Any, ClassVar
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.geogebra.construction_notes import notes_of
from compoundkin.files.exchange.geogebra.drawn_shapes import window_of
from compoundkin.files.exchange.geogebra.geogebra_xml import xml_of
from compoundkin.files.exchange.geogebra.mechanism_construction import construction_of, ranged_motion
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

# The day that every file in the archive bears, so that the same mechanism makes the same bytes: the earliest there is.
_DAY = (1980, 1, 1, 0, 0, 0)


class GeogebraFile(Writable):
    """An archive with the construction in it."""

    name: ClassVar[str] = "geogebra"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra file"
    suffix: ClassVar[str] = ".ggb"

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
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
