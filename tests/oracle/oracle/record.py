"""A record: one line of JSON for each part of each case, written to a compressed file."""

from __future__ import annotations

import gzip
import json
import math
import os
import re
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.cases import cases
from tests.oracle.program import asked, without_addresses

# Of the processor, so that a busy machine is not taken for a slow program.
SECONDS = 20
DIGITS = 15
SLOW = "too slow"


class Line(NamedTuple):
    """What is recorded of one part of a case, and the seconds that it took, which are not written."""

    case: str
    part: str
    found: Any
    took: float = 0.0


class TooSlow(BaseException):
    """A question that takes too long."""


def recorded(quick: bool = False, only: str = "", named: str = "") -> Iterator[Line]:
    """The lines of all cases, or of those whose name contains a text, of all parts or one."""
    root = Path.cwd()
    with tempfile.TemporaryDirectory() as folder, _standing_in(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for case in cases(quick):
            for part, question in case.questions.items():
                if named in case.name and only in ("", part):
                    began = time.process_time()
                    found = _plain(_in_time(question), (str(root), os.path.realpath(folder), folder))
                    yield Line(case.name, part, found, time.process_time() - began)


def written(path: str, lines: Iterator[Line]) -> int:
    """Write lines to a file; how many there were."""
    count, slowest, spent = 0, [], {}
    with gzip.open(path, "wt", encoding="utf-8", compresslevel=5) as file:
        for count, line in enumerate(lines, 1):  # noqa: B007
            file.write(json.dumps({"case": line.case, "part": line.part, "found": line.found}) + "\n")
            spent[line.part] = spent.get(line.part, 0.0) + line.took
            slowest = sorted([*slowest, (round(line.took, 1), line.part, line.case)])[-8:]
    print({part: round(seconds, 1) for part, seconds in spent.items()}, *slowest, sep="\n", file=sys.stderr)
    return count


def read(path: str) -> Iterator[Line]:
    """The lines of a file."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        for text in file:
            line = json.loads(text)
            yield Line(line["case"], line["part"], line["found"])


@contextmanager
def _standing_in(folder: str) -> Iterator[None]:
    """With a folder as the current one, so that paths in texts are always the same."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def _in_time(question: Callable[[], Any]) -> Any:
    def ring(*_: Any) -> None:
        raise TooSlow

    signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        return asked(question)
    except TooSlow:
        return SLOW
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _plain(value: Any, folders: tuple[str, ...]) -> Any:
    """A value as JSON has it: complex arrays as [re, im], floats to so many digits, texts without folders."""
    if isinstance(value, dict) or hasattr(value, "items"):
        return {str(key): _plain(one, folders) for key, one in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _numbers(np.asarray(value))
    if isinstance(value, list | tuple):
        return [_plain(one, folders) for one in value]
    if isinstance(value, complex):
        return _numbers(np.asarray(value))
    if isinstance(value, float):
        return _rounded(value)
    if value is None or isinstance(value, bool | int):
        return value
    return _told(str(value), folders)


def _numbers(array: Any) -> Any:
    if np.iscomplexobj(array):
        return [_numbers(array.real), _numbers(array.imag)]
    if array.dtype.kind == "f":
        return _nested(array.tolist())
    return array.tolist()


def _nested(value: Any) -> Any:
    return [_nested(one) for one in value] if isinstance(value, list) else _rounded(value)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else value


def _told(text: str, folders: tuple[str, ...]) -> str:
    for folder in folders:
        text = text.replace(folder, "FOLDER")
    return without_addresses(re.sub(r"compoundkin-\w{8}\.html", "compoundkin-X.html", text))
