"""Files that cannot be read or written, and files that are written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from compoundkin.base.errors import InvalidInput
from compoundkin.files import dumps, load, loads
from compoundkin.files.atomic import write_atomically
from compoundkin.files.saved_files import save
from compoundkin.model.elements import link
from compoundkin.model.mechanism import Mechanism

PIN = Mechanism("Pin", link("frame", A=0))


def refused(path: Path | str, match: str) -> None:
    with pytest.raises(InvalidInput, match=match):
        load(path)


def test_what_cannot_be_read_is_said_plainly(tmp_path: Path) -> None:
    save(PIN, tmp_path / "crank.toml")
    refused(tmp_path / "crnk.toml", "there is no such file; did you mean 'crank.toml'?")
    refused(tmp_path / "no" / "crank.toml", "there is no such file$")
    refused(tmp_path / "crank.yaml", r"does not tell the format; mechanism files end in \.toml or \.json")
    refused("a\0b.toml", "cannot be read")
    (tmp_path / "folder.toml").mkdir()
    refused(tmp_path / "folder.toml", "it cannot be read: Is a directory")
    (tmp_path / "latin.toml").write_bytes(b'title = "\xe9"')
    refused(tmp_path / "latin.toml", r"it is not UTF-8 text \(byte 9\)")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission(tmp_path: Path) -> None:
    save(PIN, tmp_path / "pin.toml")
    (tmp_path / "pin.toml").chmod(0)
    refused(tmp_path / "pin.toml", "it cannot be read: Permission denied")


def test_the_suffix_tells_the_syntax_in_any_case(tmp_path: Path) -> None:
    for name in ("pin.toml", "pin.JSON"):
        save(PIN, tmp_path / name)
        assert load(str(tmp_path / name)) == PIN
    assert (tmp_path / "pin.JSON").read_text().startswith("{")


def test_a_byte_order_mark_and_windows_lines_are_read(tmp_path: Path) -> None:
    text = dumps(PIN).replace("\n", "\r\n")
    (tmp_path / "pin.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert load(tmp_path / "pin.toml") == PIN


def test_unknown_syntaxes_are_refused() -> None:
    with pytest.raises(InvalidInput, match=r"syntax: 'tom' is not known; did you mean 'toml'\?"):
        dumps(PIN, "tom")  # type: ignore[arg-type]
    with pytest.raises(InvalidInput):
        loads("", "yaml")  # type: ignore[arg-type]


def test_what_cannot_be_written_is_said_plainly(tmp_path: Path) -> None:
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(InvalidInput, match=r"it cannot be written: there is no folder .*no; make it"):
        save(PIN, tmp_path / "no" / "pin.toml")
    with pytest.raises(InvalidInput, match="this is a folder; name a file in it"):
        save(PIN, tmp_path / "folder.toml")
    with pytest.raises(InvalidInput, match="half a surrogate pair"):
        save(Mechanism("\ud800", link("frame", A=0)), tmp_path / "pin.json")
    assert [p.name for p in tmp_path.iterdir()] == ["folder.toml"]


def test_a_failed_write_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "pin.toml"
    save(PIN, path)
    path.chmod(0o640)

    def fail(file: object) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(InvalidInput, match="it cannot be written: No space left"):
        write_atomically(path, fail)
    assert load(path) == PIN
    save(Mechanism("Other", link("frame", A=0)), path)
    assert load(path).title == "Other"
    assert path.stat().st_mode & 0o777 == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    (tmp_path / "link.toml").symlink_to(tmp_path / "pin.toml")
    save(PIN, tmp_path / "link.toml")
    assert (tmp_path / "link.toml").is_symlink()
    assert load(tmp_path / "pin.toml") == PIN
    write_atomically("/dev/null", lambda file: file.write(b"x"))
    assert not Path("/dev/null").is_file()
