"""Errors and warnings: one small tree of exceptions that say where a problem is and how to mend it."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from threading import Lock
from typing import Any

from compoundkin.base.display import escaped_text


@dataclass(frozen=True)
class Problem:
    """One problem: where it is, what it is, and how to mend it.

    >>> print(Problem("drives[0].link", "there is no link 'crnk'", "did you mean 'crank'?"))
    drives[0].link: there is no link 'crnk'; did you mean 'crank'?
    """

    where: str
    what: str
    remedy: str = ""

    def __str__(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return escaped_text(f"{text}; {self.remedy}" if self.remedy else text)


class CompoundkinError(Exception):
    """The root of every error compoundkin raises on purpose. `problems` lists all that was found.

    `exit_code` is what the command line answers with.
    """

    exit_code = 2

    def __init__(self, problems: Iterable[Problem] | Problem | str, heading: str = "") -> None:
        if isinstance(problems, str):
            problems = Problem("", problems)
        if isinstance(problems, Problem):
            problems = (problems,)
        self.problems: tuple[Problem, ...] = tuple(problems)
        self.heading = heading
        super().__init__(self._text())

    def __reduce__(self) -> tuple[Any, ...]:
        # the text alone would lose its problems between processes
        return type(self), (self.problems, self.heading)

    def _text(self) -> str:
        if len(self.problems) == 1 and not self.heading:
            return str(self.problems[0])
        heading = self.heading or f"{len(self.problems)} problems"
        return "\n".join([f"{heading}:", *(f"  {problem}" for problem in self.problems)])


class InvalidMechanism(CompoundkinError, ValueError):
    """A mechanism or a mechanism file is not valid."""


class InvalidInput(CompoundkinError, ValueError):
    """A call was given values that do not fit the mechanism."""


class UnknownName(CompoundkinError, LookupError):
    """A name that the mechanism, its motion or the catalog does not have."""


class NotDetermined(CompoundkinError):
    """Mobility and drivers disagree, or a part of the mechanism is over- or under-constrained."""


class NotAssembled(CompoundkinError):
    """No pose, or not the requested pose, can be assembled."""

    exit_code = 3


class StudyStopped(CompoundkinError):
    """A study stopped before its end: workers died, or a disk was full. What was written stays."""


class UnassembledPoses(UserWarning):
    """Some poses of a motion cannot be assembled; they are NaN, masked and explained."""


class ChangePointWarning(UserWarning):
    """Drivers rest exactly at a change point, where two branches meet."""


class NearChangePoint(ChangePointWarning):
    """A motion turns back so near to a change point that a rounding of the dimensions decides."""


class DrawnBeyondEnd(UserWarning):
    """The drawn pose is beyond an end of a guide."""


class FewDigits(UserWarning):
    """Some rates have fewer than three digits, next to a limit position."""


class WedgedPoses(UserWarning):
    """Friction has no forces at some poses, or several. They are NaN, named and explained."""


class LikelySlip(UserWarning):
    """A value that is possible but most often a slip."""


class UnmetConstraints(UserWarning):
    """A search found no design at which all its constraints hold."""


def missing_extra(where: str, what: str, extra: str, otherwise: str = "") -> InvalidInput:
    """Return the error for a library that is not installed: what needs it, the extra that brings it, what else helps.

    >>> print(missing_extra("x.png", "PNG needs CairoSVG", "pictures", "save an .svg"))
    x.png: PNG needs CairoSVG; pip install 'compoundkin[pictures]', or save an .svg
    """
    remedy = f"pip install 'compoundkin[{extra}]'"
    return InvalidInput(Problem(where, what, f"{remedy}, or {otherwise}" if otherwise else remedy))


def warn(text: str, category: type[Warning]) -> None:
    """Warn at the line of the user's program that called the package."""
    import inspect
    import warnings

    own, frame, depth = __name__.partition(".")[0], inspect.currentframe(), 1
    # context managers used as decorators stand between the package's own calls
    while frame is not None and f"{frame.f_globals.get('__name__')}.".startswith((f"{own}.", "contextlib.")):
        frame, depth = frame.f_back, depth + 1
    warnings.warn(text, category, stacklevel=depth)


def suggestion(name: object, known: Sequence[str]) -> str:
    """Return the remedy for an unknown name: the closest known one, or the list of known ones.

    >>> suggestion("crnk", ["crank", "rod"])
    "did you mean 'crank'?"
    >>> suggestion("x", ["crank", "rod"])
    'known: crank, rod'
    """
    import difflib

    close = difflib.get_close_matches(str(name), known, n=1)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"known: {', '.join(known[:12])}{' ...' if len(known) > 12 else ''}" if known else "there is none"


_lock = Lock()
# Filters of warnings belong to the whole process: who comes first puts them up, who goes last takes them away.
_inside: list[ExitStack] = []
_count = [0]


@contextmanager
def suppress_pose_warnings() -> Iterator[None]:
    """Keep warnings of unassembled poses and few digits still. Threads may do so side by side."""
    with _lock:
        _count[0] += 1
        if _count[0] == 1:
            _inside.append(ExitStack())
            _inside[0].enter_context(warnings.catch_warnings())
            for category in (UnassembledPoses, FewDigits):
                warnings.simplefilter("ignore", category)
    try:
        yield
    finally:
        with _lock:
            _count[0] -= 1
            if not _count[0]:
                _inside.pop().close()
