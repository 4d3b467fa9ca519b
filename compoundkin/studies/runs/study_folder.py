"""The folder of a study: the study itself, and parts that are there whole or not at all."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import time
from typing import NamedTuple

from compoundkin.base.errors import InvalidInput, LikelySlip, warn
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.atomic import write_atomically
from compoundkin.studies.runs.parquet_parts import rows_of_part
from compoundkin.studies.runs.row_pieces import missing_rows

_SUFFIX = suffix_for("table", "parquet")
_PART = re.compile(rf"rows-(\d+)-(\d+){re.escape(_SUFFIX)}")
# What a writer leaves that was killed; another may still be writing what is younger, in seconds.
_LEFT, _YOUNG = ".*.tmp", 3600


class StudyPart(NamedTuple):
    """A part: its file and its rows.

    The `fresh` ones are those that no part before it has.
    """

    path: Path
    rows: range
    fresh: range


@dataclass(frozen=True)
class StudyFolder:
    """A folder of a study: where it is, and the fingerprint of the study."""

    path: Path
    fingerprint: str

    def part(self, rows: range) -> Path:
        """Return where the part of some rows is or will be."""
        return self.path / f"rows-{rows.start:09d}-{rows.stop:09d}{_SUFFIX}"

    def write(self, rows: range, content: bytes) -> None:
        """Write the part of some rows.

        Raises InvalidInput where it cannot be written, and no other run has put these rows there meanwhile: one that
        completes the folder sweeps what is being written.
        """
        try:
            write_atomically(self.part(rows), lambda file: file.write(content))
        except InvalidInput:
            if any(one.stop > rows.start for one in self.missing(rows.stop)):
                raise

    def parts(self) -> tuple[StudyPart, ...]:
        """Return the parts that are there, in order.

        Warns LikelySlip of files that are damaged or belong to another study: their rows count as missing.
        """
        found: list[StudyPart] = []
        named = [(_PART.fullmatch(path.name), path) for path in self.path.iterdir()]
        there = [(range(int(match[1]), int(match[2])), path) for match, path in named if match]
        reached = 0
        # runs with other chunks leave parts that overlap: the rows are the same, each is taken once
        for rows, path in sorted(there, key=lambda one: (one[0].start, -one[0].stop)):
            if rows_of_part(path, self.fingerprint) != rows:
                warn(f"{path}: the part is damaged or of another study: its rows count as missing", LikelySlip)
            elif rows.stop > reached:
                found.append(StudyPart(path, rows, range(max(rows.start, reached), rows.stop)))
                reached = rows.stop
        return tuple(found)

    def missing(self, count: int) -> list[range]:
        """Return which of so many rows are in no part."""
        return list(missing_rows((part.fresh for part in self.parts()), count))

    def sweep(self, is_complete: bool) -> None:
        """Remove what killed writers left; where rows are missing, only what is old."""
        for path in self.path.glob(_LEFT):
            # another run may finish its file meanwhile
            with suppress(FileNotFoundError):
                if is_complete or time() - path.stat().st_mtime > _YOUNG:
                    path.unlink()
