"""The folder of a study: `study.json` with its definition, and rows in Parquet files that are whole or absent.

Workers write their parts, or return them where they cannot reach the folder. A folder opens without the program that
made it; columns are read when they are needed.
"""

from __future__ import annotations

import io
import json
import os
import re
import secrets
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from importlib import import_module
from math import ceil
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, StudyStopped, warn
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.atomic import atomic_file, begin_folder, remove_leftovers
from compoundkin.files.saved_files import parquet
from compoundkin.studies.samples import sample_from
from compoundkin.studies.samples.variations import variation_from
from compoundkin.studies.study_plan import (
    CALLED,
    ORDER,
    PLAN_ARGUMENTS,
    StudyPlan,
    differences,
    digest,
    mechanism_of_document,
)
from compoundkin.studies.study_program import StudyColumn, version_text, versions
from compoundkin.studies.study_rows import (
    RunStore,
    StudyRows,
    cached_program,
    compute_rows,
    missing_rows,
    piece_size,
    pieces_of,
    rows_of_bytes,
    rows_together,
    whole_blocks,
)


def open_folder(path: str | os.PathLike[str]) -> tuple[StudyPlan, RowsInFolder]:
    """Return the study of a folder and its rows.

    Raises InvalidInput for a folder without a study, or a study with Python functions.
    """
    parquet("folder")
    place = Path(os.path.abspath(path))
    head = read_head(place)
    try:
        plan = plan_from(head.study)
    except (KeyError, TypeError, AttributeError):
        raise InvalidInput(Problem(str(place / HEAD), "its study is damaged")) from None
    return plan, RowsInFolder(head.columns, StudyFolder(place, digest(head.study)).parts())


def plan_from(data: Mapping[str, Any]) -> StudyPlan:
    """Return the study of plain data.

    Raises InvalidInput for functions and configurations without signs, which data only name.
    """
    if unreadable := list(_unreadable(data, "")):
        remedy = "run the study into this folder: existing rows are not computed again"
        raise InvalidInput(Problem(f"study.{unreadable[0]}", "it is a Python object, which no file contains", remedy))
    named = {name: data["dimensions"][name] for name in data[ORDER]}
    dimensions = {name: variation_from(f"dimensions.{name}", one) for name, one in named.items()}
    sample = sample_from(data["sample"])
    rest: dict[str, Any] = {name: data.get(name) for name in PLAN_ARGUMENTS}
    return StudyPlan(mechanism_of_document(data["mechanism"]), dimensions, tuple(data["outputs"]), sample, **rest)


def _unreadable(data: Any, where: str) -> Iterator[str]:
    """Yield the keys of objects that the data only name."""
    if isinstance(data, Mapping):
        if CALLED in data:
            yield where
        for key, one in data.items():
            yield from _unreadable(one, f"{where}.{key}" if where else key)


FORMAT = 1
HEAD = f"study{suffix_for('mechanism', 'json')}"
_MORE = 3


class FolderHead(NamedTuple):
    """The content of `study.json`: the study's data, its columns, versions. `token` identifies this folder."""

    study: Mapping[str, Any]
    columns: tuple[StudyColumn, ...]
    versions: Mapping[str, str]
    token: str


def prepare_folder(path: str | os.PathLike[str], plan: StudyPlan) -> tuple[StudyFolder, FolderHead]:
    """Return the folder of a study, created if it does not exist.

    Raises InvalidInput for the folder of another study, for one with other files, and where it cannot be written.
    Warns LikelySlip if other versions began it.
    """
    parquet("folder")
    place = Path(os.path.abspath(path))
    own = FolderHead(plan.data, plan.columns, versions(plan.program), secrets.token_hex(8))
    if not os.path.exists(place / HEAD):
        begin_folder(place / HEAD, _content(own))
    there = read_head(place)
    _check_same_study(place, own, there)
    return StudyFolder(place, plan.fingerprint), there


