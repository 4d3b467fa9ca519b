"""A folder of a study opened by itself: the study that it tells, and the rows that are there."""

from __future__ import annotations

import os
from pathlib import Path

from compoundkin.studies.recovered_plan import plan_from
from compoundkin.studies.runs.folder_head import head_of
from compoundkin.studies.runs.parquet_parts import parquet
from compoundkin.studies.runs.rows_in_folder import RowsInFolder
from compoundkin.studies.runs.study_folder import StudyFolder
from compoundkin.studies.study_data import digest
from compoundkin.studies.study_plan import StudyPlan


def opened(path: str | os.PathLike[str]) -> tuple[StudyPlan, RowsInFolder]:
    """Return the study of a folder and its rows.

    Raises InvalidInput where it is no folder of a study, or where the study has functions of a program.
    """
    parquet()
    place = Path(os.path.abspath(path))
    head = head_of(place)
    return plan_from(head.study), RowsInFolder(head.columns, StudyFolder(place, digest(head.study)).parts())
