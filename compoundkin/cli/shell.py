"""Between the program and the shell: results to stdout, all else to stderr, exit codes, no tracebacks."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable
from typing import Any, NoReturn

import click

from compoundkin.base.errors import CompoundkinError, Problem
from compoundkin.base.texts import written_out

BAD_INPUT, NOT_ASSEMBLED, FAILED = 2, 3, 4
# As if ended by the signal: what shells expect of a filter whose reader has gone, and of Ctrl-C.
READER_GONE, INTERRUPTED = 141, 130
# Reports are made for 80 columns; a wider terminal is used up to where lines become hard to read.
WIDTH, WIDEST, NARROWEST = 80, 100, 60


class NotWritten(CompoundkinError):
    """The results cannot be written to stdout."""


def guarded(run: Callable[[], Any]) -> NoReturn:
    """Run a command and exit. Exit with its code, or with a message and the code of what went wrong."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, _ended)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warned
            code = run()
    except click.ClickException as error:
        _tell(error.show)
        code = BAD_INPUT
    except CompoundkinError as error:
        show(error)
        code = error.exit_code
    except (click.Abort, KeyboardInterrupt):
        say("Interrupted.")
        code = INTERRUPTED
    except MemoryError:
        show(CompoundkinError(Problem("", "there is not enough memory for this", "ask for fewer poses at a time")))
        code = BAD_INPUT
    sys.exit(code or 0)


def _ended(number: int, _: object) -> NoReturn:
    """End as when Ctrl-C is pressed, so that what is half done is cleaned up."""
    sys.exit(128 + number)


def _warned(message: Warning | str, *_: Any, **__: Any) -> None:
    """Say a warning in a line of its own: where it was given is of no use to who typed the command."""
    say(f"Warning: {message}")


def put(text: str | bytes) -> None:
    """Write results to stdout; where nobody reads them any more, end quietly."""
    if sys.stdout is None:
        raise NotWritten(Problem("", "standard output is closed", "write to a file with -o"))
    if isinstance(text, bytes) and b"\0" in text and sys.stdout.isatty():
        raise NotWritten(Problem("", "this is no text for a terminal", "write to a file with -o"))
    try:
        # a name that the terminal's encoding lacks becomes a question mark, not an accident
        rest = memoryview(text if isinstance(text, bytes) else text.encode(sys.stdout.encoding or "utf-8", "replace"))
        sys.stdout.flush()
        while rest:
            # unbuffered streams (python -u) may take a part only, and say so by nothing but the count
            rest = rest[sys.stdout.buffer.write(rest) :]
        sys.stdout.flush()
    except BrokenPipeError:
        _forget(sys.stdout)
        raise click.exceptions.Exit(READER_GONE) from None
    except OSError as error:
        _forget(sys.stdout)
        raise NotWritten(Problem("", f"the results cannot be written: {error.strerror or error}")) from None


def say(text: str) -> None:
    """Write a diagnostic line to stderr, if it takes one."""
    _tell(lambda: click.echo(text, err=True))


def _tell(write: Callable[[], None]) -> None:
    """Write to stderr. Where it is closed or takes no more, the results and the exit code are what is left."""
    if sys.stderr is not None:
        try:
            write()
        except OSError:
            _forget(sys.stderr)


def show(error: CompoundkinError) -> None:
    """Tell an error on stderr: what, where, and how to mend it."""
    several = len(error.problems) > 1 or error.heading
    if several:
        say(f"{_red('Error:')} {error.heading or f'{len(error.problems)} problems'}")
    for problem in error.problems:
        head = "  - " if several else f"{_red('Error:')} "
        indent = "    " if several else "  "
        say(f"{head}{written_out(problem.what)}")
        for term, text in (("where", problem.where), ("remedy", problem.remedy)):
            if text:
                say(f"{indent}{term + ':':8}{written_out(text)}")


def has_colour(stream: Any) -> bool:
    """Tell whether a stream takes colour: a terminal that is not told otherwise (https://no-color.org).

    >>> import io
    >>> has_colour(io.StringIO())
    False
    """
    return (
        stream is not None
        and bool(stream.isatty())
        and not os.environ.get("NO_COLOR")
        and os.environ.get("TERM") != "dumb"
    )


def width() -> int:
    """Return the width of a report. It is the terminal's within bounds, 80 where there is none."""
    if sys.stdout is None or not sys.stdout.isatty():
        return WIDTH
    import shutil  # late: few commands need it

    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDTH, 24)).columns))


def _red(text: str) -> str:
    return click.style(text, fg="red", bold=True) if has_colour(sys.stderr) else text


def _forget(stream: Any) -> None:
    """Keep the interpreter from complaining about a stream once more when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
