"""A folder of a study opened by itself: the study that it tells, and the rows that are there."""

from __future__ import annotations

import os
from pathlib import Path

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.parquet_library import parquet
from compoundkin.studies.runs.folder_head import HEAD, head_of
from compoundkin.studies.runs.recovered_plan import plan_from
from compoundkin.studies.runs.rows_in_folder import RowsInFolder
from compoundkin.studies.runs.study_data import digest
from compoundkin.studies.runs.study_folder import StudyFolder
from compoundkin.studies.runs.study_plan import StudyPlan


def opened(path: str | os.PathLike[str]) -> tuple[StudyPlan, RowsInFolder]:
    """Return the study of a folder and its rows.

    Raises InvalidInput where it is no folder of a study, or where the study has functions of a program.
    """
    parquet("folder")
    place = Path(os.path.abspath(path))
    head = head_of(place)
    try:
        plan = plan_from(head.study)
    except (KeyError, TypeError, AttributeError):
        raise InvalidInput(Problem(str(place / HEAD), "what it says of the study is damaged")) from None
    return plan, RowsInFolder(head.columns, StudyFolder(place, digest(head.study)).parts())