def read_head(place: Path) -> FolderHead:
    """Return the head of a folder. Raises InvalidInput if it has none or it is damaged."""
    try:
        found = json.loads((place / HEAD).read_bytes())
        known, columns = found["format"], tuple(StudyColumn(**column) for column in found["columns"])
        head = FolderHead(found["study"], columns, found["versions"], found["token"])
    except FileNotFoundError:
        raise InvalidInput(Problem(str(place), f"it is no folder of a study: it has no {HEAD}")) from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        what = getattr(error, "strerror", None) or "it is damaged"
        raise InvalidInput(Problem(str(place / HEAD), f"it cannot be read: {what}")) from None
    if known != FORMAT:
        raise InvalidInput(Problem(str(place / HEAD), f"its format {known} is not known", "update compoundkin"))
    return head


def _content(head: FolderHead) -> bytes:
    """Return the file that says what is in a folder."""
    columns = [column._asdict() for column in head.columns]
    text = json.dumps({"format": FORMAT, **head._asdict(), "columns": columns}, indent=1)
    return text.encode("utf-8", "surrogatepass")


def _check_same_study(place: Path, own: FolderHead, there: FolderHead) -> None:
    """Raise InvalidInput for the folder of another study."""
    if digest(own.study) != digest(there.study):
        where = list(differences(own.study, there.study))
        # the order matters only where the dimensions are the same
        where = [name for name in where if name != ORDER or where == [ORDER]]
        more = f" and {len(where) - _MORE} more" if len(where) > _MORE else ""
        what = f"it has rows of another study, which differs in {', '.join(where[:_MORE])}{more}"
        raise InvalidInput(Problem(str(place), what, "name another folder"))
    if other := version_text(own.versions, there.versions):
        warn(f"{place}: rows were begun by other versions: now {other}; last digits may differ", LikelySlip)


@dataclass(frozen=True)
class PartTask:
    """Computes a part of a study and writes it. It may be pickled."""

    plan: StudyPlan
    folder: StudyFolder
    token: str
    versions: Mapping[str, str]

    def __call__(self, rows: range) -> bytes | None:
        """Write the part of some rows, or return its bytes where the folder cannot be reached.

        Raises InvalidInput where versions differ from those of the program that started the run.
        """
        program = cached_program(self.plan)
        if other := version_text(versions(program), self.versions):
            raise InvalidInput(Problem("on", f"a worker has {other}", "give all workers the same versions"))
        size = piece_size(program)
        found = (compute_rows(self.plan, piece) for piece in pieces_of([rows], lambda: size))
        columns, fingerprint = self.plan.columns, self.folder.fingerprint
        if not is_reachable(self.folder.path, self.token):
            return part_content(columns, found, fingerprint)
        self.folder.write(rows, lambda file: write_part(file, columns, found, fingerprint))
        return None


@lru_cache(16)
def is_reachable(place: Path, token: str) -> bool:
    """Return whether the folder exists here, not another of the same name on another machine."""
    try:
        return read_head(place).token == token
    except InvalidInput:
        return False


