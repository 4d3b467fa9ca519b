"""What a folder says of its study: `study.json`, read before anything is computed or written."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, warn
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.atomic import write_atomically
from compoundkin.files.parquet_library import parquet
from compoundkin.studies.runs.study_data import ORDER, differences, digest
from compoundkin.studies.runs.study_folder import StudyFolder
from compoundkin.studies.runs.study_plan import StudyPlan
from compoundkin.studies.runs.study_program import StudyColumn
from compoundkin.studies.runs.study_versions import told_versions, versions

FORMAT = 1
HEAD = f"study{suffix_for('mechanism', 'json')}"
_MORE = 3


class FolderHead(NamedTuple):
    """What `study.json` says of a study: its data, its columns, versions.

    `token` is a word that no other folder has.
    """

    study: Mapping[str, Any]
    columns: tuple[StudyColumn, ...]
    versions: Mapping[str, str]
    token: str


def prepared(path: str | os.PathLike[str], plan: StudyPlan) -> tuple[StudyFolder, FolderHead]:
    """Return the folder of a study, which is made where there is none.

    Raises InvalidInput for the folder of another study, for one with other files, and where it cannot be written.
    Warns LikelySlip where other versions have begun it.
    """
    parquet("folder")
    place = Path(os.path.abspath(path))
    own = FolderHead(plan.data, plan.columns, versions(plan.program), secrets.token_hex(8))
    if not os.path.exists(place / HEAD):
        _begin(place, own)
    there = head_of(place)
    _hold_same(place, own, there)
    return StudyFolder(place, plan.fingerprint), there


def head_of(place: Path) -> FolderHead:
    """Return what a folder says of its study. Raises InvalidInput where it is none."""
    try:
        found = json.loads((place / HEAD).read_bytes())
        known, columns = found["format"], tuple(StudyColumn(**column) for column in found["columns"])
        head = FolderHead(found["study"], columns, found["versions"], found["token"])
    except FileNotFoundError:
        raise InvalidInput(Problem(str(place), f"it is no folder of a study: it has no {HEAD}")) from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        what = getattr(error, "strerror", None) or "it is damaged"
        raise InvalidInput(Problem(str(place / HEAD), f"it cannot be read: {what}")) from None
    if known != FORMAT:
        raise InvalidInput(Problem(str(place / HEAD), f"its format {known} is not known", "update compoundkin"))
    return head


def _begin(place: Path, head: FolderHead) -> None:
    """Make a folder, or take an empty one."""
    try:
        place.mkdir(parents=True, exist_ok=True)
        others = [one.name for one in place.iterdir() if not one.name.startswith(".")]
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(place), f"it cannot be a folder of a study: {what}")) from None
    if os.path.exists(place / HEAD):
        # another run has begun it meanwhile
        return
    if others:
        what = f"it has files that are no study's, such as {others[0]}"
        raise InvalidInput(Problem(str(place), what, "name a new folder"))
    columns = [column._asdict() for column in head.columns]
    text = json.dumps({"format": FORMAT, **head._asdict(), "columns": columns}, indent=1)
    write_atomically(place / HEAD, lambda file: file.write(text.encode("utf-8", "surrogatepass")))


def _hold_same(place: Path, own: FolderHead, there: FolderHead) -> None:
    """Raise InvalidInput where a folder is that of another study."""
    if digest(own.study) != digest(there.study):
        where = list(differences(own.study, there.study))
        # the order says something only where the dimensions are the same
        where = [name for name in where if name != ORDER or where == [ORDER]]
        more = f" and {len(where) - _MORE} more" if len(where) > _MORE else ""
        what = f"it has rows of another study, which differs in {', '.join(where[:_MORE])}{more}"
        raise InvalidInput(Problem(str(place), what, "name another folder"))
    if other := told_versions(own.versions, there.versions):
        warn(f"{place}: rows were begun by other versions: now {other}; last digits may differ", LikelySlip)
