"""Compiled code on disk: another process loads it, damaged files are replaced, locked folders ignored."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from compoundkin.programs.backends import llvm_backend, runner_of
from compoundkin.programs.graph.flat_program import BY_POSE, flat_program
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph

pytest.importorskip("llvmlite")
SCRIPT = """
import sys
from tests.programs.test_object_cache import run
run(int(sys.argv[1]))
"""


def run(number: int) -> None:
    """Compile and run a small program, and look at what it computes."""
    graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    node = graph.apply("add", graph.apply("cos", graph.input(x)), graph.constant(float(number)))
    angles, found = np.linspace(0, 3, 50)[None], np.empty((1, 50))
    runner_of(flat_program(graph, [node], {x: BY_POSE}), "llvm")([angles], [found], (1, 50))
    np.testing.assert_allclose(found, np.cos(angles) + number, atol=1e-15)


def process(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", SCRIPT, *arguments], cwd=Path(__file__).parents[2])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COMPOUNDKIN_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


def test_other_processes_load_what_one_compiled(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two at once compile and keep the same program; this one need not compile. A damaged file is replaced."""
    both = [process("3"), process("3")]
    assert [each.wait() for each in both] == [0, 0]
    assert [path.suffix for path in folder.iterdir()] == [".o"]
    with monkeypatch.context() as patch:
        patch.setattr("llvmlite.binding.TargetMachine.emit_object", None)
        run(3)
    (kept,) = folder.iterdir()
    whole = kept.read_bytes()
    for damaged in (b"", whole[:100], whole[:-9] + b"disturbed", b"\x00" * len(whole)):
        kept.write_bytes(damaged)
        run(3)
        assert kept.read_bytes() == whole


def test_a_folder_that_cannot_be_written_is_ignored(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.mkdir()
    folder.chmod(0o500)
    run(4)
    folder.chmod(0o700)
    (folder / "file").write_text("")
    monkeypatch.setenv("COMPOUNDKIN_CACHE", str(folder / "file"))
    run(5)
    monkeypatch.setattr(llvm_backend, "cache_folder", lambda: Path("no\0folder"))
    run(6)


def test_where_compiled_code_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COMPOUNDKIN_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    for platform, part in (("linux", "/caches/compoundkin"), ("darwin", "Caches"), ("win32", "Local")):
        monkeypatch.setattr(sys, "platform", platform)
        assert part in llvm_backend.cache_folder().as_posix()
    monkeypatch.setenv("COMPOUNDKIN_CACHE", "~/kept")
    assert llvm_backend.cache_folder() == Path.home() / "kept"