@dataclass(frozen=True, eq=False, repr=False)
class FolderStore(RunStore):
    """A folder of parts, which stay whatever happens to the run."""

    folder: StudyFolder
    head: FolderHead
    # whether workers write their parts, which one tells by its first answer
    _answers: set[bool] = field(default_factory=set)

    def piece_size(self, workers: int, is_local: bool) -> int:
        """Return the number of rows of the next part.

        Workers that write parts themselves compute them piece by piece: these are larger than those that are sent.
        """
        program, small = self.plan.program, super().piece_size(workers, is_local)
        if not is_local and self._answers != {True}:
            return small
        large = min(rows_of_bytes(program.columns, PART_BYTES), ceil(program.count / (PARTS_EACH * workers)))
        return max(small, whole_blocks(program, large))

    def missing(self) -> Iterator[range]:
        """Yield the rows that are in no part; removes old files of killed writers."""
        remove_leftovers(self.folder.path, is_complete=False)
        yield from self.folder.missing(len(self.plan))

    @property
    def task(self) -> Callable[[range], Any]:
        """The task that writes a part."""
        return PartTask(self.plan, self.folder, self.head.token, versions(self.plan.program))

    def take(self, rows: range, answer: bytes | None) -> None:
        """Write a part that a worker has sent."""
        self._answers.add(answer is None)
        if answer is not None:
            self.folder.write(rows, lambda file: file.write(answer))

    def finished(self) -> RowsInFolder:
        """Return all rows; raises StudyStopped where parts are missing."""
        parts = self.folder.parts()
        if missing := len(self.plan) - sum(len(part.fresh) for part in parts):
            raise StudyStopped(
                Problem(str(self.folder.path), f"{missing} rows were written and are missing", "run again")
            )
        remove_leftovers(self.folder.path, is_complete=True)
        return RowsInFolder(self.head.columns, parts)

    def remainder(self) -> str:
        """Return the number of rows written, as text."""
        there = len(self.plan) - sum(map(len, self.folder.missing(len(self.plan))))
        return f"{there:,} of {len(self.plan):,} rows are written in {self.folder.path}: run again to continue"


# A part has at most so many bytes before they are packed; a worker writes so many at least where there are rows enough,
# so that little is computed again when a run goes on.
PART_BYTES, PARTS_EACH = 2**27, 32
_SUFFIX = suffix_for("table", "parquet")
_PART = re.compile(rf"rows-(\d+)-(\d+){re.escape(_SUFFIX)}")


class StudyPart(NamedTuple):
    """A part: its file and its rows. `fresh` are the rows that no earlier part has."""

    path: Path
    rows: range
    fresh: range


@dataclass(frozen=True)
class StudyFolder:
    """A folder of a study: where it is, and the fingerprint of the study."""

    path: Path
    fingerprint: str

    def part(self, rows: range) -> Path:
        """Return the path of the part of some rows."""
        return self.path / f"rows-{rows.start:09d}-{rows.stop:09d}{_SUFFIX}"

    def write(self, rows: range, fill: Callable[[BinaryIO], Any]) -> None:
        """Write the part of some rows.

        Raises InvalidInput where it cannot be written, unless another run has written these rows meanwhile: a run that
        completes the folder removes temporary files.
        """
        part = self.part(rows)
        try:
            with atomic_file(part) as file:
                fill(file)
        except OSError as error:
            if any(one.stop > rows.start for one in self.missing(rows.stop)):
                raise InvalidInput(Problem(str(part), f"it cannot be written: {error.strerror or error}")) from None

    def parts(self) -> tuple[StudyPart, ...]:
        """Return the existing parts, in order.

        Warns LikelySlip of files that are damaged or belong to another study: their rows count as missing.
        """
        found: list[StudyPart] = []
        named = [(_PART.fullmatch(path.name), path) for path in self.path.iterdir()]
        there = [(range(int(match[1]), int(match[2])), path) for match, path in named if match]
        reached = 0
        # runs with other chunks leave overlapping parts: the rows are the same, each is used once
        for rows, path in sorted(there, key=lambda one: (one[0].start, -one[0].stop)):
            if rows_of_part(path, self.fingerprint) != rows:
                warn(f"{path}: the part is damaged or of another study: its rows count as missing", LikelySlip)
            elif rows.stop > reached:
                found.append(StudyPart(path, rows, range(max(rows.start, reached), rows.stop)))
                reached = rows.stop
        return tuple(found)

    def missing(self, count: int) -> list[range]:
        """Return which of so many rows are in no part."""
        return list(missing_rows((part.fresh for part in self.parts()), count))


