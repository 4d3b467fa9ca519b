"""Folders of studies: whatever stops a run, what is written stays, and a second run loses and doubles nothing."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies import study_folder, study_rows
from compoundkin.studies.study_folder import is_reachable
from tests.source import ROOT
from tests.studies.test_study import assert_same, six_bar

StudyResult = ck.results.StudyResult
COUNT = 4 * 4096


@pytest.fixture(scope="module")
def whole() -> ck.results.StudyResult:
    return six_bar(COUNT).run()


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def rows_there(folder: Path) -> list[int]:
    return StudyResult.open(folder)["row"].tolist()


def assert_goes_on(folder: Path, whole: ck.results.StudyResult, computed: int) -> None:
    """A second run computes what is missing only, and then every row is there once."""
    told: list[int] = []
    result = six_bar(COUNT).run(folder, chunk=1, progress=lambda done, _: told.append(done))
    assert told == list(range(computed, COUNT + 1, 4096))
    assert result["row"].tolist() == list(range(COUNT))
    assert_same(result, whole)
    assert not [name for name in names(folder) if name.endswith(".tmp")]


def test_a_folder_has_the_rows_and_the_study(whole: ck.results.StudyResult, tmp_path: Path) -> None:
    result = six_bar(COUNT).run(tmp_path / "new" / "folder", chunk=8192)
    assert names(tmp_path / "new" / "folder") == [
        "rows-000000000-000008192.parquet",
        "rows-000008192-000016384.parquet",
        "study.json",
    ]
    assert_same(result, whole)
    opened = StudyResult.open(tmp_path / "new" / "folder")
    assert_same(opened, whole)
    assert opened.is_complete
    assert opened.study.data == result.study.data
    row = opened.best("rocker.A.x", 40)[-1]
    for name, value in whole.best("rocker.A.x", 40)[-1].items():
        assert np.array_equal(row[name], value), name
    last = int(np.flatnonzero(whole.assembled)[-1])
    again = [ck.quantity(one.motion(last), "G.position").values for one in (opened, whole)]
    assert np.array_equal(*again)
    assert opened.mechanism(last) == whole.mechanism(last)


def test_a_part_is_computed_and_read_piece_by_piece(
    whole: ck.results.StudyResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # what is computed at once is rounded up to a block of 4096 rows
    monkeypatch.setattr(study_rows, "MOST_ROWS", 3000)
    result = six_bar(COUNT).run(tmp_path / "one", chunk=COUNT)
    assert names(tmp_path / "one") == [f"rows-000000000-{COUNT:09d}.parquet", "study.json"]
    assert_same(result, whole)
    assert len(list(result.rows.pieces("row"))) > 4
    places = np.array([9000, 5, 4095, 4096, 16383, 4097])
    for name, values in result.rows.picked(places).items():
        np.testing.assert_array_equal(values, whole[name][places])
    assert list(result.rows.picked(places, "row")) == ["row"]
    # without a chunk threads write larger parts than they compute at once, within bytes
    monkeypatch.setattr(study_folder, "PARTS_EACH", 1)
    for most, count in ((2**27, 2), (0, 4)):
        monkeypatch.setattr(study_folder, "PART_BYTES", most)
        assert_same(six_bar(COUNT).run(tmp_path / str(count), threads=2), whole)
        assert len(names(tmp_path / str(count))) == count + 1


def test_an_error_within_a_part_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopping(plan: object, rows: range) -> dict[str, np.ndarray]:
        if rows.start:
            raise ZeroDivisionError("a fault of the program")
        return computed(plan, rows)

    computed = study_folder.compute_rows
    monkeypatch.setattr(study_rows, "MOST_ROWS", 4096)
    monkeypatch.setattr(study_folder, "compute_rows", stopping)
    with pytest.raises(ZeroDivisionError, match="a fault of the program"):
        six_bar(COUNT).run(tmp_path / "new", chunk=COUNT, threads=1)
    assert names(tmp_path / "new") == ["study.json"]


def test_parts_of_other_chunks_and_damaged_ones_are_mended(whole: ck.results.StudyResult, tmp_path: Path) -> None:
    six_bar(COUNT).run(tmp_path, chunk=8192)
    first, second = sorted(tmp_path.glob("rows-*"))
    second.write_bytes(second.read_bytes()[:-100])
    with pytest.warns(ck.errors.LikelySlip, match="damaged"):
        assert rows_there(tmp_path) == list(range(8192))
    second.unlink()
    # two runs beside each other, with other chunks
    first.rename(tmp_path / "first")
    six_bar(COUNT).run(tmp_path, chunk=4096)
    (tmp_path / "first").rename(first)
    assert len(names(tmp_path)) == 6
    assert_same(StudyResult.open(tmp_path), whole)


def test_folders_of_others_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    six_bar(4).run(tmp_path / "a")
    before = names(tmp_path / "a")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "thesis.txt").write_text("years")
    (tmp_path / "c").write_text("a file")
    for folder, (count, speed), told in (
        ("a", (8, 3.0), "rows of another study, which differs in sample.count"),
        ("a", (4, 9.0), "differs in speed"),
        ("b", (4, 3.0), "thesis.txt"),
        ("c", (4, 3.0), "it cannot be made: File exists"),
    ):
        with pytest.raises(ck.errors.InvalidInput, match=told):
            six_bar(count, speed).run(tmp_path / folder)
    assert names(tmp_path / "a") == before
    assert names(tmp_path / "b") == ["thesis.txt"]
    with pytest.raises(ck.errors.InvalidInput, match="no folder of a study"):
        StudyResult.open(tmp_path / "b")
    (tmp_path / "a" / "study.json").write_text("{")
    with pytest.raises(ck.errors.InvalidInput, match="damaged"):
        six_bar(4).run(tmp_path / "a")


@contextmanager
def full_disk() -> Iterator[Callable[[int, int], None]]:
    """A progress that lets no more than two parts be written: files of more than 20 kB fail then."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill(done: int, count: int) -> None:
        if done == 2 * 4096:
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, hard))

    try:
        yield fill
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_disk_stops_a_run_and_loses_nothing(whole: ck.results.StudyResult, tmp_path: Path) -> None:
    with full_disk() as fill, pytest.raises(ck.errors.StudyStopped) as stopped:
        six_bar(COUNT).run(tmp_path, chunk=4096, threads=1, progress=fill)
    assert "File too large; 8,192 of 16,384 rows are written" in str(stopped.value)
    assert "run again" in str(stopped.value)
    assert names(tmp_path) == ["rows-000000000-000004096.parquet", "rows-000004096-000008192.parquet", "study.json"]
    assert_goes_on(tmp_path, whole, 8192)


