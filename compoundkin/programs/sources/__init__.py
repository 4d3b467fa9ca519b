"""Texts of programs in other languages: one file for each language, and this registry."""

from __future__ import annotations

from collections.abc import Mapping

from compoundkin.programs.sources.c_text import CLanguage
from compoundkin.programs.sources.javascript_text import JavaScriptLanguage
from compoundkin.programs.sources.matlab_text import MatlabLanguage
from compoundkin.programs.sources.python_text import PythonLanguage
from compoundkin.programs.sources.written_program import Language

LANGUAGES: Mapping[str, Language] = {
    one.name: one for one in (CLanguage(), PythonLanguage(), JavaScriptLanguage(), MatlabLanguage())
}
