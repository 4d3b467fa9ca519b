"""Compiled code on disk: another process loads it, damaged files are replaced, locked folders ignored."""

from __future__ import annotations

import hashlib
import os
import secrets
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from compoundkin.programs.backends import object_cache, runner_of
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
    assert sorted(path.suffix for path in folder.iterdir()) == ["", ".o"]
    with monkeypatch.context() as patch:
        patch.setattr("llvmlite.binding.TargetMachine.emit_object", None)
        run(3)
    (kept,) = folder.glob("*.o")
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
    monkeypatch.setattr(object_cache, "cache_folder", lambda: Path("no\0folder"))
    run(6)


@pytest.fixture
def kept(folder: Path) -> Path:
    """An object, stored by this user."""
    object_cache.store_object("source", b"code")
    assert object_cache.cached_object("source") == b"code"
    (path,) = folder.glob("*.o")
    return path


POSIX = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="access rights of POSIX")


@POSIX
def test_nobody_else_may_read_or_write_what_is_kept(folder: Path, kept: Path) -> None:
    modes = [stat.S_IMODE(path.stat().st_mode) for path in (folder, folder / "key", kept)]
    assert modes == [0o700, 0o600, 0o600]


def test_an_object_of_another_source_or_signed_by_another_key_is_not_run(folder: Path, kept: Path) -> None:
    object_cache.store_object("other", b"other code")
    (other,) = set(folder.glob("*.o")) - {kept}
    own = kept.read_bytes()
    kept.write_bytes(other.read_bytes())
    assert object_cache.cached_object("source") is None
    kept.write_bytes(own)
    (folder / "key").write_bytes(secrets.token_bytes(object_cache.LENGTH))
    assert object_cache.cached_object("source") is None
    object_cache.store_object("source", b"code")
    assert object_cache.cached_object("source") == b"code"


def test_a_digest_without_the_key_is_no_signature(kept: Path) -> None:
    """Whoever may put files there, but not read the key, cannot make one that is run."""
    kept.write_bytes(hashlib.sha256(b"planted").digest() + b"planted")
    assert object_cache.cached_object("source") is None


def test_a_damaged_key_is_made_again(folder: Path, kept: Path) -> None:
    for damaged in (b"", b"short"):
        (folder / "key").write_bytes(damaged)
        assert object_cache.cached_object("source") is None
        object_cache.store_object("source", b"code")
        assert object_cache.cached_object("source") == b"code"


@POSIX
@pytest.mark.parametrize("path", ["", "key", "*.o"])
def test_what_others_may_write_is_not_used(folder: Path, kept: Path, path: str) -> None:
    (target,) = folder.glob(path) if path else [folder]
    mode = target.stat().st_mode
    target.chmod(mode | stat.S_IWOTH)
    assert object_cache.cached_object("source") is None
    target.chmod(mode)
    assert object_cache.cached_object("source") == b"code"


@POSIX
@pytest.mark.parametrize("path", ["", "key", "*.o"])
def test_what_belongs_to_somebody_else_is_not_used(
    folder: Path, kept: Path, path: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (target,) = folder.glob(path) if path else [folder]
    inode, own = target.stat().st_ino, os.geteuid()
    is_own = object_cache._is_ones_own

    def changed(entry: os.stat_result, forbidden: int) -> bool:
        monkeypatch.setattr(os, "geteuid", lambda: own + (entry.st_ino == inode))
        return is_own(entry, forbidden)

    monkeypatch.setattr(object_cache, "_is_ones_own", changed)
    assert object_cache.cached_object("source") is None
    if not path.startswith("*"):
        before = kept.read_bytes()
        object_cache.store_object("source", b"another")
        assert kept.read_bytes() == before


@POSIX
def test_links_are_not_followed(folder: Path, kept: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere.o"
    kept.rename(elsewhere)
    kept.symlink_to(elsewhere)
    assert object_cache.cached_object("source") is None
    kept.unlink()
    elsewhere.rename(kept)
    folder.rename(tmp_path / "moved")
    folder.symlink_to(tmp_path / "moved")
    assert object_cache.cached_object("source") is None
    object_cache.store_object("new", b"code")
    assert len(list(folder.glob("*.o"))) == 1


def test_where_compiled_code_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COMPOUNDKIN_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    for platform, part in (("linux", "/caches/compoundkin"), ("darwin", "Caches"), ("win32", "Local")):
        monkeypatch.setattr(sys, "platform", platform)
        assert part in object_cache.cache_folder().as_posix()
    monkeypatch.setenv("COMPOUNDKIN_CACHE", "~/kept")
    assert object_cache.cache_folder() == Path.home() / "kept"
