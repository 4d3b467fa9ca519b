"""Between the program and the shell: results to stdout, messages and progress to stderr, exit codes, no tracebacks."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import Any, NoReturn

import click

from compoundkin.base.display import escaped_text
from compoundkin.base.errors import CompoundkinError, Problem

BAD_INPUT, NOT_ASSEMBLED, FAILED = 2, 3, 4
# As if ended by the signal: what shells expect of a filter whose reader has gone, and of Ctrl-C.
READER_GONE, INTERRUPTED = 141, 130
# Reports are made for 80 columns; a wider terminal is used up to where lines become hard to read.
WIDTH, WIDEST, NARROWEST = 80, 100, 60
# Work of fewer seconds needs no message; a message is renewed this often.
PATIENCE, REFRESH = 2.0, 0.5


class NotWritten(CompoundkinError):
    """The results cannot be written to stdout."""


def guarded(run: Callable[[], Any]) -> NoReturn:
    """Run a command and exit with its code, or with a message and the code of the error."""
    _heard.clear()
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, _ended)
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a job in the background ignores it
            signal.signal(signal.SIGINT, _ended)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warned
            code = run()
    except click.ClickException as error:
        _write_to_stderr(error.show)
        code = BAD_INPUT
    except CompoundkinError as error:
        show_error(error)
        code = error.exit_code
    except (click.Abort, KeyboardInterrupt):
        say("Interrupted.")
        code = INTERRUPTED
    except MemoryError:
        show_error(
            CompoundkinError(Problem("", "there is not enough memory for this", "ask for fewer poses at a time"))
        )
        code = BAD_INPUT
    sys.exit(code or 0)


class _Interrupted(KeyboardInterrupt):
    """Ctrl-C. Once an `eval` has met the exact type, Python ends by the signal, whatever exit code it is given."""


# The signals that came.
_heard: list[int] = []


def _ended(number: int, _: object) -> NoReturn:
    """Note the signal, and leave."""
    _heard.append(number)
    _leave()


@contextmanager
def deferred_signals(act: Callable[[], object]) -> Iterator[None]:
    """Within, a signal to end calls `act`; only behind the block does it raise.

    What runs tasks of its own swallows exceptions that are raised wherever a task happens to be.
    """
    came: list[int] = []

    def note(number: int, _: object) -> None:
        came.append(number)
        act()

    heard = [number for number in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(number) is _ended]
    for number in heard:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number in heard:
            signal.signal(number, _ended)
    if came:
        _ended(came[0], None)


def _leave() -> NoReturn:
    """Leave by an exception, so that unfinished work is cleaned up."""
    if _heard[-1] == signal.SIGINT:
        raise _Interrupted
    sys.exit(128 + _heard[-1])


def leave_at_once() -> NoReturn:
    """Leave for the signal that came, though a library's thread still waits for something."""
    if _heard[-1] == signal.SIGINT:
        say("Interrupted.")
    os._exit(128 + _heard[-1])