def test_a_killed_worker_loses_nothing(whole: ck.results.StudyResult, tmp_path: Path) -> None:
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        pid = pool.submit(os.getpid).result()

        def kill(done: int, count: int) -> None:
            if done:
                os.kill(pid, signal.SIGKILL)

        with pytest.raises(ck.errors.StudyStopped, match=r"a worker died: .* rows are written .* run again"):
            six_bar(COUNT).run(tmp_path, on=pool, chunk=4096, progress=kill)
    there = rows_there(tmp_path)
    assert 4096 <= len(there) < COUNT
    assert_goes_on(tmp_path, whole, len(there))


@pytest.mark.full
def test_a_killed_client_loses_nothing(whole: ck.results.StudyResult, tmp_path: Path) -> None:
    words = (
        "import sys, time",
        "from tests.studies.test_study import six_bar",
        "def slow(done, count):",
        "    print(done, flush=True)",
        "    time.sleep(60 * (done > 4096))",
        f"six_bar(count={COUNT}).run(sys.argv[1], chunk=4096, threads=1, progress=slow)",
    )
    command = [sys.executable, "-c", "\n".join(words), str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as client:
        assert client.stdout is not None
        assert [client.stdout.readline() for _ in range(3)] == ["0\n", "4096\n", "8192\n"]
        client.kill()
    (tmp_path / ".rows-000008192-00001228.0123456789ab.tmp").write_bytes(b"half")
    assert rows_there(tmp_path) == list(range(8192))
    assert_goes_on(tmp_path, whole, 8192)


def test_a_worker_that_does_not_see_the_folder_sends_its_parts(
    whole: ck.results.StudyResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not is_reachable(tmp_path, "word")
    monkeypatch.setattr("compoundkin.studies.study_folder.is_reachable", lambda place, token: False)
    assert_same(six_bar(COUNT).run(tmp_path, threads=2), whole)


def test_other_versions_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    six_bar(4).run(tmp_path)
    monkeypatch.setattr("compoundkin.studies.study_program.VERSION", "99.0")
    with pytest.warns(ck.errors.LikelySlip, match="now compoundkin 99.0, not"):
        six_bar(4).run(tmp_path)


def test_the_best_and_percentiles_are_those_of_whole_columns(tmp_path: Path) -> None:
    result = six_bar(COUNT).run(tmp_path / "folder", chunk=4096)
    assert len(list(result.rows.pieces("row"))) == COUNT // 4096
    for column in result.columns:
        if not column.is_figure:
            continue
        values, there = result[column.name], result.assembled
        for greatest in (False, True):
            order = np.argsort(np.where(there, -values if greatest else values, np.inf), kind="stable")
            found = [row["row"] for row in result.best(column.name, 50, greatest=greatest)]
            assert found == order[:50].tolist()
        shares = [0.0, 5.0, 50.0, 97.3, 100.0]
        assert result.percentiles(column.name, shares) == np.percentile(values[there], shares).tolist()
    assert result.counts("assembled")[True] == np.count_nonzero(result.assembled)
