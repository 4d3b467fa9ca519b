"""`study`: the effect of dimensions on outputs of a mechanism, for many designs; `load_study`: studies of files.

Missing rows are computed in pieces by threads, an executor of `concurrent.futures`, or Dask; the number of pieces under
way is bounded.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import islice
from os import PathLike
from pathlib import Path
from pickle import PicklingError
from typing import Any, ClassVar, TypeAlias, TypeVar

from compoundkin.base.arguments import checked
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import (
    CompoundkinError,
    InvalidInput,
    InvalidMechanism,
    Problem,
    StudyStopped,
    suppress_pose_warnings,
)
from compoundkin.base.suffixes import Kind
from compoundkin.files.parsed_document import Syntax, heading, known_syntax, parsed, text_of, too_deep
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.design_sample import DesignSample
from compoundkin.studies.samples.grid_sample import TableSample
from compoundkin.studies.samples.variations import variations_of
from compoundkin.studies.study_document import study_arguments, study_text
from compoundkin.studies.study_folder import FolderStore, prepare_folder
from compoundkin.studies.study_plan import StudyPlan
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.study_rows import MemoryStore, RunStore, StudyRows, pieces_of, whole_blocks

Progress: TypeAlias = Callable[[int, int], Any]
# Errors that stop a run and are no programming error: dead workers, full disks, lost connections.
_ENDS = (CompoundkinError, BrokenExecutor, CancelledError, OSError, PicklingError, MemoryError)
# Libraries that send tasks to workers, whose errors stop a run; none is imported here.
_CARRIERS = {"distributed", "tornado"}


def run_study(
    store: RunStore,
    on: Any = None,
    chunk: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> StudyRows:
    """Compute all missing rows and return all.

    Raises InvalidInput for invalid workers, StudyStopped where the run cannot be completed.
    """
    with workers(on, threads) as computing, suppress_pose_warnings():
        missing = list(store.missing())

        def size() -> int:
            if chunk:
                return whole_blocks(store.plan.program, chunk)
            return store.piece_size(computing.number(), is_local=on is None)

        tell = progress or (lambda done, count: None)
        done, count = len(store.plan) - sum(map(len, missing)), len(store.plan)
        tell(done, count)
        with closing(_answered(computing, store, pieces_of(missing, size))) as answered:
            for rows in _taken(store, answered):
                done += len(rows)
                tell(done, count)
    return store.finished()


def _taken(store: RunStore, answered: Iterable[tuple[range, Any]]) -> Iterator[range]:
    """Yield the rows of each answer when they are stored."""
    try:
        for rows, answer in answered:
            store.take(rows, answer)
            yield rows
    except Exception as error:
        if ends_a_run(error):
            raise _stopped(store, error) from error
        raise


def ends_a_run(error: Exception) -> bool:
    """Return whether an error ends a run on workers and is no programming error."""
    return isinstance(error, _ENDS) or type(error).__module__.partition(".")[0] in _CARRIERS


def _answered(computing: Workers, store: RunStore, pieces: Iterable[range]) -> Generator[tuple[range, Any]]:
    task = store.task
    if computing.executor is None:
        yield from ((rows, task(rows)) for rows in pieces)
        return
    yield from run_pieces(computing.executor, task, pieces, computing.room)


def _stopped(store: RunStore, error: Exception) -> StudyStopped:
    """Return the error of a stopped run."""
    what = str(error).strip() or type(error).__name__
    if isinstance(error, BrokenExecutor):
        what = f"a worker died: {what}"
    return StudyStopped(Problem("", what, store.remainder()))


Piece = TypeVar("Piece")
Answer = TypeVar("Answer")


def run_pieces(
    executor: Executor, work: Callable[[Piece], Answer], pieces: Iterable[Piece], room: Callable[[], int]
) -> Iterator[tuple[Piece, Answer]]:
    """Yield each piece with the result of `work`, as soon as it is done.

    At most `room()` pieces are under way. Pieces that have not begun when the caller stops are cancelled.
    """
    waiting: dict[Future[Answer], Piece] = {}
    coming = iter(pieces)
    try:
        while True:
            for piece in islice(coming, max(0, room() - len(waiting))):
                waiting[_submitted(executor, work, piece)] = piece
            if not waiting:
                return
            for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                yield waiting.pop(done), done.result()
    finally:
        for future in waiting:
            future.cancel()


def _submitted(executor: Executor, work: Callable[[Piece], Answer], piece: Piece) -> Future[Answer]:
    try:
        return executor.submit(work, piece)
    except BrokenExecutor:
        raise
    except RuntimeError as error:
        # raised by executors that have been shut down
        raise InvalidInput(Problem("on", f"it takes no work: {error}", "give one that is open")) from None


# Pieces under way for each worker: one being computed, one waiting.
AT_A_TIME = 2
# The assumed number of workers of a foreign executor, which does not say; and the expected number of a cluster, which
# may be starting, or grow with the work that waits.
UNKNOWN_WORKERS = 16


@dataclass(frozen=True, eq=False, repr=False)
class Workers(ShortRepr):
    """An executor, or None for this thread alone; `number()` is its present number of workers.

    There may soon be as many as `expected`.
    """

    executor: Executor | None
    number: Callable[[], int]
    expected: int = 0

    def room(self) -> int:
        """Return the number of pieces that may be under way now."""
        return AT_A_TIME * max(self.expected, self.number())


@contextmanager
def workers(on: Any, threads: int | None) -> Iterator[Workers]:
    """Yield the workers of a run. Own threads end with the run.

    Raises InvalidInput for other objects than an executor or a client.
    """
    if on is None:
        number = threads or usable_cores()
        if number == 1:
            yield Workers(None, lambda: 1)
            return
        with ThreadPoolExecutor(number, "compoundkin-study") as own:
            yield Workers(own, lambda: number)
    elif threads is not None:
        raise InvalidInput(Problem("threads", "workers are given too", "leave out threads or on"))
    else:
        yield _checked_workers(on)


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _checked_workers(on: Any) -> Workers:
    if isinstance(on, Executor):
        return Workers(on, lambda: UNKNOWN_WORKERS)
    # a Dask client has an executor, and says how many threads its workers have; they may become more or fewer
    made, counts = getattr(on, "get_executor", None), getattr(on, "nthreads", None)
    if not callable(made) or not callable(counts):
        remedy = "give a concurrent.futures.Executor, or a Dask client: cluster.get_client()"
        raise InvalidInput(Problem("on", f"{short_repr(on)} computes nothing", remedy))
    if getattr(on, "asynchronous", False):
        raise InvalidInput(Problem("on", "the client is asynchronous", "distributed.Client(..., asynchronous=False)"))
    # a cluster takes some ten milliseconds to carry a piece: the workers that are there get large ones
    return Workers(made(pure=False), lambda: sum(counts().values()) or UNKNOWN_WORKERS, UNKNOWN_WORKERS)


@dataclass(frozen=True, eq=False, repr=False)
class Study(StudyPlan):
    """A study that can be run: designs and their outputs. It is saved as a .toml or .json file."""

    saved_as: ClassVar[Kind] = "study"

    def content(self, form: str) -> bytes:
        """Return the bytes of its file in a form, "toml" or "json".

        Raises InvalidInput for outputs that are Python functions.
        """
        return study_text(self, form).encode("utf-8")

    @checked
    def run(
        self,
        folder: str | os.PathLike[str] | None = None,
        *,
        on: Any = None,
        chunk: int | None = None,
        threads: int | None = None,
        progress: Callable[[int, int], Any] | None = None,
    ) -> StudyResult:
        """Compute all rows, in memory or into a folder of Parquet files.

        A folder contains the study itself and parts that are written whole or not at all: an interrupted run continues
        when it is started again, and the result reads columns from the folder when they are needed.
        Rows are computed by `threads`, by default one for each core, or `on` other workers: any executor of
        `concurrent.futures`, or a Dask client. `chunk` is the number of rows that a worker computes at a time, in whole
        blocks. `progress(done, total)` is called with numbers of rows. Results depend on none of these.
        Raises InvalidInput for invalid arguments, such as the folder of another study, and StudyStopped where workers
        die or a disk is full.
        """
        for name, value in {"chunk": chunk, "threads": threads}.items():
            if value is not None and value < 1:
                raise InvalidInput(Problem(name, f"{value} is too few", "at least 1"))
        store = MemoryStore(self) if folder is None else FolderStore(self, *prepare_folder(folder, self))
        return StudyResult(self, run_study(store, on, chunk, threads, progress))


@checked
def study(
    mechanism: Mechanism,
    dimensions: Mapping[str, Any] | str | PathLike[str],
    outputs: str | Sequence[str] | Mapping[str, Callable[..., Any] | None],
    *,
    sample: str | Mapping[str, int] | DesignSample = "sobol",
    count: int | None = None,
    seed: int = 0,
    values: Any = None,
    speed: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    time: Any = None,
    modes: Mapping[str, int] | str | Configuration | None = None,
    given: Mapping[str, Any] | None = None,
) -> Study:
    """Return a study of many designs of a mechanism, to be run.

    `dimensions` are variations of free dimensions by name: a range (40, 60), a frozen distribution of scipy.stats,
    levels, `around(centre, within)`; or the path of a CSV or Parquet table of designs, with sample="table". `outputs`
    are quantities and figures by name; or {"error": function, "G.x.stroke": None}, where functions of a pose, as
    `CompiledPath.objective` takes them, are summed over the motion and read the data `given`. `sample` is the kind of
    sample, `count` the number of designs. Drivers move as in `solve`, in the same `modes`. Raises InvalidInput and
    UnknownName before anything is computed.

    >>> import compoundkin as ck
    >>> press = ck.load("crank-rocker")
    >>> studied = ck.study(press, {"crank.B.x": (1.8, 2.2)}, ["rocker.angle.stroke"], count=64, seed=1)
    >>> result = studied.run()
    >>> len(result), bool(result.assembled.all())
    (64, True)
    """
    wanted = (outputs,) if isinstance(outputs, str) else outputs if isinstance(outputs, Mapping) else tuple(outputs)
    if not wanted:
        raise InvalidInput(Problem("outputs", "there is none", 'name some: ["G.position", "bar.angle.stroke"]'))
    if given is not None and not isinstance(outputs, Mapping):
        raise InvalidInput(Problem("given", "no output reads it", "it is for outputs that are functions"))
    free = variations_of(dimensions)
    if not isinstance(dimensions, Mapping) and sample != TableSample.word:
        raise InvalidInput(Problem("sample", "the dimensions are the columns of a table", f"{TableSample.word!r}"))
    drive = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time}
    found = Study(mechanism, free, wanted, sample_of(sample, count, seed, free), **drive, modes=modes, given=given)
    with suppress_pose_warnings():
        found.check()
    return found


@checked
def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study of a TOML or JSON file, distinguished by the suffix.

    Raises InvalidInput for a file that cannot be read, or listing all problems of its content; and the errors of
    `study`.

    >>> load_study("no/such.toml")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: no/such.toml: there is no such file
    """
    return loads_study(*text_of(path, "study"), where=str(path), folder=Path(path).parent)


def loads_study(text: str, syntax: Syntax = "toml", *, where: str = "study file", folder: Path = Path()) -> Study:
    """Return the study of a text in TOML or JSON.

    Its paths are relative to a folder; `where` names the text in errors.
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