def _warned(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning in a line of its own; its place in the code is of no use on the command line."""
    say(f"Warning: {message}")


def put(text: str | bytes) -> None:
    """Write results to stdout; exit without a message where the reader has gone."""
    if sys.stdout is None:
        raise NotWritten(Problem("", "standard output is closed", "write to a file with -o"))
    if isinstance(text, bytes) and b"\0" in text and sys.stdout.isatty():
        raise NotWritten(Problem("", "binary data cannot be shown on a terminal", "write to a file with -o"))
    try:
        # a name that the terminal's encoding lacks becomes a question mark, not an accident
        rest = memoryview(text if isinstance(text, bytes) else text.encode(sys.stdout.encoding or "utf-8", "replace"))
        sys.stdout.flush()
        while rest:
            # unbuffered streams (python -u) may take a part only, which only the returned count shows
            rest = rest[sys.stdout.buffer.write(rest) :]
        sys.stdout.flush()
    except BrokenPipeError:
        _discard_stream(sys.stdout)
        raise click.exceptions.Exit(READER_GONE) from None
    except OSError as error:
        _discard_stream(sys.stdout)
        raise NotWritten(Problem("", f"the results cannot be written: {error.strerror or error}")) from None


def say(text: str) -> None:
    """Write a line to stderr, if it is open."""
    _write_to_stderr(lambda: click.echo(text, err=True))


def _write_to_stderr(write: Callable[[], None]) -> None:
    """Write to stderr; where it is closed or full, results and exit code must do."""
    if sys.stderr is not None:
        try:
            write()
        except OSError:
            _discard_stream(sys.stderr)


def show_error(error: CompoundkinError) -> None:
    """Write an error to stderr: what, where, and the remedy."""
    several = len(error.problems) > 1 or error.heading
    if several:
        say(f"{_error_word()} {error.heading or f'{len(error.problems)} problems'}")
    for problem in error.problems:
        head = "  - " if several else f"{_error_word()} "
        indent = "    " if several else "  "
        say(f"{head}{escaped_text(problem.what)}")
        for term, text in (("where", problem.where), ("remedy", problem.remedy)):
            if text:
                say(f"{indent}{term + ':':8}{escaped_text(text)}")
    for note in getattr(error, "__notes__", ()):
        say(note)


def has_colour(stream: Any) -> bool:
    """Return whether a stream takes colour: a terminal without NO_COLOR (https://no-color.org) that is not dumb.

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


def report_width() -> int:
    """Return the width of a report in columns: the terminal's within bounds, 80 without one."""
    if sys.stdout is None or not sys.stdout.isatty():
        return WIDTH
    import shutil  # late: few commands need it

    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDTH, 24)).columns))


def _error_word() -> str:
    return click.style("Error:", fg="red", bold=True) if has_colour(sys.stderr) else "Error:"


def _discard_stream(stream: Any) -> None:
    """Keep the interpreter from flushing a broken stream when it exits."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def working(what: str, patience: float = PATIENCE) -> Iterator[None]:
    """Show on stderr what is being done and for how long, once it takes long and if stderr is a terminal.

    >>> with working("counting"):
    ...     sum(range(3))
    3
    """
    if not _is_terminal():
        yield
        return
    done = threading.Event()
    ticker = threading.Thread(target=_show_elapsed, args=(what, patience, done), daemon=True)
    ticker.start()
    try:
        yield
    finally:
        done.set()
        ticker.join()


def _is_terminal() -> bool:
    """Return whether stderr is an open terminal."""
    return sys.stderr is not None and sys.stderr.isatty()


def _show_elapsed(what: str, patience: float, done: threading.Event) -> None:
    start = monotonic()
    if done.wait(patience):
        return
    while True:
        line = f"{what} ... {monotonic() - start:.0f} s"
        sys.stderr.write(f"\r{line}")
        sys.stderr.flush()
        if done.wait(REFRESH):
            sys.stderr.write(f"\r{' ' * len(line)}\r")
            sys.stderr.flush()
            return


@contextmanager
def counting(what: str, things: str, patience: float = PATIENCE) -> Iterator[Callable[[int, int], None]]:
    """Yield a function of the number done and the total, which shows a bar on stderr as `working` shows a line.

    >>> with counting("drawing", "frames") as progress:
    ...     progress(1, 2)
    """
    start, stack = monotonic(), ExitStack()
    update: list[Callable[[int, int], None]] = []

    def report(done: int, total: int) -> None:
        if _heard:  # Python drops what is raised while a finalizer or a callback of a library in C runs
            _leave()
        if not update and monotonic() - start >= patience and _is_terminal():
            update.append(stack.enter_context(_progress_bar(what, things)))
        for show in update:
            show(done, total)

    with stack:
        yield report


@contextmanager
def _progress_bar(what: str, things: str) -> Iterator[Callable[[int, int], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn(what), BarColumn(), MofNCompleteColumn(), TextColumn(things), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what)
        yield lambda done, total: bar.update(task, completed=done, total=total)
