"""Studies of files: `load_study`, `loads_study`."""

from __future__ import annotations

import os
from pathlib import Path

from compoundkin.base.arguments import checked
from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism
from compoundkin.files.parsed_document import Syntax, heading, known_syntax, parsed, text_of, too_deep
from compoundkin.studies.study import Study, study
from compoundkin.studies.study_files.study_reader import study_arguments


@checked
def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study of a TOML or JSON file, distinguished by the suffix.

    Raises InvalidInput for a file that cannot be read, or listing all problems of its content; and what `study` raises.

    >>> load_study("no/such.toml")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: no/such.toml: there is no such file
    """
    return loads_study(*text_of(path, "study"), where=str(path), folder=Path(path).parent)


def loads_study(text: str, syntax: Syntax = "toml", *, where: str = "study file", folder: Path = Path()) -> Study:
    """Return the study that a text in TOML or JSON says.

    Its paths are seen from a folder; `where` names the text in errors.
    """
    try:
        arguments = study_arguments(parsed(text, known_syntax(syntax), where, "study"), folder, where)
    except RecursionError:
        error = too_deep(where)
        raise InvalidInput(error.problems, error.heading) from None
    except InvalidMechanism as error:
        raise InvalidInput(error.problems, error.heading) from None
    try:
        return study(**arguments)
    except CompoundkinError as error:
        raise type(error)(error.problems, heading([*error.problems], where)) from None
