"""What writes itself as functions in other languages, and is saved as such."""

from __future__ import annotations

from typing import ClassVar

from compoundkin.base.arguments import checked
from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.base.suffixes import Kind
from compoundkin.programs.recorded_path import PathVariants
from compoundkin.programs.sources import LANGUAGES
from compoundkin.programs.sources.contract import WrittenProgram
from compoundkin.programs.sources.path_text import written_program


class WritesSources:
    """A path of a mechanism that writes itself in other languages."""

    saved_as: ClassVar[Kind] = "program"
    programs: PathVariants

    @checked
    def source(self, language: str, name: str = "") -> str:
        """Return it as a function in another language: "c", "python", "javascript" or "matlab".

        It needs nothing else. `name` is what the function is called. Raises UnknownName for other languages, and
        InvalidInput for what no text can compute, such as a mechanism that passes change points.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.model.mechanism import Mechanism
        >>> from compoundkin.programs.compilation import compile
        >>> crank = Mechanism("A crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> "out->B_position_x = B_x;" in compile(crank, "B.position").source("c")
        True
        """
        if language not in LANGUAGES:
            raise UnknownName(Problem("language", f"{language!r} is none of them", nearest(language, list(LANGUAGES))))
        return LANGUAGES[language].text(self.written(name))

    def written(self, name: str = "") -> WrittenProgram:
        """Return what all languages write."""
        return written_program(self.programs, name)

    def content(self, form: str) -> bytes:
        """Return the file of a function in a language, for `save`."""
        return self.source(form).encode("utf-8")
