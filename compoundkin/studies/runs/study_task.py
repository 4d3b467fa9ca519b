"""The task of a worker: rows of a study, whatever process it runs in."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from threading import Lock

from compoundkin.base.arrays import Number
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.studies.runs.study_plan import StudyPlan
from compoundkin.studies.runs.study_program import StudyProgram

# So many studies a worker keeps compiled.
KEPT = 4
_LOCK = Lock()


@dataclass(frozen=True)
class StudyTask:
    """Computes rows of a study. It may be pickled; a worker compiles a study once."""

    plan: StudyPlan

    def __call__(self, rows: range) -> dict[str, Number]:
        """Return some rows."""
        return computed(self.plan, rows)


def computed(plan: StudyPlan, rows: range) -> dict[str, Number]:
    """Return some rows of a study."""
    with suppress_pose_warnings():
        return kept_program(plan).rows(rows)


def kept_program(plan: StudyPlan) -> StudyProgram:
    """Return the program of a study, compiled once in each process."""
    with _LOCK:
        return _kept(plan).program


@lru_cache(KEPT)
def _kept(plan: StudyPlan) -> StudyPlan:
    return plan
