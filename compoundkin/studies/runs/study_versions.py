"""Versions of what computes a study, on which the last digits may depend."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.version import VERSION
from compoundkin.studies.runs.study_program import StudyProgram


def versions(program: StudyProgram) -> dict[str, str]:
    """Return what computes, with its version, and the back end of compiled programs."""
    import scipy

    back_end = program.path.compiled.backend
    return {"compoundkin": VERSION, "numpy": np.__version__, "scipy": scipy.__version__, "back end": back_end}


def told_versions(own: Mapping[str, str], other: Mapping[str, str]) -> str:
    """Return where two sets of versions differ, in words.

    >>> told_versions({"numpy": "2.2", "scipy": "1.17"}, {"numpy": "2.1", "scipy": "1.17"})
    'numpy 2.2, not 2.1'
    """
    names = [name for name in own if own[name] != other.get(name)]
    return "; ".join(f"{name} {own[name]}, not {other.get(name)}" for name in names)