@dataclass(frozen=True, eq=False, repr=False)
class RowsInFolder(StudyRows):
    """Rows in parts: a column is read from all, a row from one."""

    parts: tuple[StudyPart, ...]

    @property
    def count(self) -> int:
        """The number of rows."""
        return sum(len(part.fresh) for part in self.parts)

    def column(self, name: str) -> Number:
        """Return all values of a column. Raises InvalidInput where there is no part yet."""
        found: Number | None = None
        start = 0
        for piece in self.pieces(name):
            values = piece[name]
            if found is None:
                found = np.empty((self.count, *values.shape[1:]), values.dtype)
            found[start : start + len(values)] = values
            start += len(values)
        if found is None:
            raise InvalidInput(Problem(name, "there is no row yet", "run the study"))
        return found

    def pieces(self, *names: str) -> Iterator[dict[str, Number]]:
        """Yield some columns of pieces of each part."""
        wanted = [one for one in self.columns if one.name in names]
        for part in self.parts:
            yield from part_pieces(part.path, wanted, part.fresh.start - part.rows.start)

    def picked(self, places: Number, *names: str) -> dict[str, Number]:
        """Return some columns, or all, of some rows."""
        columns = [one for one in self.columns if one.name in names] if names else self.columns
        if not len(places):
            return {one.name: np.empty(0) for one in columns}
        starts = np.cumsum([0, *(len(part.fresh) for part in self.parts)])
        owner = np.searchsorted(starts, places, side="right") - 1
        order: list[Number] = []
        found: list[dict[str, Number]] = []
        for k in np.unique(owner):
            part, mine = self.parts[k], np.flatnonzero(owner == k)
            inside = places[mine] - starts[k] + part.fresh.start - part.rows.start
            found.append(part_rows(part.path, columns, inside))
            order.append(mine)
        back = np.argsort(np.concatenate(order))
        return {one.name: np.concatenate([rows[one.name] for rows in found])[back] for one in columns}


# The key of a part's metadata that identifies its study.
STUDY = b"study"
# Rows in a row group at most: so many are read at once.
ROWS_TOGETHER = 8192


def part_content(columns: Iterable[StudyColumn], pieces: Iterable[Mapping[str, Any]], fingerprint: str) -> bytes:
    """Return the bytes of a part."""
    content = io.BytesIO()
    write_part(content, columns, pieces, fingerprint)
    return content.getvalue()


def write_part(
    file: BinaryIO, columns: Iterable[StudyColumn], pieces: Iterable[Mapping[str, Any]], fingerprint: str
) -> None:
    """Write a part, piece by piece, with units, and the fingerprint of its study."""
    arrow, writer, chosen = import_module("pyarrow"), None, list(columns)
    try:
        for found in pieces:
            arrays = [_array(arrow, found[column.name], column.width) for column in chosen]
            if writer is None:
                units = [{"unit": column.unit} if column.unit else None for column in chosen]
                fields = [arrow.field(one.name, array.type, metadata=unit)
                          for one, array, unit in zip(chosen, arrays, units, strict=True)]  # fmt: skip
                schema = arrow.schema(fields, metadata={STUDY: fingerprint, b"angles": b"radians"})
                texts = [each.name for each in fields if each.type == arrow.string()]
                pressed = {each.name: "NONE" if _is_bytes(each.type) else "SNAPPY" for each in fields}
                writer = parquet().ParquetWriter(file, schema, use_dictionary=texts, write_page_checksum=True,
                                                 compression=pressed)  # fmt: skip
            writer.write_table(arrow.Table.from_arrays(arrays, schema=writer.schema), row_group_size=ROWS_TOGETHER)
    finally:
        if writer is not None:
            writer.close()


def _is_bytes(of: Any) -> bool:
    """Return whether a type of Parquet is bytes of a fixed number."""
    return str(of).startswith("fixed_size_binary")


