"""Rows of a study kept in a folder: workers write their parts, or send them where they do not see the folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem, StudyStopped
from compoundkin.studies.runs.contract import RunStore
from compoundkin.studies.runs.folder_head import FolderHead, head_of
from compoundkin.studies.runs.parquet_parts import part_content
from compoundkin.studies.runs.rows_in_folder import RowsInFolder
from compoundkin.studies.runs.study_folder import StudyFolder
from compoundkin.studies.runs.study_plan import StudyPlan
from compoundkin.studies.runs.study_task import computed, kept_program
from compoundkin.studies.runs.study_versions import told_versions, versions


@dataclass(frozen=True)
class PartTask:
    """Computes a part of a study and writes it. It may be pickled."""

    plan: StudyPlan
    folder: StudyFolder
    token: str
    versions: Mapping[str, str]

    def __call__(self, rows: range) -> bytes | None:
        """Write the part of some rows; return its bytes where the folder is not seen from here.

        Raises InvalidInput where other versions compute here than where the run was started.
        """
        program = kept_program(self.plan)
        if other := told_versions(versions(program), self.versions):
            raise InvalidInput(Problem("on", f"a worker has {other}", "give all workers the same versions"))
        content = part_content(self.plan.columns, computed(self.plan, rows), self.folder.fingerprint)
        if not is_seen(self.folder.path, self.token):
            return content
        self.folder.write(rows, content)
        return None


@lru_cache(16)
def is_seen(place: Path, token: str) -> bool:
    """Return whether a folder is there.

    Another of the same name on another machine is not the same.
    """
    try:
        return head_of(place).token == token
    except InvalidInput:
        return False


@dataclass(frozen=True, eq=False, repr=False)
class FolderStore(RunStore):
    """A folder of parts. What is in it stays, whatever happens to the run."""

    folder: StudyFolder
    head: FolderHead

    def missing(self) -> Iterator[range]:
        """Yield the rows that are in no part.

        What killed writers left long ago is removed.
        """
        self.folder.sweep(is_complete=False)
        yield from self.folder.missing(len(self.plan))

    @property
    def task(self) -> Callable[[range], Any]:
        """What writes a part."""
        return PartTask(self.plan, self.folder, self.head.token, versions(self.plan.program))

    def take(self, rows: range, answer: bytes | None) -> None:
        """Write a part that a worker has sent."""
        if answer is not None:
            self.folder.write(rows, answer)

    def finished(self) -> RowsInFolder:
        """Return all rows; raises StudyStopped where parts are not to be seen."""
        parts = self.folder.parts()
        if lost := len(self.plan) - sum(len(part.fresh) for part in parts):
            raise StudyStopped(
                Problem(str(self.folder.path), f"{lost} rows were written that are not there", "run again")
            )
        self.folder.sweep(is_complete=True)
        return RowsInFolder(self.head.columns, parts)

    def kept(self) -> str:
        """Return how many rows are there."""
        there = len(self.plan) - sum(map(len, self.folder.missing(len(self.plan))))
        return f"{there:,} of {len(self.plan):,} rows are written in {self.folder.path}: run again to go on"
