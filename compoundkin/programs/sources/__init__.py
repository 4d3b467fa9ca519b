"""Texts of programs in other languages: one file for each language, and this registry."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from compoundkin.model.fields import LateKinds

if TYPE_CHECKING:
    from compoundkin.programs.sources.written_program import Language

LANGUAGES: Mapping[str, type[Language]] = LateKinds(
    __name__,
    {
        "c": "c_text.CLanguage",
        "python": "python_text.PythonLanguage",
        "javascript": "javascript_text.JavaScriptLanguage",
        "matlab": "matlab_text.MatlabLanguage",
    },
)
