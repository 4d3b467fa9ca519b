"""`save`: whatever can be saved, in the form that the file's suffix tells."""

from __future__ import annotations

import os
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import Kind, everything, form_of
from compoundkin.files.atomic import write_atomically
from compoundkin.files.mechanism_files import encoded
from compoundkin.files.table_files import WRITERS
from compoundkin.kinematics import Motion
from compoundkin.kinematics.table import Table
from compoundkin.model.mechanism import Mechanism


class Savable:
    """What saves itself in forms of its own: pictures, plots, animations, pages, reports."""

    saved_as: ClassVar[Kind]

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in one of the forms of its kind. The same every time."""
        raise NotImplementedError

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save it to a file in the form that the suffix tells.

        Raises InvalidInput for another suffix, where the file cannot be written, or where a library is missing.
        """
        content = self.content(form_of(self.saved_as, path))
        write_atomically(path, lambda file: file.write(content))


def save(what: Any, path: str | os.PathLike[str]) -> None:
    """Save anything to a file in the form that its suffix tells.

    A mechanism is a .toml or .json file; a motion or a table .csv or .json (angles in degrees), .npz or .parquet
    (radians); a picture .svg, .png, .pdf; a plot the same; an animation .gif, .mp4, .svg; a page .html; a report .txt,
    .md, .json, .html. Raises InvalidInput for another suffix, for what cannot be saved, where the file cannot be
    written, or where a library is missing.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(solve(crank, {"crank": 0.0}, order=0), f"{folder}/crank.csv")
    ...     print(Path(f"{folder}/crank.csv").read_text().splitlines()[0].split(",")[:2])
    ['crank.value [deg]', 'A.position.x [length]']
    """
    if isinstance(what, Savable):
        what.save(path)
    elif isinstance(what, Mechanism):
        content = encoded(what, form_of("mechanism", path), path)
        write_atomically(path, lambda file: file.write(content))
    elif isinstance(what, Motion | Table):
        write = WRITERS[form_of("table", path)]
        write_atomically(path, write(what if isinstance(what, Table) else what.table()))
    else:
        told = f"a {type(what).__name__} cannot be saved"
        raise InvalidInput(Problem(str(path), told, everything()))