def _array(arrow: Any, values: Number, width: int | None) -> Any:
    if values.dtype.kind == "V":  # bytes of rows, which are read five times as fast as lists of numbers
        kept = np.ascontiguousarray(values)
        return arrow.FixedSizeBinaryArray.from_buffers(
            arrow.binary(kept.dtype.itemsize), len(kept), [None, arrow.py_buffer(kept.view(np.uint8))]
        )
    if width is None:
        return arrow.array(values, type=arrow.string() if values.dtype == object else None)
    return arrow.FixedSizeListArray.from_arrays(arrow.array(np.ravel(values)), width)


def rows_of_part(path: Path, fingerprint: str) -> range | None:
    """Return the rows of a part by its metadata; None if it is damaged or belongs to another study."""
    try:
        found = parquet().read_metadata(path)
    except (OSError, ValueError):
        return None
    if (found.metadata or {}).get(STUDY) != fingerprint.encode() or not found.num_rows:
        return None
    first, last = (found.row_group(k).column(0).statistics for k in (0, found.num_row_groups - 1))
    return range(first.min, last.max + 1)


def part_columns(path: Path, columns: Sequence[StudyColumn]) -> dict[str, Number]:
    """Return some columns of a part. Raises InvalidInput where it is damaged."""
    with _opened(path) as file:
        table = file.read([column.name for column in columns])
    return {column.name: _values(table, column) for column in columns}


def part_pieces(path: Path, columns: Sequence[StudyColumn], start: int) -> Iterator[dict[str, Number]]:
    """Yield some columns of a part from a row on, piece by piece. Raises InvalidInput where it is damaged."""
    names = [column.name for column in columns]
    with _opened(path) as file:
        for batch in file.iter_batches(rows_together(columns), columns=names):
            if start < len(batch):
                yield {column.name: _values(batch, column)[start:] for column in columns}
            start = max(start - len(batch), 0)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Yield a part whose pages are verified as they are read. Raises InvalidInput for a damaged or missing part."""
    try:
        with parquet().ParquetFile(path, page_checksum_verification=True) as file:
            yield file
    except FileNotFoundError:
        raise InvalidInput(Problem(str(path), "the part is gone", "run the study into this folder again")) from None
    except (OSError, ValueError):
        remedy = "remove it, and run the study into this folder again"
        raise InvalidInput(Problem(str(path), "the part is damaged", remedy)) from None


def part_rows(path: Path, columns: Sequence[StudyColumn], places: Number) -> dict[str, Number]:
    """Return some columns of some rows of a part, by their places in it. Raises InvalidInput where it is damaged."""
    with _opened(path) as file:
        sizes = [file.metadata.row_group(k).num_rows for k in range(file.num_row_groups)]
        starts = np.cumsum([0, *sizes])
        owner = np.searchsorted(starts, places, side="right") - 1
        groups, which = np.unique(owner, return_inverse=True)
        table = file.read_row_groups(groups.tolist(), [column.name for column in columns])
    # the groups that are read follow each other
    near = np.cumsum([0, *(sizes[k] for k in groups)])[which] + places - starts[owner]
    return {column.name: _values(table, column)[near] for column in columns}


def _values(table: Any, column: StudyColumn) -> Number:
    """Return a column of a table, or of one batch of it."""
    found = table.column(column.name)
    found = found.combine_chunks() if hasattr(found, "combine_chunks") else found
    if _is_bytes(found.type):
        place = found.offset * found.type.byte_width
        return np.frombuffer(found.buffers()[1], f"V{found.type.byte_width}", len(found), place)
    if column.width is not None:
        return np.asarray(found.flatten()).reshape(-1, column.width)
    if str(found.type) == "string":
        # few texts, each of very many rows: one object for all of a text
        encoded = found.dictionary_encode()
        texts = np.array([*encoded.dictionary.to_pylist(), None], dtype=object)
        return texts[encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False)]
    return np.asarray(found.to_numpy(zero_copy_only=False))
